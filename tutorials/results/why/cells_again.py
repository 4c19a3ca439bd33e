"""Cells of the full run, once more: what they began with, for the other programs in this folder.

Homes, starts, net and classifiers are those of `make table`, in its folder out/table; what is not there yet is made
as the table would make it, and kept. What was measured is lost if a program is stopped.
"""

import os
import sys
from functools import partial
from itertools import repeat
from pathlib import Path

from gnl.experiment import Cell
from gnl.groundwork import load_starts, prepare
from gnl.paper import WORLDS
from gnl.places import PlaceGrid
from gnl.robot import Robot
from gnl.table import Settings
from gnl.terminal import Stage, guarded, processes

SIX = [Cell(world, t_xy_m, t_theta_deg, 0) for world in WORLDS for t_xy_m, t_theta_deg in ((0.2, 10), (1.0, 90))]


def in_cells(measure, cells=SIX, settings=None, out="out/table", retaught=None):
    """measure(i, (Senses, Robot, PlaceGrid), starts) in each cell i, on all cores: a list in the order of the cells.

    retaught(Senses, settings) : the Senses of a home instead of the table's
    """
    settings = settings or Settings()
    with processes(os.cpu_count()) as pool:
        senses = dict(prepare(Path(out), settings, cells, os.cpu_count(), pool))
        if retaught:
            senses = dict(zip(senses, pool.map(retaught, senses.values(), repeat(settings)), strict=True))
        starts = [load_starts(out, cell, settings) for cell in cells]
        found, stage = [], Stage("cells")
        for of_cell in pool.map(partial(_in_cell, measure), range(len(cells)), [senses[cell.world] for cell in cells],
                                starts):
            found.append(of_cell)
            stage(len(found) / len(cells))
    stage.done(f"{len(cells)} measured")
    return found


def _in_cell(measure, i, senses, starts):
    """The same in one cell, in the process that measures."""
    return measure(i, (senses, Robot(senses.world), PlaceGrid(senses.world)), starts)


def run(main):
    """main() as a program, which takes no options."""
    def alone():
        if sys.argv[1:]:
            raise ValueError(f"expected no options, found {' '.join(sys.argv[1:])} (see the head of the file)")
        main()

    guarded(Path(sys.argv[0]).name, alone)


def undone(actions):
    """Share of actions (B, L) that undo the one before: left is 0, right is 1."""
    return (actions[:, 1:] + actions[:, :-1] == 1).mean()
