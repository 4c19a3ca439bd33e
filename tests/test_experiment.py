"""A cell: all methods from the same starts with the same luck, and what it depends on."""

import itertools
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from data_gen.rooms import make_home
from data_gen.starts import starts_of
from gnl import episode, experiment, planners
from gnl.experiment import GAPS_DEG, GAPS_M, N_CHECKPOINTS, Cell, made_from, run_cell
from gnl.gcn import GCN
from gnl.learned import digest, fingerprint
from gnl.options import Options
from gnl.outcomes import from_strings, outcome_of, right
from gnl.places import PlaceGrid
from gnl.ranks import reciprocal_ranks
from gnl.robot import Robot
from gnl.senses import Senses

CELL = Cell(800, 0.2, 10, 3)
N_TRAINING, N_TESTS, N_VALIDATION = 20, 12, 4


@pytest.fixture(scope="module")
def parts():
    """Senses of true labels and a GCN that has learned nothing, and starts."""
    home = make_home(CELL.world)
    senses = Senses(home, None, GCN(PlaceGrid(home).n_places, np.random.default_rng(0), hidden=8))
    return senses, starts_of(CELL, home, N_TRAINING, N_TESTS, N_VALIDATION)


def live(cell, parts):
    """Result and costs of a cell whose robots learn two by two; of each part what it was given and what it found."""
    given, found = ({"train_nnql": [], "race": [], "run_all": []} for _ in range(2))  # (starts, seed) of each call

    def watched(function):
        def call(senses, robot, grid, *args, **options):
            given[function.__name__].append(args[-2:])
            found[function.__name__].append(function(senses, robot, grid, *args, **options))
            patch.setattr(episode, "SIDE_BY_SIDE", 64)  # training comes first
            return found[function.__name__][-1]
        return call

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(episode, "SIDE_BY_SIDE", 2)  # so that its checkpoints differ
        found["Options"] = []
        patch.setattr(experiment, "Options", lambda *args: found["Options"].append(args) or Options(*args))
        for name in given:
            patch.setattr(episode, name, watched(getattr(episode, name)))
        return *run_cell(cell, replace(parts[0], seconds={}, views=0), parts[1], {"tests": N_TESTS}), given, found


@pytest.fixture(scope="module")
def lived(parts):
    return live(CELL, parts)


def test_a_cell_is_a_function_of_its_arguments(parts, lived):
    assert live(CELL, parts)[0] == lived[0]


def test_a_classifier_may_be_anything_with_scores(parts, lived):
    gcn = parts[0].gcn
    of_another = live(CELL, (replace(parts[0], gcn=SimpleNamespace(scores=gcn.scores)), parts[1]))[0]
    assert {**of_another, "made from": 0} == {**lived[0], "made from": 0}


def test_a_cell_knows_a_classifier_without_parameters_by_its_kind(parts):
    senses = parts[0]
    kinds = [type(name, (), {"params": params})() for name, params in (("Bag", {}), ("Nearest", None), ("Nearest", {}))]
    assert [made_from(replace(senses, gcn=kind))["gcn"] for kind in kinds] == ["Bag", "Nearest", "Nearest"]
    assert made_from(senses)["gcn"] == fingerprint(senses.gcn.params)


def test_another_seed_is_another_cell(parts, lived):
    assert live(Cell(800, 0.2, 10, 4), parts)[0]["tests"] != lived[0]["tests"]


def test_equal_actions_have_equal_outcomes_so_pairs_are_pairs(parts, lived):
    """Scan and MV of the cell, run again: Scan as a planner of another name, under the seed that all tests had."""
    senses, starts = parts
    result, _, given, _ = lived
    sequence, testing = result["sequence"], given["run_all"][0][1]

    def same_in_other_words(step, states, rng):
        rng.random(7)
        return np.full(len(states), sequence[step])

    grid = PlaceGrid(senses.world)
    for name, plan in (("Scan", same_in_other_words), ("MV", planners.chance)):
        record = episode.run_all(senses, Robot(senses.world), grid, plan, starts["tests"], testing)
        assert outcome_of(grid, record) == result["tests"][name]


def test_what_is_learned_never_comes_from_a_test_nor_a_choice_from_a_test_or_its_luck(parts, lived):
    starts, (result, _, given, _) = parts[1], lived
    np.testing.assert_array_equal(given["train_nnql"][0][0], starts["training"])
    np.testing.assert_array_equal(given["race"][0][0], starts["training"])
    tests, validation = ([call for call in given["run_all"] if np.array_equal(call[0], starts[name])]
                         for name in ("tests", "validation"))
    known = given["run_all"][len(tests):-len(validation)]
    assert (len(tests), len(known), len(validation)) == (len(result["tests"]) + N_CHECKPOINTS, 3, N_CHECKPOINTS)
    luck = [{seed.spawn_key for _, seed in calls}
            for calls in (given["train_nnql"], given["race"], tests, known, validation)]
    assert [len(of) for of in luck] == [1, 1, 1, 1, 1]  # all tests have the same luck
    assert len(set.union(*luck)) == 5


