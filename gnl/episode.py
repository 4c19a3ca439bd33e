"""Episodes: sense, plan, act, many robots side by side.

A robot looks once where it starts, then L times plans, acts and looks again. After every look the particle filter
gives an answer: the place that holds the most belief.

    B episodes side by side   L cycles after the first view   K places
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from . import nnql, planners
from .checks import check_count
from .nn import softmax
from .particles import FLOOR, ParticleFilter
from .places import check_poses
from .ranks import reciprocal_ranks

LENGTH = 4
SIDE_BY_SIDE = 64  # episodes in lockstep: some fifty NumPy calls cost much the same for one as for many


# What the paper leaves open in an episode: each function settles one point, and Rules says which ones are used.

def probability(scores):
    """Likelihood of each place given a view: the classifier's probability and a floor, (B, K)."""
    return softmax(scores) + FLOOR  # CHOICE: softmax and a floor; the paper does not say how a view weighs a particle


def view_ranks(scores, _particles, _step, _actions):
    """State: the reciprocal ranks of the latest view, (B, K)."""
    return reciprocal_ranks(scores)


def every_step(right, **_others):
    """Reward after every step: +1 for a right answer, -1 for a wrong one, (B,)."""
    # CHOICE: the answer is the filter's, as in the tests; the paper's "Top-1 predicted place class" may be the view's.
    return np.where(right, 1.0, -1.0)  # CHOICE: the reward comes after every step; the text also calls it sparse.


@dataclass(frozen=True)
class Rules:
    """How an episode goes."""

    length: int = LENGTH
    likelihood: Callable = probability
    filter: Callable = ParticleFilter
    state: Callable = view_ranks
    reward: Callable = every_step
    # DIFFERS: the answer is the place (x, y, bearing) that holds most of the particles' weight; the paper pools by max,
    # "regardless of their bearing attributes".
    pooling: str = "sum"


@dataclass(frozen=True)
class Record:
    """What happened in B episodes: T looks each, T = 1 + number of actions."""

    poses: np.ndarray  # (B, T, 3) true poses
    actions: np.ndarray  # (B, T - 1)
    answers: np.ndarray  # (B, T) place the filter names after each look
    places: np.ndarray  # (B, T) true place
    belief: np.ndarray  # (B, T) belief in the true place

    @property
    def correct(self):
        """Whether each answer is right: (B, T) bool."""
        return self.answers == self.places


def run(senses, robot, grid, plan, starts, seed, rules=None, watch=None):
    """Run one episode from each of the poses `starts` (B, 3); returns a Record.

    The streams of appearance, motion, filter and exploration are independent children of `seed`. Each step
    draws from them alike, so two planners see the same start, noise and particles until their actions differ.
    watch(step, poses, scores, filter, pooled, before, actions, states, places, right, belief) is called with these
    keywords after every look: that is where a learner learns. `before` are the states in which `actions` were chosen,
    `states` those to which they led; at the first look `before` and `actions` are None.
    """
    rules = rules or Rules()
    appearance, motion, filtering, exploring = map(np.random.default_rng, _seed(seed).spawn(4))
    poses = check_poses(starts).reshape(-1, 3)
    B = len(poses)
    looks, done = [], []
    states = actions = particles = None
    for step in range(rules.length + 1):
        if step:
            actions = senses.timed("plan", plan, step - 1, states, exploring)
            if actions is None:
                break
            actions = np.array(actions)  # a planner may reuse its own array
            poses, odometry, _ = senses.timed("robot", robot.step, poses, actions, motion)
            done.append(actions)
        scores = senses.scores(poses, appearance)
        if np.shape(scores) != (B, grid.n_places):
            raise ValueError(f"scores: expected shape ({B}, {grid.n_places}), found {np.shape(scores)}")
        likelihood = rules.likelihood(scores)
        if particles:
            senses.timed("filter", _update, particles, odometry, likelihood)
        else:
            particles = senses.timed("filter", rules.filter, grid, likelihood, filtering)
        pooled = senses.timed("filter", particles.belief, rules.pooling)
        before, states = states, senses.timed("ranks", rules.state, scores, particles, step, actions)
        places, answers = grid.place_of(poses), pooled.argmax(1)
        belief = pooled[np.arange(B), places]
        looks.append((poses, answers, places, belief))
        if watch:
            watch(step, poses=poses, scores=scores, filter=particles, pooled=pooled, before=before,
                  actions=actions, states=states, places=places, right=answers == places, belief=belief)
    poses, answers, places, belief = (np.stack(of_looks, 1) for of_looks in zip(*looks, strict=True))
    return Record(poses, np.stack(done, 1) if done else np.empty((B, 0), int), answers, places, belief)


def run_all(senses, robot, grid, plan, starts, seed, progress=None, **options):
    """`run` for any number of starts, in groups side by side, each with a seed of its own; one Record.

    progress(share done, share right after the last look) is called after each group
    """
    groups, records = side_by_side(starts), []
    for group, child in zip(groups, _seed(seed).spawn(len(groups)), strict=True):
        records.append(run(senses, robot, grid, plan, group, child, **options))
        if progress:
            progress(len(records) / len(groups), np.concatenate([record.correct[:, -1] for record in records]).mean())
    if len(n_looks := {record.places.shape[1] for record in records}) > 1:
        raise ValueError("plan: expected to end all groups of robots after equally many looks, "
                         f"found {sorted(n_looks)}")
    return Record(*map(np.concatenate, zip(*(vars(record).values() for record in records), strict=True)))


