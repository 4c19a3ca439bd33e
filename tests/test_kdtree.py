"""The KD-tree gives the answers of brute force, whatever the points and however they arrive."""

import numpy as np
import pytest
from naive import nearest

from gnl.kdtree import LEAF_SIZE, KDTree


def gaussian(rng, n, dim):
    return rng.normal(size=(n, dim)).astype(np.float32)


def clustered(rng, n, dim):
    centres = 10 * rng.normal(size=(7, dim))
    return (centres[rng.integers(7, size=n)] + rng.normal(size=(n, dim))).astype(np.float32)


def lattice(rng, n, dim):
    """Few different values: equal points, and equal distances to different points."""
    return rng.integers(-1, 2, size=(n, dim)).astype(np.float32)


def agrees_with_brute_force(tree, points, queries, k, n_first=None):
    distances, ids = tree.query(queries, k, n_first)
    true_distances, true_ids = nearest(points[:n_first], queries, k)
    np.testing.assert_array_equal(ids, true_ids)
    np.testing.assert_array_equal(distances, true_distances)
    assert distances.dtype == float
    assert ids.dtype == int


@pytest.mark.parametrize("k", [1, 4, 16, 500])
@pytest.mark.parametrize("dim", [1, 2, 8, 300])
@pytest.mark.parametrize("draw", [gaussian, clustered, lattice])
def test_answers_are_those_of_brute_force(draw, dim, k):
    rng = np.random.default_rng(dim)
    points = draw(rng, 400, dim)
    queries = np.concatenate([draw(rng, 8, dim), points[::100]])
    tree = KDTree(dim)
    np.testing.assert_array_equal(tree.add(points), np.arange(400))
    agrees_with_brute_force(tree, points, queries, k)


@pytest.mark.parametrize("draw", [gaussian, lattice])
def test_tree_grows_one_point_at_a_time(draw):
    rng = np.random.default_rng(0)
    points, tree = draw(rng, 300, 3), KDTree(3)
    for i, point in enumerate(points):
        assert tree.add(point[None]).tolist() == [i]
        assert len(tree) == i + 1
        if i % 7 == 0:
            agrees_with_brute_force(tree, points[:i + 1], draw(rng, 2, 3), 4)


def test_first_stored_point_is_found_again():
    points, tree = gaussian(np.random.default_rng(1), 1000, 8), KDTree(8)
    tree.add(points)
    distances, ids = tree.query(points[:1], 1)
    assert (distances[0, 0], ids[0, 0]) == (0, 0)


@pytest.mark.parametrize("draw", [gaussian, lattice])
def test_a_point_is_found_by_its_oldest_equal(draw):
    rng = np.random.default_rng(5)
    points, tree = draw(rng, 400, 4), KDTree(4)
    assert tree.find(points).tolist() == [-1] * 400
    tree.add(points[:100])
    tree.add(points[100:300])
    plain = [[i for i, point in enumerate(points[:300]) if (point == wanted).all()] for wanted in points]
    assert tree.find(points).tolist() == [equal[0] if equal else -1 for equal in plain]
    assert -1 in tree.find(points)
    assert tree.find(points[:0]).tolist() == []


@pytest.mark.parametrize("n_first", [0, 1, 40, 200])
def test_an_older_state_is_a_fresh_tree_of_the_first_points(n_first):
    rng = np.random.default_rng(2)
    points, queries = lattice(rng, 200, 4), lattice(rng, 10, 4)
    tree, fresh = KDTree(4), KDTree(4)
    tree.add(points)
    fresh.add(points[:n_first])
    for now, then in zip(tree.query(queries, 5, n_first), fresh.query(queries, 5), strict=True):
        np.testing.assert_array_equal(now, then)


def test_points_come_back_as_they_were_added():
    points, tree = gaussian(np.random.default_rng(3), 100, 5), KDTree(5)
    tree.add(points[:30])
    tree.add(points[30:30])
    tree.add(points[30:])
    np.testing.assert_array_equal(tree.points, points)
    assert tree.points.dtype == np.float32
    tree.points[:] = 7  # a copy: the tree does not change
    np.testing.assert_array_equal(tree.points, points)


def test_equal_points_are_found_oldest_first():
    tree = KDTree(2)
    tree.add(np.ones((10 * LEAF_SIZE, 2)))
    tree.add([[1, 2]])
    distances, ids = tree.query([[1, 1]], 10 * LEAF_SIZE + 1)
    assert ids[0].tolist() == list(range(10 * LEAF_SIZE + 1))
    assert distances[0].tolist() == [0] * (10 * LEAF_SIZE) + [1]


def test_sorted_arrivals_make_no_trouble():
    points, tree = np.arange(5_000, dtype=np.float32)[:, None], KDTree(1)
    for start in range(0, len(points), 40):
        tree.add(points[start:start + 40])
    assert tree.query([[1234.25]], 3)[1].tolist() == [[1234, 1235, 1233]]


def test_few_points_are_looked_at_in_the_plane(monkeypatch):
    rng = np.random.default_rng(4)
    tree = KDTree(2)
    tree.add(rng.random((5000, 2)))
    seen = []
    monkeypatch.setattr("gnl.kdtree.lengths", lambda rows: seen.append(len(rows)) or np.hypot(*rows.T))
    tree.query(rng.random((20, 2)), 4)
    assert sum(seen) / 20 < 250  # of 5000, boxes included


def test_an_empty_tree_answers_with_nothing():
    distances, ids = KDTree(3).query(np.zeros((2, 3)), 4)
    np.testing.assert_array_equal(distances, np.full((2, 4), np.inf))
    np.testing.assert_array_equal(ids, np.full((2, 4), -1))
    assert KDTree(3).query(np.zeros((0, 3)), 4)[1].shape == (0, 4)


@pytest.mark.parametrize("points, message", [
    (np.zeros(3), r"points: expected shape \(n, 3\), found \(3,\)"),
    (np.zeros((2, 4)), r"points: expected shape \(n, 3\), found \(2, 4\)"),
    ([[0, np.nan, 0]], "points: expected finite float32 values, found nan"),
    ([[0, 1e300, 0]], "points: expected finite float32 values, found inf"),
])
def test_bad_points_are_refused_and_leave_no_trace(points, message):
    tree = KDTree(3)
    for call in (tree.add, lambda points: tree.query(points, 1)):
        with pytest.raises(ValueError, match=message):
            call(points)
    assert len(tree) == 0


def test_bad_counts_are_refused():
    tree = KDTree(1)
    for k in (0, -1, 2.5):
        with pytest.raises(ValueError, match="k: expected a whole number from 1"):
            tree.query([[0]], k)
    for n_first in (-1, 1):
        with pytest.raises(ValueError, match="n_first: expected a whole number from 0 to 0, found"):
            tree.query([[0]], 1, n_first)
    with pytest.raises(ValueError, match="dim: expected a whole number from 1"):
        KDTree(0)
