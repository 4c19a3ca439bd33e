"""The demonstration: every stage of the paper learns from scratch, then a robot finds out where it is."""

import copy
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import draw, episode, gcn, learned, planners, replay, segnet
from .camera import render
from .compare import paired_difference
from .files import check_folder
from .paper import VIEW_MS
from .photo import check_noise
from .places import PlaceGrid
from .ranks import reciprocal_ranks
from .robot import ACTIONS, Robot
from .scene_graph import scene_graph
from .senses import Senses
from .strip import cast
from .terminal import Stage, processes
from .world import World

COMPARED = ("MV", "SV"), ("Scan", "MV"), ("Ours", "MV"), ("Ours", "Scan")
TRIES = 40  # episodes looked through for one that starts in doubt and ends well


@dataclass(frozen=True)
class Scale:
    """How much the demonstration learns and tests; the comments give the paper's numbers."""

    net_epochs: int = 4
    gcn_views: int = 5000  # 10,000
    gcn_epochs: int = 25  # 100
    gcn_batch: int = 128  # 32; large batches and steps learn most in a short time
    episodes: int = 1200  # 10,000
    scan_starts: int = 160
    tests: int = 320  # 100


def add_arguments(parser):
    """Options of `python -m gnl demo`."""
    parser.add_argument("--plan", required=True, help="floor plan of the home (.json)")
    parser.add_argument("--views", required=True, help="training views of other homes, from `python -m data_gen views`")
    parser.add_argument("--out", default="out", help="folder for what is learned and drawn (out)")
    parser.add_argument("--pictures", help="folder for the pictures (OUT/demo)")
    parser.add_argument("--seed", type=int, default=0, help="seed of all that is learned and tested (0)")
    parser.add_argument("--noise", type=float, default=1.0, help="appearance noise of the views (1)")
    for name, default in vars(Scale()).items():
        parser.add_argument(f"--{name.replace('_', '-')}", type=int, default=default, metavar="N",
                            help=f"{name.replace('_', ' ')} ({default})")


def run(args):
    """Learn what is not learned yet, test the methods on the same starts, draw; at most 25 lines of output."""
    check(args)
    with processes(1) as helper:
        play(args, Scale(**{name: getattr(args, name) for name in vars(Scale())}), helper)


def play(args, scale, helper):
    """The stages one by one; `helper` is an executor with one process, for a second core."""
    world = World.load(args.plan)
    robot, grid = Robot(world), PlaceGrid(world)
    x0, y0, x1, y1 = world.bounds
    print(f"{world.name}: {x1 - x0:.1f} x {y1 - y0:.1f} m, {len(world.plan.get('objects', []))} objects, "
          f"{grid.n_places} places ({grid.nx} x {grid.ny} cells x {grid.n_bearings} bearings)")
    if lost := world.out_of_reach():
        print(f"no robot gets into: {', '.join(lost)} (is there a doorway?)")
    senses, store, sequence = learn(args, scale, helper, world, robot, grid)
    starts = world.free_poses(scale.tests, stream(args, 5))
    plans = {"MV": planners.chance, "Scan": planners.scan(sequence), "Ours": planners.greedy(store)}
    test(args, senses, robot, grid, plans, starts)
    show(args, senses, robot, grid, store, starts)


