"""The rank index gives the answers of brute force and of the KD-tree, on the pile or on the shelves."""

import numpy as np
import pytest
from naive import nearest

from gnl import rank_index
from gnl.kdtree import KDTree
from gnl.rank_index import RankIndex, most_beyond


def reciprocal_ranks(scores):
    return (1 / (1 + np.argsort(np.argsort(-scores, axis=1), axis=1))).astype(np.float32)


def random(rng, n, n_places):
    return reciprocal_ranks(rng.normal(size=(n, n_places)))


def clustered(rng, n, n_places):
    prototypes = rng.normal(size=(12, n_places))
    which = rng.zipf(1.5, size=n) % 12
    return reciprocal_ranks(prototypes[which] + 0.2 * rng.normal(size=(n, n_places)))


def duplicated(rng, n, n_places):
    return random(rng, 9, n_places)[rng.integers(9, size=n)]


def index_of(points):
    index = RankIndex(points.shape[1])
    index.add(points)
    return index


@pytest.fixture(params=[(0, 0), (0, 40), (100, 40), (2000, 0)], ids="{0[0]}+{0[1]}".format)
def small(request, monkeypatch):
    """Rows on the pile before any goes to the shelves, and then: none, some, some later, all of them."""
    for name, value in zip(("SMALL", "PILE"), request.param, strict=True):
        monkeypatch.setattr(rank_index, name, value)


@pytest.mark.parametrize("k", [1, 4, 16, 500])
@pytest.mark.parametrize("n_places", [1, 2, 5, 60, 360])
@pytest.mark.parametrize("draw", [random, clustered, duplicated])
def test_answers_are_those_of_brute_force(draw, n_places, k, small):
    rng = np.random.default_rng(n_places)
    points = draw(rng, 308, n_places)
    points, queries = points[:300], np.concatenate([points[300:], points[:4], random(rng, 2, n_places)])
    distances, ids = index_of(points).query(queries, k)
    true_distances, true_ids = nearest(points, queries, k)
    np.testing.assert_array_equal(ids, true_ids)
    np.testing.assert_array_equal(distances, true_distances)
    assert distances.dtype == float
    assert ids.dtype == int


@pytest.mark.parametrize("k", [4, 16])
def test_those_that_32_bits_cannot_tell_apart_are_told_apart_by_exact_distance(k, small):
    rng = np.random.default_rng(0)
    order, rows, low = rng.permutation(360), np.arange(120), rng.permutation(120) + 150
    ranks = np.tile(np.arange(1, 361), (120, 1))  # each with two hopeless places exchanged: nearly equal dot products
    ranks[rows, low], ranks[rows, low + 1] = ranks[rows, low + 1], ranks[rows, low].copy()
    points = (1 / ranks).astype(np.float32)[:, order]
    query = (1 / np.arange(1, 361)).astype(np.float32)[None, order]
    for ours, true in zip(index_of(points).query(query, k), nearest(points, query, k), strict=True):
        np.testing.assert_array_equal(ours, true)


@pytest.mark.parametrize("draw", [clustered, duplicated])
def test_both_indexes_agree_while_they_grow(draw, small):
    rng = np.random.default_rng(0)
    points, index, tree = draw(rng, 250, 20), RankIndex(20), KDTree(20)
    for i, point in enumerate(points):
        assert index.add(point[None]).tolist() == tree.add(point[None]).tolist() == [i]
        assert len(index) == i + 1
        if i % 9 == 0:
            queries = np.concatenate([points[rng.integers(250, size=2)], random(rng, 1, 20)])
            for k in (1, 4):
                for ours, theirs in zip(index.query(queries, k), tree.query(queries, k), strict=True):
                    np.testing.assert_array_equal(ours, theirs)


def test_first_stored_point_is_found_again(small):
    points = clustered(np.random.default_rng(1), 300, 60)
    distances, ids = index_of(points).query(points[:1], 1)
    assert (distances[0, 0], ids[0, 0]) == (0, 0)


