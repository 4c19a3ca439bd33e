"""Other choices: each can be put in the place of ours and is taken back; what is measured is what the page says."""

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
from gnl.experiment import arrays, to_bytes
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
    names = [ablate.name_of(choice, CELL) for choice in (OURS, *CHOICES)]
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
    assert len(regions(labels)[0]) == 5  # two beds, and the wall is in two parts


def test_the_sparse_reward_comes_at_the_end():
    right = np.array([True, False, True, False])
    assert choices.at_the_end(right, None, np.array([False, False, True, True])).tolist() == [0, 0, 1, -1]


def test_brute_force_answers_like_the_tree():
    rng, brute, tree = np.random.default_rng(0), BruteForce(5), KDTree(5)
    points = rng.random((40, 5), np.float32)
    points[7] = points[3]
    for part in np.array_split(points, 3):
        np.testing.assert_array_equal(brute.add(part), tree.add(part))
    queries = np.concatenate([rng.random((6, 5), np.float32), points[:4]])
    for k, n_first in ((1, 40), (4, 40), (4, 10), (4, 2)):
        mine, trees = brute.query(queries, k, n_first), tree.query(queries, k, n_first)
        np.testing.assert_allclose(mine[0], trees[0], atol=1e-3)
        np.testing.assert_array_equal(mine[1], trees[1])


def made_up(out, monkeypatch):
    """Outcomes of ours, of true labels and of one more choice in two cells."""
    rng, more = np.random.default_rng(0), Choice("edges", "none")
    monkeypatch.setattr(ablate, "CELLS", ablate.CELLS[:2])
    for choice, share in ((OURS, 0.5), (TRUE_LABELS, 0.6), (more, 0.4)):
        for cell in ablate.CELLS:
            tests = {name: {"place": ["".join("01"[int(x)] for x in rng.random(50) < share)] * 5}
                     for name in ("MV", "Ours")}
            path = path_of(out, ablate.name_of(choice, cell))
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(to_bytes({"name": ablate.name_of(choice, cell), "tests": tests}))
    return more


def test_an_effect_is_the_difference_in_pairs_from_our_choice(tmp_path, monkeypatch):
    more = made_up(tmp_path, monkeypatch)
    rows = ablate.effects(tmp_path, [OURS, TRUE_LABELS, more])

    def right(choice):
        return np.concatenate([arrays(json.loads(path_of(tmp_path, ablate.name_of(choice, cell)).read_bytes())
                                      ["tests"]["Ours"]["place"])[:, -1] for cell in ablate.CELLS])

    d, low, high = (100 * value for value in paired_difference(right(more), right(OURS)))
    assert rows[2][:3] == ["edges", "none", "ours"]
    assert rows[2][4] == f"{d:+.1f} [{low:+.1f}, {high:+.1f}]"
    assert rows[0][4] == f"{100 * right(OURS).mean():.1f}"


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
