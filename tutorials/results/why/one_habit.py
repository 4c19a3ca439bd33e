"""What is a plan's lead over chance made of? Plans that turn, or go on, or both, in six cells from anywhere.

    python tutorials/results/why/one_habit.py

Prints by how much each plan is ahead of MV, with an interval over episodes, in the lowest and the highest of the cells,
and how often it goes forward; then three differences between plans. Then what Q says in these views: by how much turns
are worth more to it than a step forward, and left than right, how much that varies from view to view (standard
deviation), and how alike two trainings are in it (correlation).

    turns     turn left or right at random; "Ours, turns" by Q
    k = 64    Ours with so many neighbours
    again     repeats a turn where it would undo it
    going on  chooses at the first view and does the same in every step
"""

import numpy as np
from cells_again import SIX, in_cells, run

from gnl import episode, planners
from gnl.compare import in_points, paired_difference
from gnl.episode import LENGTH
from gnl.nnql import NNQL
from gnl.ranks import reciprocal_ranks
from gnl.robot import FORWARD, LEFT, N_ACTIONS, RIGHT


def turns(_step, states, rng):
    """Left or right at random: 0 or 1."""
    return rng.integers(2, size=len(states))


def among_turns(store):
    """The turn of the greatest Q-value."""
    return lambda _step, states, rng: planners.best_actions(store.q_values(states)[:, :2], rng)


def again(plan):
    """What `plan` says, but the last turn again where that would undo it."""
    last = None

    def repeat(step, states, rng):
        nonlocal last
        action = plan(step, states, rng)
        last = action if step == 0 else np.where(action + last == 1, last, action)  # left is 0, right is 1
        return last
    return repeat


def measure(i, task, starts):
    """For each plan the right answers (n,) and how often it goes forward; numbers of Q, for turns and for left."""
    (senses, _, grid), rng = task, np.random.default_rng((5, i))
    stores = [episode.train_nnql(*task, starts["training"], seed) for seed in (21, 22)]
    wide = episode.train_nnql(*task, starts["training"], 21, store=NNQL(grid.n_places, N_ACTIONS, k=64))
    anywhere = senses.world.free_poses(20 * len(starts["tests"]), rng)
    states = reciprocal_ranks(senses.scores(anywhere, rng))
    plans = {"MV": planners.chance, "turns": turns, "Ours": planners.greedy(stores[0]),
             "Ours, turns": among_turns(stores[0]), "k = 64": planners.greedy(wide)}
    plans = {"always forward": planners.scan([FORWARD] * LENGTH), "always left": planners.scan([LEFT] * LENGTH),
             **plans, **{f"{name}, again": again(plans[name]) for name in ("MV", "Ours", "k = 64")},
             **{f"{name}, going on": planners.go_on(plan) for name, plan in plans.items()}}
    found = {}
    for name, plan in plans.items():
        record = episode.run_all(*task, plan, anywhere, 7 + i)
        found[name] = record.correct[:, -1], (record.actions == FORWARD).mean()
    compared = [(q[:, [LEFT, RIGHT]].mean(1) - q[:, FORWARD], q[:, LEFT] - q[:, RIGHT])
                for q in (store.q_values(states) for store in (*stores, wide))]
    return found, [(one.mean(), one.std(), np.corrcoef(one, two)[0, 1], more.mean(), more.std())
                   for one, two, more in zip(*compared, strict=True)]


def main(cells=SIX, **where):
    """Measure the cells, and print."""
    found, of_q = zip(*in_cells(measure, cells, **where), strict=True)

    def ahead(name, other):
        right, beside = (np.array([of_cell[one][0] for of_cell in found]) for one in (name, other))
        by_cell = 100 * (right.mean(1) - beside.mean(1))
        interval = in_points(*paired_difference(right.ravel(), beside.ravel()))
        return f"{interval:<20}{min(by_cell):+6.1f} to {max(by_cell):+.1f}"

    for name in found[0]:
        print(f"{name:<23}{ahead(name, 'MV'):<36}{np.mean([of_cell[name][1] for of_cell in found]):.0%}")
    for name, other in (("Ours, again", "Ours"), ("Ours, turns, going on", "turns, going on"), ("k = 64", "Ours")):
        print(f"{name} - {other}: ", ahead(name, other))
    for what, numbers in zip(("turns less forward", "left less right"), np.mean(of_q, 0), strict=True):
        print("Q of {}: {:+.2f}, by view {:.2f}, alike {:.2f}; k = 64: {:+.2f}, by view {:.2f}".format(what, *numbers))


if __name__ == "__main__":
    run(main)
