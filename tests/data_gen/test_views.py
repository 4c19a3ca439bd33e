"""Training views: something to see in each, from homes in which no robot is tested; the command that writes them."""

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from data_gen import views
from data_gen.__main__ import main
from data_gen.views import training_views
from gnl.files import load_arrays, save_arrays
from gnl.segnet import SIZE_PX
from gnl.world import World

WORLD_SEEDS = (800, 801, 809)  # of the homes in which robots are localized


@pytest.fixture
def tokens(monkeypatch):
    """Homes and views reduced to tokens: a view shows its home's seed, and every third view is a bare wall."""
    seeds = []

    def make_home(seed):
        seeds.append(seed)
        return SimpleNamespace(seed=seed, free_poses=lambda n, rng: np.zeros((n, 3)))

    def render(home, poses, rng, size_px, noise):
        labels = np.zeros((len(poses), size_px, size_px), np.uint8)
        labels[:, 0], labels[:, 1] = 3, 6
        labels[::3] = 0
        seen = np.full((*labels.shape, 3), home.seed % 256, np.uint8)
        seen[..., 1] = min(max(noise, 0), 255)
        return seen, labels

    monkeypatch.setattr(views, "make_home", make_home)
    monkeypatch.setattr(views, "render", render)
    return seeds


def test_views_and_labels_fit_together():
    rgb, labels = training_views(1, 5, seed=0)
    assert rgb.shape == (5, SIZE_PX, SIZE_PX, 3)
    assert labels.shape == (5, SIZE_PX, SIZE_PX)
    assert rgb.dtype == labels.dtype == np.uint8
    assert labels.max() <= 9


def test_each_view_shows_at_least_three_classes():
    _, labels = training_views(2, 40, seed=0)
    for label in labels:
        _, area = np.unique(label, return_counts=True)
        assert (area >= SIZE_PX ** 2 / 100).sum() >= 3


def test_a_bare_wall_is_looked_away_from(tokens):
    _, labels = training_views(2, 9, seed=0)
    assert (labels.max((1, 2)) == 6).all()


def test_where_one_kind_of_things_is_enough_a_bare_wall_will_do(tokens):
    _, labels = training_views(2, 9, seed=0, n_kinds=1)
    assert (labels.max((1, 2)) == [0, 6, 6, 0, 0, 6, 6, 0, 6]).all()


def test_there_are_as_many_views_as_were_asked_for_where_not_enough_of_the_first_ones_will_do(tokens, monkeypatch):
    """One of three will do: of nine from each home the first eighteen have six, and the next eighteen the rest."""
    render = views.render

    def more_bare_walls(*args):
        rgb, labels = render(*args)
        labels[1::3] = 0
        return rgb, labels

    monkeypatch.setattr(views, "render", more_bare_walls)
    rgb, labels = training_views(2, 18, seed=0)
    assert np.bincount(rgb[:, 0, 0, 0]).tolist() == [9, 9]
    assert (labels.max((1, 2)) == 6).all()
    assert len(labels) == len(rgb)


def test_a_kind_is_seen_that_fills_one_percent_of_a_view_and_not_one_that_fills_less(tokens, monkeypatch):
    """One percent of 64 x 64 pixels is 41, rounded up."""
    render = views.render

    def with_a_small_thing(*args):
        rgb, labels = render(*args)
        labels[:, 1:] = 0
        labels[::2, 1, :40] = labels[1::2, 1, :41] = 6
        return rgb, labels

    monkeypatch.setattr(views, "render", with_a_small_thing)
    _, labels = training_views(1, 6, seed=0)
    assert (labels == 6).sum((1, 2)).tolist() == [41] * 6


@pytest.mark.parametrize(("n_homes", "n_views"), [(4, 10), (3, 9), (5, 3), (1, 1)])
def test_views_come_evenly_from_all_homes(tokens, n_homes, n_views):
    rgb, _ = training_views(n_homes, n_views, seed=0)
    each = np.bincount(rgb[:, 0, 0, 0], minlength=n_homes)
    assert each.sum() == n_views
    assert each.max() - each.min() <= 1


