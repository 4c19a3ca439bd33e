"""Comparisons in pairs: by hand, against scipy, and the interval holds the truth as often as it says."""

import hashlib

import numpy as np
import pytest
from scipy import stats

from gnl.compare import episodes_needed, in_points, mcnemar, over_cells, paired_difference
from gnl.paper import WORLDS, table_1


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


def test_the_interval_over_cells_is_scipys_bootstrap_of_their_mean():
    d = np.random.default_rng(0).normal(0.03, 0.1, 75)
    mean, *interval = over_cells(d, np.random.default_rng(1))
    assert mean == pytest.approx(d.mean())
    scipys = stats.bootstrap((d,), np.mean, method="percentile", rng=np.random.default_rng(2)).confidence_interval
    assert interval == pytest.approx(scipys, abs=0.001)


def test_episodes_of_one_cell_are_no_evidence_of_their_own():
    """Ten cells that differ: a hundred equal episodes in each make the interval no narrower."""
    of_cell = np.random.default_rng(0).normal(0, 0.2, 10)
    _, low, high = over_cells(of_cell, np.random.default_rng(1))
    assert high - low == pytest.approx(2 * 1.96 * of_cell.std() / np.sqrt(10), rel=0.1)


def test_equal_cells_leave_no_doubt():
    assert over_cells([0.1] * 5, np.random.default_rng(0)) == pytest.approx((0.1, 0.1, 0.1))


@pytest.mark.parametrize("cells", [[], [[0.1, 0.2]], 0.3])
def test_what_are_no_cells_is_refused(cells):
    with pytest.raises(ValueError, match="differences: expected one for each cell, found shape"):
        over_cells(cells, np.random.default_rng(0))


def test_mcnemars_p_by_hand():
    # A alone is right in 5 pairs, B alone in 1: p = 2 (1 + 6) / 2^6
    a, b = np.array([1, 1, 1, 1, 1, 0, 1, 0]), np.array([0, 0, 0, 0, 0, 1, 1, 0])
    assert mcnemar(a, b) == mcnemar(b, a) == pytest.approx(14 / 64)


@pytest.mark.parametrize(("a", "b"), [([1, 0], [1]), ([0.3, 1], [0, 1]), ([[1, 0]], [[0, 1]])],
                         ids=["lengths", "shares", "tables"])
def test_mcnemars_p_is_of_right_and_wrong_alone(a, b):
    with pytest.raises(ValueError, match="pairs: expected two lists of 0 and 1, equally long, found "):
        mcnemar(a, b)


def test_mcnemars_p_tends_to_the_chi_square_of_the_textbook():
    rng = np.random.default_rng(0)
    a, b = rng.random(20_000) < 0.5, rng.random(20_000) < 0.51
    n_a, n_b = (a & ~b).sum(), (b & ~a).sum()
    assert mcnemar(a, b) == pytest.approx(stats.chi2.sf((abs(n_a - n_b) - 1) ** 2 / (n_a + n_b), 1), rel=0.02)


def test_methods_that_never_differ_are_not_told_apart():
    assert mcnemar([1, 0, 1], [1, 0, 1]) == 1.0


def test_as_many_episodes_as_are_needed_show_the_difference_four_times_in_five():
    rng, p, q = np.random.default_rng(0), 0.50, 0.60
    n = episodes_needed(q - p, np.sqrt(p * (1 - p) + q * (1 - q)))
    assert 380 < n < 400
    shown = [paired_difference(rng.random(n) < q, rng.random(n) < p)[1] > 0 for _ in range(600)]
    assert np.mean(shown) == pytest.approx(0.8, abs=0.05)


def test_no_fewer_episodes_would_do():
    for difference, std in ((0.1, 0.5), (0.025, 0.7), (0.05, 0.3)):
        n, needed = episodes_needed(difference, std), stats.norm.ppf(0.975) + stats.norm.ppf(0.8)
        assert difference * np.sqrt(n - 1) / std < needed <= difference * np.sqrt(n) / std + 1e-5


@pytest.mark.parametrize(("difference", "std"), [(0, 0.5), (np.nan, 0.5), (0.1, np.inf), (1e-200, 0.5)])
def test_no_number_of_episodes_shows_a_difference_of_nothing(difference, std):
    with pytest.raises(ValueError, match="difference, std: expected finite numbers and a difference that some "):
        episodes_needed(difference, std)


def test_outcomes_that_are_no_numbers_are_refused():
    with pytest.raises(ValueError, match="pairs: expected finite numbers, found nan"):
        paired_difference([1, np.nan], [0, 1])
    with pytest.raises(ValueError, match="differences: expected finite numbers, found nan"):
        over_cells([0.1, np.nan], np.random.default_rng(0))


def test_the_papers_own_numbers_have_the_means_that_were_seen_in_them():
    cells = table_1()
    assert len(cells) == 75
    assert {cell[0] for cell in cells} == set(WORLDS)
    assert cells[800, 1.0, 90] == {"SV": 38, "MV": 52, "Ours": 61, "DA": 54}
    assert cells[809, 0.2, 10] == {"SV": 33, "MV": 53, "Ours": 56, "DA": 54}
    found = {pair: over_cells([c[pair[0]] - c[pair[1]] for c in cells.values()], np.random.default_rng(0))
             for pair in (("MV", "SV"), ("Ours", "MV"), ("DA", "Ours"))}
    assert [round(mean, 1) for mean, _, _ in found.values()] == [9.5, 2.6, -0.2]
    assert found["Ours", "MV"][1] > 0 > found["DA", "Ours"][1]


def test_the_papers_table_is_theirs_to_the_last_number():
    """The digest is that of the rows of its file: the number of the scan, T_xy, T_theta, SV, MV, Ours, DA."""
    rows = [",".join(f"{number:g}" for number in of.values()) for of in table_1().values()]
    heads = [f"{world:05d},{t_xy_m},{t_theta_deg}" for world, t_xy_m, t_theta_deg in table_1()]
    whole = "".join(f"{head},{row}\n" for head, row in zip(heads, rows, strict=True))
    assert hashlib.sha256(whole.encode()).hexdigest() == (
        "e2fe08fb9763e40abe50a09ac2dec9b6f2e1f9e418db31c6d4bad655d496af82")


def test_a_difference_is_told_in_points_with_signs():
    assert in_points(0.0125, -0.0034, 0.12) == "+1.2 [-0.3, +12.0]"
