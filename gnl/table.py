"""Table I: all cells on all cores, one file per finished cell; a run that was stopped resumes where it was."""

import os
import sys
import threading
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from .experiment import GAPS_DEG, GAPS_M, N_CHECKPOINTS, Cell, costs_path, load_cell, made_from, run_cell
from .files import check_folder, load_json, save_json
from .gcn import BATCH, EPOCHS, RATE
from .groundwork import check_settings, load_starts, prepare
from .paper import WORLDS
from .photo import check_noise
from .terminal import Stage, count, executor

GAPS = tuple(f"{m}/{deg}" for m in GAPS_M for deg in GAPS_DEG)


@dataclass(frozen=True)
class Settings:
    """What is the same in all cells of a table; the paper's numbers where it has them."""

    episodes: int = 10_000
    tests: int = 100
    validation: int = 10
    noise: float = 1.0
    net_homes: int = 40
    net_views: int = 2400
    net_epochs: int = 6
    gcn_views: int = 10_000
    gcn_epochs: int = EPOCHS
    gcn_batch: int = BATCH
    gcn_rate: float = RATE


QUICK = Settings(episodes=320, tests=40, net_views=1200, net_epochs=3, gcn_views=3000, gcn_epochs=25,
                 gcn_batch=64, gcn_rate=0.004)
QUICK_GAPS = "0.2/10", "1.0/90"


def add_arguments(parser):
    """Options of `python -m gnl table`."""
    parser.add_argument("--worlds", nargs="+", default=WORLDS, metavar="SEED", help="homes (800 801 809)")
    parser.add_argument("--gaps", nargs="+", metavar="M/DEG", help=f"T_xy/T_theta of {GAPS[0]} .. {GAPS[-1]} (all 25)")
    parser.add_argument("--episodes", type=int, help="training episodes per cell (10000)")
    parser.add_argument("--tests", type=int, help="test episodes per cell (100)")
    parser.add_argument("--noise", type=float, help="appearance noise of the views (1)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first cell of each kind (0)")
    parser.add_argument("--repeats", type=int, default=1, help="cells of each kind, with consecutive seeds (1)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (one a core)")
    parser.add_argument("--dask", metavar="ADDRESS", help="run on the cluster of this dask scheduler instead")
    parser.add_argument("--out", default="out/table", help="folder of results (out/table)")
    parser.add_argument("--quick", action="store_true", help="a small slice, in about a minute")


def run(args):
    """Run the cells that are not finished yet."""
    settings, cells = check(args)
    out = Path(args.out)
    check_folder("--out", args.out)
    agree(out, asdict(settings))
    todo = [cell for cell in cells if not finished(out, cell.name, load_cell, asdict(settings))]
    save_json(out / "settings.json", asdict(settings))
    if todo:
        with executor(args.jobs, args.dask) as pool:
            run_jobs(out, jobs_of(out, settings, cells, todo, args.jobs, pool), settings.episodes, pool, "table")
    print(f"{count(len(cells), 'cell')} in {out / 'cells'}")


def jobs_of(out, settings, cells, todo, n_processes, pool):
    """A job for each of the cells to do, home by home.

    ValueError before the first job of a home, if a finished cell was made from another home, net or classifier
    """
    for world, senses in prepare(out, settings, todo, n_processes, pool):
        for cell in cells:
            if cell.world == world and cell not in todo:
                check_parts(cell_path(out, cell.name), senses)
        for cell in todo:
            if cell.world == world:
                yield cell.name, run_cell, cell, senses, load_starts(out, cell, settings), asdict(settings)


def check_parts(path, senses):
    """ValueError if a finished cell was made from another home, net or classifier than new ones will be."""
    here, there = made_from(senses), load_json(path, "the outcomes of a cell").get("made from")
    if there != here:
        raise ValueError(f"{path}: expected a cell made from {here}, as new ones are, found one made from "
                         f"{there}; name another folder with --out")


