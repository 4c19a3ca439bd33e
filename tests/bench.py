"""Our kernels beside the plain or the library way: `make bench`.

Times drift by a third from run to run, so what counts is the ratio: ours and its rivals take turns within one run, and
a row shows the medians. All times are microseconds of one processor per view, graph, query or filter. Nothing is
asserted. Rivals that are not installed (`pip install -e .[bench]`) are not counted.
"""

import importlib
import time

import numpy as np
import pymunk
from scipy import ndimage
from scipy.spatial import cKDTree

from data_gen.rooms import make_home
from gnl import gcn, nn, segnet
from gnl.camera import true_labels
from gnl.particles import ParticleFilter
from gnl.places import PlaceGrid
from gnl.rank_index import RankIndex
from gnl.ranks import reciprocal_ranks
from gnl.robot import Robot
from gnl.scene_graph import regions, scene_graph
from gnl.strip import cast, slopes

ROUNDS, SAMPLE_S = 11, 0.004  # turns of each peer, and how long one lasts at least
K = 300  # places


def optional(name):
    """The module, or None where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


torch, torch_geometric, faiss = map(optional, ("tests.torch_rivals", "torch_geometric", "faiss"))


class Table:
    """Prints one row a race, and counts the goals."""

    def __init__(self):
        self.rows = self.goals = self.stretches = self.missing = 0
        print(f"{'kernel':42}{'us':>9}  {'beside':38}{'us':>9}{'ratio':>8}{'goal':>7}{'stretch':>9}")

    def race(self, name, ours, n, *rivals):
        """Time `ours`, which does n views at once, beside each rival: (name, function or None, its n, goal, stretch)."""
        here = [rival for rival in rivals if rival[1]]
        times = in_turns([(ours, n), *(rival[1:3] for rival in here)])
        for rival, _, _, goal, stretch in here:
            mine, its = times[0], times[1 + [r[0] for r in here].index(rival)]
            ratio = np.median(mine / its)
            counts = goal is not None
            self.rows, self.goals = self.rows + counts, self.goals + (counts and ratio <= goal)
            self.stretches += counts and ratio <= stretch
            wanted = f"{goal:7.3g}{stretch:9.3g}" if counts else f"{'-':>7}{'-':>9}"
            print(f"{name:42}{np.median(mine):9.1f}  {rival:38}{np.median(its):9.1f}{ratio:8.3f}{wanted}", flush=True)
        for rival in rivals:
            if rival not in here:
                self.missing += 1
                print(f"{name:42}{np.median(times[0]):9.1f}  {rival[0]:38}not installed: not counted", flush=True)

    def end(self):
        print(f"goal reached in {self.goals} of {self.rows} rows, stretch in {self.stretches}; not counted: {self.missing}")


def in_turns(peers):
    """Times of each (function, n) in microseconds per one of its n, (peers, ROUNDS): one turn each, round by round."""
    repeats = []
    for function, _ in peers:
        function()  # warm
        start = time.process_time()
        function()
        repeats.append(max(1, int(SAMPLE_S / (time.process_time() - start))))
    times = np.empty((len(peers), ROUNDS))
    for turn in range(ROUNDS):
        for i, ((function, n), repeat) in enumerate(zip(peers, repeats, strict=True)):
            start = time.process_time()
            for _ in range(repeat):
                function()
            times[i, turn] = (time.process_time() - start) / (repeat * n) * 1e6
    return times


def cameras(table, world, rng):
    """Rays and labels beside pymunk's own ray query, regions beside scipy's."""
    poses = world.free_poses(16, rng)
    one, space = poses[:1], Robot(world).space
    bearing = np.arctan(slopes(512))
    reach_m = np.hypot(*np.subtract(world.bounds[2:], world.bounds[:2]))
    rays = [(x, y, x + reach_m * np.cos(t), y + reach_m * np.sin(t)) for x, y, a in one for t in a + bearing]
    everything = pymunk.ShapeFilter()

    def loop():
        for x0, y0, x1, y1 in rays:
            space.segment_query_first((x0, y0), (x1, y1), 0, everything)

    rival = "pymunk segment_query_first, ray by ray", loop, 1
    table.race("512 rays, one view", lambda: cast(world, one), 1, (*rival, .06, .03))
    table.race("512 rays, 16 views", lambda: cast(world, poses), 16, (*rival, .06, .03))
    table.race("labels 512 x 512, one view", lambda: true_labels(world, one), 1, (*rival, .06, .025))
    table.race("labels 512 x 512, 16 views", lambda: true_labels(world, poses), 16, (*rival, .06, .025))

    for size, goal, stretch in ((512, .07, .03), (64, None, None)):
        labels = true_labels(world, poses, size)
        table.race(f"regions {size} x {size}, 16 views", lambda labels=labels: regions(labels), 16,
                   ("scipy.ndimage.label, class by class", lambda labels=labels: scipy_regions(labels), 16, goal, stretch))


def scipy_regions(labels):
    return [ndimage.label(view == k) for view in labels for k in range(10)]


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
    table.race("GCN training step, 32 graphs", step, 32, ("torch, dense and padded", theirs and theirs.step, 32, .7, .4))


def neighbours(table, rng):
    """The rank index beside everything that looks at all vectors, and a KD-tree of scipy's."""
    for n, stretch in ((10_000, .02), (50_000, .01)):
        states = views_like(n + 64, rng)
        points, queries = states[:n], states[n:]
        index, norm = RankIndex(K), (points[0] ** 2).sum()
        index.add(points)
        flat = faiss and faiss.IndexFlatL2(K)
        if faiss:
            faiss.omp_set_num_threads(1)
            flat.add(points)

        def brute(points=points, queries=queries, norm=norm):
            for q in queries:
                squared = 2 * (norm - points @ q)  # all vectors are of one length
                np.argpartition(squared, 4)[:4]

        def one_by_one(search, queries=queries):
            return lambda: [search(queries[i:i + 1], 4) for i in range(len(queries))]

        tree = cKDTree(points) if n <= 10_000 else None
        goal = .15 if n <= 10_000 else .03
        table.race(f"4 nearest of {n:,}, one query", one_by_one(index.query), 64,
                   ("faiss IndexFlatL2", faiss and one_by_one(flat.search), 64, goal, stretch),
                   ("BLAS product with all", brute, 64, None, None),
                   *([("scipy cKDTree", one_by_one(tree.query), 64, None, None)] if tree else []))
        table.race(f"4 nearest of {n:,}, 64 queries", lambda index=index, queries=queries: index.query(queries, 4), 64,
                   ("faiss IndexFlatL2", faiss and (lambda flat=flat, queries=queries: flat.search(queries, 4)), 64, None, None))


