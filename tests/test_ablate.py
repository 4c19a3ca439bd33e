"""Other choices: each can be put in the place of ours and is taken back; what is measured is what the page says."""

import contextlib
import itertools
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from data_gen.rooms import make_home
from data_gen.starts import starts_of
from gnl import ablate, camera, episode, gcn, learned, nnql, particles, planners, scene_graph, senses, strip
from gnl.__main__ import main
from gnl.choices import CHOICES, OURS, TRUE_LABELS, Choice
from gnl.compare import paired_difference
from gnl.episode import Rules
from gnl.experiment import costs_path, made_from
from gnl.files import save_json
from gnl.gcn import GCN
from gnl.places import PlaceGrid
from gnl.robot import Motion
from gnl.senses import Senses
from gnl.table import Settings, cell_path
from gnl.world import ROBOT_RADIUS_M

PAGE = Path(__file__).parents[1] / "tutorials" / "open_points.md"
CELL = ablate.CELLS[0]


@pytest.fixture(scope="module")
def parts():
    home = make_home(CELL.world)
    return (Senses(home, None, GCN(PlaceGrid(home).n_places, np.random.default_rng(0), hidden=8)),
            starts_of(CELL, home, 12, 8, 1))


def constants():
    """What the modules that choices reach into hold now."""
    modules = ablate, camera, episode, gcn, nnql, particles, planners, scene_graph, senses, strip
    return {(module.__name__, name): str(value) for module in modules for name, value in vars(module).items()
            if not name.startswith("__")}


@pytest.mark.parametrize("choice", [OURS, *CHOICES], ids=lambda choice: f"{choice.point}: {choice.other}")
def test_every_choice_runs_and_leaves_no_trace(choice, parts):
    here = constants()
    result, costs = ablate.measure(choice, CELL, *parts, Settings(gcn_views=24, gcn_epochs=1))
    assert [len(look) for look in result["tests"]["Ours"]["place"]] == [8] * 5
    assert costs["views"] > 0
    assert here == constants()


def west(poses, tests, t_xy_m, t_theta_rad):
    """A gap of its own, which sees that it is asked about this cell's."""
    assert (len(tests), t_xy_m, t_theta_rad) == (8, CELL.t_xy_m, np.radians(CELL.t_theta_deg))
    return poses[:, 0] < 4


def east(*of):
    return ~west(*of)


OTHER = Choice("a point", "other", Rules(length=3, pooling="max"), {"k": 16}, Motion(forward_m=1.0), true_labels=True,
               anew=True, constants={"camera.HEIGHT_M": 0.7}, of_training={"episode.SIDE_BY_SIDE": 3}, luck=2,
               of_gcn={"n_views": 7, "epochs": 9}, views_beyond=west, starts_beyond=east)


@pytest.mark.parametrize(("choice", "net"), [(OURS, None), (OURS, {"weights": 2}), (OTHER, None)],
                         ids=["ours", "another net", "other"])
def test_a_choice_holds_in_learning_and_in_both_tests_which_have_the_same_luck(choice, net, parts, monkeypatch):
    senses, starts, height = replace(parts[0], net={"weights": np.array(1)}), parts[1], camera.HEIGHT_M
    gcn, learnt, trained, tested, at_once = senses.gcn, [], [], [], episode.SIDE_BY_SIDE

    def learn_places(senses, grid, n_views, seed, draw, **how):
        learnt.append((senses.net, n_views, seed, how))
        if draw:
            poses = draw(50, np.random.default_rng(3))
            assert (len(poses), (poses[:, 0] < 4).all()) == (50, True)
            assert senses.world.is_free(poses[:, :2], ROBOT_RADIUS_M).all()
        return "another GCN"

    def train_nnql(senses, robot, grid, poses, seed, rules, store):
        trained.append((senses.net, senses.gcn, robot.motion, rules, camera.HEIGHT_M))
        assert store.k == choice.store.get("k", nnql.K_NEIGHBOURS)
        assert (poses is starts["training"]) == (choice is OURS)
        assert len(poses) == 12
        assert choice is OURS or (poses[:, 0] >= 4).all()
        there = choice.of_training.get("episode.SIDE_BY_SIDE", at_once)
        assert there == episode.SIDE_BY_SIDE
        tested.append(seed.spawn_key)

    def run_all(senses, robot, grid, plan, poses, seed, rules):
        trained.append((senses.net, senses.gcn, robot.motion, rules, camera.HEIGHT_M))
        assert (poses is starts["tests"], episode.SIDE_BY_SIDE) == (True, at_once)
        tested.append(seed.spawn_key)
        answers = np.full((8, 5), 0 if plan is planners.chance else 99)
        return SimpleNamespace(answers=answers, places=np.zeros((8, 5), int), correct=answers == 0)

    for module, double in ((learned, learn_places), (episode, train_nnql), (episode, run_all)):
        monkeypatch.setattr(module, double.__name__, double)
    s = Settings(gcn_views=24, gcn_epochs=3, gcn_batch=16, gcn_rate=0.02)
    result, _ = ablate.measure(choice, CELL, senses, starts, s, net)
    net = None if choice.true_labels else net or senses.net
    how = {"epochs": s.gcn_epochs, "batch": s.gcn_batch, "rate": s.gcn_rate}
    assert learnt == ([(net, 7, 2, how | {"epochs": 9})] if choice.anew else [])
    there = 0.7 if choice is OTHER else height
    assert trained == [(net, "another GCN" if choice.anew else gcn, choice.motion, choice.rules, there)] * 3
    assert tested[0] != tested[1] == tested[2]
    assert (result["tests"]["MV"]["place"], result["tests"]["Ours"]["place"]) == (["1" * 8] * 5, ["0" * 8] * 5)
    assert (senses.net, senses.gcn, senses.views, camera.HEIGHT_M) == ({"weights": 1}, gcn, parts[0].views, height)


