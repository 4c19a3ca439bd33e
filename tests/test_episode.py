"""One seed is one run; planners meet the same luck until their actions differ; who watches sees it all."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import gnl
from data_gen.rooms import make_home
from gnl import episode, planners
from gnl.episode import Record, Rules, probability, run, run_all, train_nnql
from gnl.gcn import GCN
from gnl.particles import ParticleFilter
from gnl.places import PlaceGrid, wrap_angle
from gnl.ranks import reciprocal_ranks
from gnl.robot import FORWARD, LEFT, N_ACTIONS, Motion, Robot
from gnl.senses import Senses

GRID = PlaceGrid(SimpleNamespace(bounds=(0, 0, 8, 6)))
K = GRID.n_places


class Sense:
    """Senses that score places by a function of the poses, and no noise."""

    def __init__(self, score):
        self.score = score

    def scores(self, poses, rng):
        return self.score(poses)

    def timed(self, _stage, function, *args):
        return function(*args)


class Glide:
    """A robot without obstacles."""

    def step(self, poses, actions, rng):
        m = Motion()
        forward, turn = np.where(actions == FORWARD, m.forward_m, 0), np.choose(actions, [m.turn_rad, -m.turn_rad, 0])
        x, y, theta = poses.T
        moved = np.stack([x + forward * np.cos(theta), y + forward * np.sin(theta), wrap_angle(theta + turn)], 1)
        noise = rng.normal(0, 0.01, (len(poses), 2))
        return moved, np.stack([forward, turn], 1) + noise, np.zeros(len(poses), bool)


def knows(poses):
    """Great scores for the true place."""
    return 20.0 * np.eye(K)[GRID.place_of(poses)]


def mistakes(poses):
    """Great scores for the place opposite."""
    return 20.0 * np.eye(K)[(GRID.place_of(poses) + K // 2) % K]


def starts(n, seed=0):
    """Poses away from the rim; `seed` may be a generator."""
    return np.random.default_rng(seed).uniform((2, 2, -np.pi), (6, 4, np.pi), (n, 3))


def home_of(seed=3):
    """A home with the paper's senses, but a GCN that has learned nothing."""
    home = make_home(seed)
    grid = PlaceGrid(home)
    return Senses(home, None, GCN(grid.n_places, np.random.default_rng(0), hidden=8)), Robot(home), grid


def assert_equal(one, other, episodes=slice(None), n_looks=None):
    """Whether two records agree bit by bit in some episodes, up to some look."""
    for name in vars(one):
        n = n_looks and n_looks - (name == "actions")
        np.testing.assert_array_equal(getattr(one, name)[episodes, :n], getattr(other, name)[episodes, :n])


def test_an_episode_has_a_look_at_the_start_and_one_after_each_action():
    record = run(Sense(knows), Glide(), GRID, planners.chance, starts(7), 0, Rules(length=5))
    assert (record.poses.shape, record.actions.shape, record.answers.shape) == ((7, 6, 3), (7, 5), (7, 6))
    np.testing.assert_array_equal(record.poses[:, 0], starts(7))
    np.testing.assert_array_equal(record.places, GRID.place_of(record.poses))
    np.testing.assert_array_equal(record.correct, record.answers == record.places)
    assert (record.actions < N_ACTIONS).all()
    assert (record.belief >= 0).all()
    assert (record.belief <= 1 + 1e-5).all()


def test_one_pose_is_one_robot():
    one, many = (run(Sense(knows), Glide(), GRID, planners.chance, poses, 0) for poses in (starts(1)[0], starts(1)))
    assert_equal(one, many)
    with pytest.raises(ValueError, match=r"poses: expected shape \(\.\.\., 3\), found \(4, 2\)"):
        run(Sense(knows), Glide(), GRID, planners.chance, np.zeros((4, 2)), 0)


