"""Start poses with a cross-view gap: robots learn where they will not be tested (section III).

Test starts are uniform in free space. A training start is drawn again until it lies farther than T_xy from the
nearest test start and is turned by more than T_theta from it (gnl/gaps.py), so that no episode of learning begins where
a test does.

    T_xy [m], T_theta [rad]   the domain gap     n starts, each (x [m], y [m], theta [rad])
"""

from pathlib import Path

import numpy as np

from gnl.canvas import BELIEF, ROBOT
from gnl.draw import save_png, sheet
from gnl.experiment import Cell
from gnl.files import check_folder, load_arrays, save_arrays
from gnl.floor_map import Map
from gnl.floor_plan import LARGEST_HOME_M
from gnl.gaps import poses_beyond
from gnl.learned import digest, digest_of_code
from gnl.terminal import Stage, count, processes
from gnl.world import World

from .rooms import make_home

MODULES = "box", "furnish", "furniture", "layout", "rooms", "starts"  # modules that decide the start poses


def add_arguments(parser):
    """Options of `python -m data_gen starts`."""
    parser.add_argument("folder", help="folder to write to: a floor plan per home, start poses per cell")
    parser.add_argument("--cell", nargs=4, action="append", required=True, metavar=("WORLD", "M", "DEG", "SEED"),
                        help="seed of the home, T_xy, T_theta, seed; may be repeated")
    parser.add_argument("--training", type=int, default=10_000, help="training starts per cell, beyond the gap (10000)")
    parser.add_argument("--tests", type=int, default=100, help="test starts per cell, from anywhere (100)")
    parser.add_argument("--validation", type=int, default=10, help="more of these, to choose a checkpoint by (10)")
    parser.add_argument("--jobs", type=int, default=1, help="processes (1)")
    parser.add_argument("--picture", action="store_true", help="draw both kinds of starts on the map, too")


def run(args):
    """Write homes and start poses of the cells that lack one or the other."""
    sizes = {"training": args.training, "tests": args.tests, "validation": args.validation}
    made_by = sizes | {"code": digest([digest_of_code(), digest_of_code(modules=["gaps"]),
                                       digest_of_code(Path(__file__).parent, MODULES)])}
    for name, size in (*sizes.items(), ("jobs", args.jobs)):
        if size < 1:
            raise ValueError(f"--{name}: expected at least 1, found {size}")
    cells, folder = [cell_of(words) for words in args.cell], Path(args.folder)
    check_folder("folder", args.folder)
    files = {cell: folder / f"starts-{cell.name}.npz" for cell in cells}
    plans = {cell.world: folder / f"home-{cell.world}.json" for cell in cells}
    todo = [cell for cell, path in files.items()
            if not (plans[cell.world].exists() and path.exists() and load_arrays(path)[1] == made_by
                    and (path.with_suffix(".png").exists() or not args.picture))]
    if not todo:
        return
    stage, homes = Stage("starts"), {world: make_home(world) for world in {cell.world for cell in todo}}
    for world, home in homes.items():
        if plans[world].exists() and digest(World.load(plans[world]).plan) != digest(home.plan):
            raise ValueError(f"{plans[world]}: expected {home.name} or nothing, found another home")
    for world, home in homes.items():
        home.save(plans[world])
    with processes(args.jobs) as pool:
        drawn = [pool.submit(starts_of, cell, homes[cell.world], *sizes.values()) for cell in todo]
        for i, (cell, poses) in enumerate(zip(todo, drawn, strict=True)):
            save_arrays(files[cell], made_by, **poses.result())
            if args.picture:
                save_png(picture(homes[cell.world], poses.result()), files[cell].with_suffix(".png"))
            stage((i + 1) / len(todo))
    stage.done(f"{count(len(todo), 'gap')} between where one learns and where one is tested")


def cell_of(words):
    """The Cell of `--cell WORLD M DEG SEED`."""
    try:
        world, t_xy_m, *others = (kind(word) for kind, word in zip((int, float, int, int), words, strict=True))
        cell = Cell(world, t_xy_m + 0.0, *others)  # -0.0 is 0
        in_its_name = float(f"{cell.t_xy_m:g}")
        if not (min(cell.world, cell.t_theta_deg, cell.seed) >= 0 and 0 <= cell.t_xy_m == in_its_name):
            raise ValueError
    except ValueError:
        raise ValueError("--cell: expected WORLD M DEG SEED as in 800 0.2 10 0, M of at most six digits, "
                         f"found {' '.join(words)}") from None
    if cell.t_xy_m >= LARGEST_HOME_M or cell.t_theta_deg >= 180:
        raise ValueError(f"--cell: expected M below {LARGEST_HOME_M:g} and DEG below 180, found {' '.join(words)}")
    return cell


def starts_of(cell, world, n_training, n_tests, n_validation):
    """Starts of a cell of Table I; tests of one cell are no tests of another (whose gap differs by 1 mm at least)."""
    gap = cell.t_xy_m, np.radians(cell.t_theta_deg)
    return draw_starts(world, *gap, n_training, n_tests, n_validation, np.random.default_rng(cell.entropy))


def draw_starts(world, t_xy_m, t_theta_rad, n_training, n_tests, n_validation, rng):
    """Starts of one experiment as a dict: "tests", "validation" (of the test domain, too) and "training", (n, 3) each.

    The test starts are drawn first: from equal generators they are the same whatever the gap.
    """
    tests, validation = world.free_poses(n_tests, rng), world.free_poses(n_validation, rng)
    training = poses_beyond(world, tests, t_xy_m, t_theta_rad, n_training, rng)
    return {"tests": tests, "validation": validation, "training": training}


def picture(world, starts, n=400, width_px=720):
    """A map of the test starts and of n of the training starts, each a little arrow."""
    canvas, training = Map(world, width_px), starts["training"][:n]
    canvas.starts(training, BELIEF)
    canvas.starts(starts["tests"], ROBOT)
    return sheet([canvas.picture()], [f"orange: all {len(starts['tests'])} test starts; "
                                      f"violet: {len(training)} of {len(starts['training'])} training starts"])