def test_luck_of_the_training_changes_its_seed_alone(parts, monkeypatch):
    seeds = []
    for name, real in (("train_nnql", episode.train_nnql), ("run_all", episode.run_all)):
        def watched(*args, name=name, real=real, **options):
            seeds.append((name, next(arg.spawn_key for arg in args if isinstance(arg, np.random.SeedSequence))))
            return real(*args, **options)

        monkeypatch.setattr(episode, name, watched)
    for choice in (OURS, Choice("a point", "b", luck=1), Choice("a point", "c", luck=2)):
        ablate.measure(choice, CELL, *parts, Settings())
    (ours, *tests), (one, *others), (two, *more) = seeds[:3], seeds[3:6], seeds[6:]
    assert len({ours[1], one[1], two[1]}) == 3
    assert tests == others == more


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


def test_every_choice_is_another_one_than_ours_and_than_the_others():
    changes = []
    for choice in CHOICES:
        here = constants()
        with ablate.in_place(choice.constants | choice.of_training):
            changed = {name: value for name, value in constants().items() if value != here[name]}
            assert len(changed) == len(choice.constants | choice.of_training)
        of_view = any(name.startswith(("camera.", "strip.")) for name in choice.constants)
        of_view |= any(name.startswith("senses.") for name in choice.constants)  # and none's labels take their place
        assert choice.true_labels >= of_view  # no net knows such views
        assert choice.anew or not (choice.of_gcn or choice.of_net or choice.views_beyond)
        changes.append((choice.rules, choice.store, choice.motion, changed, choice.true_labels, choice.luck,
                        choice.anew and choice.luck, choice.of_gcn, choice.of_net, choice.views_beyond,
                        choice.starts_beyond))
        assert choice.store.get("k") != nnql.K_NEIGHBOURS
    ours = OURS.rules, OURS.store, OURS.motion, {}, False, 0, False, {}, {}, None, None
    assert all(one != other for one, other in itertools.combinations([ours, *changes], 2))


HIGHER, NO_EDGES = Choice("camera height", "2 m", true_labels=True), Choice("edges", "none")


def write_outcomes(out, choices):
    """Made-up outcomes of choices in two cells."""
    rng = np.random.default_rng(0)
    for choice, cell in itertools.product(choices, ablate.CELLS):
        tests = {name: {"place": ["".join(rng.choice(["0", "1"], 50)) for _ in range(5)]} for name in ("MV", "Ours")}
        path = cell_path(out, ablate.name_of(choice, cell))
        save_json(path, {"name": ablate.name_of(choice, cell), "tests": tests})
        save_json(out / "costs" / path.name, {})


@pytest.mark.parametrize(("choice", "beside"), [(NO_EDGES, OURS), (TRUE_LABELS, OURS), (HIGHER, TRUE_LABELS)])
def test_an_effect_is_the_difference_in_pairs_from_our_choice_and_with_true_labels_from_ours_with_them(
        tmp_path, monkeypatch, choice, beside):
    monkeypatch.setattr(ablate, "CELLS", ablate.CELLS[:2])
    write_outcomes(tmp_path, [OURS, TRUE_LABELS, NO_EDGES, HIGHER])
    ours, row = ablate.effects(tmp_path, [OURS, choice])
    assert row[:3] == [choice.point, choice.other, beside.other]
    for column, method in ((3, "MV"), (4, "Ours")):
        def right(choice, method=method):
            files = [cell_path(tmp_path, ablate.name_of(choice, cell)).read_bytes() for cell in ablate.CELLS]
            return np.array([one == "1" for file in files for one in json.loads(file)["tests"][method]["place"][-1]])

        d, low, high = (100 * value for value in paired_difference(right(choice), right(beside)))
        assert row[column] == f"{d:+.1f} [{low:+.1f}, {high:+.1f}]"
        assert ours[column] == f"{100 * right(OURS).mean():.1f}"


