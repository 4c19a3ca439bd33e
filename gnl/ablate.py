"""What the paper leaves open, measured: each choice of choices.py replaces ours, and some cells are run again.

For the duration of a run, and in its process alone, the other choice replaces ours. Starts, seeds and luck stay the
same, so that effects are paired differences.
"""

import importlib
import json
import os
import re
from contextlib import contextmanager
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

import numpy as np

from . import episode, learned, nnql, planners
from .choices import CHOICES, OURS, TRUE_LABELS
from .compare import in_points, paired_difference
from .experiment import Cell, costs, costs_path, made_from, now
from .files import check_folder, load_json, save_json, write_whole
from .gaps import poses_beyond
from .groundwork import load_starts, prepare, taught_net
from .outcomes import answers, outcome_of
from .paper import WORLDS
from .places import PlaceGrid
from .report import markdown
from .robot import N_ACTIONS, Robot
from .table import Settings, agree, cell_path, check_parts, finished, run_jobs
from .terminal import executor

SETTINGS = Settings(episodes=3000, tests=400, gcn_views=5000, gcn_epochs=25, gcn_batch=128, gcn_rate=0.008)
CELLS = [Cell(world, 0.2, 10, 0) for world in WORLDS]  # narrow gaps leave room for many tests


def add_arguments(parser):
    """Options of `python -m gnl ablate`."""
    parser.add_argument("--out", default="out/ablate", help="folder of results (out/ablate)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (one a core)")
    parser.add_argument("--points", nargs="+", help="rows of tutorials/open_points.md; ours and "
                        "true labels are run in any case (all that can be measured)")
    parser.add_argument("--page", help="a page like tutorials/open_points.md, into whose tables the effects are filled")


def run(args):
    """Run every choice in every cell, unless it is done already, and print what each changed."""
    if args.jobs < 1:
        raise ValueError(f"--jobs: expected at least 1, found {args.jobs}")
    points = {choice.point for choice in CHOICES}
    for point in args.points or ():
        if point not in points:
            raise ValueError(f"--points: expected some of {', '.join(map(repr, sorted(points)))}, found {point!r}")
    chosen = [choice for choice in CHOICES if not args.points or choice.point in args.points]
    chosen = [OURS, TRUE_LABELS, *(choice for choice in chosen if choice is not TRUE_LABELS)]
    page = args.page and _read_page(args.page)
    out = Path(args.out)
    check_folder("--out", args.out)
    agree(out, asdict(SETTINGS))
    jobs = {name_of(choice, cell): (choice, cell) for choice in chosen for cell in CELLS}
    todo = {name: job for name, job in jobs.items() if not finished(out, name, load)}
    save_json(out / "settings.json", asdict(SETTINGS))
    if todo:
        with executor(args.jobs) as pool:
            senses = dict(prepare(out, SETTINGS, CELLS, args.jobs, pool))
            for name, (_, cell) in jobs.items():
                if name not in todo:
                    check_parts(cell_path(out, name), senses[cell.world])
            starts = {cell: load_starts(out, cell, SETTINGS) for cell in CELLS}
            of_nets = {(choice.point, choice.other): choice.of_net for choice, _ in todo.values() if choice.of_net}
            nets = {name: taught_net(out, SETTINGS, **options) for name, options in of_nets.items()}
            runs = [(name, measure, choice, cell, senses[cell.world], starts[cell], SETTINGS,
                     nets.get((choice.point, choice.other))) for name, (choice, cell) in todo.items()]
            run_jobs(out, runs, SETTINGS.episodes, pool, "ablate")
    if len(todo) < len(jobs):
        print(f"{len(jobs) - len(todo)} of {len(jobs)} runs were there before, in {out / 'cells'}")
    measured = effects(out, chosen)
    print(markdown(["open", "choice", "beside", "MV", "Ours"], measured))
    if page:
        write_whole(args.page, filled(page, measured).encode())


