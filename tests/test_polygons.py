"""Rectangles cover the polygon that they stand for, and little else."""

import numpy as np
import pytest
from naive import within_polygon

from gnl.free_space import box_distance
from gnl.polygons import cover_polygon, smallest_rectangle

L_SHAPE = np.array([[0, 0], [3, 0], [3, 1], [1, 1], [1, 2.5], [0, 2.5]])  # 3 x 1 and 1 x 1.5
U_SHAPE = np.array([[0, 0], [4, 0], [4, 2], [3, 2], [3, 1], [1, 1], [1, 2], [0, 2]])  # 4 x 1 and twice 1 x 1
T_SHAPE = np.array([[0, 2], [0, 3], [5, 3], [5, 2], [3, 2], [3, 0], [2, 0], [2, 2]])  # 5 x 1 and 1 x 2
SHAPES = [(L_SHAPE, 4.5), (U_SHAPE, 6.0), (T_SHAPE, 7.0)]


def turned(points, angle, shift=(0.0, 0.0)):
    return points @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]) + shift


def area_of(rectangles):
    rectangles = np.atleast_2d(rectangles)
    return (4 * rectangles[:, 2] * rectangles[:, 3]).sum()


def beyond(points, rectangles):
    """How far the farthest point lies outside all rectangles."""
    x, y, a, b, angle = np.atleast_2d(rectangles).T
    return box_distance(points, np.stack([x, y], 1), np.stack([a, b], 1), angle).min(1).max()


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2, -2.0])
def test_a_rectangle_is_its_own_cover(angle):
    (cover,) = cover_polygon(turned(np.array([[-1.5, -0.5], [1.5, -0.5], [1.5, 0.5], [-1.5, 0.5]]), angle, (7, -2)))
    np.testing.assert_allclose(cover[:2], (7, -2))
    np.testing.assert_allclose(sorted(cover[2:4]), (0.5, 1.5))
    long_side = cover[4] + (0 if cover[2] > cover[3] else np.pi / 2)
    assert abs(np.sin(long_side - angle)) < 1e-6


def test_no_rectangle_around_the_points_is_smaller():
    rng = np.random.default_rng(0)
    for _ in range(30):
        points = rng.normal(size=(rng.integers(3, 9), 2)) * [2, 1]
        hull_sides = points[:, None] - points  # every side of the hull is one of these
        angles = np.arctan2(hull_sides[..., 1], hull_sides[..., 0]).ravel()
        square_on = [np.prod(np.ptp(turned(points, -angle), axis=0)) for angle in angles]
        found = smallest_rectangle(points[convex_order(points)])
        np.testing.assert_allclose(area_of(found), min(square_on))
        assert beyond(points, found) < 1e-6


def convex_order(points):
    """Indices of the hull's points, in order (Jarvis 1973)."""
    order = [points[:, 0].argmin()]
    while True:
        best = (order[-1] + 1) % len(points)
        for i in range(len(points)):
            a, b = points[best] - points[order[-1]], points[i] - points[order[-1]]
            if a[0] * b[1] - a[1] * b[0] < 0:
                best = i
        if best == order[0]:
            return order
        order.append(best)


@pytest.mark.parametrize("angle", [0.0, 0.7])
@pytest.mark.parametrize("mirror", [1, -1])
@pytest.mark.parametrize(("shape", "area"), SHAPES, ids="LUT")
def test_a_concave_shape_gets_several_rectangles_of_its_own_area(shape, area, mirror, angle):
    cover = cover_polygon(turned(shape * [1, mirror], angle, (3, 4)))
    assert len(cover) > 1
    np.testing.assert_allclose(area_of(cover), area, rtol=1e-6)


def test_a_cut_ends_where_it_first_meets_a_side():
    """A polygon of many arms, where the cut straight on meets farther sides, too."""
    cover = cover_polygon([(5, 6), (7, 3), (4, 5), (3, 0), (2, 0), (3, 5), (1, 5), (1, 7), (2, 6), (4, 7)])
    np.testing.assert_allclose(area_of(cover), 19.25, atol=0.01)


@pytest.mark.parametrize(("notch", "n_boxes"), [(0.2, 1), (0.9, 1), (1.5, 2)])
def test_a_small_notch_is_not_worth_a_cut(notch, n_boxes):
    """A 3 x 3 m square that lacks a corner: cut where its cover then is smaller by a tenth."""
    square = np.array([[0, 0], [3, 0], [3, 3 - notch], [3 - notch, 3 - notch], [3 - notch, 3], [0, 3]])
    cover = cover_polygon(square)
    assert len(cover) == n_boxes
    np.testing.assert_allclose(area_of(cover), 9 - notch ** 2 * (n_boxes > 1))


def test_every_point_of_a_polygon_lies_in_its_cover_and_the_cover_in_one_rectangle():
    rng = np.random.default_rng(0)
    for _ in range(100):
        bearings = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 12)))
        star = rng.uniform(0.1, 2, (len(bearings), 1)) * np.stack([np.cos(bearings), np.sin(bearings)], 1)
        star = star[::rng.choice([-1, 1])] + rng.normal(size=2)
        cover = cover_polygon(star)
        points = rng.uniform(star.min(0), star.max(0), (100, 2))
        points = np.concatenate([points[within_polygon(points, star)], star])
        assert beyond(points, cover) < 1e-6
        assert area_of(cover) <= area_of(smallest_rectangle(star)) + 1e-9


@pytest.mark.parametrize("points", [[[1, 1], [1, 1], [1, 1]], [[0, 0], [1, 0], [3, 0]],
                                    [[0, 0], [2, 2], [0, 0], [1, 1]],
                                    [[0, 0], [1, 0], [1, 0], [1, 1], [0, 1], [0, 1]]])
def test_a_polygon_without_area_or_with_points_told_twice_is_covered(points):
    cover = cover_polygon(points)
    assert np.isfinite(cover).all()
    assert beyond(np.array(points, float), cover) < 1e-6
    assert area_of(cover) <= 1 + 1e-9
