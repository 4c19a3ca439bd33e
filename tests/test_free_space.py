"""Where a home is inside and where a disc has room, against exact distances and homes where the answer is known."""

import numpy as np
import pymunk
import pytest
from conftest import room, thing

from gnl.free_space import RASTER_M, FreeSpace, box_distance
from gnl.world import World


def strips(*segments):
    """Thin boxes along segments, as centre, half and angle."""
    x0, y0, x1, y1 = np.array(segments, float).T
    half = np.stack([np.hypot(x1 - x0, y1 - y0) / 2, np.full(len(x0), 0.005)], 1)
    return np.stack([(x0 + x1) / 2, (y0 + y1) / 2], 1), half, np.arctan2(y1 - y0, x1 - x0)


def walled(*segments, bounds=(0, 0, 6, 4)):
    return FreeSpace(bounds, *strips(*segments))


def test_distance_to_a_box_is_pymunks_and_zero_within():
    rng = np.random.default_rng(0)
    centre, half, angle = rng.uniform(-3, 3, (20, 2)), rng.uniform(0.05, 2, (20, 2)), rng.uniform(-4, 4, 20)
    points = rng.uniform(-5, 5, (50, 2))
    expected = np.empty((50, 20))
    for i, ((x, y), (a, b), turn) in enumerate(zip(centre, half, angle, strict=True)):
        frame = pymunk.Transform(np.cos(turn), np.sin(turn), -np.sin(turn), np.cos(turn), x, y)
        box = pymunk.Poly(pymunk.Space().static_body, [(a, b), (-a, b), (-a, -b), (a, -b)], frame)
        box.cache_bb()
        expected[:, i] = [max(0, box.point_query(tuple(point)).distance) for point in points]
    assert (expected == 0).any()
    np.testing.assert_allclose(box_distance(points, centre, half, angle), expected, atol=1e-9)


def test_clearance_is_the_distance_to_the_nearest_obstacle_up_to_the_raster(home):
    b = home.blocks
    points = home.free_poses(500, np.random.default_rng(0), radius_m=0.1)[:, :2]
    exact = box_distance(points, home.centre[b], home.half[b], home.angle[b]).min(1)
    cell = np.floor((points - home.free_space.origin) / RASTER_M).astype(int)
    assert abs(home.free_space.clearance[tuple(cell.T)] - exact).max() < 2 * RASTER_M


def test_a_closed_room_is_inside_and_the_rest_is_not():
    space = walled((0, 0, 6, 0), (6, 0, 6, 4), (6, 4, 0, 4), (0, 4, 0, 0))
    points = np.random.default_rng(0).uniform([-3, -3], [9, 7], (2000, 2))
    depth = np.minimum(points, [6, 4] - points).min(1)  # how far within the walls
    np.testing.assert_array_equal(space.inside(points[abs(depth) > 0.1]), depth[abs(depth) > 0.1] > 0)


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.2])
def test_the_thinnest_wall_holds_wherever_it_stands(turn):
    for offset in np.linspace(0, RASTER_M, 8):
        middle = np.array([3 + offset, 2 + offset])
        bearings = turn + np.arange(4) * np.pi / 2
        corners = middle + 2 * np.stack([np.cos(bearings), np.sin(bearings)], 1)
        space = walled(*[(*corners[k], *corners[k - 1]) for k in range(4)], bounds=(1, 0, 5, 4))
        assert space.inside([middle, middle + [0.5, -0.5], middle + [1.6, 1.6]]).tolist() == [True, True, False]


def test_a_ball_stays_out_of_a_narrow_gap_and_rolls_in_by_a_wide_one():
    def with_gap(width):
        """Two rooms side by side; the left one is open to the west."""
        return walled((0, 0, 6, 0), (6, 0, 6, 4), (6, 4, 0, 4), (3, 0, 3, 4),
                      (0, 0, 0, 2 - width / 2), (0, 2 + width / 2, 0, 4))
    assert with_gap(1.0).inside([[1.5, 2], [4.5, 2]]).tolist() == [True, True]
    assert with_gap(1.5).inside([[1.5, 2], [4.5, 2]]).tolist() == [False, True]


@pytest.mark.parametrize(("width", "closed"), [(1.1, True), (1.3, False)])
def test_the_ball_is_as_wide_as_is_said(width, closed):
    """A room with a gap in its west wall: 1.2 m wide is the ball, up to the raster."""
    space = walled((0, 0, 6, 0), (6, 0, 6, 4), (6, 4, 0, 4), (0, 0, 0, 2 - width / 2), (0, 2 + width / 2, 0, 4),
                   (3, 0, 3, 4))
    assert space.inside([[1.5, 2], [4.5, 2]]).tolist() == [closed, True]


def test_a_home_without_a_side_is_inside_up_to_its_bounds():
    space = walled((0, 0, 6, 0), (6, 0, 6, 4), (6, 4, 0, 4))
    assert space.inside([[0.1, 2], [5, 2], [-0.2, 2], [3, 4.2]]).tolist() == [True, True, False, False]


def test_the_largest_region_is_the_larger_room():
    space = walled((0, 0, 6, 0), (6, 0, 6, 4), (6, 4, 0, 4), (0, 4, 0, 0), (2, 0, 2, 4))
    room = space.largest_region(0.2)
    assert space.look_up(room, [[4, 2], [1, 2], [2.1, 2], [5.9, 2]]).tolist() == [True, False, False, False]
    assert not space.largest_region(3.0).any()


def test_what_is_not_an_obstacle_takes_no_room():
    free = World(room(thing("other", 3, 2, 2, 2, 0.02), thing("other", 3, 2, 1, 1, 0.3, z0=2.0))).free_space
    taken = World(room(thing("table", 3, 2, 2, 2, 0.7))).free_space
    assert free.look_up(free.largest_region(0.2), [[3, 2]])
    assert not taken.look_up(taken.largest_region(0.2), [[3, 2]])


def test_nothing_is_inside_beyond_the_raster():
    space = walled((0, 0, 6, 0), (6, 0, 6, 4), (6, 4, 0, 4), (0, 4, 0, 0))
    assert not space.inside([[100, 2], [3, -100], [-1e6, 1e6]]).any()
