"""Other choices than ours where the paper is open: `python -m gnl ablate` measures what each would change.

A choice is a rule of the episode, an argument of the store or of the robot, or a constant by its name. The constant
must be read when it is used: a default argument (N_PARTICLES) was read when its function was defined; for those there
is `partial`. Functions must have a name in a module: a choice is sent to other processes, and a lambda cannot be.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from scipy import ndimage

from . import planners
from .camera import render, true_labels
from .episode import Rules
from .gaps import beyond_gap
from .gcn import BATCH, GCN, RATE, mean_backward, mean_forward, normalise_adjacency
from .nn import softmax
from .other_stores import BruteForce, Endless, OfAnyAction, Shrunk
from .particles import FLOOR, ParticleFilter
from .places import wrap_angle
from .planners import greedy  # the original, even while planners.greedy is replaced
from .ranks import reciprocal_ranks
from .robot import FORWARD, LEFT, N_ACTIONS, Motion, Robot
from .scene_graph import VIEW_PX


@dataclass(frozen=True)
class Choice:
    """Another choice than ours; a GCN is learned anew where it changes what is seen."""

    point: str  # the row of tutorials/open_points.md
    other: str
    rules: Rules = Rules()
    store: dict = field(default_factory=dict)
    motion: Motion = Motion()
    constants: dict = field(default_factory=dict)
    of_training: dict = field(default_factory=dict)  # constants while NNQL learns
    n_more: int = 0  # numbers in a state besides one for each place
    true_labels: bool = False  # instead of the net's; then it is compared with our choice of true labels
    of_net: dict = field(default_factory=dict)  # other options of `python -m data_gen views`, for a net of its own
    anew: bool = False  # the GCN is learned anew; the next two say how
    of_gcn: dict = field(default_factory=dict)  # other arguments of learned.learn_places
    views_beyond: Callable | None = None  # the gap from the tests beyond which its views lie; None: anywhere
    starts_beyond: Callable | None = None  # the gap beyond which NNQL's starts lie; None: our starts
    luck: int = 0  # which other seed for NNQL's training, and for the classifier's if it is learned anew; 0: ours


def probabilities(scores, _particles, _step, _actions):
    """State: probabilities instead of reciprocal ranks."""
    return softmax(scores).astype(np.float32)


def best_place(scores, _particles, _step, _actions):
    """State: the best place alone, one-hot."""
    return np.eye(scores.shape[1], dtype=np.float32)[scores.argmax(1)]


def filter_ranks(scores, particles, _step, _actions, pooling="sum"):
    """State: the reciprocal ranks of the filter's belief instead of the view's."""
    return reciprocal_ranks(particles.belief(pooling))


def with_last_action(scores, _particles, _step, actions):
    """State: the view's ranks and the last action, one-hot: two actions are 1.4 apart, two views at most 1.8."""
    last = np.zeros((len(scores), N_ACTIONS + 1), np.float32)
    last[np.arange(len(scores)), 0 if actions is None else actions + 1] = 1
    return np.concatenate([reciprocal_ranks(scores), last], 1)


def with_context(scores, _particles, step, actions):
    """State: the view's ranks, and one number for how many actions were done and which was the last one."""
    last = np.zeros(len(scores)) if actions is None else 1 + actions
    context = step * (N_ACTIONS + 1) + last
    return np.append(reciprocal_ranks(scores), context[:, None].astype(np.float32), 1)


def without_context(scores, _particles, _step, _actions):
    """The same, but with one context whatever was done."""
    return np.append(reciprocal_ranks(scores), np.zeros((len(scores), 1), np.float32), 1)


def at_the_end(right, done, **_others):
    """Reward after the last step alone."""
    return np.where(done, np.where(right, 1.0, -1.0), 0.0)


def of_the_view(scores, places, **_others):
    """Reward for the first place of the latest view alone, not for the filter's answer."""
    return np.where(scores.argmax(1) == places, 1.0, -1.0)


def by_rank(scores):
    """Likelihood of a place: its reciprocal rank."""
    return reciprocal_ranks(scores) + FLOOR


def greedy_once(nnql):
    """Planner: the action of the greatest Q-value at the first view, again and again."""
    return planners.go_on(greedy(nnql))


def first_of_equals(q, _rng):
    """Ties: the first of equal actions."""
    return q.argmax(1)


def finest(world, poses, rng, size, noise, wanted=None):
    """True labels of all 512 x 512 pixels; like camera.render, and with the same luck."""
    rgb, _ = render(world, poses, rng, size, noise, wanted)
    return rgb, true_labels(world, poses if wanted is None else poses[wanted], VIEW_PX)


