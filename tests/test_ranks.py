"""Reciprocal ranks keep the order of scores, all of it and nothing else; ties go to the lower place."""

import numpy as np
import pytest

from gnl.ranks import ranks, reciprocal_ranks


def draws():
    """Batches of scores of many sizes, with and without ties."""
    for seed in range(12):
        rng = np.random.default_rng(seed)
        shape = rng.integers(1, [8, 400])
        yield rng.standard_normal(shape)
        yield rng.integers(5, size=shape).astype(float)


def test_the_rank_of_a_score_is_one_more_than_the_number_of_those_before_it():
    for scores in draws():
        higher = scores[:, None, :] > scores[:, :, None]
        lower_place = np.tri(scores.shape[1], k=-1, dtype=bool)
        tied = (scores[:, None, :] == scores[:, :, None]) & lower_place
        np.testing.assert_array_equal(ranks(scores), 1 + (higher | tied).sum(2))


def test_reciprocal_ranks_are_a_permutation_of_one_a_half_a_third():
    for scores in draws():
        found = reciprocal_ranks(scores)
        assert found.dtype == np.float32
        wanted = (1 / np.arange(1, scores.shape[1] + 1)).astype(np.float32)
        np.testing.assert_array_equal(-np.sort(-found, 1), np.broadcast_to(wanted, scores.shape))


def test_any_increasing_map_of_scores_leaves_the_ranks():
    for scores in draws():
        for same in (3 * scores - 7, np.exp(scores), scores ** 3, np.arctan(scores), scores.astype(np.float32)):
            np.testing.assert_array_equal(reciprocal_ranks(same), reciprocal_ranks(scores))


def test_a_case_worked_by_hand():
    assert ranks([[0.1, 0.7, 0.2], [5, 5, 9], [-np.inf, np.inf, 0]]).tolist() == [[3, 1, 2], [2, 3, 1], [3, 1, 2]]
    np.testing.assert_allclose(reciprocal_ranks([[0.1, 0.7, 0.2]]), [[1 / 3, 1, 1 / 2]], rtol=1e-7)


def test_where_all_scores_are_equal_places_rank_in_their_order():
    assert ranks(np.full((2, 500), 0.3)).tolist() == [list(range(1, 501))] * 2


def test_one_place_is_the_best_and_no_view_has_no_rank():
    assert reciprocal_ranks(np.array([[-4.0], [7.0]])).tolist() == [[1], [1]]
    assert reciprocal_ranks(np.empty((0, 5))).shape == (0, 5)


def test_scores_that_are_not_numbers_are_refused():
    with pytest.raises(ValueError, match="scores: expected numbers, found 2 NaN"):
        ranks(np.array([[0, np.nan], [np.nan, 1]]))


@pytest.mark.parametrize("kind", [bool, np.uint8, np.int8, np.uint64, object])
def test_scores_of_any_kind_of_numbers_rank_alike(kind):
    scores = np.array([[0, 5, 100]]).astype(kind)
    assert ranks(scores).tolist() == ranks(scores.astype(float)).tolist()
