"""Our kernels beside the plain or the library way: `make bench`.

Times drift by a third from run to run, so what counts is the ratio: ours and its rivals take turns within one run,
each long enough to find in the caches what it left there and not what the other did, and a row shows the medians. All
times are microseconds of one processor per view, graph, query or filter. A row's goal is the ratio that we set out to
reach, its stretch what we would rather reach. Nothing is asserted. Rivals that are not installed are not counted.
"""

import importlib
import itertools
import time
from types import SimpleNamespace

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from data_gen.rooms import make_home
from gnl import episode, gcn, nn, segnet
from gnl.camera import true_labels
from gnl.nnql import NNQL
from gnl.particles import ParticleFilter
from gnl.places import PlaceGrid
from gnl.rank_index import RankIndex
from gnl.robot import N_ACTIONS, Robot
from gnl.scene_graph import regions, scene_graph
from gnl.senses import Senses
from gnl.strip import cast
from tests.bench_data import plain_filter, ray_loop, views_like

ROUNDS, SAMPLE_S, K = 11, 0.05, 300  # turns of each peer, and how long one lasts at least; places


def optional(name):
    """The module, or None where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


torch, torch_geometric, faiss, filterpy = map(optional, ("tests.torch_rivals", "torch_geometric", "faiss",
                                                         "filterpy.monte_carlo"))


class Table:
    """Prints one row a race, and counts the goals."""

    def __init__(self):
        self.rows = self.goals = self.stretches = self.missing = 0
        print(f"{'kernel':42}{'us':>9}  {'beside':38}{'us':>9}{'ratio':>8}{'goal':>7}{'stretch':>9}")

    def race(self, name, ours, n, *rivals):
        """Time `ours`, n views per call, beside each rival: (name, function or None, its n, goal, stretch)."""
        here = [rival[1:3] for rival in rivals if rival[1]]
        mine, *others = in_turns([(ours, n), *here])
        for rival, function, _, goal, stretch in rivals:
            print(f"{name:42}{np.median(mine):9.1f}  {rival:38}", end="")
            if not function:
                self.missing += 1
                print("not installed: not counted")
                continue
            its = others.pop(0)
            ratio = np.median(mine / its)
            print(f"{np.median(its):9.1f}{ratio:8.3f}", f"{goal:6.3g}{stretch:9.3g}" if goal else "     -        -")
            if goal:
                self.rows, self.goals, self.stretches = (self.rows + 1, self.goals + (ratio <= goal),
                                                         self.stretches + (ratio <= stretch))

    def end(self):
        print(f"goal reached in {self.goals} of {self.rows} rows, stretch in {self.stretches}; not installed: "
              f"{self.missing}" + " (pip install -e .[bench])" * (self.missing > 0))


def in_turns(peers):
    """Times of each (function, n) in microseconds per item, round by round, each in turn: (peers, ROUNDS)."""
    def seconds(function, repeat):
        start = time.process_time()
        for _ in range(repeat):
            function()
        return time.process_time() - start

    repeats = [max(1, int(SAMPLE_S / seconds(function, 2) * 2)) for function, _ in peers]
    turns = [[seconds(function, repeat) / repeat for (function, _), repeat in zip(peers, repeats, strict=True)]
             for _ in range(ROUNDS)]
    return np.array(turns).T / [[n] for _, n in peers] * 1e6


def cameras(table, world, rng):
    """Rays and labels beside pymunk's own ray query, regions beside scipy's."""
    poses = world.free_poses(16, rng)
    singles = np.split(poses[:4], 4)
    rival = "pymunk segment_query_first, ray by ray", ray_loop(world, poses[:4]), 4
    for name, kernel, stretch in (("512 rays", cast, .03), ("labels 512 x 512", true_labels, .025)):
        table.race(f"{name}, one view", lambda kernel=kernel: [kernel(world, one) for one in singles], 4,
                   (*rival, .06, stretch))
        table.race(f"{name}, 16 views", lambda kernel=kernel: kernel(world, poses), 16, (*rival, .06, stretch))

    for size, goal in ((512, .07), (64, None)):
        labels = true_labels(world, poses, size)

        def by_scipy(labels=labels):
            return [ndimage.label(view == k) for view in labels for k in range(10)]

        table.race(f"regions {size} x {size}, 16 views", lambda labels=labels: regions(labels), 16,
                   ("scipy.ndimage.label, class by class", by_scipy, 16, goal, goal))


def nets(table, rng):
    """The segmentation net beside the same net in torch."""
    params = {name: (p + 0.05 * rng.standard_normal(p.shape)).astype(np.float32)
              for name, p in segnet.new_params(rng).items()}
    rgb = rng.integers(256, size=(32, 64, 64, 3), dtype=np.uint8)
    labels = segnet.to_quads(rng.integers(10, size=(8, 64, 64)))
    theirs = torch.TorchNet(params) if torch else None

    def forward():
        for i in range(0, 32, 8):  # as in segnet.predict
            segnet.forward(params, rgb[i:i + 8])

    def forward_backward():
        scores, cache = segnet.forward(params, rgb[:8])
        segnet.backward(params, nn.softmax_cross_entropy(scores, labels, axis=0)[1], cache)

    table.race("net forward, one view", lambda: segnet.forward(params, rgb[:1]), 1,
               ("torch", theirs and (lambda: theirs.scores(rgb[:1])), 1, .9, .5))
    table.race("net forward, 32 views", forward, 32, ("torch", theirs and (lambda: theirs.scores(rgb)), 32, 1.5, 1.0))
    table.race("net forward and backward, 8 views", forward_backward, 8,
               ("torch", theirs and (lambda: theirs.gradients(rgb[:8], labels)), 8, 1.4, 1.0))


def graph_nets(table, world, rng):
    """The GCN beside torch_geometric's layer and dense algebra in torch."""
    graphs, places = scene_graph(true_labels(world, world.free_poses(32, rng), 64)), rng.integers(K, size=32)
    ours = gcn.GCN(K, rng)
    adam, theirs = nn.Adam(ours.params), torch.TorchGCN(ours, graphs, places) if torch else None
    geometric = theirs if torch_geometric else None

    def step():
        scores, cache = ours.forward(graphs)
        adam.step(ours.backward(nn.softmax_cross_entropy(scores, places)[1], cache))

    table.race("GCN forward, 32 graphs", lambda: ours.scores(graphs), 32,
               ("torch_geometric, graph by graph", geometric and geometric.one_by_one, 32, .3, .12),
               ("torch_geometric, as one batch", geometric and geometric.at_once, 32, .3, .12))
    table.race("GCN training step, 32 graphs", step, 32,
               ("torch, dense and padded", theirs and theirs.step, 32, .7, .4))