def views_like(n, rng):
    """Reciprocal ranks as a classifier gives them: views of K places that come in 40 looks, told apart with noise."""
    look, place = rng.standard_normal((40, 12)), rng.integers(K, size=n)
    kind = look[rng.integers(40, size=K)] + 0.5 * rng.standard_normal((K, 12))
    return reciprocal_ranks((kind[place] + 0.25 * rng.standard_normal((n, 12))) @ kind.T)


def filters(table, world, rng):
    """One cycle of the particle filter beside the drawing of its random numbers alone."""
    grid = PlaceGrid(world)
    for n in (1, 32):
        likelihood = rng.dirichlet(np.full(grid.n_places, 0.1), n) + 1e-3
        belief, odometry = ParticleFilter(grid, likelihood, rng), np.tile([0.5, 0.1], (n, 1))

        def cycle(belief=belief, odometry=odometry, likelihood=likelihood):
            belief.resample()
            belief.predict(odometry)
            belief.weigh(likelihood)
            belief.belief(grid.n_places)

        table.race(f"particle filter, M = 5000, {n} side by side", cycle, n,
                   ("drawing the normals alone", lambda: rng.standard_normal((3, 5000), np.float32), 1, 3.0, 2.0))


def main():
    """Every race, one after the other."""
    rng, world, table = np.random.default_rng(0), make_home(800), Table()
    cameras(table, world, rng)
    nets(table, rng)
    graph_nets(table, world, rng)
    neighbours(table, rng)
    filters(table, world, rng)
    table.end()


if __name__ == "__main__":
    main()
