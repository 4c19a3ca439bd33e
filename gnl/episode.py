"""Episodes: sense, plan, act, many robots side by side.

A robot looks once where it starts, then L times plans, acts and looks again. After every look the particle filter
gives an answer: the place that most of the belief lies in.

    B episodes side by side   L cycles after the first view   K places
"""

import time
from dataclasses import dataclass, field

import numpy as np

from . import nnql, planners, segnet
from .camera import render
from .nn import softmax
from .particles import FLOOR, ParticleFilter
from .ranks import reciprocal_ranks
from .scene_graph import join, scene_graph

LENGTH = 4
SIDE_BY_SIDE = 32  # episodes in lockstep: some fifty calls of NumPy cost the same for one as for many


@dataclass
class Senses:
    """From poses to scores of places: camera, segmentation net, scene graph, GCN. Counts the seconds of each."""

    world: object
    net: dict | None  # weights of the segmentation net; None: true labels
    gcn: object
    noise: float = 1.0
    seconds: dict = field(default_factory=dict)
    views: int = 0

    def look(self, poses, rng):
        """What robots at `poses` (B, 3) see, as SceneGraphs."""
        rgb, labels = self.timed("view", render, self.world, poses, rng, segnet.SIZE_PX, self.noise)
        if self.net is not None:
            labels = self.timed("labels", segnet.predict, self.net, rgb)
        self.views += len(poses)
        return self.timed("graph", scene_graph, labels)

    def look_around(self, poses, rng, progress=None, at_once=128):
        """The same for any number of poses, some at once; progress(share done)."""
        parts = []
        for i in range(0, len(poses), at_once):
            parts.append(self.look(poses[i:i + at_once], rng))
            if progress:
                progress(min(1, (i + at_once) / len(poses)))
        return join(parts)

    def scores(self, poses, rng):
        """Scores of all places for the view from each pose: (B, 3) -> (B, K)."""
        return self.timed("GCN", self.gcn.scores, self.look(poses, rng))

    def timed(self, stage, function, *args):
        """function(*args), its time booked on `stage`."""
        start = time.perf_counter()
        result = function(*args)
        self.seconds[stage] = self.seconds.get(stage, 0.0) + time.perf_counter() - start
        return result


@dataclass(frozen=True)
class Record:
    """What B episodes were: T looks each, T = 1 + number of actions."""

    poses: np.ndarray  # (B, T, 3) true poses
    actions: np.ndarray  # (B, T - 1)
    answers: np.ndarray  # (B, T) place the filter names after each look
    places: np.ndarray  # (B, T) true place
    belief: np.ndarray  # (B, T) belief in the true place

    @property
    def correct(self):
        """Whether each answer is right: (B, T) bool."""
        return self.answers == self.places


def run(senses, robot, grid, plan, starts, seed, length=LENGTH, learner=None, watch=None):
    """Run one episode from each of the poses `starts` (B, 3); returns a Record.

    The streams of appearance, motion, filter and exploration are independent children of `seed`. They are drawn
    alike in every step, so two planners see the same start, noise and particles until their actions differ.
    learner : an NNQL that learns from every step;  watch(step, **what happened) is called after every look
    """
    appearance, motion, filtering, exploring = map(np.random.default_rng, _seed(seed).spawn(4))
    poses, B = np.array(starts, float), len(starts)
    scores = senses.scores(poses, appearance)
    belief = senses.timed("filter", ParticleFilter, grid, likelihood(scores), filtering)
    kept, states = {"poses": [], "actions": [], "answers": [], "places": [], "belief": []}, None
    for step in range(length + 1):
        if step:
            actions = senses.timed("plan", plan, step - 1, states, exploring)
            if actions is None:
                break
            poses, odometry, _ = senses.timed("robot", robot.step, poses, actions, motion)
            scores = senses.scores(poses, appearance)
            senses.timed("filter", _update, belief, odometry, likelihood(scores))
            kept["actions"].append(actions)
        seen, states = states, senses.timed("ranks", reciprocal_ranks, scores)
        pooled = senses.timed("filter", belief.belief, grid.n_places)
        # CHOICE: the answer is the place (x, y, bearing) that holds most of the particles' weight.
        places, answers = grid.place_of(poses), pooled.argmax(1)
        if learner and step:
            # CHOICE: the reward comes after every step; the text also calls it sparse.
            reward = np.where(answers == places, 1.0, -1.0)
            senses.timed("plan", learner.learn, seen, actions, reward, states, np.full(B, step == length))
        for name, value in (("poses", poses), ("answers", answers), ("places", places),
                            ("belief", pooled[np.arange(B), places])):
            kept[name].append(value)
        if watch:
            watch(step, poses=poses, scores=scores, states=states, filter=belief, pooled=pooled)
    return Record(**{name: np.stack(values, 1) if values else np.empty((B, 0), int) for name, values in kept.items()})