def run_jobs(out, jobs, n_episodes, pool, name_of_stage):
    """Hand jobs (name, function, *arguments) to the processes, and write each's outcomes and costs as they come.

    jobs : may be a generator; those already made are run, and written, while the next one is made
    """
    waiting, faults, news = {}, [], threading.Event()

    def keep(future):
        """Called by a thread of the pool when a job is done, whatever the main thread waits for."""
        try:
            path, (result, costs) = cell_path(out, waiting[future]), future.result()
            save_json(costs_path(path), costs)
            save_json(path, result)
            del waiting[future]
        except BaseException as error:  # a thread has nobody to tell
            faults.append(error)
        news.set()

    n_jobs = 0
    for name, *job in jobs:
        waiting[future := pool.submit(*job)] = name
        future.add_done_callback(keep)
        n_jobs += 1
    stage, n_left = Stage(name_of_stage), len(waiting)
    stage.note(f"{n_jobs - n_left} of {n_jobs} cells")
    while waiting and not faults:
        done = n_left - len(waiting)  # since this stage began
        rate = done * n_episodes / stage.seconds
        stage(done / n_left, f"{n_jobs - len(waiting)} of {n_jobs} cells, {rate:.0f} episodes/s")
        news.wait(1)
        news.clear()
    if faults:
        raise faults[0]
    stage.done(f"{count(n_jobs, 'cell')} of {n_episodes} episodes each")


def check(args):
    """Settings and cells of the command line; ValueError for what is not possible."""
    settings = QUICK if args.quick else Settings()
    given = {name: getattr(args, name) for name in ("episodes", "tests", "noise") if getattr(args, name) is not None}
    settings = replace(settings, **given)
    for name, value, least in (("jobs", args.jobs, 1), ("repeats", args.repeats, 1), ("seed", args.seed, 0),
                               ("tests", settings.tests, 2), ("episodes", settings.episodes, N_CHECKPOINTS)):
        if value < least:
            raise ValueError(f"--{name}: expected at least {least}, found {value}")
    if settings.episodes % N_CHECKPOINTS:
        raise ValueError(f"--episodes: expected a multiple of {N_CHECKPOINTS}, found {settings.episodes}")
    check_noise(settings.noise, "--noise")
    worlds = [800] if args.quick and args.worlds is WORLDS else [world_of(name) for name in args.worlds]
    gaps = [gap_of(name) for name in args.gaps or (QUICK_GAPS if args.quick else GAPS)]
    for name, values in (("worlds", worlds), ("gaps", gaps)):
        if len(set(values)) < len(values):
            raise ValueError(f"--{name}: expected each once, found {' '.join(map(str, getattr(args, name)))}")
    return settings, [Cell(world, *gap, args.seed + i) for i in range(args.repeats) for gap in gaps for world in worlds]


def world_of(name):
    """The seed of a home in which robots are localized."""
    if not str(name).isdecimal() or int(name) < WORLDS[0]:
        raise ValueError(f"--worlds: expected seeds of homes, {WORLDS[0]} or more, found {name!r}")
    return int(name)


def gap_of(name):
    """T_xy [m] and T_theta [degrees] of "0.2/10"."""
    known = {words: (m, deg) for m in GAPS_M for deg in GAPS_DEG for words in (f"{m}/{deg}", f"{m:g}/{deg}")}
    if name not in known:
        raise ValueError(f"--gaps: expected T_xy/T_theta of {', '.join(map(str, GAPS_M))} m and "
                         f"{', '.join(map(str, GAPS_DEG))} degrees, as in {GAPS[0]}, found {name!r}")
    return known[name]


def agree(out, settings):
    """ValueError if a folder holds results of other settings; settings alone, of a run stopped early, may differ."""
    path = out / "settings.json"
    if path.exists():
        there = load_json(path, "settings")
        if any(out.glob("cells/[!.]*")) or any(out.glob("data/starts-*")):
            check_settings(path, there, settings)


def finished(out, name, load, settings=None):
    """Whether both files of a cell are there and load(path) finds them whole, and of these settings.

    Damaged ones are named and set aside; ValueError for whole ones of other settings.
    """
    path = cell_path(out, name)
    files = path, costs_path(path)
    if not all(file.exists() for file in files):
        return False
    try:
        result, _ = load(path)
    except ValueError as error:
        for file in files:
            os.replace(file, file.with_suffix(".damaged"))
        print(f"{error}; set aside as {path.stem}.damaged, done again", file=sys.stderr)
        return False
    if settings:
        check_settings(path, result.get("settings") or {}, settings)
    return True


def cell_path(out, name):
    """The file of a cell's outcomes."""
    return Path(out) / "cells" / f"{name}.json"
