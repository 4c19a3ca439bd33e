"""How much of a difference is luck? Four runs of Table I, which differ in their starts and in all luck, side by side.

    python tutorials/results/four_runs.py

Seed 0 is the full run, whose cells lie beside this file; those of seeds 1 to 3 are in other_seeds. Prints for pairs of
methods the points in each run, in how many of the runs they show (their interval there leaves out zero), and the mean
of all four with its interval, for which a cell is drawn with its four runs.
"""

from functools import partial
from pathlib import Path

import numpy as np

from gnl.compare import in_points, over_cells
from gnl.outcomes import from_training, gains, groups, right
from gnl.report import PAIRS, T_XY, load
from gnl.terminal import guarded

HERE = Path(__file__).parent
ROWS = {**{f"{a} - {b}": (a, b, right) for a, b in PAIRS[:7]},
        "Ours - MV, location alone": ("Ours", "MV", partial(right, what="location")),
        "Ours - MV, training starts": ("Ours", "MV", from_training),
        "Ours - Scan, training starts": ("Ours", "Scan", from_training)}
BY_HOME = ("Ours - MV",)
BY_T_XY = ("Ours - MV", "Ours+ - Scan", "Ours - MV, training starts", "Ours - Scan, training starts")


def line(name, runs, a, b, of):
    """A line of text: method a - b in each run, given the results of its cells in the same order, and over all runs."""
    by_run = np.array([gains(results, a, b, of) for results in runs])
    alone = [over_cells(of_run, np.random.default_rng(0)) for of_run in by_run]
    shown = sum(low > 0 or high < 0 for _, low, high in alone)
    every = in_points(*over_cells(by_run.mean(0), np.random.default_rng(0)))
    return f"{name:28}" + "".join(f"{100 * mean:+8.1f}" for mean, _, _ in alone) + f"{shown:7}   {every}"


def main():
    """Read the cells, and print."""
    results = [result for folder in (HERE, HERE / "other_seeds") for result in load(folder)[0]]
    seeds = sorted({result["cell"]["seed"] for result in results})
    runs = [[result for result in results if result["cell"]["seed"] == seed] for seed in seeds]
    print(f"{'':28}" + "".join(f"  seed {seed}" for seed in seeds) + "  shown   all")
    for name, row in ROWS.items():
        print(line(name, runs, *row))
        keys = [("world", "home {}")] * (name in BY_HOME) + [T_XY] * (name in BY_T_XY)
        for part in zip(*(list(groups(of_run, *keys))[1:] for of_run in runs), strict=True):
            print(line("  " + part[0][0], [of_run for _, of_run in part], *row))


if __name__ == "__main__":
    guarded(Path(__file__).name, main)
