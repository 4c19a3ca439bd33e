"""Learned parts, each kept in a file: learned when it is not there yet, loaded when it is.

A file's name carries a digest of the settings that went into it (seed, floor plan, training views) and of the code of
the stages, so other settings or code make another file, and never a wrong answer.
"""

import hashlib
import json
from functools import partial
from pathlib import Path

import numpy as np

from . import episode, gcn, nnql, segnet
from .checks import check_count
from .classes import N_CLASSES
from .files import load_arrays, save_arrays
from .places import PlaceGrid
from .ranks import ranks
from .robot import Robot, check_actions
from .scene_graph import join
from .senses import Senses

# A change in any of these modules means that all is learned anew.
STAGES = ("camera", "checkpoints", "checks", "classes", "episode", "floor_plan", "free_space", "gcn", "kdtree",
          "learned", "nn", "nnql", "particles", "photo", "places", "planners", "polygons", "rank_index", "ranks",
          "robot", "scene_graph", "segnet", "senses", "strip", "world")


def digest_of_code(folder=Path(__file__).parent, modules=STAGES):
    """Eight hex digits of the text of some modules."""
    return digest([(folder / f"{name}.py").read_text(encoding="utf-8") for name in modules])


def digest(settings):
    """Eight hex digits of anything that JSON can hold."""
    return hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest()[:8]


def fingerprint(params):
    """Eight hex digits of a dict of arrays, to the last bit."""
    whole = hashlib.sha256()
    for name, array in sorted(params.items()):
        whole.update(f"{name} {array.dtype} {array.shape}".encode() + array.tobytes())
    return whole.hexdigest()[:8]


def path_of(folder, name, settings):
    """The file of the part `name` made with `settings`."""
    return Path(folder) / f"{name}-{digest([settings, digest_of_code()])}.npz"


def kept(folder, name, settings, load, learn):
    """load(path) of the part `name` made with `settings`, or learn(path), which must write it."""
    path = path_of(folder, name, settings)
    if not path.exists():
        return learn(path)
    try:
        part, made_by = load(path)
    except ValueError as error:
        raise ValueError(f"{error}; remove it, and it is learned anew") from None
    if made_by != json.loads(json.dumps(settings)):
        raise ValueError(f"{path}: expected what was made by {settings}, found what was made by {made_by}")
    return part


def load_views(path):
    """Training views (rgb, labels) in a file made by `python -m data_gen views`, and what made them."""
    arrays, made_by = load_arrays(path)
    if not isinstance(made_by, dict) or not isinstance(made_by.get("homes", 0), int):
        raise ValueError(f"{path}: expected views of `python -m data_gen views`, found some made by {made_by}")
    rgb, labels = arrays.get("rgb", np.empty(0)), arrays.get("labels", np.empty(0))
    size = segnet.SIZE_PX
    if not (rgb.shape == (len(labels), size, size, 3) and labels.shape == (len(rgb), size, size)
            and rgb.dtype == labels.dtype == np.uint8 and len(rgb)):
        raise ValueError(f"{path}: expected rgb (n, {size}, {size}, 3) and labels (n, {size}, {size}) of bytes, "
                         f"found {', '.join(f'{name} {a.shape}' for name, a in arrays.items())}")
    if labels.max() >= N_CLASSES:
        raise ValueError(f"{path}: expected labels 0..{N_CLASSES - 1}, found {labels.max()}")
    return (rgb, labels), made_by


def segmentation_net(folder, views, views_made_by, epochs, seed, stage):
    """Weights of the net trained on `views` (rgb, labels)."""
    settings = {"views": views_made_by, "epochs": epochs, "seed": seed,
                "start": fingerprint(segnet.new_params(np.random.default_rng(seed)))}  # other layers, another file

    def learn(path):
        rng = np.random.default_rng(seed)
        params = segnet.new_params(rng)
        segnet.train(params, *views, rng, epochs, progress=lambda share, loss: stage(share, f"loss {loss:.2f}"))
        segnet.save(params, path, settings)
        return params

    return kept(folder, "net", settings, segnet.load, learn)


def place_classifier(folder, senses, grid, n_views, seed, settings, helper, stage, **how):
    """GCN trained on `n_views` views from random free poses, `how` as for gcn.train.

    `settings` names what `senses` is made of; `helper` is an executor whose process looks at half of the views.
    """
    settings = {**settings, "views": n_views, "seed": seed, **how}

    def learn(path):
        network = learn_places(senses, grid, n_views, seed, helper, stage, **how)
        network.save(path, settings)
        return network

    return kept(folder, "gcn", settings, gcn.GCN.load, learn)


