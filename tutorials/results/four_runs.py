"""How much of a difference is luck? Four runs of Table I, which differ in their starts and in all luck, side by side.

    python tutorials/results/four_runs.py

Seed 0 is the full run, whose cells lie beside this file; those of seeds 1 to 3 are in other_seeds. Prints by how many
points one method is ahead of another in each run, with a star where the run's own interval leaves out zero, and the
mean of all runs with its interval: a bootstrap over the cells, each with the mean of its runs.
"""

from functools import partial
from pathlib import Path

import numpy as np

from gnl.compare import in_points, over_cells
from gnl.outcomes import from_training, gains, right
from gnl.report import T_XY, load
from gnl.terminal import guarded

HERE = Path(__file__).parent
HOME = "world", "home {}"
ROWS = (("MV", "SV", "", right),  # one method, another, what is special, which answers; then what else to judge it by
        ("Ours", "MV", "", right, HOME, T_XY),
        ("DA", "Ours", "", right),
        ("Scan", "MV", "", right),
        ("Ours", "Scan", "", right),
        ("Ours+", "MV", "", right),
        ("Ours+", "Scan", "", right, T_XY),
        ("Ours", "MV", ", location alone", partial(right, what="location")),
        ("Ours", "MV", ", training starts", from_training, T_XY),
        ("Ours", "Scan", ", training starts", from_training, T_XY))


def interval(d):
    """Mean and 95 % interval over cells (C,); what rounding leaves of a zero is zero."""
    return np.round(over_cells(d, np.random.default_rng(0)), 9) + 0.0


def line(name, d):
    """Differences d (runs, cells) as words: the mean of each run, and of all with its interval."""
    each = "".join(f"{100 * mean:+7.1f}{'*' if low > 0 or high < 0 else ' '}" for mean, low, high in map(interval, d))
    return f"{name:28}{each}  {in_points(*interval(d.mean(0)))}"


def where(result):
    """What the cells of several runs have in common."""
    return [result["cell"][name] for name in ("world", "t_xy_m", "t_theta_deg")]


def main():
    """Read the cells, and print."""
    results = [result for folder in (HERE, HERE / "other_seeds") for result in load(folder)[0]]
    seeds = sorted({result["cell"]["seed"] for result in results})
    runs = [[result for result in results if result["cell"]["seed"] == seed] for seed in seeds]
    for seed, run in zip(seeds, runs, strict=True):
        if list(map(where, run)) != list(map(where, runs[0])):
            raise ValueError(f"{HERE}: expected the {len(runs[0])} cells of seed {seeds[0]} for each seed, "
                             f"found {len(run)} for seed {seed}, others or fewer")
    print(f"{'':28}" + "".join(f" seed {seed} " for seed in seeds) + "  all")
    for a, b, special, of, *parts in ROWS:
        d = np.array([gains(run, a, b, of) for run in runs])
        print(line(f"{a} - {b}{special}", d))
        for key, words in parts:
            values = np.array([result["cell"][key] for result in runs[0]])
            for value in np.unique(values):
                print(line("  " + words.format(value), d[:, values == value]))


if __name__ == "__main__":
    guarded(Path(__file__).name, main)