@pytest.mark.parametrize("n_first", [0, 1, 40, 150, 300])
@pytest.mark.parametrize("draw", [clustered, duplicated])
def test_an_older_state_is_a_fresh_index_of_the_first_points(draw, n_first, small):
    rng = np.random.default_rng(2)
    points, queries = draw(rng, 300, 30), random(rng, 10, 30)
    queries = np.concatenate([queries, points[-5:]])
    index = index_of(points[:25])
    for part in np.split(points[25:], 11):
        index.add(part)
    now, then = index.query(queries, 5, n_first), index_of(points[:n_first]).query(queries, 5)
    for ours, theirs in zip(now, then, strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("draw", [random, duplicated])
def test_points_come_back_as_they_were_added(draw, small):
    points = draw(np.random.default_rng(3), 150, 40)
    index = index_of(points[:90])
    index.add(points[:0])
    index.add(points[90:])
    np.testing.assert_array_equal(index.points, points)
    assert index.points.dtype == np.float32


def test_equal_points_are_found_oldest_first(small):
    points = np.repeat(random(np.random.default_rng(4), 1, 50), 150, axis=0)
    distances, ids = index_of(points).query(points[:2], 150)
    np.testing.assert_array_equal(ids, [np.arange(150)] * 2)
    assert not distances.any()


def test_equal_points_share_one_row(small):
    points = duplicated(np.random.default_rng(5), 300, 50)
    assert len(index_of(points)._oldest) == 9


def test_vectors_of_equal_hash_stay_apart(small, monkeypatch):
    monkeypatch.setattr(rank_index, "hash", lambda _: 0, raising=False)
    rng = np.random.default_rng(6)
    points = np.concatenate([random(rng, 100, 6), duplicated(rng, 50, 6)])
    np.testing.assert_array_equal(index_of(points).points, points)
    np.testing.assert_array_equal(index_of(points).query(points, 6)[1], nearest(points, points, 6)[1])
    np.testing.assert_array_equal(index_of(points).find(points), nearest(points, points, 1)[1][:, 0])


@pytest.mark.parametrize("draw", [random, duplicated])
def test_a_point_is_found_by_its_oldest_equal(draw, small):
    rng = np.random.default_rng(9)
    points = np.concatenate([draw(rng, 150, 20), draw(rng, 50, 20)])
    index = index_of(points[:90])
    index.add(points[90:150])
    plain = [[i for i, point in enumerate(points[:150]) if (point == wanted).all()] for wanted in points]
    assert index.find(points).tolist() == [equal[0] if equal else -1 for equal in plain]
    assert -1 in index.find(points)
    assert RankIndex(20).find(points).tolist() == [-1] * 200


def test_no_vector_beyond_has_a_greater_dot_product():
    """All 720 rankings of six places against one: the bound holds, and one of them attains it."""
    everyone = np.array(np.meshgrid(*[np.arange(6)] * 6)).reshape(6, -1).T
    everyone = everyone[[len(set(ranks)) == 6 for ranks in everyone.tolist()]]
    points, query = 1 / (1 + everyone), 1 / np.arange(1, 7)
    dots, bound = points @ query, most_beyond(6)
    for depth in range(6):
        np.testing.assert_allclose(bound[depth], dots[points.argmax(axis=1) >= depth].max())
    assert bound[6] == -np.inf


def test_most_shelves_stay_closed(monkeypatch):
    monkeypatch.setattr(rank_index, "SMALL", 0)
    points = clustered(np.random.default_rng(7), 1000, 60)
    index, looks, all_rows = index_of(points), [], []
    pieces, look_at_all = index._pieces, index._look_at_all

    def counted(*query):
        looks.append(0)
        for piece in pieces(*query):
            looks[-1] += 1
            yield piece

    monkeypatch.setattr(index, "_pieces", counted)
    monkeypatch.setattr(index, "_look_at_all", lambda queries, *rest: (
        all_rows.extend(queries) or look_at_all(queries, *rest)))
    index.query(points[::20], 4)
    assert len(looks) == 50
    assert np.median(looks) <= 3  # the pile and one or two of 60 shelves
    assert len(all_rows) < 10


def test_rows_move_to_the_shelves_some_at_a_time(monkeypatch):
    monkeypatch.setattr(rank_index, "SMALL", 100)
    monkeypatch.setattr(rank_index, "PILE", 30)
    index, on_pile = RankIndex(50), []
    for point in random(np.random.default_rng(10), 200, 50):
        index.add(point[None])
        on_pile.append(len(index) - index._shelves[-1])
    assert on_pile[:101] == [*range(1, 101), 0]
    assert on_pile[101:] == [*range(1, 30), 0] * 3 + list(range(1, 10))


def test_an_empty_index_answers_with_nothing(small):
    queries = random(np.random.default_rng(8), 2, 3)
    distances, ids = RankIndex(3).query(queries, 4)
    np.testing.assert_array_equal(distances, np.full((2, 4), np.inf))
    np.testing.assert_array_equal(ids, np.full((2, 4), -1))
    assert index_of(queries).query(queries[:0], 4)[1].shape == (0, 4)
    assert index_of(queries).find(queries[:0]).tolist() == []


@pytest.mark.parametrize("points, message", [
    ([1, 1 / 2, 1 / 3], r"points: expected shape \(n, 3\), found \(3,\)"),
    ([[1, 1 / 2]], r"points: expected shape \(n, 3\), found \(1, 2\)"),
    ([[1, np.nan, 1 / 3]], "points: expected finite"),
    ([[1, 1 / 2, 1 / 2]], "points: expected reciprocal ranks"),
    ([[1, 1 / 2, 1 / 3], [1, 2, 3]], r"points: expected reciprocal ranks.*1/3.*found \[1. 2. 3.\]"),
])
def test_bad_points_are_refused_and_leave_no_trace(points, message):
    index = RankIndex(3)
    for call in (index.add, lambda points: index.query(points, 1)):
        with pytest.raises(ValueError, match=message):
            call(points)
    assert len(index) == 0


def test_bad_counts_are_refused():
    index = RankIndex(1)
    for k in (0, -1, 2.5):
        with pytest.raises(ValueError, match="k: expected a whole number from 1"):
            index.query([[1]], k)
    for n_first in (-1, 1):
        with pytest.raises(ValueError, match="n_first: expected a whole number from 0 to 0, found"):
            index.query([[1]], 1, n_first)
    with pytest.raises(ValueError, match="n_places: expected a whole number from 1"):
        RankIndex(0)
