"""Does Ours gain more where every label is right? All 75 cells with true labels and classifiers that learned from them.

    python tutorials/results/why/right_labels.py

Prints what SV and MV get right, Ours - MV with its interval over the cells, and Ours - MV by home.
"""

from dataclasses import replace

import numpy as np
from cells_again import in_cells, run

from gnl import episode, learned, planners
from gnl.compare import over_cells
from gnl.experiment import GAPS_DEG, GAPS_M, Cell
from gnl.paper import WORLDS
from gnl.places import PlaceGrid

ALL = [Cell(world, m, deg, 0) for world in WORLDS for m in GAPS_M for deg in GAPS_DEG]
TIMES = 10  # runs from each start of the tests


def with_true_labels(senses, settings):
    """Senses without a net, and a classifier that learned from what they see."""
    senses = replace(senses, net=None)
    senses.gcn = learned.learn_places(senses, PlaceGrid(senses.world), settings.gcn_views, 0, batch=settings.gcn_batch,
                                      epochs=settings.gcn_epochs, rate=settings.gcn_rate)
    return senses


def measure(_i, task, starts):
    """Share right of SV, MV and Ours."""
    ours = planners.greedy(episode.train_nnql(*task, starts["training"], seed=21))
    right, chance = (episode.run_all(*task, plan, starts["tests"].repeat(TIMES, 0), 7).correct.mean(0)
                     for plan in (ours, planners.chance))
    return chance[0], chance[-1], right[-1]


def main(cells=ALL, **where):
    """Measure all cells, and print."""
    sv, mv, ours = 100 * np.transpose(in_cells(measure, cells, retaught=with_true_labels, **where))
    mean, low, high = over_cells(ours - mv, np.random.default_rng(0))
    print(f"SV {sv.mean():.1f}   MV {mv.mean():.1f}   Ours - MV {mean:+.1f} [{low:+.1f}, {high:+.1f}]")
    for world in sorted({cell.world for cell in cells}):
        of_world = [cell.world == world for cell in cells]
        print(f"home {world}: Ours - MV {(ours - mv)[of_world].mean():+.1f}")


if __name__ == "__main__":
    run(main)