def test_what_was_learned_by_heart_is_asked_from_starts_of_training_with_luck_of_its_own(parts, lived):
    """Ours is then the checkpoint of all that was learned."""
    (senses, starts), (result, _, given, found) = parts, lived
    grid, (store,) = PlaceGrid(senses.world), found["train_nnql"]
    (known, seed), = {(poses.tobytes(), seed.spawn_key): (poses, seed) for poses, seed in given["run_all"]
                      if not any(np.array_equal(poses, starts[name]) for name in ("tests", "validation"))}.values()
    assert len(known) == N_TESTS
    assert {pose.tobytes() for pose in known} <= {pose.tobytes() for pose in starts["training"]}
    assert len({pose.tobytes() for pose in known}) == N_TESTS
    plans = {"MV": planners.chance, "Scan": planners.scan(result["sequence"]), "Ours": planners.greedy(store)}
    again = {name: outcome_of(grid, episode.run_all(senses, Robot(senses.world), grid, plan, known, seed))
             for name, plan in plans.items()}
    assert result["from training starts"] == again


def test_what_was_learned_by_heart_is_asked_from_the_first_start_to_the_last_evenly_spread(parts, lived):
    training, (known, _) = parts[1]["training"], lived[2]["run_all"][-N_CHECKPOINTS - 1]
    which = (known[:, None] == training).all(2).argmax(1)
    assert (which[0], which[-1]) == (0, N_TRAINING - 1)
    assert np.ptp(np.diff(which)) <= 1


def test_scan_is_the_winner_of_the_race_and_ours_plus_goes_on_with_one_action(lived):
    ((sequences, _),), (_, scan, ours_plus, *_) = (lived[3][name] for name in ("race", "run_all"))
    assert lived[0]["sequence"] == sequences[0].tolist()
    assert (scan.actions == sequences[0]).all()
    assert (ours_plus.actions == ours_plus.actions[:, :1]).all()


def test_ours_plus_is_made_of_all_that_was_lived_through_and_of_the_worth_in_the_race(parts, lived):
    (senses, starts), found = parts, lived[3]
    ((experience, sequences, worth),), ((raced, won),) = found["Options"], found["race"]
    np.testing.assert_array_equal(sequences, raced)
    np.testing.assert_array_equal(worth, won)
    steps, *_ = experience.arrays()
    assert np.bincount(steps).tolist() == [0] + [N_TRAINING] * episode.LENGTH
    first = reciprocal_ranks(senses.scores(starts["tests"], np.random.default_rng(0)))  # true labels have no noise
    q, chosen = Options(experience, sequences, worth).q_values(first), found["run_all"][2].actions[:, 0]
    np.testing.assert_array_equal(q[np.arange(len(q)), chosen], q.max(1))


def test_all_methods_share_the_first_look(lived):
    result = lived[0]
    assert len({o["place"][0] for o in (*result["tests"].values(), *result["checkpoints"])}) == 1
    assert right(result)["SV"].tolist() == from_strings(result["tests"]["Scan"]["place"])[:, 0].tolist()


def test_ten_checkpoints_are_tested_from_the_first_to_that_of_all_that_was_learned(parts, lived):
    (senses, starts), (result, costs, given, found) = parts, lived
    (store,) = found["train_nnql"]
    assert len(result["checkpoints"]) == len(result["validation"]) == len(store.checkpoints) == N_CHECKPOINTS
    for last, now in zip(store.at(N_CHECKPOINTS - 1).values, store.values, strict=True):
        np.testing.assert_array_equal(last, now)
    assert costs["pairs"] == sum(map(len, store.values)) > 0
    grid = PlaceGrid(senses.world)
    for kind, name, seed in (("tests", "checkpoints", given["run_all"][0][1]),
                             ("validation", "validation", given["run_all"][-1][1])):
        again = [outcome_of(grid, episode.run_all(senses, Robot(senses.world), grid,
                                                           planners.greedy(store.at(i)), starts[kind], seed))
                 for i in (0, N_CHECKPOINTS - 1)]
        assert [result[name][0], result[name][-1]] == again
    assert result["checkpoints"][0] != result["checkpoints"][-1]


def test_outcomes_and_costs_can_be_written_and_read(lived):
    result, costs, given, _ = lived
    assert json.loads(json.dumps(result)) == result
    assert json.loads(json.dumps(costs)) == costs
    assert 0 < sum(costs["of stages"].values()) < costs["seconds"] < 100
    assert 0 < costs["of processor"] < 100
    assert costs["of training"]["views"] == 5 * sum(len(poses) for poses, _ in given["train_nnql"])
    assert 0 < costs["of training"]["seconds"] < costs["seconds"]
    assert 10 < costs["peak MB"] < 10_000


def test_outcomes_say_what_they_were_made_from(parts, lived):
    result, senses = lived[0], parts[0]
    assert result["settings"] == {"tests": N_TESTS}
    home, gcn = digest(senses.world.plan), fingerprint(senses.gcn.params)
    assert result["made from"] == {"home": home, "gcn": gcn, "net": None}


def test_each_cell_has_numbers_and_a_name_of_its_own():
    cells = [Cell(*of) for of in itertools.product((800, 801), GAPS_M, GAPS_DEG, (0, 1))]
    assert len({cell.name for cell in cells}) == len({tuple(cell.entropy) for cell in cells}) == len(cells)
    assert Cell(800, 0.2, 10, 0).name == "800-0.2m-10deg-seed0"
