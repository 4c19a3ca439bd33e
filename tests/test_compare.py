"""Comparisons in pairs: by hand, against scipy, and the interval holds the truth as often as it says."""

import numpy as np
import pytest
from scipy import stats

from gnl.compare import paired_difference


@pytest.fixture
def pairs():
    """200 episodes of two methods that often are right together."""
    rng = np.random.default_rng(0)
    ease = rng.random(200)
    return ease + 0.3 * rng.random(200) > 0.6, ease + 0.3 * rng.random(200) > 0.7


def test_a_small_case_by_hand():
    # d = 1, 0, 0, 1: mean 1/2, variance 4 (1/4) / 3 = 1/3, standard error sqrt(1/12)
    mean, low, high = paired_difference([1, 1, 0, 1], [0, 1, 0, 0])
    assert mean == 0.5
    assert (low, high) == pytest.approx((0.5 - 1.959964 / 12 ** 0.5, 0.5 + 1.959964 / 12 ** 0.5), abs=1e-12)


def test_the_interval_is_that_of_the_normal_around_the_mean(pairs):
    a, b = pairs
    d = a.astype(int) - b
    mean, *interval = paired_difference(a, b)
    assert mean == pytest.approx(a.mean() - b.mean())
    assert interval == pytest.approx(stats.norm.interval(0.95, d.mean(), stats.sem(d)), abs=1e-7)


def test_the_mean_in_standard_errors_is_the_statistic_of_the_paired_t_test(pairs):
    mean, low, high = paired_difference(*pairs)
    standard_error = (high - low) / 2 / stats.norm.ppf(0.975)
    assert mean / standard_error == pytest.approx(stats.ttest_rel(*map(np.float64, pairs)).statistic, rel=1e-6)


def test_the_other_way_round_only_the_sign_changes(pairs):
    a, b = pairs
    mean, low, high = paired_difference(a, b)
    assert paired_difference(b, a) == pytest.approx((-mean, -high, -low))


def test_two_equal_lists_do_not_differ(pairs):
    assert paired_difference(pairs[0], pairs[0]) == (0, 0, 0)


def test_the_interval_holds_the_truth_in_95_of_100_experiments():
    rng, n = np.random.default_rng(0), 2000
    ease = rng.random((n, 150))
    a, b = ease < 0.5, ease + 0.2 * rng.standard_normal(ease.shape) < 0.45
    truth = 0.5 - (ease + 0.2 * rng.standard_normal(ease.shape) < 0.45).mean()
    held = [low <= truth <= high for _, low, high in map(paired_difference, a, b)]
    assert np.mean(held) == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize(("a", "b"), [([1, 0], [1]), ([1], [0]), ([], []), ([[1, 0]], [[0, 1]]), (1, 0)],
                         ids=["lengths", "one", "none", "tables", "numbers"])
def test_what_makes_no_pairs_is_refused(a, b):
    with pytest.raises(ValueError, match="pairs: expected two equal lists of at least 2 outcomes, found "):
        paired_difference(a, b)