def side_by_side(starts):
    """The starts (n, ...) in as few groups of at most SIDE_BY_SIDE as there can be, of equal size or nearly so."""
    if not len(starts):
        raise ValueError("starts: expected at least one, found none")
    return np.array_split(starts, -(-len(starts) // SIDE_BY_SIDE))


def train_nnql(senses, robot, grid, starts, seed, rules=None, checkpoint_every=None, store=None, watch=None,
               progress=None):
    """Learn Q-values in one episode from each start (n, 3); returns the NNQL with its checkpoints.

    checkpoint_every : episodes from one checkpoint to the next. Every group of robots side by side ends at or
    before one, so the same seed learns differently with another number, or with none
    store : an NNQL with other settings, or one to train further (exploration begins anew)
    watch(step, **what happened) is called after every look, as in `run`; the rules' reward is given the same, and
    `done`, whether the episode ends with this step
    progress(share done, recent share of right answers) is called after each group
    """
    if checkpoint_every is not None:
        checkpoint_every = check_count("checkpoint_every", checkpoint_every, 1)
    rules = rules or Rules()
    store = store or nnql.NNQL(grid.n_places, planners.N_ACTIONS)

    def learn(step, **look):
        if step:
            done = np.full(len(look["actions"]), step == rules.length)
            reward = rules.reward(done=done, **look)
            senses.timed("learn", store.learn, look["before"], look["actions"], reward, look["states"], done)
        if watch:
            watch(step, **look)

    cuts = range(checkpoint_every, len(starts), checkpoint_every) if checkpoint_every else ()
    groups = [group for stretch in np.split(starts, cuts) for group in side_by_side(stretch)]
    done, recent = 0, []
    for group, child in zip(groups, _seed(seed).spawn(len(groups)), strict=True):
        episodes = np.arange(done, done + len(group))
        plan = planners.explore(store, nnql.epsilon(episodes))
        record = run(senses, robot, grid, plan, group, child, rules, learn)
        done += len(group)
        if checkpoint_every and done % checkpoint_every == 0:
            store.checkpoint()
        recent = [*recent[-9:], record.correct[:, -1].mean()]
        if progress:
            progress(done / len(starts), np.mean(recent))
    return store


def race(senses, robot, grid, starts, seed, rules=None):
    """Fixed action sequences and what they are worth, over `starts` (n, 3): (41, L), (41,) for L = 4, the winner first.

    A sequence is worth the belief that it leaves in the true place, on average. Of 41 the luckiest looks best, so they
    race: after each round the best third goes on, from three times as many new starts, the same for all. Those that
    repeat one action stay to the end: few others beat them, and options.py needs their worth.
    """
    length, starts = (rules or Rules()).length, np.asarray(starts)
    if length < 1 or not len(starts):
        raise ValueError(f"race: expected at least one action and one start, found {length} and {len(starts)}")
    sequences, used = planners.sequences(length), 0
    total, count, running = np.zeros(len(sequences)), np.zeros(len(sequences)), np.arange(len(sequences))
    repeats = np.flatnonzero((sequences == sequences[:, :1]).all(1))
    for n, child in enumerate(_seed(seed).spawn(length)):
        n_new = max(1, len(starts) * 2 * 3 ** n // (3 ** length - 1))  # 1, 3, 9, ... shares, together all starts
        groups = side_by_side(np.arange(n_new * len(running)))
        for group, grandchild in zip(groups, child.spawn(len(groups)), strict=True):
            start, which = np.divmod(group, len(running))
            plan = planners.scan(sequences[running[which]])
            record = run(senses, robot, grid, plan, starts[(used + start) % len(starts)], grandchild, rules)
            np.add.at(total, running[which], record.belief[:, -1])
        used, count[running] = used + n_new, count[running] + n_new
        finalists, best = running, running[np.argsort(-total[running], kind="stable")]
        running = np.union1d(best[:-(-len(best) // 3)], repeats)
    worth = total / count
    order = np.lexsort((-worth, ~np.isin(np.arange(len(sequences)), finalists)))  # finalists first, the best one ahead
    return sequences[order], worth[order]


def _update(particles, odometry, likelihood_of_view):
    """One cycle of the filter; it resamples before it moves, so that it still answers from weighted particles."""
    particles.resample()  # CHOICE: before every move; the paper does not say whether particles are drawn anew.
    particles.predict(odometry)
    particles.weigh(likelihood_of_view)


def _seed(seed):
    """A fresh SeedSequence from a number or from another one, which itself would not spawn the same children twice."""
    if isinstance(seed, np.random.SeedSequence):
        return np.random.SeedSequence(seed.entropy, spawn_key=seed.spawn_key)
    return np.random.SeedSequence(seed)