def learn(args, scale, helper, world, robot, grid):
    """Learn what is in no file yet, and print how good it is; returns Senses, the NNQL store, the sequence of Scan."""
    parts = Path(args.out) / "learned"
    known = set(parts.glob("*.npz"))

    def done(stage, text, if_new=""):
        new = set(parts.glob(f"{stage.name}-*.npz")) - known
        stage.done(text + (if_new if new else ", learned before"))

    stage = Stage("net")
    views, views_made_by = learned.load_views(args.views)
    n_known = views_made_by.get("homes", 0)
    if world.name in (f"home-{seed}" for seed in range(n_known)):
        raise ValueError(f"{args.plan}: expected a home that the net does not learn from (HOUSE from {n_known} on), "
                         f"found {world.name}; a home of your own needs another name")
    net = learned.segmentation_net(parts, views, views_made_by, scale.net_epochs, args.seed, stage)
    seen, true = render(world, world.free_poses(200, stream(args, 8)), stream(args, 9), segnet.SIZE_PX, args.noise)
    right, overlap = segnet.accuracy(segnet.predict(net, seen), true)
    done(stage, f"labels of this unseen home: {right:.0%} of the pixels, mean IoU {overlap:.2f}")

    stage = Stage("gcn")
    senses = Senses(world, net, None, args.noise)
    settings = {"plan": learned.digest(world.plan), "noise": args.noise,
                "net": learned.digest([views_made_by, scale.net_epochs, args.seed])}
    # In few epochs more is learned at twice the paper's rate (once that is scaled to the size of the batch).
    how = {"epochs": scale.gcn_epochs, "batch": scale.gcn_batch, "rate": 2 * gcn.RATE * scale.gcn_batch / gcn.BATCH}
    senses.gcn = learned.place_classifier(parts, senses, grid, scale.gcn_views, args.seed, settings, helper, stage,
                                          **how)
    poses = world.free_poses(500, stream(args, 3))
    first, third = learned.top_places(senses.gcn, senses.look_around(poses, stream(args, 4)), grid.place_of(poses))
    done(stage, f"place from one new view: right {first:.0%}, in the first three {third:.0%}")

    stage = Stage("nnql")
    settings |= {"gcn": learned.digest([scale.gcn_views, how])}
    scan = learned.fixed_scan(parts, senses, grid, scale.scan_starts, args.seed, settings, helper)
    store = learned.q_values(parts, senses, robot, grid, scale.episodes, args.seed, settings, stage)
    done(stage, f"{scale.episodes} episodes, {sum(map(len, store.values))} state-action pairs remembered")
    stage = Stage("scan")
    sequence = scan()
    done(stage, f"best action sequence: {', '.join(ACTIONS[a] for a in sequence)}", ", raced meanwhile")
    return senses, store, sequence


def test(args, senses, robot, grid, plans, starts):
    """Run every method from the same poses, and print how each fared."""
    stage = Stage("test")
    senses.seconds, senses.views = {}, 0
    records = {}
    for i, (name, plan) in enumerate(plans.items()):
        def progress(share, right, i=i, name=name):
            stage((i + share) / len(plans), f"{name} right {right:.0%}")

        records[name] = episode.run_all(senses, robot, grid, plan, starts, args.seed + 6, progress)
    stage.done(f"{len(starts)} episodes of each method, from the same starts with the same noise")
    print_table(records)
    print_costs(senses)


def show(args, senses, robot, grid, store, starts):
    """Draw the stages and an episode."""
    stage, folder = Stage("draw"), Path(args.pictures or Path(args.out, "demo"))
    draw_stages(folder, senses, grid, starts, stream(args, 7))
    looks = telling_episode(senses, robot, grid, store, starts, args.seed, stage)
    replay.save_gif(looks, senses.world, grid, folder / "episode.gif")
    stage.done(f"home, view, labels, strip, graph, ranks and episode.gif in {folder}")


def check(args):
    """ValueError for an option that cannot be."""
    for name in (*vars(Scale()), "seed"):
        least = {"seed": 0, "tests": 2}.get(name, 1)
        if getattr(args, name) < least:
            raise ValueError(f"--{name.replace('_', '-')}: expected at least {least}, found {getattr(args, name)}")
    check_noise(args.noise, "--noise")
    check_folder("--out", args.out)
    check_folder("--pictures", args.out if args.pictures is None else args.pictures)


def stream(args, number):
    """An independent stream of random numbers for each use; 1 and 2 are those of learned.py."""
    return np.random.default_rng([args.seed, number])


