"""The charts of the report: what is better is blue, farther right, higher up or taller, as its numbers are."""

import itertools

import numpy as np
import pytest

from gnl import draw_charts
from gnl.experiment import GAPS_DEG, GAPS_M


def test_a_shade_tells_better_from_worse_and_none_is_white():
    assert draw_charts.shade(0) == (255, 255, 255)
    better, worse = draw_charts.shade(10), draw_charts.shade(-10)
    assert better[2] > better[0]
    assert worse[0] > worse[2]
    assert draw_charts.shade(15) == draw_charts.shade(40)


def test_a_heat_map_has_a_field_for_each_gap_and_grey_where_nothing_is_known():
    points = {(m, deg): 12.0 for m in GAPS_M for deg in GAPS_DEG}
    full = np.array(draw_charts.heat_maps({800: points}, GAPS_M, GAPS_DEG))
    del points[0.6, 50]
    less = np.array(draw_charts.heat_maps({800: points}, GAPS_M, GAPS_DEG))
    blue = (full == draw_charts.shade(12.0)).all(2).sum()
    assert (less == draw_charts.shade(12.0)).all(2).sum() / blue == pytest.approx(24 / 25, abs=0.01)
    assert (full == draw_charts.FAINT).all(2).sum() == 0 < (less == draw_charts.FAINT).all(2).sum()


def test_charts_of_three_homes_fit_a_page_of_830_px_with_letters_of_at_least_11(monkeypatch):
    sizes, text = [], draw_charts.Canvas.text
    monkeypatch.setattr(draw_charts.Canvas, "text", lambda page, at, words, size=12, *how: (
        sizes.append(size), text(page, at, words, size, *how)))
    points = {(m, deg): -12.3 for m in GAPS_M for deg in GAPS_DEG}
    methods = dict.fromkeys(draw_charts.LINES, np.full((2, 10), 0.5))
    assert draw_charts.heat_maps(dict.fromkeys((800, 801, 809), points), GAPS_M, GAPS_DEG).width <= 830
    assert draw_charts.curves(dict.fromkeys((800, 801, 809), methods)).width <= 830
    assert draw_charts.histogram({0: 2}).width <= 830
    assert min(sizes) >= 11


@pytest.fixture
def written(monkeypatch):
    """Words and where they were written, (x, y, words) each."""
    found, text = [], draw_charts.Canvas.text
    monkeypatch.setattr(draw_charts.Canvas, "text",
                        lambda page, at, words, *how: found.append((*at, words)) or text(page, at, words, *how))
    return found


def test_fields_and_bars_name_their_numbers(written):
    draw_charts.heat_maps({800: {(0.2, 10): 12.0, (1.0, 90): -3.51}}, (0.2, 1.0), (10, 90))
    assert [words for *_, words in written if words[0] in "+-"] == ["+12", "-3.5"]
    written.clear()
    draw_charts.histogram({0: 2, 6: 4})
    numbers = [int(words) for *_, words in written if words.isdigit()]
    assert (numbers[::2], numbers[1::2]) == ([2, 0, 0, 0, 0, 0, 4, 0, 0, 0], list(range(1, 11)))


def test_names_of_curves_that_meet_do_not_cover_each_other_and_keep_the_order_of_the_curves(written):
    for ours, scan in ((0.503, 0.50), (0.50, 0.503)):
        written.clear()
        draw_charts.curves({800: {"Ours": np.full((2, 3), ours), "Scan": np.full((2, 3), scan)}})
        heights = {words: y for _, y, words in written if words in ("Ours", "Scan")}
        assert abs(heights["Ours"] - heights["Scan"]) >= 13
        assert (heights["Ours"] < heights["Scan"]) == (ours > scan)


def spots(picture, colour):
    """Middle, upper left and lower right pixel, (x, y) each, of what has just this colour, and how many they are."""
    y, x = np.nonzero((np.array(picture) == colour).all(2))
    return (x.mean(), y.mean()), (x.min(), y.min()), (x.max(), y.max()), len(x)