def run_all(senses, robot, grid, plan, starts, seed, **options):
    """`run` for any number of starts, SIDE_BY_SIDE at a time, each group with a seed of its own; one Record."""
    groups = [starts[i:i + SIDE_BY_SIDE] for i in range(0, len(starts), SIDE_BY_SIDE)]
    records = [run(senses, robot, grid, plan, group, child, **options)
               for group, child in zip(groups, _seed(seed).spawn(len(groups)), strict=True)]
    return Record(*(np.concatenate([getattr(r, name) for r in records]) for name in Record.__dataclass_fields__))


def likelihood(scores):
    """Likelihood of each place given a view: the classifier's probability and a floor, (B, K)."""
    return softmax(scores) + FLOOR  # CHOICE: the paper does not say how a view weighs a particle


def train_nnql(senses, robot, grid, free_poses, n_episodes, seed, checkpoint_every=1000, progress=None):
    """Learn Q-values in n_episodes episodes from random starts; returns the NNQL with its checkpoints.

    free_poses(n, rng) draws starts; progress(share done, recent share of right answers)
    """
    learner = nnql.NNQL(grid.n_places, planners.N_ACTIONS)
    start_rng = np.random.default_rng(_seed(seed))
    right = []
    for first, child in zip(range(0, n_episodes, SIDE_BY_SIDE),
                            _seed(seed).spawn(-(-n_episodes // SIDE_BY_SIDE)), strict=True):
        episodes = np.arange(first, min(first + SIDE_BY_SIDE, n_episodes))
        plan = planners.explore(learner, nnql.epsilon(episodes))
        record = run(senses, robot, grid, plan, free_poses(len(episodes), start_rng), child, learner=learner)
        right.append(record.correct[:, -1].mean())
        while (len(learner.log) + 1) * checkpoint_every <= episodes[-1] + 1:
            learner.checkpoint()
        if progress:
            progress((episodes[-1] + 1) / n_episodes, np.mean(right[-10:]))
    return learner


def best_sequence(senses, robot, grid, starts, seed, length=LENGTH):
    """The fixed action sequence that leaves most belief in the true place, over `starts` (n, 3): (L,).

    Of 81 sequences the luckiest looks best, so they race: after each round the best third goes on, from twice as many
    new starts. All runs of a round see the same starts and the same noise.
    """
    sequences, n_rounds, first = planners.all_sequences(length), length, 0
    total = np.zeros(len(sequences))
    for rank, child in enumerate(_seed(seed).spawn(n_rounds)):
        size = max(1, len(starts) * 2 ** rank // (2 ** n_rounds - 1))
        part = starts[np.arange(first, first + size) % len(starts)]
        total += [run_all(senses, robot, grid, planners.scan(sequence), part, child, length=length).belief[:, -1].sum()
                  for sequence in sequences]
        best = np.argsort(-total, kind="stable")[:len(total) // planners.N_ACTIONS]
        sequences, total, first = sequences[best], total[best], first + size
    return sequences[0]


def _update(belief, odometry, likelihood_of_view):
    """One cycle of the filter; it resamples before it moves, so that what it answers from is still weighed."""
    belief.resample()
    belief.predict(odometry)
    belief.weigh(likelihood_of_view)


def _seed(seed):
    """A SeedSequence of its own for a number or another one: one that has spawned before would spawn others now."""
    if isinstance(seed, np.random.SeedSequence):
        return np.random.SeedSequence(seed.entropy, spawn_key=seed.spawn_key)
    return np.random.SeedSequence(seed)
