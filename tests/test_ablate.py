"""Other choices: each can be put in the place of ours and is taken back; what is measured is what the page says."""

import contextlib
import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from data_gen.rooms import make_home
from data_gen.starts import starts_of
from gnl import ablate, camera, choices, episode, gcn, particles, planners, scene_graph, strip
from gnl.__main__ import main
from gnl.choices import CHOICES, OURS, TRUE_LABELS, BruteForce, Choice
from gnl.compare import paired_difference
from gnl.episode import Senses
from gnl.experiment import to_bytes
from gnl.gcn import GCN
from gnl.kdtree import KDTree
from gnl.nn import softmax
from gnl.places import PlaceGrid
from gnl.ranks import reciprocal_ranks
from gnl.scene_graph import regions
from gnl.table import Settings, path_of

PAGE = Path(__file__).parents[1] / "tutorials" / "open_points.md"
CELL = ablate.CELLS[0]
SCORES, POOLED = np.array([[0.0, 3, 1], [2, 0, 0]]), np.array([[0.7, 0.1, 0.2], [0, 0, 1.0]])


@pytest.fixture(scope="module")
def parts():
    home = make_home(CELL.world)
    return (Senses(home, None, GCN(PlaceGrid(home).n_places, np.random.default_rng(0), hidden=8)),
            starts_of(CELL, home, 12, 8, 1))


def constants():
    """What the modules that choices reach into hold now."""
    modules = camera, episode, gcn, particles, planners, scene_graph, strip
    return {(module.__name__, name): str(value) for module in modules for name, value in vars(module).items()
            if not name.startswith("__")}


@pytest.mark.parametrize("choice", [OURS, *CHOICES], ids=lambda choice: f"{choice.point}: {choice.other}")
def test_every_choice_runs_and_leaves_no_trace(choice, parts, monkeypatch):
    monkeypatch.setattr(ablate, "SETTINGS", Settings(gcn_views=24, gcn_epochs=1))
    here = constants()
    result, costs = ablate.measure(choice, CELL, *parts)
    assert [len(look) for look in result["tests"]["Ours"]["place"]] == [8] * 5
    assert costs["views"] > 0
    assert here == constants()


def test_a_constant_is_another_one_for_a_time_and_then_ours_again_even_after_a_fault():
    ours = camera.HEIGHT_M
    with pytest.raises(KeyError), ablate.in_place({"camera.HEIGHT_M": 0.7}):
        assert camera.HEIGHT_M == 0.7
        raise KeyError
    assert ours == camera.HEIGHT_M


def test_a_name_that_is_no_constant_is_not_made_one():
    with pytest.raises(AttributeError), ablate.in_place({"camera.HIGHT_M": 0.7}):
        pass


def test_choices_have_names_of_their_own_and_stand_on_the_page():
    names = [ablate.name_of(choice, cell) for choice in (OURS, *CHOICES) for cell in ablate.CELLS]
    assert len(set(names)) == len(names)
    rows = [line for line in PAGE.read_text().splitlines() if line.startswith("| ")]
    points = {row.split(" | ")[0].removeprefix("| ") for row in rows}
    assert {choice.point for choice in CHOICES} - points == set()


def test_states_are_what_their_names_say():
    first = reciprocal_ranks(SCORES)
    np.testing.assert_allclose(choices.probabilities(SCORES, POOLED, None), softmax(SCORES), rtol=1e-6)
    assert choices.best_place(SCORES, POOLED, None).tolist() == [[0, 1, 0], [1, 0, 0]]
    np.testing.assert_array_equal(choices.filter_ranks(SCORES, POOLED, None), reciprocal_ranks(POOLED))
    assert choices.with_last_action(SCORES, POOLED, None)[:, 3:].tolist() == [[1, 0, 0, 0]] * 2
    after = choices.with_last_action(SCORES, POOLED, np.array([0, 2]))
    np.testing.assert_array_equal(after[:, :3], first)
    assert after[:, 3:].tolist() == [[0, 1, 0, 0], [0, 0, 0, 1]]


def test_corners_join_regions_that_sides_do_not():
    labels = np.kron(np.array([[[3, 0, 0], [0, 3, 4]]]), np.ones((1, 8, 8), int))
    view, label, area, boxes = choices.touching_at_corners(labels)
    assert sorted(zip(label.tolist(), area.tolist(), boxes.tolist(), strict=True)) == [
        (0, 192, [0, 0, 24, 16]), (3, 128, [0, 0, 16, 16]), (4, 64, [16, 8, 24, 16])]
    assert view.tolist() == [0, 0, 0]
    several = choices.touching_at_corners(np.concatenate([labels, labels[:, ::-1]]))
    assert several[0].tolist() == [0, 0, 0, 1, 1, 1]
    np.testing.assert_array_equal(several[2][:3], area)
    assert len(regions(labels)[0]) == 5  # two beds, and the wall is in two parts


def test_the_sparse_reward_comes_at_the_end():
    right = np.array([True, False, True, False])
    assert choices.at_the_end(right, None, np.array([False, False, True, True])).tolist() == [0, 0, 1, -1]


def test_a_likelihood_by_rank_is_the_reciprocal_rank_and_a_floor_below_it():
    np.testing.assert_allclose(choices.by_rank(SCORES), reciprocal_ranks(SCORES) + 1e-3, rtol=1e-6)
    assert choices.by_rank(SCORES)[0].argmax() == 1


def test_of_equal_actions_the_first_is_taken_and_of_others_the_best():
    assert choices.first_of_equals(np.array([[1.0, 2, 2], [3, 3, 3], [0, -1, 5]]), None).tolist() == [1, 0, 2]


