"""The programs of the results page: at their smallest they print what the page shows, and plans do as they are told."""

import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import room

from gnl import learned
from gnl.scene_graph import scene_graph
from gnl.senses import Senses
from gnl.table import Settings
from gnl.world import World

RESULTS = Path(__file__).parents[1] / "tutorials" / "results"
PROGRAMS = sorted(path.stem for path in (RESULTS / "why").glob("*.py") if path.stem != "cells_again")
TINY = """
import sys
sys.path.insert(0, sys.argv[1])
if __name__ == "__main__":
    from importlib import import_module
    from gnl.experiment import Cell
    from gnl.table import Settings
    settings = Settings(episodes=10, tests=4, validation=2, net_homes=1, net_views=120, net_epochs=4, gcn_views=1200,
                        gcn_epochs=12, gcn_rate=0.01)
    import_module(sys.argv[2]).main([Cell(800, 1.0, 90, 0)], settings=settings, out="table")
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("why")


@pytest.fixture
def program(monkeypatch):
    """A program as a module."""
    monkeypatch.syspath_prepend(str(RESULTS / "why"))
    return __import__


def shape(line):
    """A printed line with # in the place of each number, and no more space than between words."""
    return re.sub(r"[+-]?\d+(\.\d+)?", "#", " ".join(line.split()).replace("[ ", "["))


def shown():
    """What the page shows as printed by each program: the first fence without a language after its command."""
    page = (RESULTS / "README.md").read_text()
    return {name: re.search(rf"why/{name}\.py\n```\n.*?\n```\n(.*?)```\n", page, re.DOTALL)[1] for name in PROGRAMS}


def test_the_page_shows_every_program():
    assert len(PROGRAMS) == len(shown()) == 5


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_prints_what_the_page_shows(folder, name):
    (folder / "tiny.py").write_text(TINY)
    done = subprocess.run([sys.executable, "-W", "error", "tiny.py", RESULTS / "why", name], cwd=folder,
                          capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
    printed = [line for line in done.stdout.splitlines() if not re.match("(homes|starts|net|gcn|cells) ", line)]
    lines = [shape(line) for line in shown()[name].splitlines()]
    assert list(dict.fromkeys(map(shape, printed))) == list(dict.fromkeys(lines))


def test_again_undoes_nothing_and_goes_on_with_what_is_no_turn_back(program):
    one_habit, rng = program("one_habit"), np.random.default_rng(0)
    actions = rng.integers(3, size=(200, 6))
    plan = one_habit.again(lambda step, _states, _rng: actions[:, step])
    done = np.stack([plan(step, None, rng) for step in range(6)], 1)
    assert program("cells_again").undone(done) == 0
    assert program("cells_again").undone(actions) > 0.1
    np.testing.assert_array_equal(done[:, 0], actions[:, 0])
    kept = (done[:, :-1] + actions[:, 1:]) != 1
    np.testing.assert_array_equal(done[:, 1:][kept], actions[:, 1:][kept])
    np.testing.assert_array_equal(done[:, 1:][~kept], done[:, :-1][~kept])


def test_what_was_lived_with_another_reward_is_the_same_but_for_the_reward(program):
    ours_plus, rng = program("ours_plus"), np.random.default_rng(0)
    plain, other = ours_plus.options.Experience(), ours_plus.By(lambda look: look["belief"])
    for step in range(3):
        look = {"before": rng.random((4, 5)), "actions": rng.integers(3, size=4), "states": rng.random((4, 5)),
                "places": rng.integers(5, size=4), "belief": rng.random(4)}
        plain.watch(step, **look)
        other.watch(step, **look)
    for one, two in list(zip(plain.arrays(), other.arrays(), strict=True))[:-1]:
        np.testing.assert_array_equal(one, two)
    assert len(other.rewards) == 2
    np.testing.assert_array_equal(other.rewards[-1], look["belief"])


def test_without_edges_the_words_stay_and_no_word_has_a_neighbour(program):
    graphs = scene_graph(np.random.default_rng(0).integers(3, size=(4, 16, 16)) // 2)
    bare = program("edges").without_edges(graphs)
    assert len(graphs.edges) > 0
    assert len(bare.edges) == 0
    for one, two in zip(bare, graphs, strict=True):
        np.testing.assert_array_equal(one.words, two.words)


def test_with_true_labels_there_is_no_net_and_a_classifier_of_its_own(program):
    home, settings = World(room(size=(4.0, 4.0))), Settings(gcn_views=40, gcn_epochs=2)
    before = Senses(home, {"a net": 1}, "a classifier", 0.5)
    after = program("right_labels").with_true_labels(before, settings)
    assert (after.net, after.world, after.noise) == (None, home, 0.5)
    again = program("right_labels").with_true_labels(Senses(home, None, None, 0.5), settings)
    assert learned.fingerprint(after.gcn.params) == learned.fingerprint(again.gcn.params)


def test_among_turns_the_better_turn_is_chosen_though_going_forward_were_better_still(program):
    store = SimpleNamespace(q_values=lambda _: np.array([[1.0, 2, 9], [3, 2, 9]]))
    assert program("one_habit").among_turns(store)(0, None, np.random.default_rng(0)).tolist() == [1, 0]


def test_in_pairs_an_option_is_worth_the_belief_that_it_left_near_such_a_view(program, monkeypatch):
    ours_plus, views = program("ours_plus"), np.float32([[1, 0.5], [0.5, 1]])
    worth = np.array([[0.1, 0.2, 0.3], [0.6, 0.5, 0.4]])  # of each start, each action

    def run_all(_senses, _robot, _grid, plan, starts, seed, watch):
        assert (starts, seed) == ("starts", 7)
        watch(step=0, states=views)
        action = plan(0, views, None)[0]
        return SimpleNamespace(belief=np.stack([[9.0, 9.0], worth[:, action]], 1))

    monkeypatch.setattr(ours_plus.episode, "run_all", run_all)
    monkeypatch.setattr(ours_plus.options, "K_NEIGHBOURS", 1)
    options = ours_plus.InPairs(("senses", "robot", "grid"), "starts", 7)
    np.testing.assert_allclose(options.q_values(views[::-1]), worth[::-1])


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_takes_no_options_and_begins_nothing(tmp_path, name):
    done = subprocess.run([sys.executable, RESULTS / "why" / f"{name}.py", "--help"], cwd=tmp_path,
                          capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"{name}.py: expected no options, found --help (see the head of the file)\n"
    assert list(tmp_path.iterdir()) == []


def test_a_file_where_the_table_should_be_is_one_line(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "table").write_text("")
    done = subprocess.run([sys.executable, RESULTS / "why" / "one_habit.py"], cwd=tmp_path, capture_output=True,
                          text=True, timeout=60)
    assert (done.returncode, done.stdout) == (2, "")
    assert re.fullmatch(r".*: expected a folder, found the file out/table\n", done.stderr)
