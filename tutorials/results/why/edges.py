"""What are edges worth to the classifier of places? It learns with them and without them, from 10,000 views.

    python tutorials/results/why/edges.py

Prints for each home, for the net's labels and for true ones, the share of 3000 new views whose place ranks first:
with edges, without, and the paired difference.
"""

from dataclasses import replace
from functools import partial

import numpy as np
from cells_again import SIX, in_cells, run

from gnl import gcn
from gnl.compare import in_points, paired_difference
from gnl.table import Settings

HOMES = SIX[::2]  # one cell of each home
NEW = 3000


def without_edges(graphs):
    """The same words, and no neighbours."""
    return replace(graphs, edges=graphs.edges[:0], edge_starts=0 * graphs.edge_starts)


def measure(settings, _i, task, _starts):
    """The lines of a home."""
    (senses, _, grid), lines = task, []
    for labels, eyes in ("the net's labels", senses), ("true labels", replace(senses, net=None)):
        rng, right = np.random.default_rng(0), []
        poses, new = senses.world.free_poses(settings.gcn_views, rng), senses.world.free_poses(NEW, rng)
        graphs, of_new = eyes.look_around(poses, rng), eyes.look_around(new, rng)
        for change in (lambda graphs: graphs), without_edges:
            network, luck = gcn.GCN(grid.n_places, np.random.default_rng(1)), np.random.default_rng(2)
            gcn.train(network, change(graphs), grid.place_of(poses), luck, settings.gcn_epochs, settings.gcn_batch,
                      settings.gcn_rate)
            right.append(network.scores(change(of_new)).argmax(1) == grid.place_of(new))
        shares = "  ".join(f"{100 * one.mean():4.1f}" for one in right)
        lines.append(f"{senses.world.name}  {labels:<18}{shares}  {in_points(*paired_difference(*right))}")
    return lines


def main(cells=HOMES, settings=None, **where):
    """Measure the homes, and print."""
    settings = settings or Settings()
    print("\n".join(sum(in_cells(partial(measure, settings), cells, settings, **where), [])))


if __name__ == "__main__":
    run(main)
