"""The groundwork of a table: what its cells share, and where each of them starts.

Homes, start poses and the views that the net learns from are drawn by data_gen, a separate program; the net and a
place classifier for each home learn here. All is kept in the table's folder.
"""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from . import learned
from .files import load_arrays
from .senses import Senses
from .terminal import Stage, count
from .world import World


def prepare(out, settings, cells, n_processes, pool):
    """What the cells share: homes and starts, drawn by a separate program, the net, a GCN for each world.

    Yields (world, Senses) as soon as the world's GCN is learned.
    """
    worlds = sorted({cell.world for cell in cells})
    homes = {world: out / "data" / f"home-{world}.json" for world in worlds}
    # data_gen leaves files alone that hold just these, made by this very code; the same goes for the views.
    names = [part for cell in cells for part in ("--cell", cell.world, cell.t_xy_m, cell.t_theta_deg, cell.seed)]
    _draw("starts", out / "data", *names, "--training", settings.episodes, "--tests", settings.tests,
          "--validation", settings.validation, "--jobs", n_processes)
    net, stage = taught_net(out, settings), Stage("gcn")
    senses = {world: Senses(_load_home(homes[world], world), net, None, settings.noise) for world in worlds}
    how = {"epochs": settings.gcn_epochs, "batch": settings.gcn_batch, "rate": settings.gcn_rate}
    made_by = {"net": learned.fingerprint(net), "noise": settings.noise}
    for world, gcn in learned.place_classifiers(out / "learned", senses, settings.gcn_views, 0, made_by, pool, **how):
        yield world, replace(senses[world], gcn=gcn)
    stage.done(f"places of {count(len(worlds), 'home')}, {settings.gcn_views} views of each")


def taught_net(out, settings, **others):
    """The segmentation net; `others` are other options of `python -m data_gen views`, for another net than ours."""
    options = {"homes": settings.net_homes, "views": settings.net_views, "noise": settings.noise, **others}
    views = out / "data" / ("views" + "".join(f"-{name}-{value}" for name, value in others.items()) + ".npz")
    _draw("views", views, *(part for name, value in options.items() for part in (f"--{name}", value)))
    stage = Stage("net")
    pictures, made_by = learned.load_views(views)
    check_settings(views, made_by, options)
    net = learned.segmentation_net(out / "learned", pictures, made_by, settings.net_epochs, seed=0, stage=stage)
    stage.done(f"{settings.net_epochs} epochs of {options['views']} views of {options['homes']} other homes")
    return net


def starts_path(out, cell):
    """The file of a cell's start poses."""
    return Path(out) / "data" / f"starts-{cell.name}.npz"


def load_starts(out, cell, settings):
    """A cell's start poses; ValueError if there are more or fewer than the settings say."""
    starts, _ = load_arrays(path := starts_path(out, cell))
    wanted = {"training": (settings.episodes, 3), "tests": (settings.tests, 3), "validation": (settings.validation, 3)}
    found = {name: poses.shape for name, poses in starts.items()}
    if found != wanted:
        raise ValueError(f"{path}: expected start poses {wanted}, found {found}")
    if not all(poses.dtype == float and np.isfinite(poses).all() for poses in starts.values()):
        raise ValueError(f"{path}: expected start poses of finite numbers, found others")
    return starts


def check_settings(path, there, settings):
    """ValueError that names a setting which differs in a file of results."""
    for name, value in settings.items():
        if there.get(name) != value:
            raise ValueError(f"{path}: expected results of {name} {value}, found some of {there.get(name)!r}; "
                             "name another folder with --out")


def _load_home(path, seed):
    """The procedural home of a seed; ValueError if it has the name of another one."""
    home = World.load(path)
    if home.name != f"home-{seed}":
        raise ValueError(f"{path}: expected home-{seed}, found {home.name}")
    return home


def _draw(*words):
    """Let data_gen draw something, as a separate program."""
    status = subprocess.run([sys.executable, "-m", "data_gen", *map(str, words)]).returncode
    if status:
        sys.exit(status)  # it has said why
