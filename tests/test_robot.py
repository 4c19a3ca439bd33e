"""The robot turns as asked, stops at contact, never passes a wall, and its wheels err as stated."""

import numpy as np
import pytest
from conftest import room, thing
from naive import pierce

from gnl.free_space import box_distance
from gnl.robot import FORWARD, LEFT, N_ACTIONS, RIGHT, Motion, Robot
from gnl.world import ROBOT_RADIUS_M, World

SURE = Motion(std_m=0.0, std_rad=0.0)


def rng():
    return np.random.default_rng(0)


def distance_to_obstacles(world, poses):
    b = world.blocks
    return box_distance(poses[:, :2], world.centre[b], world.half[b], world.angle[b]).min(1)


def test_a_turn_left_and_one_right_come_back_and_move_nothing(home):
    robot, start = Robot(home), home.free_poses(50, rng())
    left, _, bumped = robot.step(start, np.full(50, LEFT), rng())
    back, _, _ = robot.step(left, np.full(50, RIGHT), rng())
    assert not bumped.any()
    np.testing.assert_array_equal(left[:, :2], start[:, :2])
    np.testing.assert_allclose(np.exp(1j * left[:, 2]), np.exp(1j * (start[:, 2] + np.pi / 6)))
    np.testing.assert_allclose(back, start, atol=1e-12)


def test_twelve_turns_make_a_circle_and_bearings_stay_wrapped(two_rooms):
    robot, pose = Robot(two_rooms), np.array([[3.0, 3.0, 3.0]])
    for _ in range(12):
        pose, _, _ = robot.step(pose, [LEFT], rng())
        assert -np.pi < pose[0, 2] <= np.pi
    np.testing.assert_allclose(pose, [[3.0, 3.0, 3.0]], atol=1e-12)


@pytest.mark.parametrize("bearing", [0.0, 1.0, np.pi / 2, -2.5])
def test_forward_goes_half_a_metre_along_the_bearing(bearing):
    pose, odometry, bumped = Robot(World(room()), SURE).step([[3, 2, bearing]], [FORWARD], rng())
    np.testing.assert_allclose(pose, [[3 + 0.5 * np.cos(bearing), 2 + 0.5 * np.sin(bearing), bearing]])
    np.testing.assert_allclose(odometry, [[0.5, 0]])
    assert bumped.tolist() == [False]


def test_forward_stops_at_contact(home):
    robot, poses = Robot(home), home.free_poses(60, rng())
    for _ in range(30):
        poses, _, bumped = robot.step(poses, np.full(60, FORWARD), rng())
    assert bumped.all()
    gap = distance_to_obstacles(home, poses) - ROBOT_RADIUS_M
    assert (gap > 0).all()
    assert (gap < 2e-3).all()


def test_a_bump_reports_how_far_it_got():
    # The wall's face is 5.95 m from the origin: a disc of 20 cm stops at 5.75, a millimetre short of it.
    pose, odometry, bumped = Robot(World(room()), SURE).step([[5.5, 2, 0.0]], [FORWARD], rng())
    np.testing.assert_allclose(pose, [[5.75, 2, 0]], atol=2e-3)
    np.testing.assert_allclose(odometry[0], [pose[0, 0] - 5.5, 0])
    assert bumped.tolist() == [True]


@pytest.mark.parametrize(("x", "end"), [(5.2495, 5.749), (5.7495, 5.7495)], ids=["comes near", "is nearer"])
def test_a_robot_stops_a_millimetre_from_contact_and_is_never_pushed_back(x, end):
    pose, odometry, bumped = Robot(World(room()), SURE).step([[x, 2, 0.0]], [FORWARD], rng())
    np.testing.assert_allclose(pose, [[end, 2, 0]], rtol=0, atol=1e-6)
    np.testing.assert_allclose(odometry, [[end - x, 0]], rtol=0, atol=1e-6)
    assert bumped.tolist() == [True]


def test_a_slimmer_robot_gets_nearer_to_the_wall():
    for radius_m, end in ((0.1, 5.849), (0.4, 5.549)):
        pose, _, bumped = Robot(World(room()), SURE, radius_m).step([[5.5, 2, 0.0]], [FORWARD], rng())
        np.testing.assert_allclose(pose[0, 0], end, rtol=0, atol=1e-6)
        assert bumped.tolist() == [True]


def test_a_robot_at_contact_can_turn_and_leave():
    robot, pose = Robot(World(room()), SURE), np.array([[5.5, 2, 0.1]])
    for _ in range(3):
        pose, _, bumped = robot.step(pose, [FORWARD], rng())
    assert bumped.all()
    for _ in range(6):
        pose, _, bumped = robot.step(pose, [LEFT], rng())
        assert not bumped.any()
    away, odometry, bumped = robot.step(pose, [FORWARD], rng())
    assert not bumped.any()
    np.testing.assert_allclose(odometry, [[0.5, 0]])
    np.testing.assert_allclose(np.hypot(*(away - pose)[0, :2]), 0.5)