def test_where_no_answer_changed_the_effect_is_nothing_without_an_interval(tmp_path):
    write_outcomes(tmp_path, [OURS, NO_EDGES])
    for cell in ablate.CELLS:
        ours, other = (json.loads(cell_path(tmp_path, ablate.name_of(choice, cell)).read_bytes())
                       for choice in (OURS, NO_EDGES))
        other["tests"]["MV"] = ours["tests"]["MV"]
        save_json(cell_path(tmp_path, ablate.name_of(NO_EDGES, cell)), other)
    row = ablate.effects(tmp_path, [NO_EDGES])[0]
    assert row[3] == "0"
    assert row[4] != "0"


def test_a_run_measures_ours_and_the_points_that_are_asked_for_in_every_cell_once(tmp_path, monkeypatch, capsys):
    asked, page = [], tmp_path / "page.md"
    page.write_text("| open | effect |\n| edges | ? |\n| neighbours | ? |\n")

    def run_jobs(out, jobs, *_):
        asked.extend((choice, cell) for _, _, choice, cell, *_ in jobs)
        assert [net for *_, net in jobs] == [choice.of_net or None for choice, _ in asked]
        assert [name for name, *_ in jobs] == [ablate.name_of(choice, cell) for choice, cell in asked]
        write_outcomes(out, [choice for choice, _ in asked[::len(ablate.CELLS)]])

    def taught_net(_out, _settings, **others):
        return others

    for name, value in (("prepare", lambda *_: dict.fromkeys((800, 801, 809))), ("load_starts", lambda *_: None),
                        ("taught_net", taught_net),
                        ("executor", contextlib.nullcontext), ("run_jobs", run_jobs)):
        monkeypatch.setattr(ablate, name, value)
    for _ in range(2):  # the second one has nothing to do
        with pytest.raises(SystemExit) as exit:
            main(["ablate", "--out", str(tmp_path / "out"), "--points", "neighbours", "labels of the views",
                  "pictures of the net", "--page", str(page)])
        assert exit.value.code == 0
        others = [choice for choice in CHOICES if choice.point in ("neighbours", "pictures of the net")]
        assert any(choice.of_net for choice in others)
        assert asked == list(itertools.product([OURS, TRUE_LABELS, *others], ablate.CELLS))
    printed = capsys.readouterr().out
    assert printed.count("33 of 33 runs were there before, in ") == printed.count("runs were there before") == 1
    assert printed.count("| neighbours | k = 16 | ours |") == printed.count("| labels of the views |") == 2
    lines = page.read_text().splitlines()
    assert lines[1] == "| edges | ? |"
    expected = ["k = 1", "k = 16", "k = 64", *(f"k = 64, alpha = 1{seed}" for seed in (
        "", ", seed 1", ", seed 2", ", seed 3", ", seed 4"))]
    assert [part.split(":")[0] for part in lines[2].split(" | ")[1].split("<br>")] == expected


def test_runs_of_another_net_are_refused_before_new_ones_are_compared_with_them(tmp_path, parts, monkeypatch, capsys):
    senses, starts = parts
    ours, costs = ablate.measure(OURS, CELL, senses, starts, Settings())
    assert ours["made from"] == made_from(senses)
    edges = next(choice for choice in CHOICES if choice.point == "edges")
    for choice, cell in itertools.product([OURS, TRUE_LABELS], ablate.CELLS):
        name = ablate.name_of(choice, cell)
        result = ours | {"name": name, "made from": made_from(senses) | {"net": "12345678"}}
        for path, value in ((cell_path(tmp_path, name), result), (costs_path(cell_path(tmp_path, name)), costs)):
            save_json(path, value)
    for name, value in (("prepare", lambda *_: dict.fromkeys((800, 801, 809), senses)),
                        ("executor", contextlib.nullcontext)):
        monkeypatch.setattr(ablate, name, value)
    with pytest.raises(SystemExit) as exit:
        main(["ablate", "--out", str(tmp_path), "--points", "edges"])
    assert exit.value.code == 2
    assert "'net': '12345678'" in capsys.readouterr().err.split("found one made from")[1]
    assert not cell_path(tmp_path, ablate.name_of(edges, CELL)).exists()


def test_effects_go_into_the_rows_of_their_points_and_nowhere_else():
    page = "| open | effect |\n| --- | --- |\n| edges | ? |\n| edges of all | ? |\n\nedges | ?\n"
    measured = [["edges", "none", "ours", "+1.0 [+0.0, +2.0]", "-1.0 [-2.0, +0.0]"], ["other", "b", "ours", "", ""]]
    assert ablate.filled(page, measured) == page.replace(
        "| edges | ? |", "| edges | none: MV +1.0 [+0.0, +2.0], Ours -1.0 [-2.0, +0.0] |")


@pytest.mark.parametrize(("options", "words"), [(["--jobs", "0"], "--jobs: expected at least 1, found 0"),
                                                (["--page", "no/page.md"], "no/page.md"),
                                                (["--points", "luck"], "found 'luck'")])
def test_an_option_that_cannot_be_is_one_line(tmp_path, capsys, options, words):
    with pytest.raises(SystemExit) as exit:
        main(["ablate", "--out", str(tmp_path / "out"), *options])
    err = capsys.readouterr().err
    assert exit.value.code == 2
    assert words in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()
