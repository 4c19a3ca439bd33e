"""What the cells of a table share: drawn and learned by its settings, and another net from other views."""

from types import SimpleNamespace

import numpy as np
import pytest

from gnl import groundwork, learned
from gnl.experiment import Cell
from gnl.table import Settings

SETTINGS = Settings(*range(101, 112))  # all numbers differ
NET = {"w": np.zeros(3)}


@pytest.fixture
def asked(monkeypatch):
    """What the programs and learners, all test doubles, are asked for; and what the file of views says of itself."""
    asked = SimpleNamespace(drawn=[], net=[], gcn=[], status=0,
                            made_by={"homes": 105, "views": 106, "seed": 0, "noise": 104})

    def segmentation_net(_folder, views, made_by, epochs, seed, stage):
        asked.net.append((views, made_by, epochs))
        return NET

    def place_classifiers(_folder, senses, n_views, _seed, made_by, pool, **how):
        asked.gcn.append((n_views, made_by, pool, how))
        return [(world, "GCN") for world in senses]

    def load_views(path):
        return f"views of {path.name}", asked.made_by

    def program(argv):
        asked.drawn.append(argv[3:])
        return SimpleNamespace(returncode=asked.status)

    monkeypatch.setattr(groundwork, "subprocess", SimpleNamespace(run=program))
    monkeypatch.setattr(groundwork, "World", SimpleNamespace(load=lambda path: SimpleNamespace(name=path.stem)))
    for double in (segmentation_net, place_classifiers, load_views):
        monkeypatch.setattr(learned, double.__name__, double)
    return asked


def test_what_cells_share_is_drawn_and_learned_by_the_settings(tmp_path, asked):
    (world, one), = groundwork.prepare(tmp_path, SETTINGS, [Cell(800, 1.0, 90, 3)], 2, "pool")
    data = tmp_path / "data"
    assert asked.drawn == [
        ["starts", f"{data}", "--cell", "800", "1.0", "90", "3", "--training", "101", "--tests", "102",
         "--validation", "103", "--jobs", "2"],
        ["views", f"{data / 'views.npz'}", "--homes", "105", "--views", "106", "--noise", "104"]]
    assert asked.net == [("views of views.npz", asked.made_by, 107)]
    assert asked.gcn == [(108, {"net": learned.fingerprint(NET), "noise": 104}, "pool",
                          {"epochs": 109, "batch": 110, "rate": 111})]
    assert (world, one.world.name, one.net, one.gcn, one.noise) == (800, "home-800", NET, "GCN", 104)
    asked.made_by["noise"] = 3
    with pytest.raises(ValueError, match=r"views\.npz: expected results of noise 104, found some of 3; "):
        next(groundwork.prepare(tmp_path, SETTINGS, [Cell(800, 1.0, 90, 3)], 2, "pool"))


def test_another_net_learns_from_views_of_its_own(tmp_path, asked):
    path = tmp_path / "data" / "views-noise-0.5-kinds-1.npz"
    asked.made_by |= {"noise": 0.5, "kinds": 1}
    assert groundwork.taught_net(tmp_path, SETTINGS, noise=0.5, kinds=1) is NET
    assert asked.drawn == [["views", f"{path}", "--homes", "105", "--views", "106", "--noise", "0.5", "--kinds", "1"]]
    assert asked.net == [(f"views of {path.name}", asked.made_by, 107)]
    asked.made_by["kinds"] = 3
    with pytest.raises(ValueError, match=r"kinds-1\.npz: expected results of kinds 1, found some of 3; "):
        groundwork.taught_net(tmp_path, SETTINGS, noise=0.5, kinds=1)


def test_starts_that_are_there_are_asked_for_too(tmp_path, asked):
    for _ in range(2):
        next(groundwork.prepare(tmp_path, SETTINGS, [Cell(800, 1.0, 90, 3)], 2, "pool"))
    assert [kind for kind, *_ in asked.drawn] == ["starts", "views"] * 2


def test_views_that_are_there_are_asked_for_too_as_they_may_be_of_older_code(tmp_path, asked):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "views.npz").touch()
    groundwork.taught_net(tmp_path, SETTINGS)
    assert [kind for kind, *_ in asked.drawn] == ["views"]


def test_what_cannot_be_drawn_ends_the_run_as_it_ended_the_program(tmp_path, asked):
    asked.status = 2
    with pytest.raises(SystemExit) as exit:
        groundwork.taught_net(tmp_path, SETTINGS)
    assert (exit.value.code, asked.net) == (2, [])
