"""The programs of the results page: at their smallest they print what the page shows, and plans do as they are told."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

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
        look = {"seen": rng.random((4, 5)), "actions": rng.integers(3, size=4), "states": rng.random((4, 5)),
                "places": rng.integers(5, size=4), "belief": rng.random(4)}
        plain.watch(step, **look)
        other.watch(step, **look)
    for one, two in list(zip(plain.arrays(), other.arrays(), strict=True))[:-1]:
        np.testing.assert_array_equal(one, two)
    assert len(other.rewards) == 2
    np.testing.assert_array_equal(other.rewards[-1], look["belief"])


def test_a_file_where_the_table_should_be_is_one_line(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "table").write_text("")
    done = subprocess.run([sys.executable, RESULTS / "why" / "one_habit.py"], cwd=tmp_path, capture_output=True,
                          text=True, timeout=60)
    assert (done.returncode, done.stdout) == (2, "")
    assert re.fullmatch(r".*: expected a folder, found the file out/table\n", done.stderr)