def test_no_view_is_from_a_home_of_the_tests(tokens):
    training_views(800, 1, seed=0)
    assert tokens == list(range(800))
    assert not {*tokens} & {*WORLD_SEEDS}
    with pytest.raises(ValueError, match=r"homes: expected 1\.\.800, found 801"):
        training_views(801, 1, seed=0)


def test_the_noise_is_that_of_the_camera(tokens):
    rgb, _ = training_views(1, 2, seed=0, noise=7)
    assert (rgb[..., 1] == 7).all()


def test_progress_ends_at_all(tokens):
    shares = []
    training_views(4, 8, seed=0, progress=shares.append)
    assert shares == [0.25, 0.5, 0.75, 1.0]


@pytest.mark.parametrize(("arguments", "name"), [
    ({"n_homes": 0}, "homes"), ({"n_homes": -1}, "homes"), ({"n_views": 0}, "views"), ({"noise": -1.0}, "noise"),
    ({"noise": np.nan}, "noise"), ({"noise": 1e9}, "noise"), ({"seed": -1}, "seed"), ({"n_kinds": 0}, "kinds"),
    ({"n_kinds": 4}, "kinds")], ids=str)
def test_what_cannot_be_is_refused_by_name(tokens, arguments, name):
    with pytest.raises(ValueError, match=f"{name}: expected .*, found "):
        training_views(**{"n_homes": 1, "n_views": 1, "seed": 0, **arguments})


def run(*arguments):
    """Exit status of `python -m data_gen`."""
    with pytest.raises(SystemExit) as exit:
        main([str(argument) for argument in arguments])
    return exit.value.code


@pytest.mark.parametrize("arguments", [[], ["home"], ["views"]], ids=" ".join)
def test_help_is_help(capsys, arguments):
    assert run(*arguments, "--help") == 0
    assert capsys.readouterr().out.startswith("usage: python -m data_gen")


def test_a_home_is_written_as_a_floor_plan(capsys, tmp_path):
    assert run("home", tmp_path / "new" / "home.json", "--seed", 801) == 0
    world = World.load(tmp_path / "new" / "home.json")
    assert len(world.plan["objects"]) > 10
    assert capsys.readouterr() == ("", "")


def test_one_seed_is_one_home_and_rooms_can_be_more_alike(tmp_path):
    for name, options in {"a": [], "b": ["--seed", 800, "--aliasing", 0.3], "c": ["--aliasing", 1],
                          "d": ["--seed", 801]}.items():
        assert run("home", tmp_path / name, *options) == 0
    a, b, c, d = ((tmp_path / name).read_bytes() for name in "abcd")
    assert a == b
    assert len({a, c, d}) == 3


def test_views_are_the_same_bits_in_a_fresh_process_and_other_ones_by_another_seed(tmp_path, capsys):
    options = ["--homes", "2", "--views", "6"]
    subprocess.run([sys.executable, "-W", "error", "-m", "data_gen", "views", tmp_path / "fresh.npz", *options],
                   check=True)
    assert run("views", tmp_path / "here.npz", *options) == 0
    assert run("views", tmp_path / "other.npz", *options, "--seed", 1) == 0
    assert (tmp_path / "fresh.npz").read_bytes() == (tmp_path / "here.npz").read_bytes()
    here, other = (load_arrays(tmp_path / name)[0] for name in ("here.npz", "other.npz"))
    assert (here["rgb"] != other["rgb"]).any()
    rgb, labels = training_views(2, 6, seed=0)
    assert np.array_equal(here["rgb"], rgb)
    assert np.array_equal(here["labels"], labels)


def test_a_file_of_views_says_what_made_it_and_is_made_once(tokens, tmp_path, capsys):
    path = tmp_path / "views.npz"
    options = ["--homes", 2, "--views", 6, "--seed", 3, "--kinds", 2, "--noise", 0.5]
    assert run("views", path, *options) == 0
    made_by = load_arrays(path)[1]
    assert len(made_by.pop("code")) == 8
    assert made_by == {"homes": 2, "views": 6, "seed": 3, "noise": 0.5, "kinds": 2}
    assert capsys.readouterr().out.count("\n") == 1
    before = path.stat()
    assert run("views", path, *options) == 0
    assert path.stat() == before
    assert len(tokens) == 2
    assert capsys.readouterr() == ("", "")
    assert run("views", path, *options[:-1], 0.25) == 0
    assert load_arrays(path)[1]["noise"] == 0.25


