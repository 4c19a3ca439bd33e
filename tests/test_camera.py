"""What a pixel shows is what its ray meets first, against a renderer that asks each ray."""

import naive
import numpy as np
import pytest
from conftest import room, thing

from gnl.camera import HEIGHT_M, render, row_of, true_labels
from gnl.classes import BED, CEILING, DOOR, FLOOR, OTHER, REFRIGERATOR, SOFA, TABLE, TV, WALL
from gnl.world import World


def agreement(world, poses, size=64):
    """Share of pixels on which camera and naive renderer agree."""
    expected = np.array([naive.labels(world, pose, size) for pose in poses])
    return (true_labels(world, poses, size) == expected).mean()


def column_of(world, pose, size=512, column=None):
    """One column of a view, the middle one unless told, from the top."""
    return true_labels(world, np.array([pose]), size)[0, :, size // 2 if column is None else column]


def runs(column):
    """The classes of a column from the top, neighbours merged."""
    return column[np.r_[True, column[1:] != column[:-1]]].tolist()


def test_labels_are_those_of_a_ray_per_pixel_in_procedural_homes(home):
    assert agreement(home, home.free_poses(6, np.random.default_rng(0))) >= 0.9999


@pytest.mark.parametrize("state", ["open", "closed"])
def test_labels_are_those_of_a_ray_per_pixel_where_a_doors_leaf_touches_the_wall_above_it(state):
    """One sees the underside of that wall, and the leaf before it, from near by."""
    walls = [[0, 0, 6, 0], [6, 0, 6, 4], [6, 4, 0, 4], [0, 4, 0, 2.5], [0, 1.5, 0, 0]]
    world = World({"walls": walls, "doors": [{"segment": [0, 1.5, 0, 2.5], "state": state}]})
    poses = np.array([[0.8, 2, np.pi], [1.2, 2.2, 3.0], [0.5, 1.7, 2.6], [1.0, 3.3, -2.4]])
    assert agreement(world, poses, 128) == 1


def test_labels_are_those_of_a_ray_per_pixel_among_things_carried_and_hanging(strewn):
    poses = np.random.default_rng(0).uniform([0.3, 0.3, -np.pi], [7.7, 4.7, np.pi], (60, 3))
    poses = poses[strewn.is_free(poses[:, :2], radius_m=0.05)][:8]
    assert len(poses) == 8
    assert agreement(strewn, poses) >= 0.999


def test_labels_are_nearly_those_of_a_ray_per_pixel_in_real_homes_whose_things_overlap(real_home):
    assert agreement(real_home, real_home.free_poses(20, np.random.default_rng(0))) >= 0.997


def test_of_nothing_one_sees_ceiling_above_the_horizon_and_floor_below():
    labels = true_labels(World(room()), np.array([[-5.0, 2.0, np.pi]]), 64)[0]
    assert (labels[:32] == CEILING).all()
    assert (labels[32:] == FLOOR).all()


def test_no_floor_is_above_the_horizon_and_no_ceiling_below(home):
    labels = true_labels(home, home.free_poses(20, np.random.default_rng(1)), 64)
    assert not (labels[:, :32] == FLOOR).any()
    assert not (labels[:, 32:] == CEILING).any()


def test_a_wall_stands_between_ceiling_and_floor_where_geometry_says():
    column = column_of(World(room()), (1.95, 2.0, 0.0))  # 4 m before the wall's face, 512 px over 90 degrees
    top, foot = 256 * (1 - (2.5 - HEIGHT_M) / 4), 256 * (1 + HEIGHT_M / 4)
    assert runs(column) == [CEILING, WALL, FLOOR]
    assert (column == WALL).sum() == foot - top
    assert column[int(top)] == WALL
    assert column[int(top) - 1] == CEILING
    assert (row_of(2.5, 1 / 4, 512), row_of(0.0, 1 / 4, 512)) == (top, foot)


def test_a_wall_stands_above_an_open_door(two_rooms):
    column = column_of(two_rooms, (1.95, 1.45, 0.0))  # 2 m before the wall in which the door is
    top, edge = (int(256 * (1 - (z - HEIGHT_M) / 2)) for z in (2.5, 2.0))
    assert (column[top:edge] == WALL).all()
    assert (column[:top] == CEILING).all()
    assert column[edge + 20] == CEILING  # that of the next room
    assert runs(column[edge + 20:]) == [CEILING, WALL, FLOOR, OTHER, FLOOR]  # its far wall, the carpet


def test_a_shut_door_fills_its_doorway_up_to_the_wall_above(two_rooms):
    assert runs(column_of(two_rooms, (2.05, 1.95, np.pi))) == [CEILING, WALL, DOOR, FLOOR]


def test_a_table_shows_its_top_and_a_refrigerator_does_not():
    for kind, height, visible in [("table", 0.75, True), ("refrigerator", 1.8, False)]:
        column = column_of(World(room(thing(kind, 3.5, 2, 1.0, 1, height))), (1.0, 2.0, 0.0))
        near, far = 2.0, 3.0
        foot, front, back = (256 * (1 + (HEIGHT_M - z) / d) for z, d in [(0, near), (height, near), (height, far)])
        label, expected = (TABLE, foot - back) if visible else (REFRIGERATOR, foot - front)
        assert abs((column == label).sum() - expected) <= 1


def test_a_lamp_shows_its_underside():
    column = column_of(World(room(thing("other", 3.5, 2, 1.0, 1, 0.4, z0=1.75))), (1.0, 2.0, 0.0))
    top, _, back = (256 * (1 - (z - HEIGHT_M) / d) for z, d in [(2.15, 2), (1.75, 2), (1.75, 3)])
    assert abs((column == OTHER).sum() - (back - top)) <= 1


def test_a_camera_below_a_lamp_sees_its_underside_overhead():
    column = column_of(World(room(thing("other", 3, 2, 2.0, 3, 0.4, z0=1.75))), (3.0, 2.0, 0.0))
    assert runs(column) == [OTHER, CEILING, WALL, FLOOR]


def test_what_stands_on_a_table_hides_its_top_and_not_its_front():
    world = World(room(thing("table", 3, 2, 1, 2, 0.7), thing("tv", 3, 2, 0.1, 1, 0.4, z0=0.7)))
    column = column_of(world, (1.0, 2.0, 0.0))
    assert runs(column) == [CEILING, WALL, TV, TABLE, FLOOR]
    top, foot = (256 * (1 + (HEIGHT_M - z) / 1.95) for z in (1.1, 0.7))
    assert abs((column == TV).sum() - (foot - top)) <= 1


@pytest.mark.parametrize("back", [5.93, 5.95, 5.96, 6.0], ids=["before", "at", "in", "up to the middle of"])
def test_a_table_against_a_wall_with_something_on_it_shows_its_top(back):
    lamp = thing("other", back - 0.4, 2.5, 0.2, 0.2, 0.3, z0=0.75)  # the wall's face is at 5.95
    world = World(room(thing("table", back - 0.4, 2, 0.8, 1.6, 0.75), lamp))
    poses = np.array([[3.0, 2.0, 0.0], [4.0, 1.2, 0.4], [4.5, 3.0, -0.5]])
    assert agreement(world, poses) >= 0.999


def test_furniture_side_by_side_with_things_on_it_shows_its_tops():
    row = [thing(kind, x, 2, 0.5, 1.5, 0.75) for kind, x in [("table", 3.0), ("sofa", 3.5), ("bed", 4.0)]]
    bowls = [thing("other", x, 2.2, 0.1, 0.1, 0.1, z0=0.75) for x in (3.0, 3.5, 4.0)]
    assert agreement(World(room(*row, *bowls)), np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.5]])) >= 0.999