def far_or_turned(poses, tests, t_xy_m, t_theta_rad):
    """Whether each pose differs from each test enough in location or in bearing; like gaps.beyond_gap."""
    distance = np.hypot(*(poses[:, None, :2] - tests[:, :2]).T)
    turned = abs(wrap_angle(poses[:, None, 2] - tests[:, 2])).T
    return ((distance > t_xy_m) | (turned > t_theta_rad)).all(0)


def touching_at_corners(labels):
    """Regions whose pixels are connected by sides or corners (8-connected); like scene_graph.regions."""
    found = []
    for view, image in enumerate(labels):
        for label in np.unique(image):
            numbered, _ = ndimage.label(image == label, np.ones((3, 3)))
            area = np.bincount(numbered.ravel())[1:]
            found += [(view, label, n, x.start, y.start, x.stop, y.stop)
                      for n, (y, x) in zip(area, ndimage.find_objects(numbered), strict=True)]
    view, label, area, *boxes = np.array(found).T
    return view, label, area, np.stack(boxes, 1)


def plain_sums(edges, n_nodes, dtype=np.float32):
    """A + I: each node sums its neighbours and itself as they are; like gcn.normalise_adjacency."""
    adjacency = normalise_adjacency(edges, n_nodes, dtype)
    adjacency.data[:] = 1
    return adjacency


def sum_forward(node_features, starts):
    """A graph is the sum of its nodes; like gcn.mean_forward."""
    mean, (count,) = mean_forward(node_features, starts)
    return mean * count[:, None].astype(mean.dtype), (count,)


def sum_backward(dout, cache):
    """Every node of a graph gets its whole gradient; like gcn.mean_backward."""
    count, = cache
    return mean_backward(dout * count[:, None].astype(dout.dtype), cache)


class Unresampled(ParticleFilter):
    """Particles that are never resampled and keep their weights."""

    def resample(self):
        pass


class LeftOrForward(Robot):
    """A robot of two actions: 0 turn left, 1 forward."""

    def step(self, poses, actions, rng):
        return super().step(poses, np.where(np.asarray(actions) == 0, LEFT, FORWARD), rng)


def _five_times(point, other, *args, **options):
    """A choice with our seed and four others: one training says little."""
    return [Choice(point, other + (f", seed {n}" if n else ""), *args, **options, luck=n) for n in range(5)]


