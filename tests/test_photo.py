"""The photograph: clean without noise, the same for the same seed, and random alike whatever there is to see."""

import numpy as np
import pytest
from conftest import room, thing

from gnl.camera import HEIGHT_M, render
from gnl.classes import BED, FLOOR, OTHER, SOFA, WALL
from gnl.photo import SUN_RAD
from gnl.world import World

POSES = np.array([[2.0, 1.2, 0.4], [5.0, 1.5, 2.5]])


def photo(world, poses=POSES, seed=0, noise=1.0, size=64):
    return render(world, poses, np.random.default_rng(seed), size, noise)[0].astype(int)


def test_without_noise_the_generator_does_not_matter(two_rooms):
    np.testing.assert_array_equal(photo(two_rooms, seed=0, noise=0), photo(two_rooms, seed=1, noise=0))


def test_a_seed_gives_one_picture_and_another_seed_another(two_rooms):
    np.testing.assert_array_equal(photo(two_rooms, seed=0), photo(two_rooms, seed=0))
    assert (photo(two_rooms, seed=0) != photo(two_rooms, seed=1)).mean() > 0.5


def test_what_is_drawn_does_not_depend_on_what_is_seen(two_rooms, home):
    after = []
    for world, poses, noise in [(two_rooms, POSES, 1), (two_rooms, POSES[::-1] + 0.3, 1), (home, POSES, 1),
                                (World(room()), POSES - 50, 1), (two_rooms, POSES, 0)]:
        rng = np.random.default_rng(0)
        render(world, poses, rng, 64, noise)
        after.append(rng.bit_generator.state)
    assert all(state == after[0] for state in after)
    assert after[0] != np.random.default_rng(0).bit_generator.state


def test_more_noise_moves_pixels_further_from_the_clean_picture(two_rooms):
    clean = photo(two_rooms, noise=0)
    distance = [abs(photo(two_rooms, seed=5, noise=noise) - clean).mean() for noise in (0.25, 0.5, 1, 2)]
    assert 0 < distance[0] < distance[1] < distance[2] < distance[3]


def test_noise_differs_from_pixel_to_pixel_and_from_view_to_view(two_rooms):
    added = photo(two_rooms, poses=POSES[[0, 0]]) - photo(two_rooms, poses=POSES[[0, 0]], noise=0)
    assert added.std((1, 2)).min() > 5
    assert (added[0] != added[1]).mean() > 0.5
    columns = added[0, ..., 0] - added[0, ..., 0].mean()
    assert abs((columns[:, 1:] * columns[:, :-1]).mean()) < 0.5 * columns.var()


@pytest.mark.parametrize(("colour", "low", "high"), [(0, 0, 140), (255, 60, 255)], ids=["black", "white"])
def test_colours_are_cut_off_and_do_not_wrap(colour, low, high):
    world = World(room(colors={part: [colour] * 3 for part in ("wall", "floor", "ceiling")}))
    rgb = photo(world, poses=np.array([[5.6, 2.0, 0.0], [2.0, 2.0, 1.0]]), noise=2.0)
    assert low <= rgb.min()
    assert rgb.max() <= high
    assert ((rgb == 0) | (rgb == 255)).any()


def test_shapes_and_types_are_those_of_pictures(two_rooms):
    rgb, _ = render(two_rooms, POSES, np.random.default_rng(0), 32)
    assert (rgb.shape, rgb.dtype) == ((2, 32, 32, 3), np.uint8)


def test_a_thing_bears_its_colour():
    world = World(room({**thing("bed", 4, 2, 1, 2, 1.0), "color": [250, 20, 20]}, colors={"floor": [20, 20, 250]}))
    rgb, labels = render(world, np.array([[1.0, 2.0, 0.0]]), np.random.default_rng(0), 64, noise=0)
    for label, strong in [(BED, 0), (FLOOR, 2)]:
        seen = rgb[labels == label].astype(int)
        assert len(seen) > 50
        assert (seen[:, strong] > 4 * np.delete(seen, strong, 1).max(1)).all()


def test_the_farther_is_the_darker():
    hall, pose = World(room(size=(20.0, 4.0))), np.array([[1.0, 2.0, 0.0]])
    rgb, labels = render(hall, pose, np.random.default_rng(0), 64, noise=0)
    wall_on_the_left = [rgb[0, labels[0, :, c] == WALL, c].mean() for c in (0, 10, 20, 26)]
    assert sorted(wall_on_the_left, reverse=True) == wall_on_the_left
    floor = rgb[0, labels[0, :, 32] == FLOOR, 32].mean(-1)
    assert (np.diff(floor) >= 0).all()  # downwards is nearer
    assert floor[-1] > floor[0]


def test_a_clean_pixel_is_albedo_times_facing_times_distance():
    """A wall 5 m ahead that looks to the west, and the floor of the lowest row."""
    world = World(room(size=(20.0, 20.0), colors={"wall": [255, 100, 50], "floor": [10, 200, 90]}))
    pose = np.array([[20 - 0.05 - 5.0, 10.0, 0.0]])  # the wall is 0.1 m thick
    rgb, labels = render(world, pose, np.random.default_rng(0), 64, noise=0)
    assert labels[0, 32, 32] == WALL
    assert labels[0, 63, 32] == FLOOR
    facing = 0.8 + 0.15 * np.cos(np.pi - SUN_RAD)
    expected = np.array([255, 100, 50]) * facing * (0.6 + 0.4 * np.exp(-1))
    np.testing.assert_allclose(rgb[0, 32, 32], expected, atol=1)
    depth = HEIGHT_M / (63 / 64)
    expected = np.array([10, 200, 90]) * 0.95 * (0.6 + 0.4 * np.exp(-depth / 5))
    np.testing.assert_allclose(rgb[0, 63, 32], expected, atol=1)


def test_what_lies_at_the_height_of_the_camera_is_seen_edge_on():
    things = thing("sofa", 3, 1, 1, 1, HEIGHT_M), thing("other", 3, 3, 1, 1, 0.5, z0=HEIGHT_M)
    rgb, labels = render(World(room(*things)), np.array([[1.0, 2.0, 0.0]]), np.random.default_rng(0), 64, noise=0)
    assert (labels[0, :32] != SOFA).all()
    assert (labels[0, 32:] != OTHER).all()
    assert {SOFA, OTHER} < set(labels.ravel().tolist())
    assert rgb.min() > 0


def test_two_sides_of_a_thing_differ():
    world = World(room(thing("refrigerator", 4, 2, 1, 1, 2.0, angle=np.pi / 4)))
    rgb, labels = render(world, np.array([[1.5, 2.0, 0.0]]), np.random.default_rng(0), 64, noise=0)
    left, right = rgb[0, 32, 28].astype(int), rgb[0, 32, 35].astype(int)
    assert labels[0, 32, 28] == labels[0, 32, 35] == 7
    assert (left > right + 5).all()  # the light comes from the left


def test_things_of_one_class_differ_in_colour():
    world = World(room(*[thing("sofa", 1 + i, 2, 0.5, 0.5, 0.5) for i in range(4)]))
    assert len({tuple(colour) for colour in world.colour[4:]}) == 4