def neighbours(table, rng):
    """The rank index beside two that look at all vectors, and scipy's KD-tree."""
    for n, goal, stretch in ((10_000, .15, .02), (50_000, .03, .01)):
        states = views_like(n + 64, K, rng)
        points, queries = states[:n], states[n:]
        index, flat, tree = RankIndex(K), faiss and faiss.IndexFlatL2(K), n <= 10_000 and cKDTree(points)
        index.add(points)
        if faiss:
            faiss.omp_set_num_threads(1)
            flat.add(points)

        def one_by_one(search, queries=queries):
            return lambda: [search(query, 4) for query in queries[:, None]]

        def at_once(search, queries=queries):
            return lambda: search(queries, 4)

        def nearest_by_product(query, k, points=points):  # all vectors are of one length
            return np.argpartition(-(points @ query[0]), k)[:k]

        table.race(f"4 nearest of {n:,}, one query", one_by_one(index.query), 64,
                   ("faiss IndexFlatL2", faiss and one_by_one(flat.search), 64, goal, stretch),
                   ("BLAS product with all", one_by_one(nearest_by_product), 64, None, None),
                   *([("scipy cKDTree", one_by_one(tree.query), 64, None, None)] if tree else []))
        table.race(f"4 nearest of {n:,}, 64 queries", at_once(index.query), 64,
                   ("faiss IndexFlatL2", faiss and at_once(flat.search), 64, goal, stretch))


def steps(table, world, rng):
    """A step of robots that learn, all stages, with much to remember beside one with little; what they see is new."""
    grid, robot, starts = PlaceGrid(world), Robot(world), world.free_poses(64, rng)
    net, classifier = segnet.new_params(rng), gcn.GCN(grid.n_places, rng)

    def with_pairs(n):
        store, states = NNQL(grid.n_places, N_ACTIONS), views_like(n + 64 * 100, grid.n_places, rng)
        for a, of_action in enumerate(np.array_split(states[:n], N_ACTIONS)):
            store.index[a].add(of_action)
            store.values[a] = np.zeros(len(of_action))
        unseen = itertools.cycle(states[n:].reshape(-1, 64, grid.n_places))
        taught = SimpleNamespace(scores=lambda graphs: (classifier.scores(graphs), next(unseen))[1])
        senses = Senses(world, net, taught)
        return lambda: episode.train_nnql(senses, robot, grid, starts, 0, store=store)

    table.race("a step of 64 learners, 40,000 pairs", with_pairs(40_000), 64 * 5,
               ("with 4,000 pairs", with_pairs(4_000), 64 * 5, 1.5, 1.0))


def filters(table, world, rng):
    """One cycle of the particle filter beside the drawing of its random numbers alone, and filterpy's resampling."""
    grid = PlaceGrid(world)
    for n in (1, 32):
        likelihood = rng.dirichlet(np.full(grid.n_places, 0.1), n) + 1e-3
        belief, odometry = ParticleFilter(grid, likelihood, rng), np.tile([0.5, 0.1], (n, 1))

        def cycle(belief=belief, odometry=odometry, likelihood=likelihood):
            belief.resample()
            belief.predict(odometry)
            belief.weigh(likelihood)
            belief.belief()

        plain = filterpy and plain_filter(grid, likelihood[0], rng, filterpy.systematic_resample)
        table.race(f"particle filter, M = 5000, {n} side by side", cycle, n,
                   ("drawing the normals alone", lambda: rng.standard_normal((3, 5000), np.float32), 1, 3.0, 2.0),
                   ("one plain filter, filterpy resampling", plain, 1, .2, .2))


def main():
    """Every race, one after the other."""
    rng, world, table = np.random.default_rng(0), make_home(800), Table()
    cameras(table, world, rng)
    nets(table, rng)
    graph_nets(table, world, rng)
    neighbours(table, rng)
    filters(table, world, rng)
    steps(table, world, rng)
    table.end()


if __name__ == "__main__":
    main()
