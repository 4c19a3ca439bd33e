"""The gap: what lies beyond it, and poses that are uniform there."""

import numpy as np
import pytest
from conftest import room
from scipy import stats

from gnl import gaps
from gnl.gaps import beyond_gap, poses_beyond
from gnl.places import wrap_angle
from gnl.world import World


@pytest.fixture(autouse=True)
def fewer_at_once(monkeypatch):
    monkeypatch.setattr(gaps, "DRAWN_AT_ONCE", 20_000)


def test_the_gap_is_a_matter_of_the_nearest_test_start_alone():
    tests = np.array([[0.0, 0, 0], [1.0, 0, np.pi]])
    poses = np.array([[0.3, 0, 1.0], [0.3, 0, 0.1], [0.1, 0, 1.0], [0.8, 0, 3.0], [0.7, 0, 0.0], [0.3, 0, -3.1]])
    assert beyond_gap(poses, tests, 0.2, 0.5).tolist() == [True, False, False, False, True, True]


def test_what_is_just_as_far_as_the_gap_is_not_beyond_it():
    poses = np.array([[0.25, 0, 1.0], [0.5, 0, 0.5], [0.5, 0, 1.0]])
    assert beyond_gap(poses, np.zeros((1, 3)), 0.25, 0.5).tolist() == [False, False, True]


def test_bearings_are_compared_around_the_circle():
    tests = np.array([[0.0, 0, np.pi - 0.05]])
    poses = np.array([[1.0, 0, -np.pi + 0.1], [1.0, 0, -np.pi + 0.5]])
    assert beyond_gap(poses, tests, 0.5, 0.2).tolist() == [False, True]


def test_poses_beyond_it_are_uniform_but_for_the_gap():
    """In an empty room with one test start: equal areas and equal angles beyond the gap get equal shares."""
    home, tests = World(room(size=(6.0, 4.0))), np.array([[3.0, 2.0, 0.5]])
    starts = poses_beyond(home, tests, 0.5, np.radians(60), 20_000, np.random.default_rng(1))
    turned = (starts[:, 2] - 0.5) % (2 * np.pi)
    assert stats.kstest(turned, stats.uniform(np.pi / 3, 4 * np.pi / 3).cdf).pvalue > 1e-3
    x, y = np.meshgrid(np.arange(0.05, 6, 0.1), np.arange(0.05, 4, 0.1), indexing="ij")
    area = home.is_reachable(np.stack([x, y], -1).reshape(-1, 2)).reshape(x.shape) & (np.hypot(x - 3, y - 2) > 0.5)
    expected = area.reshape(6, 10, 4, 10).sum((1, 3)).ravel()  # of each square metre, what is free and beyond the gap
    found = np.histogram2d(starts[:, 0], starts[:, 1], [np.arange(7), np.arange(5)])[0].ravel()
    assert (abs(found / len(starts) - expected / expected.sum()) < 0.012).all()


def test_a_gap_that_few_poses_are_beyond_is_tried_for_as_long_as_poses_do_turn_up(monkeypatch):
    monkeypatch.setattr(gaps, "DRAWN_AT_ONCE", 500)
    home, tests = World(room()), np.array([[3.0, 2.0, 0.0]])
    assert len(poses_beyond(home, tests, 0.0, np.radians(170), 100, np.random.default_rng(0))) == 100
    monkeypatch.setattr(gaps, "FEWEST", 0.1)
    with pytest.raises(ValueError, match=r"found \d+ among \d+ poses drawn"):
        poses_beyond(home, tests, 0.0, np.radians(170), 100, np.random.default_rng(0))


def test_who_learns_starts_only_where_one_can_get_to(two_rooms_plan):
    two_rooms_plan["doors"][1]["state"] = "closed"
    home, tests = World(two_rooms_plan), np.array([[1.0, 2.0, 0.0]])
    starts = poses_beyond(home, tests, 0.1, 0.1, 500, np.random.default_rng(0))
    assert home.is_reachable(starts[:, :2]).all()
    others = np.random.default_rng(0).uniform((0, 0), (7, 4), (2000, 2))
    assert (home.is_free(others) & ~home.is_reachable(others)).any()


def test_no_poses_beyond_a_gap_are_drawn_where_none_are_wanted(two_rooms_plan):
    assert poses_beyond(World(two_rooms_plan), np.zeros((1, 3)), 0.2, 0.1, 0, np.random.default_rng(0)).shape == (0, 3)


def test_no_pose_is_turned_by_more_than_half_a_circle():
    home = World(room())
    with pytest.raises(ValueError, match="found 0 among"):
        poses_beyond(home, home.free_poses(3, np.random.default_rng(0)), 0.0, np.pi, 1, np.random.default_rng(0))


def test_few_tests_leave_room_in_a_bearing_of_their_own():
    home, tests = World(room()), np.array([[3.0, 2.0, 0.0]])
    starts = poses_beyond(home, tests, 0.0, np.radians(179), 50, np.random.default_rng(0))
    assert (abs(wrap_angle(starts[:, 2] - np.pi)) < np.radians(1) + 1e-9).all()
