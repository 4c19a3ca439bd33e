"""Cross-view starts: tests uniform in free space; training beyond the gap from the nearest, and else uniform, too."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from PIL import Image

from data_gen import starts as starts_module
from data_gen.__main__ import main
from data_gen.rooms import make_home
from data_gen.starts import cell_of, draw_starts, starts_of
from gnl import gaps
from gnl.canvas import BELIEF, ROBOT
from gnl.experiment import GAPS_DEG, GAPS_M, Cell
from gnl.files import load_arrays
from gnl.world import World
from tests.conftest import room

N_TESTS = 100


@pytest.fixture(autouse=True)
def fewer_at_once(monkeypatch):
    """And in this process; test_table.py draws starts in others."""
    monkeypatch.setattr(gaps, "DRAWN_AT_ONCE", 20_000)
    monkeypatch.setattr(starts_module, "processes", ThreadPoolExecutor)


@pytest.fixture(scope="module", params=[800, 801, 809])
def home(request):
    return make_home(request.param)


def differences(poses, tests):
    """Distance [m] to the nearest test start, and turn [rad] from it, by hand: one pose after the other."""
    found = []
    for x, y, theta in poses:
        distance = np.hypot(tests[:, 0] - x, tests[:, 1] - y)
        nearest = distance.argmin()
        turn = (theta - tests[nearest, 2]) % (2 * np.pi)
        found.append((distance[nearest], min(turn, 2 * np.pi - turn)))
    return np.array(found).T


@pytest.mark.parametrize("t_xy_m", GAPS_M)
@pytest.mark.parametrize("t_theta_deg", GAPS_DEG)
def test_training_starts_are_beyond_each_of_the_papers_gaps(home, t_xy_m, t_theta_deg):
    starts = draw_starts(home, t_xy_m, np.radians(t_theta_deg), 60, N_TESTS, 10, np.random.default_rng(3))
    assert [starts[name].shape for name in ("tests", "validation", "training")] == [(N_TESTS, 3), (10, 3), (60, 3)]
    distance, turn = differences(starts["training"], starts["tests"])
    assert (distance > t_xy_m).all()
    assert (turn > np.radians(t_theta_deg)).all()
    assert home.is_free(starts["training"][:, :2]).all()
    assert len(np.unique(np.concatenate(list(starts.values())), axis=0)) == N_TESTS + 10 + 60  # none serves twice


def test_there_are_starts_just_beyond_the_gap_so_it_is_not_larger_than_said():
    home = make_home(800)
    starts = draw_starts(home, 0.4, np.radians(50), 4000, N_TESTS, 1, np.random.default_rng(0))
    distance, turn = differences(starts["training"], starts["tests"])
    assert distance.min() < 0.401
    assert np.degrees(turn.min()) < 50.2


def test_test_starts_are_drawn_before_all_else_and_do_not_depend_on_the_gap():
    home = make_home(800)
    near, far = (draw_starts(home, t, 0.2, 20, 7, 3, np.random.default_rng(5)) for t in (0.2, 1.0))
    for name in ("tests", "validation"):
        np.testing.assert_array_equal(near[name], far[name])
    np.testing.assert_array_equal(near["tests"], home.free_poses(7, np.random.default_rng(5)))


def test_a_cell_has_starts_beyond_its_own_gap_the_same_each_time_and_as_no_other_cell():
    home, sizes = World(room()), (30, 6, 2)
    cells = [Cell(*of) for of in ((800, 0.4, 50, 0), (800, 0.4, 50, 1), (800, 0.4, 90, 0), (800, 0.6, 50, 0))]
    of_cells = [starts_of(cell, home, *sizes) for cell in cells]
    for cell, starts in zip(cells, of_cells, strict=True):
        assert [len(starts[name]) for name in ("training", "tests", "validation")] == list(sizes)
        distance, turn = differences(starts["training"], starts["tests"])
        assert (distance > cell.t_xy_m).all()
        assert (turn > np.radians(cell.t_theta_deg)).all()
        for name, again in starts_of(cell, home, *sizes).items():
            np.testing.assert_array_equal(starts[name], again)
    assert len(np.unique(np.concatenate([starts["tests"] for starts in of_cells]), axis=0)) == 4 * 6


def test_a_gap_that_a_home_has_no_room_for_is_refused_with_the_share_that_was_seen():
    home = World(room(size=(2.0, 2.0)))
    with pytest.raises(ValueError, match=r"room: expected room for starts 3 m and 10 degrees off the nearest of 5 test "
                                         r"starts, found 0 among \d+ poses drawn"):
        draw_starts(home, 3.0, np.radians(10), 10, 5, 1, np.random.default_rng(0))


def test_a_picture_shows_both_kinds_of_starts_where_they_are():
    home, along = World(room()), np.linspace(0.5, 3.5, 9)
    training, tests = (np.stack([np.full(9, x), along, along], 1) for x in (1.0, 5.0))
    pixels = np.array(starts_module.picture(home, {"training": training, "tests": tests}))
    violet, orange = (np.nonzero((pixels[60:] == colour).all(2))[1] for colour in (BELIEF, ROBOT))
    assert violet.max() < pixels.shape[1] / 2 < orange.min()


def test_a_picture_shows_all_tests_and_the_first_of_the_training_starts(monkeypatch):
    home, shown = World(room()), []
    starts = {name: home.free_poses(n, np.random.default_rng(n)) for name, n in (("training", 30), ("tests", 20))}
    monkeypatch.setattr(starts_module.Map, "starts", lambda _, poses, colour: shown.append((colour, poses)))
    starts_module.picture(home, starts, n=7)
    assert [colour for colour, _ in shown] == [BELIEF, ROBOT]
    np.testing.assert_array_equal(shown[0][1], starts["training"][:7])
    np.testing.assert_array_equal(shown[1][1], starts["tests"])


def test_a_home_is_drawn_with_its_starts_and_again_if_it_is_lost(tmp_path):
    def drawn():
        with pytest.raises(SystemExit) as exit:
            main(["starts", str(tmp_path), "--cell", "801", "0.2", "10", "0", "--training", "5", "--tests", "3"])
        assert exit.value.code == 0
        return {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    first, plan = drawn(), tmp_path / "home-801.json"
    assert World.load(plan).plan == make_home(801).plan
    plan.unlink()
    assert drawn() == first


def test_a_picture_is_drawn_where_it_is_asked_for_and_lacking_and_changes_no_starts(tmp_path):
    def drawn(*options):
        words = ["--cell", "801", "0.2", "10", "0", "--training", "5", "--tests", "3", *options]
        with pytest.raises(SystemExit) as exit:
            main(["starts", str(tmp_path), *words])
        assert exit.value.code == 0
        return {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    first = drawn()
    with_picture = drawn("--picture")
    name, = with_picture.keys() - first.keys()
    assert name == "starts-801-0.2m-10deg-seed0.png"
    with Image.open(tmp_path / name) as picture:
        assert picture.size[0] > 720
    assert {other: with_picture[other] for other in first} == first
    assert drawn() == with_picture


def test_a_folder_without_a_name_is_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as exit:
        main(["starts", "", "--cell", "801", "0.2", "10", "0"])
    assert exit.value.code == 2
    assert capsys.readouterr().err == "python -m data_gen: folder: expected a folder, found no name\n"
    assert not list(tmp_path.iterdir())


def test_starts_are_not_drawn_in_another_home(tmp_path, capsys):
    plan = tmp_path / "home-801.json"
    make_home(802).save(plan)
    before = plan.read_bytes()
    with pytest.raises(SystemExit) as exit:
        main(["starts", str(tmp_path), "--cell", "801", "0.2", "10", "0", "--training", "5", "--tests", "3"])
    assert exit.value.code == 2
    assert f"{plan}: expected home-801 or nothing, found another home" in capsys.readouterr().err
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [before]


@pytest.mark.parametrize("words", ["eight 0.2 10 0", "800 x 10 0", "800 0.2 ten 0", "800 0.2 10 -1", "800 nan 10 0",
                                   "800 0.20000001 10 0"])
def test_a_cell_that_cannot_be_is_one_line(tmp_path, capsys, words):
    with pytest.raises(SystemExit) as exit:
        main(["starts", str(tmp_path / "out"), "--cell", *words.split()])
    assert exit.value.code == 2
    assert capsys.readouterr().err == ("python -m data_gen: --cell: expected WORLD M DEG SEED as in 800 0.2 10 0, "
                                       f"M of at most six digits, found {words}\n")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("option", ["training", "tests", "validation", "jobs"])
def test_no_starts_and_no_processes_are_one_line(tmp_path, capsys, option):
    with pytest.raises(SystemExit) as exit:
        main(["starts", str(tmp_path / "out"), "--cell", "800", "0.2", "10", "0", f"--{option}", "0"])
    assert exit.value.code == 2
    assert capsys.readouterr().err == f"python -m data_gen: --{option}: expected at least 1, found 0\n"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", ["800 0.2 180 0", "800 200 10 0", "800 5000 10 0"])
def test_a_gap_wider_than_homes_or_half_a_circle_is_one_line(tmp_path, capsys, words):
    with pytest.raises(SystemExit) as exit:
        main(["starts", str(tmp_path / "out"), "--cell", *words.split()])
    assert exit.value.code == 2
    said = capsys.readouterr().err
    assert said == f"python -m data_gen: --cell: expected M below 200 and DEG below 180, found {words}\n"


def test_no_gap_has_one_name():
    assert cell_of(["800", "-0.0", "0", "0"]).name == cell_of(["800", "0", "0", "0"]).name == "800-0m-0deg-seed0"


def test_starts_of_other_code_are_drawn_anew(tmp_path, monkeypatch):
    def written():
        with pytest.raises(SystemExit) as exit:
            main(["starts", str(tmp_path), "--cell", "800", "0.2", "10", "0", "--training", "5", "--tests", "4"])
        assert exit.value.code == 0
        path, = tmp_path.glob("starts-*.npz")
        return path.stat().st_mtime_ns, load_arrays(path)[0]["training"].tolist()

    first, again = written(), written()
    assert first == again
    monkeypatch.setattr(starts_module, "digest_of_code", lambda *_, **__: "other")
    assert written()[0] > first[0]
    assert written()[1] == first[1]


def test_cells_have_starts_in_their_own_homes_as_many_as_were_asked_for_whatever_was_there(tmp_path):
    def drawn(n_training, *worlds):
        words = [word for world in worlds for word in ("--cell", world, "0.2", "10", "0")]
        with pytest.raises(SystemExit) as exit:
            main(["starts", str(tmp_path), *words, "--training", str(n_training), "--tests", "30"])
        assert exit.value.code == 0
        for world in worlds:
            starts = load_arrays(tmp_path / f"starts-{world}-0.2m-10deg-seed0.npz")[0]
            assert [len(starts[name]) for name in ("training", "tests")] == [n_training, 30]
            home = World.load(tmp_path / f"home-{world}.json")
            assert all(home.is_reachable(poses[:, :2]).all() for poses in starts.values())

    drawn(40, "801")
    drawn(40, "800", "801")
    drawn(50, "801", "800")
