"""What cells found, as their files hold it, and what can be asked of it: who was right, after which look, how often.

An outcome is a dict {"place": looks, "location": looks}; looks are T strings, one character per episode, 1 where the
answer was right. The result of a cell holds an outcome of each method and of each checkpoint (experiment.py).

    n episodes of a cell   T looks each   C cells
"""

import numpy as np


def outcome_of(grid, record, n_looks=0):
    """The outcome of a Record: right or wrong after each look, the place and the location alone.

    n_looks : if robots took fewer looks, their last answer is repeated up to this many
    """
    where = grid.location_of(record.answers) == grid.location_of(record.places)
    more = (0, 0), (0, max(0, n_looks - where.shape[1]))
    return {"place": to_strings(np.pad(record.correct, more, "edge")),
            "location": to_strings(np.pad(where, more, "edge"))}


def to_strings(right):
    """(n, T) bool -> T strings of n characters."""
    return ["".join("01"[int(one)] for one in look) for look in right.T]


def from_strings(looks):
    """The way back: T strings -> (n, T) bool."""
    if set("".join(looks)) - {"0", "1"} or len(set(map(len, looks))) != 1 or not looks[0]:
        raise ValueError("looks that are no strings of 0 and 1, all equally long")
    characters = np.array([np.frombuffer(look.encode(), np.uint8) for look in looks]).T
    return characters == ord("1")


def answers(outcome, what="place", look=-1):
    """Whether the answers after one look, by default the last, were right: (n,) bool.

    what : "place", or "location" for the place without its bearing
    """
    return from_strings(outcome[what])[:, look]


def right(result, what="place", checkpoint=-1):
    """Right answers after the last look by method, (n,) bool each; of NNQL at one of its checkpoints."""
    first = {"SV": answers(result["tests"]["MV"], what, look=0)}
    tests = {name: answers(outcome, what) for name, outcome in result["tests"].items()}
    past = result["checkpoints"]
    return {**first, **tests, "Ours": answers(past[checkpoint], what),
            "DA": answers(past[adapted(result)], what), "Oracle": answers(past[best_checkpoint(past)], what)}


def from_training(result):
    """Right answers after the last look from starts of training, of the methods that were tested there."""
    return {name: answers(outcome) for name, outcome in result["from training starts"].items()}


def gains(results, a, b, of=right):
    """Share of right answers of method a minus that of b, cell by cell: a list."""
    by_method = [of(result) for result in results]
    return [one[a].mean() - one[b].mean() for one in by_method]


def curve(results):
    """Right answers of NNQL at each checkpoint, and of the other planners, by cell: {method: (C, checkpoints)}."""
    n = len(results[0]["checkpoints"])
    ours = [[answers(outcome).mean() for outcome in result["checkpoints"]] for result in results]
    others = {name: [[answers(result["tests"][name]).mean()] * n for result in results] for name in results[0]["tests"]}
    return {name: np.array(shares) for name, shares in {"Ours": ours, **others}.items()}


def adapted(result):
    """Checkpoint that is best on the validation episodes: 0, 1, ..."""
    return best_checkpoint(result["validation"])


def best_checkpoint(past):
    """Index of the one with the most right answers, of equal ones the latest; `past` holds an outcome for each."""
    return latest_best([answers(outcome).mean() for outcome in past])


def latest_best(values):
    """Index of the greatest value, of equal ones the last."""
    # CHOICE: of checkpoints that are right equally often the latest; the paper does not say.
    return len(values) - 1 - int(np.argmax(values[::-1]))


def by_world(results):
    """The results of each world."""
    return {world: [result for result in results if result["cell"]["world"] == world]
            for world in sorted({result["cell"]["world"] for result in results})}


def by_gap(results, a, b):
    """Mean gain in points: {world: {(T_xy, T_theta): points}}."""
    found = {}
    for result, gain in zip(results, gains(results, a, b), strict=True):
        cell = result["cell"]
        found.setdefault(cell["world"], {}).setdefault((cell["t_xy_m"], cell["t_theta_deg"]), []).append(100 * gain)
    return {world: {gap: np.mean(points) for gap, points in gaps.items()} for world, gaps in found.items()}


def groups(results, *keys):
    """All results, and those of each value of each key: (words, results). A key comes with a format for its values."""
    yield "all", results
    for key, words in keys:
        for value in sorted({result["cell"][key] for result in results}):
            yield words.format(value), [result for result in results if result["cell"][key] == value]
