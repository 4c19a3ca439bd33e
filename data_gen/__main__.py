"""python -m data_gen: write homes and training views to files, for `python -m gnl` to learn from."""

from pathlib import Path

from gnl.draw import save_png
from gnl.experiment import Cell
from gnl.files import load_arrays, save_arrays
from gnl.floor_plan import LARGEST_HOME_M
from gnl.terminal import Parser, Stage, guarded, processes

from .rooms import make_home
from .starts import picture, starts_of
from .views import training_views


def home(args):
    """One procedural home as a floor plan."""
    make_home(args.seed, args.aliasing).save(args.out)


def views(args):
    """Views of many homes and their true labels, unless the file has just these already."""
    made_by = {"homes": args.homes, "views": args.views, "seed": args.seed, "noise": args.noise}
    if Path(args.out).exists() and load_arrays(args.out)[1] == made_by:
        return
    stage = Stage("homes")
    rgb, labels = training_views(args.homes, args.views, args.seed, args.noise, stage)
    save_arrays(args.out, made_by, rgb=rgb, labels=labels)
    stage.done(f"{args.homes} furnished homes drawn, {args.views} views rendered to learn from")


def starts(args):
    """Start poses of cells of Table I, of those that are not there yet."""
    sizes = {"training": args.training, "tests": args.tests, "validation": args.validation}
    for name, size in (*sizes.items(), ("jobs", args.jobs)):
        if size < 1:
            raise ValueError(f"--{name}: expected at least 1, found {size}")
    cells = [cell_of(words) for words in args.cell]
    files = {cell: Path(args.folder) / f"starts-{cell.name}.npz" for cell in cells}
    todo = [cell for cell, path in files.items() if not (path.exists() and load_arrays(path)[1] == sizes)]
    if not todo:
        return
    stage, homes = Stage("starts"), {world: make_home(world) for world in {cell.world for cell in todo}}
    with processes(args.jobs) as pool:
        drawn = [pool.submit(starts_of, cell, homes[cell.world], *sizes.values()) for cell in todo]
        for i, (cell, poses) in enumerate(zip(todo, drawn, strict=True)):
            save_arrays(files[cell], sizes, **poses.result())
            if args.picture:
                save_png(picture(homes[cell.world], poses.result()), files[cell].with_suffix(".png"))
            stage((i + 1) / len(todo))
    stage.done(f"{len(todo)} gaps between where one learns and where one is tested")


def cell_of(words):
    """The Cell of `--cell WORLD M DEG SEED`."""
    try:
        cell = Cell(*(kind(word) for kind, word in zip((int, float, int, int), words, strict=True)))
        if not (min(cell.world, cell.t_theta_deg, cell.seed) >= 0 and 0 <= cell.t_xy_m < LARGEST_HOME_M):
            raise ValueError
    except ValueError:
        raise ValueError(f"--cell: expected WORLD M DEG SEED as in 800 0.2 10 0, found {' '.join(words)}") from None
    return cell


def main(argv=None):
    """Parse the command line and run; exit status 2 and one line for what cannot be done."""
    parser = Parser(prog="python -m data_gen", description=__doc__.partition(": ")[2])
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    command = commands.add_parser("home", help="draw a procedural home")
    command.add_argument("out", help="floor plan to write (.json)")
    command.add_argument("--seed", type=int, default=800)
    command.add_argument("--aliasing", type=float, default=0.3, help="0..1, how alike rooms are (0.3)")
    command.set_defaults(run=home)
    command = commands.add_parser("views", help="render views to train the segmentation net on")
    command.add_argument("out", help="file of arrays to write (.npz)")
    command.add_argument("--homes", type=int, default=40)
    command.add_argument("--views", type=int, default=2400)
    command.add_argument("--seed", type=int, default=0)
    command.add_argument("--noise", type=float, default=1.0, help="appearance noise (1)")
    command.set_defaults(run=views)
    command = commands.add_parser("starts", help="draw start poses with a gap between training and tests")
    command.add_argument("folder", help="where to write them, a file for each cell")
    command.add_argument("--cell", nargs=4, action="append", required=True, metavar=("WORLD", "M", "DEG", "SEED"),
                         help="seed of the home, T_xy, T_theta, seed; may be repeated")
    command.add_argument("--training", type=int, default=10_000)
    command.add_argument("--tests", type=int, default=100)
    command.add_argument("--validation", type=int, default=10)
    command.add_argument("--jobs", type=int, default=1)
    command.add_argument("--picture", action="store_true", help="draw both kinds of starts on the map, too")
    command.set_defaults(run=starts)
    args = parser.parse_args(argv)
    guarded("python -m data_gen", args.run, args)


if __name__ == "__main__":
    main()