@pytest.mark.parametrize("z0, height", [(0, 6), (1.5, 3), (2.0, 0.5), (2.5, 1), (4, 1)])
def test_what_is_taller_than_the_walls_ends_at_the_ceiling(z0, height):
    world = World(room(thing("refrigerator", 4, 2, 0.5, 1, height, z0)))
    assert agreement(world, np.array([[1.0, 2.0, 0.0], [3.0, 2.5, -0.3]])) >= 0.999


@pytest.mark.parametrize("z0, height", [(-0.3, 0.8), (-0.02, 0.5), (-0.5, 3.5), (-1, 0.5), (-0.5, 0.5)])
def test_what_reaches_through_the_floor_begins_at_the_floor(z0, height):
    world = World(room(thing("bed", 4, 2, 0.5, 1, height, z0)))
    poses = np.array([[1.0, 2.0, 0.0], [3.0, 2.5, -0.3]])
    assert agreement(world, poses) >= 0.999
    above = room(thing("bed", 4, 2, 0.5, 1, z0 + height)) if z0 + height > 0 else room()
    np.testing.assert_array_equal(true_labels(world, poses), true_labels(World(above), poses))


def test_the_nearer_hides_the_farther():
    near, far = thing("refrigerator", 2.5, 2, 0.5, 1, 1.8), thing("bed", 4.5, 2, 1, 1, 0.5)
    assert BED not in column_of(World(room(near, far)), (1.0, 2.0, 0.0))
    assert BED in column_of(World(room(far)), (1.0, 2.0, 0.0))
    world = World(room(thing("sofa", 2.5, 2, 0.5, 1, 0.4), thing("refrigerator", 4.5, 2, 0.5, 1, 1.8)))
    assert runs(column_of(world, (0.6, 2.0, 0.0))) == [CEILING, WALL, REFRIGERATOR, FLOOR, SOFA, FLOOR]


def test_of_more_things_than_a_column_can_hold_the_nearest_are_seen():
    row = [thing("table", 2 + 0.1 * i, 2, 0.05, 1, 0.7) for i in range(80)]
    alone = World(room(*row[:1], size=(12.0, 4.0)))
    world = World(room(*row, size=(12.0, 4.0)))
    column = column_of(world, (1.0, 2.0, 0.0))
    front = column_of(alone, (1.0, 2.0, 0.0)) == TABLE
    assert (column[front] == TABLE).all()
    assert set(column) <= {CEILING, WALL, TABLE, FLOOR}
    assert agreement(world, np.array([[1.0, 2.0, 0.0]])) > 0.9
    screen = thing("refrigerator", 1.9, 2, 0.05, 1, 2.0)
    np.testing.assert_array_equal(column_of(World(room(screen, *row, size=(12.0, 4.0))), (1.0, 2.0, 0.0)),
                                  column_of(World(room(screen, size=(12.0, 4.0))), (1.0, 2.0, 0.0)))