def test_a_robot_never_passes_a_wall(home):
    robot, generator = Robot(home), rng()
    poses = home.free_poses(20, generator)
    obstacles = np.flatnonzero(home.blocks)
    for step in range(200):
        before = poses
        poses, _, _ = robot.step(poses, generator.choice([LEFT, RIGHT, FORWARD, FORWARD], 20), generator)
        assert (distance_to_obstacles(home, poses) > ROBOT_RADIUS_M).all()
        if step % 20 == 0:  # and the way there crossed none
            for start, way in zip(before[:, :2], (poses - before)[:, :2], strict=True):
                ways = np.array([pierce(home, box, start, way + 1e-12) for box in obstacles])
                assert not ((ways[:, 0] < ways[:, 1]) & (ways[:, 0] > 0) & (ways[:, 0] < 1)).any()
    assert home.free_space.inside(poses[:, :2]).all()


@pytest.mark.parametrize(("in_the_way", "stops"), [
    (thing("other", 3, 2, 0.4, 1, 0.5, z0=1.6), False), (thing("other", 3, 2, 0.4, 1, 0.02), False),
    (thing("table", 3, 2, 0.4, 1, 0.7), True), (thing("other", 3, 2, 0.4, 1, 0.5, z0=1.0), True),
], ids=["lamp", "carpet", "table", "shelf"])
def test_what_stops_a_robot(in_the_way, stops):
    pose, _, bumped = Robot(World(room(in_the_way))).step([[2.5, 2, 0.0]], [FORWARD], rng())
    assert bumped.tolist() == [stops]
    assert (pose[0, 0] < 2.61) == stops


def test_an_open_door_lets_a_robot_through_and_a_shut_one_does_not(two_rooms_plan):
    ends = {}
    for state in ("open", "closed"):
        two_rooms_plan["doors"][1]["state"] = state
        robot, pose = Robot(World(two_rooms_plan)), np.array([[3.3, 1.45, 0.0]])
        for _ in range(3):
            pose, _, _ = robot.step(pose, [FORWARD], rng())
        ends[state] = pose[0, 0]
    np.testing.assert_allclose(ends["open"], 4.8)
    assert ends["closed"] < 4


def test_odometry_is_the_true_motion_and_noise_of_the_stated_size():
    motion, n = Motion(std_m=0.04, std_rad=0.02), 2000
    actions = np.arange(n) % N_ACTIONS
    start = np.tile([5.5, 2, 0.0], (n, 1))  # forward is a bump after a quarter of a metre
    poses, odometry, _ = Robot(World(room()), motion).step(start, actions, rng())
    error = odometry - (poses - start)[:, [0, 2]]
    for column, std in enumerate([0.04, 0.02]):
        assert abs(error[:, column].mean()) < 4 * std / np.sqrt(n)
        assert abs(error[:, column].std() / std - 1) < 0.06
    assert abs(np.corrcoef(error.T)[0, 1]) < 4 / np.sqrt(n)


def test_noise_is_drawn_alike_whatever_the_robots_do(two_rooms):
    robot, start = Robot(two_rooms), two_rooms.free_poses(30, rng())
    errors, states = [], []
    for actions in (np.full(30, LEFT), np.full(30, FORWARD), np.arange(30) % N_ACTIONS):
        generator = rng()
        poses, odometry, _ = robot.step(start, actions, generator)
        truth = np.stack([np.hypot(*(poses - start)[:, :2].T), np.choose(actions, [np.pi / 6, -np.pi / 6, 0])], 1)
        errors.append(odometry - truth)
        states.append(generator.bit_generator.state)
    np.testing.assert_allclose(errors[1], errors[0], atol=1e-12)
    np.testing.assert_allclose(errors[2], errors[0], atol=1e-12)
    assert states[0] == states[1] == states[2]


def test_poses_that_are_none_are_refused(home):
    with pytest.raises(ValueError, match="poses: expected finite numbers, found nan"):
        Robot(home).step([[1, 2, np.nan]], [0], rng())


@pytest.mark.parametrize("actions", [0, [0], [0, 3], [0, -1], [0.5, 1], [[0, 1]]], ids=str)
def test_actions_that_are_none_are_refused(home, actions):
    with pytest.raises(ValueError, match=rf"actions: expected 2 whole numbers 0\.\.{N_ACTIONS - 1}, found "):
        Robot(home).step(home.free_poses(2, rng()), actions, rng())


def test_actions_may_be_any_kind_of_numbers(home):
    start = home.free_poses(2, rng())
    for actions in ([2, 1], [2.0, 1.0], np.array([2, 1], np.uint8)):
        np.testing.assert_array_equal(Robot(home).step(start, actions, rng())[0],
                                      Robot(home).step(start, np.array([2, 1]), rng())[0])


def test_many_robots_move_as_each_would_alone(home):
    robot, start = Robot(home, SURE), home.free_poses(30, rng())
    actions = np.arange(30) % N_ACTIONS
    together = robot.step(start, actions, rng())
    alone = [robot.step(start[i:i + 1], actions[i:i + 1], rng()) for i in range(30)]
    for whole, *parts in zip(together, *alone, strict=True):
        np.testing.assert_array_equal(whole, np.concatenate(parts))


def test_a_step_leaves_the_callers_poses_alone(two_rooms):
    start = two_rooms.free_poses(5, rng())
    kept = start.copy()
    Robot(two_rooms).step(start, np.full(5, FORWARD), rng())
    np.testing.assert_array_equal(start, kept)