PLAIN_MEAN = {"k": 64, "alpha": 1.0}  # a pair's value is what came of it last time; no trace of its neighbours
CHOICES = [
    Choice("labels of the views", "true labels", true_labels=True, anew=True),
    Choice("camera height", "0.8 m", constants={"camera.HEIGHT_M": 0.8}, true_labels=True, anew=True),
    Choice("field of view", "60 degrees", constants={"strip.FIELD_OF_VIEW_RAD": np.pi / 3}, true_labels=True,
           anew=True),
    Choice("field of view", "120 degrees", constants={"strip.FIELD_OF_VIEW_RAD": 2 * np.pi / 3}, true_labels=True,
           anew=True),
    Choice("size of the net's view", "512 x 512, true labels", constants={"senses.render": finest}, true_labels=True,
           anew=True),
    Choice("pictures of the net", "clean drawings", of_net={"noise": 0.0}, anew=True),
    Choice("training views of the net", "any view", of_net={"kinds": 1}, anew=True),
    Choice("region", "8-connected", constants={"scene_graph.regions": touching_at_corners}, anew=True),
    Choice("edges", "none", constants={"scene_graph.FARTHEST_EDGE_PX": -1.0}, anew=True),
    Choice("width of the GCN", "256", constants={"gcn.GCN": partial(GCN, hidden=256)}, anew=True),
    Choice("epochs of the GCN", "a hundred batches of 32", anew=True,
           of_gcn={"n_views": 100 * BATCH, "epochs": 1, "batch": BATCH, "rate": RATE}),
    Choice("views of the classifier", "beyond the gap alone", anew=True, views_beyond=beyond_gap),
    Choice("sums over neighbours", "plain", constants={"gcn.normalise_adjacency": plain_sums}, anew=True),
    Choice("readout of the graph", "sum of its nodes", anew=True,
           constants={"gcn.mean_forward": sum_forward, "gcn.mean_backward": sum_backward}),
    Choice("likelihood of a particle", "reciprocal rank", Rules(likelihood=by_rank)),
    Choice("floor of the likelihood", "1e-2", constants={"episode.FLOOR": 1e-2}),
    Choice("floor of the likelihood", "1e-4", constants={"episode.FLOOR": 1e-4}),
    Choice("motion noise of the filter", "none", Rules(filter=partial(ParticleFilter, std=(0.0, 0.0)))),
    Choice("motion noise of the filter", "10 cm, 0.1 rad", Rules(filter=partial(ParticleFilter, std=(0.1, 0.1)))),
    Choice("guided start", "10 places", Rules(filter=partial(ParticleFilter, n_start_places=10))),
    Choice("guided start", "30 places", Rules(filter=partial(ParticleFilter, n_start_places=30))),
    Choice("resampling", "never", Rules(filter=Unresampled)),
    Choice("resampling", "never, and answers pooled by max", Rules(filter=Unresampled, pooling="max")),
    Choice("noise of the odometry", "none", motion=Motion(std_m=0.0, std_rad=0.0)),
    Choice("answer, pooling of particles to places", "max", Rules(pooling="max")),
    Choice("actions: turn", "60 degrees", motion=Motion(turn_rad=np.pi / 3)),
    Choice("actions: forward", "0.25 m", motion=Motion(forward_m=0.25)),
    Choice("actions: forward", "1 m", motion=Motion(forward_m=1.0)),
    Choice("actions: which", "left and forward", constants={
        "ablate.Robot": LeftOrForward, "ablate.N_ACTIONS": 2, "planners.N_ACTIONS": 2}),
    *_five_times("state", "probabilities", Rules(state=probabilities), {"index": BruteForce}),
    Choice("state", "best place, one-hot", Rules(state=best_place), {"index": BruteForce}),
    Choice("state", "the filter's ranks", Rules(state=filter_ranks)),
    Choice("state", "the filter's ranks, max", Rules(state=partial(filter_ranks, pooling="max"))),
    Choice("state", "ranks and last action", Rules(state=with_last_action), {"index": BruteForce},
           n_more=N_ACTIONS + 1),
    *_five_times("state", "the filter's ranks, k = 64, alpha = 1", Rules(state=filter_ranks), PLAIN_MEAN),
    Choice("reward", "after the last step alone", Rules(reward=at_the_end)),
    Choice("reward: for which answer", "the view's first place", Rules(reward=of_the_view)),
    Choice("the last step", "Q goes on after it", constants={"nnql.NNQL": Endless}),
    Choice("neighbours of which action", "of any", constants={"nnql.NNQL": OfAnyAction}),
    Choice("neighbours", "k = 1", store={"k": 1}),
    Choice("neighbours", "k = 16", store={"k": 16}),
    Choice("neighbours", "k = 64", store={"k": 64}),
    *_five_times("neighbours", "k = 64, alpha = 1", store=PLAIN_MEAN),
    *_five_times("mean of the neighbours", "and, as 64 more, that of step and last action", Rules(state=with_context),
                 constants={"nnql.NNQL": partial(Shrunk, pull=64)}),
    *_five_times("mean of the neighbours", "that of step and last action alone", Rules(state=with_context),
                 constants={"nnql.NNQL": partial(Shrunk, pull=1e9)}),
    *_five_times("mean of the neighbours", "and, as 64 more, that of the action", Rules(state=without_context),
                 constants={"nnql.NNQL": partial(Shrunk, pull=64)}),
    *_five_times("actions by chance", "all", of_training={"nnql.epsilon": np.ones_like}),
    *_five_times("when to choose", "at the first view alone", constants={"planners.greedy": greedy_once}),
    Choice("the same state again", "within 0.6", constants={"nnql.SAME": 0.6}),
    Choice("value of a new pair", "from 0", constants={"nnql.first_value": np.zeros_like}),
    Choice("value of a new pair", "from 1", constants={"nnql.first_value": np.ones_like}),
    Choice("nearest test start", "any: far from each or turned from it", starts_beyond=far_or_turned),
    Choice("ties between actions", "the first of equals", constants={"planners.best_actions": first_of_equals}),
    Choice("order of learning", "one robot at a time", of_training={"episode.SIDE_BY_SIDE": 1}),
    *(Choice("luck of the training", f"seed {n}", luck=n) for n in range(1, 9)),
    *(Choice("luck of the classifier", f"seed {n}", anew=True, luck=n) for n in range(1, 5)),
]
OURS, TRUE_LABELS = Choice("all", "ours"), CHOICES[0]