def test_who_knows_is_right_and_who_mistakes_is_wrong():
    assert run(Sense(knows), Glide(), GRID, planners.scan([LEFT] * 4), starts(20), 0).correct.all()
    mistaken = run(Sense(mistakes), Glide(), GRID, planners.scan([LEFT] * 4), starts(20), 0)
    assert not mistaken.correct.any()
    assert mistaken.belief.max() < 0.01  # it is the belief in the true place


def test_who_stays_has_one_look_and_one_answer():
    record = run(Sense(knows), Glide(), GRID, planners.stay, starts(5), 0)
    assert (record.poses.shape, record.actions.shape, record.answers.shape) == ((5, 1, 3), (5, 0), (5, 1))


def test_planners_meet_the_same_luck_until_their_actions_differ():
    """Through camera, noise, robot and filter: actions from three planners, of which two agree for some robots."""
    senses, robot, grid = home_of()
    poses = senses.world.free_poses(6, np.random.default_rng(0))

    def differs_for_some(step, states, rng):
        rng.random(100)  # who explores more than another draws from a stream of its own
        return np.where(np.arange(6) < 3, LEFT, FORWARD if step else LEFT)

    scan, other, nobody = (run(senses, robot, grid, plan, poses, 5) for plan in
                           (planners.scan([LEFT] * 4), differs_for_some, planners.stay))
    assert_equal(scan, other, episodes=slice(3))
    assert_equal(scan, other, n_looks=2)
    assert_equal(scan, nobody, n_looks=1)
    assert (scan.poses[3:, 2:] != other.poses[3:, 2:]).any()


def test_what_a_planner_draws_changes_neither_views_nor_motion_nor_filter():
    class Noisy(Sense):
        def scores(self, poses, rng):
            return self.score(poses) + 9 * rng.random((len(poses), K))

    def same_in_other_words(step, states, rng):
        return np.full(len(states), LEFT + 0 * int(rng.random(7 + step)[0]))

    one, other = (run(Noisy(knows), Glide(), GRID, plan, starts(9), 0)
                  for plan in (planners.scan([LEFT] * 4), same_in_other_words))
    assert_equal(one, other)


def test_appearance_motion_filter_and_exploration_are_the_seeds_four_children_in_this_order():
    met = {}

    class Seeing(Sense):
        def scores(self, poses, rng):
            met["appearance"] = rng
            return self.score(poses)

    class Moving(Glide):
        def step(self, poses, actions, rng):
            met["motion"] = rng
            return super().step(poses, actions, rng)

    def filtering(grid, likelihood, rng):
        met["filter"] = rng
        return ParticleFilter(grid, likelihood, rng)

    def plan(step, states, rng):
        met["exploration"] = rng
        return np.zeros(len(states), int)

    run(Seeing(knows), Moving(), GRID, plan, starts(2), 7, Rules(length=1, filter=filtering))
    children = {name: rng.bit_generator.seed_seq for name, rng in met.items()}
    assert {name: (child.entropy, child.spawn_key) for name, child in children.items()} == {
        "appearance": (7, (0,)), "motion": (7, (1,)), "filter": (7, (2,)), "exploration": (7, (3,))}


def test_another_seed_is_another_run():
    a, again, b = (run(Sense(knows), Glide(), GRID, planners.chance, starts(9), seed) for seed in (0, 0, 1))
    assert_equal(a, again)
    assert (a.actions != b.actions).any()
    assert (a.belief != b.belief).any()


def test_a_seed_that_has_spawned_before_gives_the_same_run_and_its_children_others():
    seed = np.random.SeedSequence(3)
    first, second = seed.spawn(2)
    runs = [run_all(Sense(knows), Glide(), GRID, planners.chance, starts(9), one)
            for one in (seed, seed, 3, first, second)]
    assert_equal(runs[0], runs[1])
    assert_equal(runs[0], runs[2])
    for one, other in ((0, 3), (0, 4), (3, 4)):
        assert (runs[one].actions != runs[other].actions).any()