def _read_page(path):
    """The text of a page; ValueError if it holds none."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: expected a page of text, found {error}") from None


def load(path):
    """Outcomes and costs of a run from its two files; ValueError if they are not whole."""
    def check(result):
        if result["name"] != path.stem:
            raise ValueError(f"those of {result['name']}")
        answers(result["tests"]["MV"]), answers(result["tests"]["Ours"])

    return (load_json(path, "the outcomes of a run", check),
            load_json(costs_path(path), "the costs of a run"))


def name_of(choice, cell):
    """For file names: field-of-view-60-degrees-800-0.2m-10deg-seed0."""
    return "-".join(re.findall(r"[\w.]+", f"{choice.point} {choice.other}")) + f"-{cell.name}"


def measure(choice, cell, senses, starts, settings, net=None):
    """Outcomes of MV and of Ours under a choice, and what they cost; `net`, if given, replaces that of the senses."""
    began, (learning, testing) = now(), np.random.SeedSequence(cell.entropy).spawn(2)
    learning = learning.spawn(choice.luck)[-1] if choice.luck else learning
    parts, senses, grid = made_from(senses), replace(senses, seconds={}, views=0), PlaceGrid(senses.world)
    beyond = partial(poses_beyond, senses.world, starts["tests"], cell.t_xy_m, np.radians(cell.t_theta_deg))
    with in_place(choice.constants):
        senses.net = None if choice.true_labels else net or senses.net
        if choice.anew:
            how = {"n_views": settings.gcn_views, "epochs": settings.gcn_epochs, "batch": settings.gcn_batch,
                   "rate": settings.gcn_rate, "draw": choice.views_beyond and partial(beyond, gap=choice.views_beyond)}
            senses.gcn = learned.learn_places(senses, grid, seed=choice.luck, **how | choice.of_gcn)
        training = starts["training"]
        if choice.starts_beyond:
            training = beyond(len(training), np.random.default_rng(learning.spawn(1)[0]), gap=choice.starts_beyond)
        robot = Robot(senses.world, choice.motion)
        store = nnql.NNQL(grid.n_places + choice.n_more, N_ACTIONS, **choice.store)
        with in_place(choice.of_training):
            episode.train_nnql(senses, robot, grid, training, learning, choice.rules, store=store)
        tests = {name: outcome_of(grid, episode.run_all(senses, robot, grid, plan, starts["tests"], testing,
                                                        rules=choice.rules))
                 for name, plan in {"MV": planners.chance, "Ours": planners.greedy(store)}.items()}
    result = {"name": name_of(choice, cell), "made from": parts, "tests": tests}
    return result, costs(senses, began, sum(map(len, store.values)))


@contextmanager
def in_place(constants):
    """Replace constants {"module.NAME": value} of gnl by these values, and put ours back at the end."""
    ours = {}
    try:
        for name, value in constants.items():
            module, attribute = name.split(".")
            module = importlib.import_module(f"gnl.{module}")
            ours[module, attribute] = getattr(module, attribute)
            setattr(module, attribute, value)
        yield
    finally:
        for (module, attribute), value in ours.items():
            setattr(module, attribute, value)


def effects(out, chosen):
    """How much more often MV and Ours are right with each choice than with its reference, in points: rows of text."""
    def right(choice, method):
        parts = [json.loads(cell_path(out, name_of(choice, cell)).read_bytes())["tests"][method] for cell in CELLS]
        return np.concatenate([answers(part) for part in parts])

    rows = []
    for choice in chosen:
        beside = TRUE_LABELS if choice.true_labels and choice is not TRUE_LABELS else OURS
        row = [choice.point, choice.other, beside.other]
        for method in ("MV", "Ours"):
            here, there = right(choice, method), right(beside, method)
            if choice is OURS:
                row.append(f"{100 * here.mean():.1f}")
            else:
                row.append("0" if np.array_equal(here, there) else in_points(*paired_difference(here, there)))
        rows.append(row)
    return rows


def filled(page, measured):
    """The page with the effects filled into the last cell of each table row that begins with the name of a point."""
    words = {}
    for point, other, _beside, mv, ours in measured:
        words.setdefault(point, []).append(f"{other}: MV {mv}, Ours {ours}")
    lines = page.split("\n")
    for i, line in enumerate(lines):
        cells = line.split(" | ")
        point = cells[0].removeprefix("| ")
        if line.startswith("| ") and point in words:
            lines[i] = " | ".join([*cells[:-1], "<br>".join(words[point]) + " |"])
    return "\n".join(lines)