def test_on_a_heat_map_wider_gaps_lie_farther_right_and_sharper_turns_higher_up():
    gaps_m, gaps_deg = (0.2, 0.6, 1.0, 2.0), (10, 90)
    middles = {}
    for gap in itertools.product(gaps_m, gaps_deg):
        for value in (12.0, -12.0):
            picture = draw_charts.heat_maps({800: {gap: value}}, gaps_m, gaps_deg)
            middles[gap, value] = spots(picture, draw_charts.shade(value))[0]
        assert middles[gap, 12.0] == pytest.approx(middles[gap, -12.0], abs=3)
    columns = [middles[(m, 10), 12.0][0] for m in gaps_m]
    assert np.diff(columns) == pytest.approx([41] * 3, abs=1)
    for m in gaps_m:
        (x, y), (above_x, above_y) = middles[(m, 10), 12.0], middles[(m, 90), 12.0]
        assert (above_x - x, above_y - y) == pytest.approx((0, -34), abs=1)


def test_curves_rise_as_their_numbers_do_between_their_axes_and_only_ours_has_a_band():
    n, rising = 5, np.linspace(0.35, 0.65, 5)
    methods = {"Ours": np.tile(rising, (4, 1)), "Scan": np.repeat([[0.33], [0.67], [0.5]], n, 1)}
    picture = draw_charts.curves({800: methods})
    inside = np.array(picture)[:, :12 + 260 - 52]  # without the names at the right
    ours = [np.nonzero(abs(inside[:, x] - np.array(draw_charts.LINES["Ours"])).max(1) < 60)[0].mean()
            for x in (60, 96, 176, 212)]  # not where the lines cross
    _, scan_first, scan_last, _ = spots(inside, draw_charts.LINES["Scan"])
    assert (np.diff(ours) < 0).all()
    assert ours[0] + ours[-1] == pytest.approx(scan_first[1] + scan_last[1], abs=3)  # the mean of Scan lies half-way
    assert scan_last[1] - scan_first[1] <= 3
    _, first, last, _ = spots(inside, draw_charts.FAINT)
    assert first[1] < min(ours) < max(ours) < last[1]
    assert last[0] == pytest.approx(scan_last[0], abs=2)
    assert (first[1] + last[1]) / 2 == pytest.approx((scan_first[1] + scan_last[1]) / 2, abs=1)  # 30, 70 and 50 %
    aside = np.array(picture)[:, 12 + 260 - 50:].astype(int)  # letters are thin: few pixels are of their colour alone
    names = {name: np.nonzero(abs(aside - draw_charts.LINES[name]).max(2) < 60)[0].mean() for name in methods}
    assert names["Ours"] < names["Scan"]
    methods["Ours"] = methods["Ours"] + [[-0.1], [0.1], [0], [0]]
    band = np.array(draw_charts.curves({800: methods}))
    pale = (np.array([255, 255, 255]) * 205 + np.array(draw_charts.LINES["Ours"]) * 50) / 255
    assert (abs(band - pale).max(2) <= 2).sum() > 500
    assert ((abs(band - pale).max(2) <= 2).sum(0)[60:212] > 10).all()  # from side to side
    assert (abs(inside - pale).max(2) <= 2).sum() < 50


@pytest.mark.parametrize(("shares", "wanted"), [
    ([1.0, 1.0], ["90 %", "100 %"]), ([0.5, 1.0], ["50 %", "60 %", "70 %", "80 %", "90 %", "100 %"]),
    ([0.0, 0.0], ["0 %", "10 %"]), ([0.31, 0.39], ["30 %", "40 %"]), ([0.3, 0.4], ["30 %", "40 %", "50 %"])])
def test_an_axis_of_shares_holds_them_and_ends_at_100_percent(written, shares, wanted):
    draw_charts.curves({800: {"Ours": np.tile(shares, (3, 1))}})
    assert [words for *_, words in written if words.endswith(" %")] == wanted


def test_nothing_has_no_sign_of_a_loss(written):
    draw_charts.heat_maps({800: {(0.2, 10): -6.7e-16, (0.4, 10): -0.04, (0.6, 10): -0.06}}, (0.2, 0.4, 0.6), (10,))
    assert {words for *_, words in written} >= {"+0", "-0.1"}
    assert "-0" not in {words for *_, words in written}