@pytest.mark.parametrize("n_steps", [32, 40, 80])
def test_where_a_column_holds_no_more_no_ceiling_is_below_the_horizon_and_no_floor_above(n_steps):
    """Stairs up to the camera, the front and the top of each step in view, and a wall behind."""
    stairs = [thing("table", 2 + 0.03 * i, 2, 0.03, 3, 0.05 + 0.014 * i) for i in range(n_steps)]
    world = World(room(*stairs, size=(12.0, 4.0)))
    labels = true_labels(world, np.array([[1.0, 2.0, 0.0], [1.2, 2.0, -0.3]]), 512)
    assert not (labels[:, :256] == FLOOR).any()
    assert not (labels[:, 256:] == CEILING).any()


def test_small_views_show_what_large_views_show(home):
    poses = home.free_poses(8, np.random.default_rng(2))
    small, large = true_labels(home, poses, 64), true_labels(home, poses, 512)
    blocks = large.reshape(8, 64, 8, 64, 8).transpose(0, 1, 3, 2, 4).reshape(8, 64, 64, 64)
    majority = (blocks[..., None] == np.arange(10)).sum(-2).argmax(-1)
    assert (small == majority).mean() >= 0.97


def test_many_views_are_rendered_as_each_would_alone(home):
    poses = home.free_poses(70, np.random.default_rng(3))
    rgb, labels = render(home, poses, np.random.default_rng(0), 64, noise=0)
    for v in range(0, 70, 9):
        alone_rgb, alone_labels = render(home, poses[v:v + 1], np.random.default_rng(0), 64, noise=0)
        np.testing.assert_array_equal(labels[v], alone_labels[0])
        np.testing.assert_array_equal(rgb[v], alone_rgb[0])


@pytest.mark.parametrize("size", [64, 512])
def test_views_that_are_wanted_are_those_among_all_and_the_luck_of_the_others_is_spent(two_rooms, size):
    rng = np.random.default_rng(0)
    poses = two_rooms.free_poses(150 if size == 64 else 20, rng)  # more than are rendered at once
    wanted, luck = rng.random(len(poses)) < 0.3, np.random.default_rng(5)
    everything = render(two_rooms, poses, luck, size)
    for some in (wanted, ~wanted, np.zeros(len(poses), bool)):
        again = np.random.default_rng(5)
        for of_all, of_some in zip(everything, render(two_rooms, poses, again, size, wanted=some), strict=True):
            np.testing.assert_array_equal(of_some, of_all[some])
        assert again.bit_generator.state == luck.bit_generator.state


@pytest.mark.parametrize("size", [64, 512])
def test_true_labels_are_those_of_the_rendered_view(home, size):
    poses = home.free_poses(3, np.random.default_rng(4))
    rgb, labels = render(home, poses, np.random.default_rng(0), size)
    np.testing.assert_array_equal(true_labels(home, poses, size), labels)
    assert (labels.shape, labels.dtype) == ((3, size, size), np.uint8)
    assert (rgb.shape, rgb.dtype) == ((3, size, size, 3), np.uint8)


@pytest.mark.parametrize("wanted", [[1, 0], [True], [True] * 3, [[True, False]]], ids=str)
def test_what_says_not_of_each_pose_whether_it_is_wanted_is_refused(two_rooms, wanted):
    rng = np.random.default_rng(0)
    with pytest.raises(ValueError, match="wanted: expected 2 of bool, found "):
        render(two_rooms, two_rooms.free_poses(2, rng), rng, 64, wanted=wanted)


def test_no_view_at_all_is_no_error(home):
    rgb, labels = render(home, np.empty((0, 3)), np.random.default_rng(0), 64)
    assert (rgb.shape, labels.shape) == ((0, 64, 64, 3), (0, 64, 64))


@pytest.mark.parametrize(("poses", "size", "noise", "words"), [
    ([[1, 2, np.nan]], 64, 1, "poses: expected finite numbers, found nan"), ([[1, 2]], 64, 1, "poses: expected shape"),
    ([[1, 2, 0]], 0, 1, "size: expected an even number of pixels, found 0"), ([[1, 2, 0]], 63, 1, "size: .* found 63"),
    ([[1, 2, 0]], 64.0, 1, "size: expected an even number of pixels, found 64.0"),
    ([[1, 2, 0]], 64, -1, "noise: expected 0..10, found -1")])
def test_views_that_cannot_be_are_refused(two_rooms, poses, size, noise, words):
    with pytest.raises(ValueError, match=words):
        render(two_rooms, poses, np.random.default_rng(0), size, noise)
    if noise > 0:
        with pytest.raises(ValueError, match=words):
            true_labels(two_rooms, poses, size)
