"""The photograph: clean without noise, the same for the same seed, its random numbers the same whatever is in view."""

import numpy as np
import pytest
from conftest import room, thing

from gnl import photo as photo_module
from gnl.camera import HEIGHT_M, render
from gnl.classes import BED, FLOOR, OTHER, SOFA, WALL
from gnl.photo import SUN_RAD
from gnl.strip import slopes
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


@pytest.mark.parametrize("distance_m", [10.0, 15.0])
def test_a_far_wall_is_as_dark_as_its_distance_makes_it(distance_m):
    world = World(room(size=(40.0, 40.0), colors={"wall": [250, 200, 150]}))
    pose = np.array([[40 - 0.05 - distance_m, 20.0, 0.0]])
    facing = 0.8 + 0.15 * np.cos(np.pi - SUN_RAD)
    expected = np.array([250, 200, 150]) * facing * (0.6 + 0.4 * np.exp(-distance_m / 5))
    np.testing.assert_allclose(photo(world, pose, noise=0)[0, 32, 32], expected, atol=1)


def test_an_underside_is_darker_than_any_other_face():
    """The board hangs 0.5 m above the camera and over it."""
    board = {**thing("other", 3, 2, 3.0, 3, 0.4, z0=HEIGHT_M + 0.5), "color": [250, 200, 150]}
    rgb, labels = render(World(room(board)), np.array([[2.0, 2.0, 0.0]]), np.random.default_rng(0), 64, noise=0)
    assert labels[0, 10, 32] == OTHER
    depth = 0.5 / (1 - 21 / 64)
    expected = np.array([250, 200, 150]) * 0.6 * (0.6 + 0.4 * np.exp(-depth / 5))
    np.testing.assert_allclose(rgb[0, 10, 32], expected, atol=1)


@pytest.fixture
def lucky(monkeypatch):
    """A photograph whose luck is known: plain exposure, such a gradient across and down, no noise of the sensor."""
    def draw(world, poses, noise=0, across=0.0, down=0.0):
        one = np.ones((len(poses), 1, 1), np.float32)
        monkeypatch.setattr(photo_module, "_luck", lambda n, H, *_: (
            np.full((n, 3), 255.0), across * one, down * one, np.zeros((n, 3, H, H), np.int8)))
        return photo(world, poses, noise=noise)
    return draw


def test_the_light_falls_off_across_or_down_the_view(lucky, two_rooms):
    plain, slope = lucky(two_rooms, POSES), slopes(64)
    for across, down, light in ((0.3, 0.0, 1 + 0.3 * slope), (0.0, 0.2, 1 + 0.2 * slope[:, None])):
        expected = np.minimum(plain * light[..., None] if down else plain * light[:, None], 255)
        assert abs(lucky(two_rooms, POSES, across=across, down=down) - expected).max() < 2.5


def test_waves_lie_on_the_floor_whoever_looks_and_wherever_from(lucky):
    world = World(room(size=(8.0, 6.0), colors={"floor": [200, 150, 100]}))
    n, poses = len(world.label) + 1, np.array([[2.0, 1.2, 0.4], [5.0, 3.5, 2.5]])
    turn, pitch = 2.4 * n, 12 + 9 * np.sin(1.7 * n)
    depth = HEIGHT_M / -slopes(64)[40:]  # of the rows below the horizon
    for pose, rgb in zip(poses, lucky(world, poses, noise=1), strict=True):
        for row, ahead in enumerate(depth, 40):
            left = ahead * slopes(64)
            x = pose[0] + ahead * np.cos(pose[2]) - left * np.sin(pose[2])
            y = pose[1] + ahead * np.sin(pose[2]) + left * np.cos(pose[2])
            wave = np.sin(n + pitch * (x * np.cos(turn) + y * np.sin(turn) - HEIGHT_M * np.sin(3.1 * n)))
            light = 0.95 * (0.6 + 0.4 * np.exp(-ahead / 5)) * (1 + 0.1 * wave)
            on_floor = (x > 0.1) & (x < 7.9) & (y > 0.1) & (y < 5.9)
            np.testing.assert_allclose(rgb[row, on_floor, 0], (200 * light)[on_floor], atol=1.5)


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
