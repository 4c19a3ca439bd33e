"""Outcomes as text, the checkpoint that is taken, and shares of right answers by cell."""

from types import SimpleNamespace

import numpy as np
import pytest

from gnl.outcomes import (
    adapted,
    by_gap,
    by_world,
    curve,
    from_strings,
    from_training,
    gains,
    groups,
    latest_best,
    outcome_of,
    right,
    to_strings,
)
from gnl.places import PlaceGrid


def test_a_right_place_with_a_wrong_bearing_is_a_right_location():
    grid = PlaceGrid(SimpleNamespace(bounds=(0, 0, 8, 6)))
    answers, places = np.array([[5, 5], [5, 17], [5, 6]]), np.array([[5, 6], [17, 17], [5, 18]])
    record = SimpleNamespace(answers=answers, places=places, correct=answers == places)
    assert outcome_of(grid, record) == {"place": ["101", "010"], "location": ["101", "110"]}


def test_who_looks_no_further_keeps_to_his_last_answer():
    grid = PlaceGrid(SimpleNamespace(bounds=(0, 0, 8, 6)))
    answers, places = np.array([[5, 5], [5, 17]]), np.array([[5, 6], [17, 17]])
    record = SimpleNamespace(answers=answers, places=places, correct=answers == places)
    assert outcome_of(grid, record, 4) == {"place": ["10", "01", "01", "01"], "location": ["10", "11", "11", "11"]}
    assert outcome_of(grid, record, 1) == outcome_of(grid, record)


def test_strings_and_arrays_are_each_others_inverse():
    rng = np.random.default_rng(0)
    there = rng.random((7, 5)) < 0.5
    assert to_strings(there)[2] == "".join("1" if one else "0" for one in there[:, 2])
    np.testing.assert_array_equal(from_strings(to_strings(there)), there)


@pytest.mark.parametrize("looks", [["01", "0"], ["0x"], ["01", "1 "], [""]], ids=str)
def test_looks_that_are_no_strings_of_right_and_wrong_are_refused(looks):
    with pytest.raises(ValueError, match="looks that are no strings of 0 and 1, all equally long"):
        from_strings(looks)


@pytest.mark.parametrize(("values", "best"), [([1, 3, 2], 1), ([3, 1, 3], 2), ([2, 2, 2], 2), ([5], 0)])
def test_of_equal_checkpoints_the_latest_is_taken(values, best):
    assert latest_best(values) == best
    assert latest_best(np.array(values)) == best


def made_up(checkpoints, validation):
    """A result of 4 tests and 2 looks: answers after the last look of each checkpoint, on tests and validation."""
    def of(first, last):
        return {"place": [first, last], "location": [last, first]}

    return {"cell": {"world": 800}, "tests": {"MV": of("0110", "0011"), "Scan": of("0110", "1111")},
            "checkpoints": [of("0110", last) for last in checkpoints],
            "validation": [of("1110" if i == 0 else "0000", last) for i, last in enumerate(validation)]}


def test_adaptation_looks_at_validation_alone_and_the_oracle_at_the_tests():
    result = made_up(["0000", "1111", "0111", "0001"], ["0001", "0111", "0111", "0011"])
    assert adapted(result) == 2
    found = {name: values.mean() for name, values in right(result).items()}
    assert found == {"SV": 0.5, "MV": 0.5, "Scan": 1.0, "Ours": 0.25, "DA": 0.75, "Oracle": 1.0}
    assert right(result, checkpoint=0)["Ours"].mean() == 0.0


def test_locations_are_those_of_the_checkpoints_that_the_places_chose():
    result = made_up(["0000", "1111", "0111", "0001"], ["0001", "0111", "0111", "0011"])
    for i, outcome in enumerate(result["checkpoints"]):
        outcome["location"] = ["0000", "0001"[i:] + "1" * i]
    result["tests"]["Scan"]["location"] = ["0000", "1000"]
    found = {name: "".join("01"[int(x)] for x in values) for name, values in right(result, "location").items()}
    assert found == {"SV": "0011", "MV": "0110", "Scan": "1000", "Ours": "1111", "DA": "0111", "Oracle": "0011"}


def test_a_curve_has_a_row_a_cell_and_a_column_a_checkpoint():
    of_cells = curve([made_up(["1111", "0000", "0001"], ["0001"] * 3), made_up(["0000", "0011", "1111"], ["0001"] * 3)])
    assert of_cells["Ours"].tolist() == [[1.0, 0.0, 0.25], [0.0, 0.5, 1.0]]
    assert of_cells["MV"].tolist() == [[0.5] * 3] * 2
    assert of_cells["Scan"].tolist() == [[1.0] * 3] * 2


def in_cell(world, t_xy_m, ours):
    """A result of a cell; MV gets half of its tests right."""
    return {**made_up([ours], ["0001"]), "cell": {"world": world, "t_xy_m": t_xy_m, "t_theta_deg": 10}}


def test_gains_are_those_of_pairs_in_each_cell_from_wherever_they_start():
    result = made_up(["1110"], ["0001"])
    result["from training starts"] = {"Ours": {"place": ["1111", "0001"]}, "MV": {"place": ["0000", "1111"]}}
    assert gains([result, made_up(["0000"], ["1111"])], "Ours", "MV") == [0.25, -0.5]
    assert {name: one.tolist() for name, one in from_training(result).items()} == {
        "Ours": [False, False, False, True], "MV": [True] * 4}
    assert gains([result], "Ours", "MV", from_training) == [-0.75]


def test_cells_are_told_apart_by_world_and_by_gap():
    results = [in_cell(800, 0.2, "1111"), in_cell(801, 0.2, "0111"), in_cell(800, 1.0, "0000"),
               in_cell(800, 0.2, "0001")]
    assert {world: len(of_world) for world, of_world in by_world(results).items()} == {800: 3, 801: 1}
    assert by_gap(results, "Ours", "MV") == {800: {(0.2, 10): 12.5, (1.0, 10): -50}, 801: {(0.2, 10): 25}}
    named = {words: [results.index(one) for one in some] for words, some in groups(results, ("t_xy_m", "{} m"))}
    assert named == {"all": [0, 1, 2, 3], "0.2 m": [0, 1, 3], "1.0 m": [2]}