def fingerprint():
    """Every bit of some episodes, training and search in a home with the paper's senses."""
    senses, robot, grid = home_of()
    starts_40 = senses.world.free_poses(40, np.random.default_rng(2))
    learner = train_nnql(senses, robot, grid, starts_40, 7, checkpoint_every=20)
    poses = senses.world.free_poses(5, np.random.default_rng(1))
    record = run_all(senses, robot, grid, planners.greedy(learner), poses, 11)
    bits = b"".join(np.ascontiguousarray(array).tobytes() for array in (*vars(record).values(), *learner.values))
    return hashlib.sha256(bits).hexdigest()


def test_one_seed_gives_the_same_bits_in_a_fresh_process():
    paths = os.pathsep.join([str(Path(gnl.__file__).parents[1]), str(Path(__file__).parent)])
    fresh = subprocess.run([sys.executable, "-c", "import test_episode; print(test_episode.fingerprint())"],
                           env={**os.environ, "PYTHONPATH": paths, "PYTHONHASHSEED": "1"},
                           capture_output=True, text=True, check=True)
    assert fresh.stdout.strip() == fingerprint()


def test_many_episodes_are_their_groups_one_after_the_other(monkeypatch):
    monkeypatch.setattr(episode, "SIDE_BY_SIDE", 4)
    senses, plan, poses = Sense(knows), planners.chance, starts(10)
    together = run_all(senses, Glide(), GRID, plan, poses, 3)
    seeds = np.random.SeedSequence(3).spawn(3)
    for first, end, seed in zip((0, 4, 7), (4, 7, 10), seeds, strict=True):
        group = slice(first, end)
        alone = run(senses, Glide(), GRID, plan, poses[group], seed)
        for name in vars(alone):
            np.testing.assert_array_equal(getattr(together, name)[group], getattr(alone, name))
    assert len(together.poses) == 10


def test_many_episodes_say_how_far_they_are_and_how_many_were_right_in_the_end(monkeypatch):
    rng, told = np.random.default_rng(0), []

    def made_up(_senses, _robot, _grid, _plan, group, _seed):
        answers = rng.integers(2, size=(len(group), 5))
        ones = np.ones_like(answers)
        return Record(poses=ones, actions=ones, answers=answers, places=ones, belief=ones)

    monkeypatch.setattr(episode, "SIDE_BY_SIDE", 4)
    monkeypatch.setattr(episode, "run", made_up)
    record = run_all(None, None, None, None, starts(10), 3, lambda share, right: told.append((share, right)))
    right = record.correct[:, -1]
    np.testing.assert_allclose(told, [(n / 3, right[:end].mean()) for n, end in ((1, 4), (2, 7), (3, 10))])
    assert 0 < right.mean() < 1


def test_who_ends_some_groups_of_robots_sooner_than_others_is_told(monkeypatch):
    monkeypatch.setattr(episode, "SIDE_BY_SIDE", 3)
    ends = iter([1, 2])

    def plan(step, states, _rng):
        plan.end = next(ends) if step == 0 else plan.end
        return None if step == plan.end else np.zeros(len(states), int)

    with pytest.raises(ValueError, match=r"plan: expected to end all groups .* equally many looks, found \[2, 3\]"):
        run_all(Sense(knows), Glide(), GRID, plan, starts(6), 0)


def test_a_planner_may_use_its_own_array_again():
    mine = np.zeros(2, int)

    def plan(step, _states, _rng):
        mine[:] = step % 3
        return mine

    record = run(Sense(knows), Glide(), GRID, plan, starts(2), 0)
    np.testing.assert_array_equal(record.actions, [[0, 1, 2, 0]] * 2)


@pytest.mark.parametrize("shape", [(3, K), (2, K - 1), (2,)], ids=str)
def test_scores_of_other_views_or_places_are_refused(shape):
    with pytest.raises(ValueError, match=rf"scores: expected shape \(2, {K}\), found \({shape[0]}"):
        run(Sense(lambda poses: np.zeros(shape)), Glide(), GRID, planners.chance, starts(2), 0)