def print_table(records):
    """Top-1 accuracy after each look, and paired differences after the last, in percentage points."""
    right = {"SV": records["MV"].correct[:, :1], **{name: record.correct for name, record in records.items()}}
    n_looks = records["MV"].correct.shape[1]
    print(f"{'top-1 [%] after look':<22}" + "".join(f"{look:>6}" for look in range(1, n_looks + 1))
          + "    paired difference, 95 % interval")
    for (name, correct), (a, b) in zip(right.items(), COMPARED, strict=True):
        d, low, high = (100 * value for value in paired_difference(right[a][:, -1], right[b][:, -1]))
        print(f"  {name:<20}" + "".join(f"{100 * share:6.1f}" for share in correct.mean(0)).ljust(6 * n_looks)
              + f"    {a + ' - ' + b:<11} {d:+5.1f}  [{low:+.1f}, {high:+.1f}]")


def print_costs(senses):
    """Milliseconds per view of each stage, episodes side by side."""
    cost = {stage: 1000 * seconds / senses.views for stage, seconds in senses.seconds.items()}
    print(f"a view of 64 x 64, {episode.SIDE_BY_SIDE} at once, costs {sum(cost.values()):.1f} ms "
          f"(the paper: {', '.join(f'{stage} {ms:g}' for stage, ms in VIEW_MS.items())}):")
    print("  " + ", ".join(f"{stage} {ms:.2f}" for stage, ms in cost.items()))


def draw_stages(folder, senses, grid, starts, rng):
    """A picture of the home, and of each stage for the start from which there is most to see.

    It is one where the net gets no fewer pixels right than on average: others would not show what it can do.
    """
    world, size = senses.world, segnet.SIZE_PX
    small, true = render(world, starts, copy.deepcopy(rng), size, senses.noise)
    right = np.mean(_labels(senses, small, true) == true, (1, 2))
    best = np.where(right >= right.mean(), np.diff(scene_graph(true).starts), -1).argmax()
    pose = starts[best:best + 1]
    large, _ = render(world, pose, copy.deepcopy(rng), noise=senses.noise)  # the same light in both sizes
    small, true = render(world, pose, rng, size, senses.noise)
    labels = _labels(senses, small, true)
    graph = scene_graph(labels)
    values = reciprocal_ranks(senses.gcn.scores(graph))[0]
    strip = [part[0] for part in cast(world, pose).dense()]
    view = draw.view(large[0], 512)
    pictures = {
        "1-home": draw.home(world, 820, grid, starts, pose[0]),
        "2-view": draw.sheet([view], [f"what the robot sees; its net gets {size} x {size} pixels of it"]),
        "3-labels": draw.sheet([draw.sheet([draw.labels(labels[0], 384), draw.labels(true[0], 384)],
                                           ["what the net recognises", "the truth"], margin=6),
                                draw.legend(np.unique([labels, true]))], columns=1, margin=6),
        "4-strip": draw.sheet([draw.strip(world, strip)],
                              ["what each ray of the view crosses on its way, at any height; white: nothing"]),
        "5-graph": draw.sheet([draw.graph(graph, view)],
                              ["the scene graph: regions that the net recognises, lines between neighbours"]),
        "6-ranks": draw.sheet([draw.ranks(grid, values, int(grid.place_of(pose)[0]), 10, 400,
                                          ("rank", "place: cell and bearing", "1 / rank"))],
                              ["where such a graph is seen, most likely first; green: the true place"])}
    for name, picture in pictures.items():
        draw.save_png(picture, folder / f"{name}.png")


def _labels(senses, rgb, true):
    """What the robot makes of its views."""
    return true if senses.net is None else segnet.predict(senses.net, rgb)


def telling_episode(senses, robot, grid, store, starts, seed, progress):
    """The first episode of Ours whose first two answers are wrong, its last two right and elsewhere, or nearly so."""
    telling, most = None, -1
    for i, start in enumerate(starts[:TRIES]):
        looks = replay.collect(senses, robot, grid, planners.greedy(store), start, [seed, i], store)
        right = [look.answer == look.place for look in looks]
        moved = grid.location_of(looks[0].answer) != grid.location_of(looks[-1].answer)  # not only the robot
        points = 16 * right[-1] + 8 * (not right[0]) + 4 * moved + 2 * right[-2] + (not right[1])
        if points > most:
            telling, most = looks, points
        if most == 31:
            break
        progress((i + 1) / TRIES)
    return telling