def test_a_histogram_has_bars_as_high_as_they_are_many_each_in_its_place():
    picture = draw_charts.histogram({0: 2, 6: 4})
    bars = np.array(picture)
    first, seventh = (spots(half, draw_charts.BAR) for half in (bars[:, :210], bars[:, 210:]))
    assert first[3] / seventh[3] == pytest.approx(1 / 2, abs=0.02)
    assert first[2][1] == seventh[2][1]  # they stand on one line
    assert seventh[0][0] + 210 - first[0][0] == pytest.approx(6 * (420 - 32) / 10, abs=1)
    assert seventh[1][1] < 30  # the highest fills the picture


def test_lines_begin_and_end_at_their_ticks_and_one_point_is_a_dot(written):
    ticks = {0: "none", 10: "all"}, {0.0: "0", 1.0: "1"}
    picture = draw_charts.lines({"slope": ((0, 10), (0.0, 1.0)), "dot": ((10,), (0.5,))}, *ticks, "x", y_name="y",
                                colours={"slope": (0, 200, 0), "dot": (200, 0, 0)})
    at = {words: (x, y) for x, y, words in written}
    inside = np.array(picture)[:, :460 - 52 + 1]  # without the names at the right
    _, upper_left, lower_right, _ = spots(inside, (0, 200, 0))
    assert (upper_left[0], lower_right[0]) == pytest.approx((at["none"][0], at["all"][0]), abs=2)
    assert (upper_left[1], lower_right[1]) == pytest.approx((at["1"][1], at["0"][1]), abs=2)
    middle, first, last, _ = spots(np.array(picture)[:, :460 - 52 + 5], (200, 0, 0))
    assert middle == pytest.approx((at["all"][0], (at["1"][1] + at["0"][1]) / 2), abs=1.5)
    assert last[1] - first[1] == pytest.approx(8, abs=2)
    assert at["slope"][1] < at["dot"][1]
    assert at["y"][1] < at["1"][1]


def test_a_line_beneath_another_shows_as_its_rim_and_else_lines_are_thin():
    def rows(colour, other):
        flat = {"first": ((0, 1), (0.5, 0.5)), "second": ((0, 1), (other, other))}
        picture = draw_charts.lines(flat, {0: "0", 1: "1"}, {0: "0", 1: "1"}, "x")
        return (abs(np.array(picture)[:, 200].astype(int) - colour).sum(1) < 100).sum()

    for colour in draw_charts.USUAL[:2]:
        assert rows(colour, 0.501) >= 1  # at one height both are seen
        assert 1 <= rows(colour, 0.8) <= 2


def test_lines_take_the_usual_colours_in_turn():
    picture = np.array(draw_charts.lines({"a": ((0, 1), (0.2, 0.2)), "b": ((0, 1), (0.8, 0.8))}, {0: "0", 1: "1"},
                                         {0: "0", 1: "1"}, "x"))
    (_, a), (_, b) = (spots(picture[:, 50:400], colour)[0] for colour in draw_charts.USUAL[:2])
    assert a > b


def test_names_of_gaps_stand_beside_their_fields_and_ticks_beside_their_values(written):
    draw_charts.heat_maps({800: {(0.2, 10): 12.0, (1.0, 90): -3.5}}, (0.2, 1.0), (10, 90))
    at = {words: (x, y) for x, y, words in written}
    for m, deg, value in (("0.2 m", "10 deg", "+12"), ("1 m", "90 deg", "-3.5")):
        assert (at[m][0], at[deg][1]) == at[value]
    written.clear()
    draw_charts.curves({800: {"Ours": np.full((2, 3), 0.5)}})
    at = {words: (x, y) for x, y, words in written}
    assert at["1"][0] < at["2"][0] < at["3"][0]
    assert at["50 %"][1] == pytest.approx(at["Ours"][1])
    assert "home 800: share right after five looks" in at


def test_a_small_loss_is_orange_too():
    assert draw_charts.shade(-3)[0] > draw_charts.shade(-3)[2]