BAD = ["home {}/a --aliasing 2", "home {}/a --aliasing nan", "home {}/a --seed -1", "home {}", "views {}/a --homes 0",
       "views {}/a --homes 801", "views {}/a --views 0", "views {}/a --noise -1", "views {}/a --noise nan",
       "views {}/a --seed -1", "views {}/a --kinds 4", "views {}", "views {}/song.txt",
       "views {}/song.txt/a --homes 1 --views 1"]


@pytest.mark.parametrize("line", BAD)
def test_a_mistake_is_one_line_and_writes_nothing(tokens, capsys, tmp_path, line):
    (tmp_path / "song.txt").write_text("la la la")
    assert run(*line.format(tmp_path).split()) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("python -m data_gen: ")
    assert err.count("\n") == 1
    assert [path.read_text() for path in tmp_path.iterdir()] == ["la la la"]


@pytest.mark.parametrize("line", ["", "house", "home", "views {}/a --homes many", "home {}/a --song la"])
def test_what_is_no_command_has_status_2(capsys, tmp_path, line):
    assert run(*line.format(tmp_path).split()) == 2
    err = capsys.readouterr().err
    assert err.startswith("python -m data_gen")
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_views_of_other_code_are_made_anew(tokens, tmp_path, monkeypatch):
    path, options = tmp_path / "views.npz", ["--homes", 2, "--views", 6]
    assert run("views", path, *options) == 0
    monkeypatch.setattr(views, "digest_of_code", lambda *_: "other")
    assert run("views", path, *options) == 0
    assert tokens == [0, 1, 0, 1]


@pytest.mark.parametrize("n_arguments", [0, 2], ids=["gnl", "data_gen"])
def test_views_of_other_code_of_one_package_alone_are_made_anew(tokens, tmp_path, monkeypatch, n_arguments):
    path, options, code = tmp_path / "views.npz", ["--homes", 2, "--views", 6], views.digest_of_code
    assert run("views", path, *options) == 0
    monkeypatch.setattr(views, "digest_of_code", lambda *where: "other" if len(where) == n_arguments else code(*where))
    assert run("views", path, *options) == 0
    assert tokens == [0, 1, 0, 1]


@pytest.mark.parametrize("made_by", ["a test", {}, {"episodes": 9}, {"views": 9}], ids=str)
def test_views_are_not_written_over_a_file_of_something_else(tokens, tmp_path, capsys, made_by):
    path = tmp_path / "store.npz"
    save_arrays(path, made_by, a=np.arange(9))
    before = path.read_bytes()
    assert run("views", path, "--homes", 1, "--views", 1) == 2
    said = f"python -m data_gen: {path}: expected views or nothing, found a file made by {made_by}\n"
    assert capsys.readouterr().err == said
    assert path.read_bytes() == before


def test_views_are_not_written_over_a_damaged_file(tokens, tmp_path, capsys):
    path = tmp_path / "views.npz"
    save_arrays(path, {}, a=np.arange(100))
    path.write_bytes(path.read_bytes()[:-50])
    before = path.read_bytes()
    assert run("views", path, "--homes", 1, "--views", 1) == 2
    assert path.read_bytes() == before
    assert str(path) in capsys.readouterr().err


@pytest.mark.parametrize(("out", "said"), [("", "a file, found no name"),
                                          ("file/views.npz", "a folder, found the file file")])
def test_where_no_folder_can_be_views_are_refused_before_any_is_drawn(tokens, tmp_path, monkeypatch, capsys, out, said):
    (tmp_path / "file").touch()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as exit:
        main(["views", out])
    assert exit.value.code == 2
    assert capsys.readouterr() == ("", f"python -m data_gen: out: expected {said}\n")
    assert tokens == []
