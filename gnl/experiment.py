"""One cell of Table I: learn on one side of a domain gap, be tested on the other (section V).

A cell is a world, a gap (T_xy, T_theta) between the starts of training and of the tests, and a seed. All its methods
are tested from the same starts with the same luck, so that they can be compared in pairs.

    SV     the first view alone               MV     random actions   Scan   the best fixed sequence of actions
    Ours   the paper's NNQL                   DA     Ours at the checkpoint that is best on a few validation episodes
    Oracle Ours at the checkpoint that is best on the tests themselves: that is cheating, and shows what DA could gain
    Ours+  an action chosen once and repeated (options.py; not in the paper)

SV is the first look of MV; Ours, DA and Oracle are chosen among the checkpoints (outcomes.py).
MV, Scan and Ours are tested once more, from some of the starts of training: what has Ours learned by heart?
"""

import platform
import resource
import sys
import time
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version

import numpy as np

from . import episode, learned, planners
from .files import load_json
from .options import Experience, Options
from .outcomes import curve, from_strings, from_training, outcome_of, right
from .places import PlaceGrid
from .robot import Robot
from .senses import SharedSenses

N_CHECKPOINTS = 10
RACE_STARTS = 240  # training starts over which the fixed sequences race
GAPS_M, GAPS_DEG = (0.2, 0.4, 0.6, 0.8, 1.0), (10, 30, 50, 70, 90)  # the paper's, 25 in all


@dataclass(frozen=True)
class Cell:
    """Which cell it is; `world` is the seed of its home."""

    world: int
    t_xy_m: float
    t_theta_deg: int
    seed: int

    @property
    def name(self):
        """For file names: 800-0.2m-10deg-seed0."""
        return f"{self.world}-{self.t_xy_m:g}m-{self.t_theta_deg}deg-seed{self.seed}"

    @property
    def entropy(self):
        """What its random numbers are seeded with."""
        return [self.seed, self.world, round(1000 * self.t_xy_m), self.t_theta_deg]


def run_cell(cell, senses, starts, settings=None):
    """Learn and test in one cell; a function of its arguments alone, in whatever process it runs.

    starts   : "training" (a multiple of N_CHECKPOINTS), "validation" and "tests", (n, 3) each
    settings : a dict that goes into the outcomes with what identifies home, net and GCN
    returns  : the outcomes, and what they cost, both as dicts for JSON
    """
    began, senses = now(), replace(senses, seconds={}, views=0)
    robot, grid = Robot(senses.world), PlaceGrid(senses.world)
    learning, racing, testing, validating, rehearsing = np.random.SeedSequence(cell.entropy).spawn(5)
    training = starts["training"]
    lived = Experience()
    store = episode.train_nnql(senses, robot, grid, training, learning,
                               checkpoint_every=len(training) // N_CHECKPOINTS, watch=lived.watch)
    of_training = {"seconds": time.time() - began[0], "views": senses.views}
    sequences, worth = episode.race(senses, robot, grid, training[:RACE_STARTS], racing)
    options = senses.timed("options", Options, lived, sequences, worth)

    def test(plans, poses, seed):  # all from the same starts with the same luck
        shared = SharedSenses(senses)
        return {name: outcome_of(grid, episode.run_all(shared, robot, grid, plan, poses, seed), 1 + episode.LENGTH)
                for name, plan in plans.items()}

    plans = {"MV": planners.chance, "Scan": planners.scan(sequences[0]),
             "Ours+": planners.go_on(planners.greedy(options))}
    past = {i: planners.greedy(store.at(i)) for i in range(N_CHECKPOINTS)}
    tests = test({**plans, **past}, starts["tests"], testing)
    known = training[np.linspace(0, len(training) - 1, len(starts["tests"])).astype(int)]
    by_heart = {"MV": plans["MV"], "Scan": plans["Scan"], "Ours": past[N_CHECKPOINTS - 1]}
    result = {"name": cell.name, "cell": asdict(cell), "settings": settings, "made from": made_from(senses),
              "sequence": sequences[0].tolist(), "tests": {name: tests[name] for name in plans},
              "from training starts": test(by_heart, known, rehearsing),
              "checkpoints": [tests[i] for i in past],
              "validation": list(test(past, starts["validation"], validating).values())}
    return result, {**costs(senses, began, sum(map(len, store.values))), "of training": of_training}


def made_from(senses):
    """What identifies home, net and classifier."""
    params = getattr(senses.gcn, "params", None)  # another classifier may have none
    return {"home": learned.digest(senses.world.plan), "net": senses.net and learned.fingerprint(senses.net),
            "gcn": learned.fingerprint(params) if params else type(senses.gcn).__name__}


def now():
    """Wall-clock time and processor time of this process [s]."""
    return time.time(), time.process_time()


def costs(senses, began, n_pairs):
    """Seconds of each stage, memory, and the machine and the library versions behind them."""
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform == "darwin" else 1)  # [kB]
    return {"seconds": time.time() - began[0], "of processor": time.process_time() - began[1], "views": senses.views,
            "of stages": senses.seconds, "pairs": n_pairs, "host": platform.node(), "machine": platform.platform(),
            "peak MB": memory / 1024,
            "versions": {"python": platform.python_version(), **{name: version(name) for name in
                                                                 ("numpy", "scipy", "pillow", "pymunk")}}}


def costs_path(path):
    """The file of the costs of a cell, from that of its outcomes."""
    return path.parents[1] / "costs" / path.name


def load_cell(path):
    """Outcomes and costs of a cell from its two files, checked for all that the report needs."""
    def check(result):
        curve([result]), right(result)  # each fails where something is missing
        if lacking := {"MV", "Scan", "Ours"} - from_training(result).keys():
            raise ValueError(f"no {', '.join(sorted(lacking))} from training starts")
        for tests in [*result["tests"].values(), *result["checkpoints"]], result["from training starts"].values():
            sizes = {np.shape(from_strings(outcome[name])) for outcome in tests for name in ("place", "location")}
            if len(sizes) > 1:
                raise ValueError(f"tests of {sizes} episodes and looks")
            n_tests, _ = sizes.pop()
            if n_tests != (result.get("settings") or {}).get("tests", n_tests):
                raise ValueError(f"{n_tests} tests")
        cell = Cell(**result["cell"])
        if cell.name != path.stem or not all(isinstance(value, (int, float)) for value in result["cell"].values()):
            raise ValueError(f"those of {cell}")
        if not len(result["checkpoints"]) == len(result["validation"]) == N_CHECKPOINTS:
            raise ValueError(f"{len(result['checkpoints'])} checkpoints, {len(result['validation'])} validated")

    def check_costs(costs):
        numbers = [costs["seconds"], costs["views"], costs["peak MB"], costs["of training"]["seconds"],
                   *costs["of stages"].values()]
        if not all(0 <= number < 1e15 for number in numbers) or not costs["views"]:  # NaN compares as false
            raise ValueError("no views, less than nothing, or no number")
        costs["of stages"]["graph"], costs["machine"].split(), costs["versions"].items()

    return (load_json(path, "the outcomes of a cell", check),
            load_json(costs_path(path), "the costs of a cell", check_costs))