def test_the_likelihood_is_a_probability_and_a_floor_below_it():
    found = probability(np.array([[0.0, 0, 0, 500]]))
    np.testing.assert_allclose(found, [[1e-3, 1e-3, 1e-3, 1.001]], rtol=1e-6)


def test_particles_are_drawn_anew_then_moved_then_weighed_after_every_action():
    calls = []

    class Watched(ParticleFilter):
        def resample(self):
            calls.append("drawn anew")
            super().resample()

        def predict(self, odometry):
            calls.append("moved")
            super().predict(odometry)

    run(Sense(knows), Glide(), GRID, planners.chance, starts(3), 0, Rules(filter=Watched),
        watch=lambda step, **_: calls.append(step))
    assert calls == [0, *(call for step in range(1, 5) for call in ("drawn anew", "moved", step))]


def test_the_answer_remembers_earlier_views():
    """Only the first view tells anything; odometry carries what it told."""
    first = []

    def once(poses):
        first.append(poses)
        return knows(poses) * (len(first) == 1)

    record = run(Sense(once), Glide(), GRID, planners.scan([LEFT] * 4), starts(40), 0)
    assert record.correct.mean() > 0.8


@pytest.mark.parametrize("score", [knows, mistakes])
def test_whoever_watches_sees_every_look(score):
    seen = []
    record = run(Sense(score), Glide(), GRID, planners.chance, starts(3), 0, Rules(length=2),
                 lambda step, **what: seen.append((step, what)))
    assert [step for step, _ in seen] == [0, 1, 2]
    for step, what in seen:
        np.testing.assert_array_equal(what["poses"], record.poses[:, step])
        np.testing.assert_array_equal(what["scores"], score(what["poses"]))
        np.testing.assert_array_equal(what["states"], reciprocal_ranks(what["scores"]))
        np.testing.assert_array_equal(what["pooled"].argmax(1), record.answers[:, step])
        np.testing.assert_array_equal(what["right"], record.correct[:, step])
        np.testing.assert_array_equal(what["belief"], record.belief[:, step])
        if step:
            np.testing.assert_array_equal(what["actions"], record.actions[:, step - 1])
            np.testing.assert_array_equal(what["before"], seen[step - 1][1]["states"])


def test_a_race_of_nothing_is_refused():
    for n_starts, rules in ((0, Rules()), (5, Rules(length=0))):
        with pytest.raises(ValueError, match="race: expected at least one action and one start, found "):
            episode.race(Sense(knows), Glide(), GRID, starts(n_starts), 0, rules)


@pytest.mark.parametrize("many", [run_all, train_nnql])
def test_no_starts_are_refused(many):
    rest = [planners.chance] if many is run_all else []
    with pytest.raises(ValueError, match="starts: expected at least one, found none"):
        many(Sense(knows), Glide(), GRID, *rest, starts(0), 0)


def test_the_rules_of_an_episode_are_those_that_are_given():
    def opposite(scores):
        return np.roll(probability(scores), K // 2, 1)

    assert not run(Sense(knows), Glide(), GRID, planners.chance, starts(9), 0, Rules(likelihood=opposite)).correct.any()
    pooled = []
    for pooling in ("sum", "max"):
        run(Sense(knows), Glide(), GRID, planners.chance, starts(9), 0, Rules(pooling=pooling),
            lambda step, **what: pooled.append(what["pooled"]))
    assert (pooled[0] >= pooled[5] - 1e-6).all()
    assert pooled[0].sum() > 2 * pooled[5].sum()
    made, used = [], []

    def small(*args):
        made.append(ParticleFilter(*args, n_particles=30))
        return made[-1]

    run(Sense(knows), Glide(), GRID, planners.chance, starts(9), 0, Rules(filter=small),
        lambda step, **what: used.append(what["filter"]))
    assert len(made) == 1
    assert all(one is made[0] for one in used)
