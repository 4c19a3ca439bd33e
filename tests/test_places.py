"""Places partition location and bearing; tested on homes that are not square and do not begin at the origin."""

from types import SimpleNamespace

import numpy as np
import pytest

from gnl.places import PlaceGrid, wrap_angle


def grid_over(width, depth, x0=-1.3, y0=2.1):
    return PlaceGrid(SimpleNamespace(bounds=(x0, y0, x0 + width, y0 + depth)))


@pytest.mark.parametrize(("width", "depth", "n_places"), [(12, 10, 360), (12.1, 10, 420), (12, 9.9, 360), (2, 2, 12),
                                                          (0.5, 7, 48), (11.4, 19.0, 720)])
def test_a_home_has_cells_of_two_metres_times_twelve_bearings(width, depth, n_places):
    assert grid_over(width, depth).n_places == n_places


def test_a_place_is_column_then_row_then_bearing():
    grid = grid_over(8, 6, x0=0, y0=0)
    assert grid.place_of([0.1, 0.1, 0.1]) == 0
    assert grid.place_of([0.1, 0.1, 0.1 + np.pi / 6]) == 1
    assert grid.place_of([0.1, 2.1, 0.1]) == 12
    assert grid.place_of([2.1, 0.1, 0.1]) == 3 * 12


def test_place_and_cell_are_inverse():
    grid = grid_over(8, 6)
    places = np.arange(grid.n_places)
    low = grid.corner_of(places)
    for inside in (1e-6, 0.5, 1 - 1e-6):
        np.testing.assert_array_equal(grid.place_of(low + inside * np.array([2, 2, np.pi / 6])), places)
    np.testing.assert_array_equal(grid.corner_of(places.reshape(4, 3, 12)), low.reshape(4, 3, 12, 3))


def test_each_pose_lies_in_the_cell_of_its_place():
    grid = grid_over(7, 11)
    poses = np.random.default_rng(0).uniform([-1.3, 2.1, -np.pi], [5.7, 13.1, np.pi], (5000, 3))
    within = (poses - grid.corner_of(grid.place_of(poses))) % [np.inf, np.inf, 2 * np.pi]
    assert (within >= 0).all()
    assert (within < [2, 2, np.pi / 6]).all()


def test_bearings_wrap():
    bearing = grid_over(2, 2)
    for theta, expected in [(0.0, 0), (-1e-9, 11), (np.pi / 6 + 1e-9, 1), (np.pi, 6), (-np.pi, 6), (np.pi - 1e-9, 5),
                            (np.pi + 1e-9, 6), (2 * np.pi, 0), (-np.pi / 2 + 1e-9, 9)]:
        assert bearing.place_of([-0.3, 3.1, theta]) == expected
        assert bearing.place_of([-0.3, 3.1, theta + 1e-12 + 20 * np.pi]) == expected


def test_a_pose_off_the_grid_gets_the_nearest_cell_of_the_rim():
    grid = grid_over(7, 11)
    poses = np.random.default_rng(1).uniform([-30, -30, -np.pi], [30, 30, np.pi], (1000, 3))
    on_rim = poses.clip([-1.3, 2.1, -np.inf], [5.7 - 1e-9, 13.1 - 1e-9, np.inf])
    np.testing.assert_array_equal(grid.place_of(poses), grid.place_of(on_rim))
    assert grid.place_of([1e9, 1e9, 0.1]) == grid.n_places - 12


def test_coordinates_apart_give_the_same_places():
    grid = grid_over(7, 11)
    poses = np.random.default_rng(2).uniform(-5, 15, (2, 50, 3))
    np.testing.assert_array_equal(grid.place_of(poses), grid.place_of_xyt(*np.moveaxis(poses, -1, 0)))


@pytest.mark.parametrize(("cell_m", "n_bearings"), [(2.0, 12), (0.7, 7), (0.3, 36)])
def test_what_lies_on_a_border_lies_beyond_it(cell_m, n_bearings):
    grid = PlaceGrid(SimpleNamespace(bounds=(-1.3, 2.1, 10.7, 9.1)), cell_m, n_bearings)
    places = np.arange(grid.n_places)
    np.testing.assert_array_equal(grid.place_of(grid.corner_of(places)), places)


def test_a_location_forgets_the_bearing():
    grid = grid_over(8, 6)
    poses = np.random.default_rng(3).uniform([-1.3, 2.1, -np.pi], [6.7, 8.1, np.pi], (200, 3))
    turned = poses + [0, 0, 2.0]
    locations = grid.location_of(grid.place_of(poses))
    np.testing.assert_array_equal(locations, grid.location_of(grid.place_of(turned)))
    assert set(locations) == set(range(12))


def test_angles_are_wrapped_to_the_half_open_circle():
    assert wrap_angle(0.0) == 0
    assert wrap_angle(np.pi) == np.pi
    assert wrap_angle(-np.pi) == np.pi
    angles = np.random.default_rng(0).uniform(-50, 50, 1000)
    wrapped = wrap_angle(angles)
    assert ((wrapped > -np.pi) & (wrapped <= np.pi)).all()
    np.testing.assert_allclose(np.exp(1j * wrapped), np.exp(1j * angles), atol=1e-12)


@pytest.mark.parametrize("cells", [(0, 12), (-2, 12), (np.nan, 12), (2, 0), (2, 7.5)], ids=str)
def test_cells_that_cannot_be_are_refused(cells):
    with pytest.raises(ValueError, match="places: expected cells of more than 0 m and a whole number of bearings, "
                                         f"found {cells[0]} and {cells[1]}"):
        PlaceGrid(SimpleNamespace(bounds=(0, 0, 8, 6)), *cells)


@pytest.mark.parametrize(("poses", "words"), [
    (np.zeros(4), r"poses: expected shape \(\.\.\., 3\), found \(4,\)"),
    (np.array([[1, 2, np.nan]]), "poses: expected finite numbers, found nan"),
    (np.array([[1, np.inf, 0]]), "poses: expected finite numbers, found inf")])
def test_poses_that_cannot_be_are_refused(poses, words):
    with pytest.raises(ValueError, match=words):
        grid_over(8, 6).place_of(poses)
