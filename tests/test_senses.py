"""The senses: their bookkeeping, looks around, and looks that planners share."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from data_gen.rooms import make_home
from gnl import episode, planners, segnet
from gnl.camera import render
from gnl.gcn import GCN
from gnl.places import PlaceGrid
from gnl.robot import Robot
from gnl.scene_graph import scene_graph
from gnl.senses import Senses, SharedSenses

POSES = np.array([[1.0, 2, 0], [3, 4, 1], [3, 4, 1], [5, 6, 2]])


@pytest.fixture
def task():
    """A home with the paper's senses, but a GCN that has learned nothing."""
    home = make_home(3)
    grid = PlaceGrid(home)
    return Senses(home, None, GCN(grid.n_places, np.random.default_rng(0), hidden=8)), Robot(home), grid


class Lucky:
    """Senses by luck alone, that note how many robots have looked."""

    timed = None

    def __init__(self):
        self.looked = []

    def scores(self, poses, rng, wanted=slice(None)):
        drawn = rng.random((len(poses), 7))[wanted]
        self.looked.append(len(drawn))
        return drawn


def test_senses_book_the_seconds_of_each_stage(task):
    senses, robot, grid = task
    episode.run(senses, robot, grid, planners.chance, senses.world.free_poses(3, np.random.default_rng(0)), 0)
    assert senses.views == 3 * (1 + episode.LENGTH)
    assert set(senses.seconds) == {"view", "graph", "GCN", "filter", "plan", "robot", "ranks"}


def test_a_stage_costs_the_sum_of_its_calls(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("gnl.senses.time", SimpleNamespace(perf_counter=lambda: now[0]))

    def lasts(seconds):
        now[0] += seconds
        return seconds

    senses = Senses(None, None, None)
    assert [senses.timed("a", lasts, 2.0), senses.timed("b", lasts, 1.0), senses.timed("a", lasts, 3.0)] == [2, 1, 3]
    assert senses.seconds == {"a": 5.0, "b": 1.0}


@pytest.mark.parametrize("net", [None, {"scale": np.array(10)}], ids=["true labels", "net"])
def test_a_robot_sees_what_the_net_makes_of_its_noisy_photograph_and_without_a_net_the_truth(two_rooms, monkeypatch,
                                                                                             net):
    seen, poses = [], two_rooms.free_poses(4, np.random.default_rng(0))
    monkeypatch.setattr(segnet, "predict", lambda net, rgb: net["scale"] * rgb[..., 0] // 256)
    monkeypatch.setattr("gnl.senses.scene_graph", lambda labels: seen.append(labels) or scene_graph(labels))
    Senses(two_rooms, net, None, noise=3.0).look(poses, np.random.default_rng(2))
    rgb, true = render(two_rooms, poses, np.random.default_rng(2), segnet.SIZE_PX, 3.0)
    np.testing.assert_array_equal(seen[0], true if net is None else 10 * rgb[..., 0].astype(int) // 256)


def test_a_look_around_is_the_looks_one_after_the_other(task):
    senses, _, _ = task
    poses, told = senses.world.free_poses(10, np.random.default_rng(0)), []
    around = senses.look_around(poses, np.random.default_rng(1), told.append, at_once=4)
    at_once = senses.look(poses, np.random.default_rng(1))
    for name in vars(at_once):
        np.testing.assert_array_equal(getattr(around, name), getattr(at_once, name))
    assert told == [0.4, 0.8, 1]


def test_to_look_around_from_nowhere_gives_no_graph(task):
    senses, _, _ = task
    shares = []
    assert len(senses.look_around(np.empty((0, 3)), np.random.default_rng(0), shares.append)) == 0
    assert shares == [1]


def test_who_shares_senses_sees_what_he_would_see_alone_and_only_what_is_new_is_looked_at():
    lucky = Lucky()
    shared, elsewhere = SharedSenses(lucky), POSES + [[0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 0, 0]]
    for poses, seed in ((POSES, 0), (elsewhere, 0), (POSES, 0), (POSES, 1), (elsewhere, 0)):
        rng, alone = np.random.default_rng(seed), np.random.default_rng(seed)
        np.testing.assert_array_equal(shared.scores(poses, rng), Lucky().scores(poses, alone))
        assert rng.bit_generator.state == alone.bit_generator.state
    assert lucky.looked == [4, 1, 0, 4, 0]


def test_planners_that_share_senses_live_through_what_they_would_alone(task):
    senses, robot, grid = task
    senses.net = segnet.new_params(np.random.default_rng(1))
    sequences = (0, 0, 2, 2), (0, 0, 2, 1), (2, 0, 2, 1)
    starts = senses.world.free_poses(70, np.random.default_rng(0))  # more than go side by side
    alone = [episode.run_all(senses, robot, grid, planners.scan(s), starts, 5) for s in sequences]
    before, shared = senses.views, SharedSenses(senses)
    together = [episode.run_all(shared, robot, grid, planners.scan(s), starts, 5) for s in sequences]
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one.poses, other.poses)
        np.testing.assert_allclose(one.belief, other.belief, rtol=1e-3)  # sums of other batches round otherwise
        assert (one.answers == other.answers).mean() > 0.99
    pasts = {past for s in sequences for past in itertools.accumulate(map(str, s), initial="")}
    assert senses.views - before == len(starts) * len(pasts)