def place_classifiers(folder, senses, n_views, seed, settings, pool, **how):
    """The same for several worlds, each in a process of the executor `pool`: dict of Senses -> (world, GCN) one by one.

    To ask for the next one is to wait until it is learned; in between, the pool can be given other work.
    """
    settings_of = {world: {**settings, "plan": digest(of_world.world.plan), "views": n_views, "seed": seed, **how}
                   for world, of_world in senses.items()}
    learning = {world: pool.submit(learn_places, of_world, PlaceGrid(of_world.world), n_views, seed, **how)
                for world, of_world in senses.items() if not path_of(folder, "gcn", settings_of[world]).exists()}

    def learn(world, path):
        network = learning[world].result()
        network.save(path, settings_of[world])
        return network

    for world in senses:
        yield world, kept(folder, "gcn", settings_of[world], gcn.GCN.load, partial(learn, world))


def learn_places(senses, grid, n_views, seed, helper=None, stage=None, dtype=np.float32, draw=None, **how):
    """GCN trained on views from random free poses; half of them are seen by the `helper`, if there is one.

    draw(n, rng) : poses (n, 3) to learn from, if not from anywhere
    """
    n_views, rng = check_count("n_views", n_views, 1), np.random.default_rng(seed)
    # CHOICE: from the whole home, places near the tests too; the paper trains one classifier "for each dataset".
    poses = (draw or senses.world.free_poses)(n_views, rng)
    theirs, ours = None, poses
    if helper and n_views > 1:
        ours, others = poses[:n_views // 2], poses[n_views // 2:]
        theirs = helper.submit(senses.look_around, others, np.random.default_rng([seed, 1]))
    graphs = senses.look_around(ours, rng, stage and (lambda share: stage(0.5 * share, "looking around")))
    if theirs:
        graphs = join([graphs, theirs.result()])
    network = gcn.GCN(grid.n_places, rng, dtype=dtype)
    gcn.train(network, graphs, grid.place_of(poses), rng, **how,
              progress=stage and (lambda share, loss: stage(0.5 + 0.5 * share, f"loss {loss:.2f}")))
    return network


def quick_senses(world, n_views=2000, seed=0, grid=None):
    """Senses to try things with: true labels, no noise, and a GCN that has learned the places in seconds.

    It learns in 64 bits, so that rounding decides nothing, and from poses that default_rng(seed) does not draw.
    """
    senses = Senses(world, None, None, noise=0)
    senses.gcn = learn_places(senses, grid or PlaceGrid(world), n_views, [seed, 1], dtype=float, epochs=10, batch=64,
                              rate=0.01)
    return senses


def q_values(folder, senses, robot, grid, n_episodes, seed, settings, stage):
    """NNQL store after `n_episodes` training episodes from random starts."""
    settings = {**settings, "episodes": n_episodes, "seed": seed}

    def learn(path):
        starts = senses.world.free_poses(n_episodes, np.random.default_rng([seed, 1]))
        store = episode.train_nnql(senses, robot, grid, starts, seed,
                                   progress=lambda share, right: stage(share, f"right {right:.0%}"))
        store.save(path, settings)
        return store

    return kept(folder, "nnql", settings, nnql.NNQL.load, learn)


def fixed_scan(folder, senses, grid, n_starts, seed, settings, helper):
    """Best fixed action sequence over `n_starts` random starts: a function that waits till `helper` has found it."""
    settings = {**settings, "starts": n_starts, "seed": seed}
    known = path_of(folder, "scan", settings).exists()
    sought = None if known else helper.submit(best_sequence, senses, grid, n_starts, seed)

    def learn(path):
        save_arrays(path, settings, sequence=sought.result())
        return sought.result()

    def load(path):
        arrays, made_by = load_arrays(path)
        try:
            return check_actions(arrays["sequence"], episode.LENGTH), made_by
        except (ValueError, KeyError) as error:
            raise ValueError(f"{path}: expected a sequence of actions ({error})") from None

    return lambda: kept(folder, "scan", settings, load, learn)


def best_sequence(senses, grid, n_starts, seed):
    """The winner of a race from random starts, not those that the classifier learned from under the same seed."""
    starts = senses.world.free_poses(n_starts, np.random.default_rng([seed, 2]))
    return episode.race(senses, Robot(senses.world), grid, starts, seed)[0][0]


def top_places(network, graphs, places):
    """Share of views whose place is the classifier's first, and among its first three."""
    rank = ranks(network.scores(graphs))[np.arange(len(places)), places]
    return (rank == 1).mean(), (rank <= 3).mean()