def test_brute_force_finds_the_oldest_that_is_the_same_and_nothing_that_is_only_near():
    brute = BruteForce(3)
    brute.add(np.float32([[0, 0, 1], [1, 0, 0], [1, 0, 0]]))
    assert brute.find(np.float32([[1, 0, 0], [0, 0, 1], [0, 1, 0], [0, 0.01, 1]])).tolist() == [1, 0, -1, -1]


def test_brute_force_answers_like_the_tree():
    rng, brute, tree = np.random.default_rng(0), BruteForce(5), KDTree(5)
    points = rng.random((40, 5), np.float32)
    points[7] = points[3]
    for part in np.array_split(points, 3):
        np.testing.assert_array_equal(brute.add(part), tree.add(part))
    queries = np.concatenate([rng.random((6, 5), np.float32), points[:4]])
    for k, n_first in ((1, 40), (4, 40), (4, 10), (4, 2), (4, None)):
        mine, trees = brute.query(queries, k, n_first), tree.query(queries, k, n_first)
        np.testing.assert_allclose(mine[0], trees[0], atol=1e-3)
        np.testing.assert_array_equal(mine[1], trees[1])


HIGHER, NO_EDGES = Choice("camera height", "2 m", true_labels=True), Choice("edges", "none")


def write_outcomes(out, choices):
    """Made-up outcomes of choices in two cells."""
    rng = np.random.default_rng(0)
    for choice, cell in itertools.product(choices, ablate.CELLS):
        tests = {name: {"place": ["".join(rng.choice(["0", "1"], 50)) for _ in range(5)]} for name in ("MV", "Ours")}
        path = path_of(out, ablate.name_of(choice, cell))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(to_bytes({"name": ablate.name_of(choice, cell), "tests": tests}))


@pytest.mark.parametrize(("choice", "beside"), [(NO_EDGES, OURS), (TRUE_LABELS, OURS), (HIGHER, TRUE_LABELS)])
def test_an_effect_is_the_difference_in_pairs_from_our_choice_and_with_true_labels_from_ours_with_them(
        tmp_path, monkeypatch, choice, beside):
    monkeypatch.setattr(ablate, "CELLS", ablate.CELLS[:2])
    write_outcomes(tmp_path, [OURS, TRUE_LABELS, NO_EDGES, HIGHER])
    ours, row = ablate.effects(tmp_path, [OURS, choice])
    assert row[:3] == [choice.point, choice.other, beside.other]
    for column, method in ((3, "MV"), (4, "Ours")):
        def right(choice, method=method):
            files = [path_of(tmp_path, ablate.name_of(choice, cell)).read_bytes() for cell in ablate.CELLS]
            return np.array([one == "1" for file in files for one in json.loads(file)["tests"][method]["place"][-1]])

        d, low, high = (100 * value for value in paired_difference(right(choice), right(beside)))
        assert row[column] == f"{d:+.1f} [{low:+.1f}, {high:+.1f}]"
        assert ours[column] == f"{100 * right(OURS).mean():.1f}"


def test_a_run_measures_ours_and_the_points_that_are_asked_for_in_every_cell_once(tmp_path, monkeypatch, capsys):
    asked, page = [], tmp_path / "page.md"
    page.write_text("| open | effect |\n| edges | ? |\n| neighbours | ? |\n")

    def run_jobs(out, jobs, *_):
        asked.extend((choice, cell) for _, choice, cell, *_ in jobs.values())
        assert list(jobs) == [ablate.name_of(choice, cell) for choice, cell in asked]
        write_outcomes(out, [choice for choice, _ in asked[::len(ablate.CELLS)]])

    for name, value in (("prepare", lambda *_: dict.fromkeys((800, 801, 809))), ("load_arrays", lambda _: [None]),
                        ("executor", contextlib.nullcontext), ("run_jobs", run_jobs)):
        monkeypatch.setattr(ablate, name, value)
    for _ in range(2):  # the second one has nothing to do
        with pytest.raises(SystemExit) as exit:
            main(["ablate", "--out", str(tmp_path / "out"), "--points", "neighbours", "labels of the views",
                  "--page", str(page)])
        assert exit.value.code == 0
        neighbours = [choice for choice in CHOICES if choice.point == "neighbours"]
        assert asked == list(itertools.product([OURS, TRUE_LABELS, *neighbours], ablate.CELLS))
    assert capsys.readouterr().out.count("| neighbours | k = 16 | ours |") == 2
    lines = page.read_text().splitlines()
    assert lines[1] == "| edges | ? |"
    assert [part.split(":")[0] for part in lines[2].split(" | ")[1].split("; ")] == ["k = 1", "k = 16", "k = 64"]


def test_effects_go_into_the_rows_of_their_points_and_nowhere_else():
    page = "| open | effect |\n| --- | --- |\n| edges | ? |\n| edges of all | ? |\n\nedges | ?\n"
    measured = [["edges", "none", "ours", "+1.0 [+0.0, +2.0]", "-1.0 [-2.0, +0.0]"], ["other", "b", "ours", "", ""]]
    assert ablate.filled(page, measured) == page.replace(
        "| edges | ? |", "| edges | none: MV +1.0 [+0.0, +2.0], Ours -1.0 [-2.0, +0.0] |")


@pytest.mark.parametrize(("options", "words"), [(["--jobs", "0"], "--jobs: expected at least 1, found 0"),
                                                (["--points", "luck"], "found 'luck'")])
def test_an_option_that_cannot_be_is_one_line(tmp_path, capsys, options, words):
    with pytest.raises(SystemExit) as exit:
        main(["ablate", "--out", str(tmp_path / "out"), *options])
    err = capsys.readouterr().err
    assert exit.value.code == 2
    assert words in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()
