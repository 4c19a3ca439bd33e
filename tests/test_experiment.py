"""A cell: all methods from the same starts with the same luck, the checkpoint that is taken, outcomes as text."""

import itertools
import json

import numpy as np
import pytest

from data_gen.rooms import make_home
from data_gen.starts import starts_of
from gnl import episode, experiment, planners
from gnl.episode import Senses
from gnl.experiment import N_CHECKPOINTS, Cell, adapted, arrays, curve, latest_best, right, run_cell, strings, to_bytes
from gnl.gcn import GCN
from gnl.places import PlaceGrid
from gnl.robot import Robot

CELL = Cell(800, 0.2, 10, 3)
N_TESTS = 40


@pytest.fixture(scope="module")
def parts():
    """Senses of true labels and a GCN that has learned nothing, and starts."""
    home = make_home(CELL.world)
    senses = Senses(home, None, GCN(PlaceGrid(home).n_places, np.random.default_rng(0), hidden=8))
    return senses, starts_of(CELL, home, 20, N_TESTS, 4)


@pytest.fixture(scope="module")
def outcome(parts):
    return run_cell(CELL, *parts)


def test_a_cell_is_a_function_of_its_arguments(parts, outcome):
    again, _ = run_cell(CELL, *parts)
    assert to_bytes(again) == to_bytes(outcome[0])


def test_another_seed_is_another_cell(parts, outcome):
    other, _ = run_cell(Cell(800, 0.2, 10, 4), *parts)
    assert other["tests"] != outcome[0]["tests"]


def test_equal_actions_have_equal_outcomes_so_pairs_are_pairs(parts, outcome):
    """Scan of the cell, run again as a planner of another name under the cell's seed for tests."""
    senses, starts = parts
    result, _ = outcome
    _, _, testing, _ = np.random.SeedSequence(CELL.entropy).spawn(4)
    sequence = result["sequence"]

    def same_in_other_words(step, states, rng):
        rng.random(7)
        return np.full(len(states), sequence[step])

    grid = PlaceGrid(senses.world)
    record = episode.run_all(senses, Robot(senses.world), grid, same_in_other_words, starts["tests"], testing)
    assert experiment.outcomes(grid, record) == result["tests"]["Scan"]
    chance = episode.run_all(senses, Robot(senses.world), grid, planners.chance, starts["tests"], testing)
    assert experiment.outcomes(grid, chance) == result["tests"]["MV"]
    moved_alike = (chance.actions == sequence).all(1)
    assert (chance.answers[moved_alike] == record.answers[moved_alike]).all()


def test_all_methods_share_the_first_look(outcome):
    result, _ = outcome
    assert len({o["place"][0] for o in (*result["tests"].values(), *result["checkpoints"])}) == 1
    assert right(result)["SV"].tolist() == arrays(result["tests"]["Scan"]["place"])[:, 0].tolist()


def test_outcomes_can_be_written_and_read(outcome):
    result, costs = outcome
    assert json.loads(to_bytes(result)) == result
    assert json.loads(to_bytes(costs)) == costs
    assert costs["views"] > 0
    assert costs["peak MB"] > 10


def test_strings_and_arrays_are_each_others_inverse():
    rng = np.random.default_rng(0)
    there = rng.random((7, 5)) < 0.5
    assert strings(there)[2] == "".join("1" if one else "0" for one in there[:, 2])
    np.testing.assert_array_equal(arrays(strings(there)), there)


@pytest.mark.parametrize(("values", "best"), [([1, 3, 2], 1), ([3, 1, 3], 2), ([2, 2, 2], 2), ([5], 0)])
def test_of_equal_checkpoints_the_latest_is_taken(values, best):
    assert latest_best(values) == best
    assert latest_best(np.array(values)) == best


def made_up(checkpoints, validation):
    """A result of 4 tests and 2 looks: answers after the last look of each checkpoint, on tests and validation."""
    def of(last):
        return {"place": ["0110", last], "location": ["1111", "1111"]}

    return {"cell": {"world": 800}, "tests": {"MV": of("0011"), "Scan": of("1111")},
            "checkpoints": [of(last) for last in checkpoints], "validation": [of(last) for last in validation]}


def test_adaptation_looks_at_validation_alone_and_the_oracle_at_the_tests():
    result = made_up(["1111", "0000", "0001"], ["0001", "0111", "0111"])
    assert adapted(result) == 2
    found = {name: values.mean() for name, values in right(result).items()}
    assert found == {"SV": 0.5, "MV": 0.5, "Scan": 1.0, "Ours": 0.25, "DA": 0.25, "Oracle": 1.0}
    assert right(result, checkpoint=1)["Ours"].mean() == 0.0
    assert right(result, "location")["MV"].mean() == 1.0


def test_a_curve_has_a_row_a_cell_and_a_column_a_checkpoint():
    of_cells = curve([made_up(["1111", "0000", "0001"], ["0001"] * 3), made_up(["0000", "0011", "1111"], ["0001"] * 3)])
    assert of_cells["Ours"].tolist() == [[1.0, 0.0, 0.25], [0.0, 0.5, 1.0]]
    assert of_cells["MV"].tolist() == [[0.5] * 3] * 2


def test_a_cell_keeps_ten_checkpoints_the_last_of_all_it_learned(outcome):
    result, costs = outcome
    assert len(result["checkpoints"]) == N_CHECKPOINTS
    assert 0 < costs["pairs"] <= 20 * episode.LENGTH


def test_each_cell_has_numbers_and_a_name_of_its_own():
    cells = [Cell(*of) for of in itertools.product((800, 801), (0.2, 1.0), (10, 90), (0, 1))]
    assert len({cell.name for cell in cells}) == len({tuple(cell.entropy) for cell in cells}) == len(cells)
    assert Cell(800, 0.2, 10, 0).name == "800-0.2m-10deg-seed0"
