"""The demonstration at the smallest scale: it runs, again in less time, after Ctrl-C and after a kill."""

import contextlib
import io
import os
import re
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import FLAT, begun_by_make, heed_ctrl_c
from PIL import Image

from data_gen.__main__ import main as draw_data
from data_gen.rooms import make_home
from gnl import demo
from gnl import learned as parts_learned
from gnl.__main__ import main
from gnl.classes import N_CLASSES, WALL
from gnl.files import load_arrays, save_arrays

SMALLEST = [f"--{name}={n}" for name, n in {"net-epochs": 1, "gcn-views": 128, "gcn-epochs": 2, "gcn-batch": 32,
                                            "episodes": 64, "scan-starts": 2, "tests": 4}.items()]
PICTURES = {"1-home.png", "2-view.png", "3-labels.png", "4-strip.png", "5-graph.png", "6-ranks.png", "episode.gif"}
PARTS = ["gcn", "net", "nnql", "scan"]


def start(out, views, *options):
    """The demo in a process group of its own, as a terminal starts it; a warning is an error."""
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-u", "-m", "gnl", "demo", "--plan", FLAT, "--views", views, "--out", out,
         *SMALLEST, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=heed_ctrl_c)


def end(process):
    """Wait for it: exit status, lines on stdout, text on stderr."""
    try:
        out, err = process.communicate(timeout=100)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    return SimpleNamespace(status=process.returncode, lines=out.splitlines(), err=err)


def stop(process, sign, folder, part):
    """Send a signal to the whole group, as a terminal does, once `part` is learned."""
    while process.poll() is None and not list(folder.glob(f"learned/{part}-*.npz")):
        time.sleep(0.01)
    os.killpg(process.pid, sign)
    return end(process)


def here(*options):
    """The command in this process: exit status, lines on stdout, text on stderr."""
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err, \
            pytest.raises(SystemExit) as exit:
        main(["demo", "--plan", str(FLAT), *map(str, options), *SMALLEST])
    return SimpleNamespace(status=exit.value.code, lines=out.getvalue().splitlines(), err=err.getvalue())


def files(folder):
    """Bytes and time of every file, by name."""
    return {path.relative_to(folder): (path.read_bytes(), path.stat().st_mtime_ns)
            for path in folder.rglob("*") if path.is_file()}


def learned(folder):
    return {name: content for name, content in files(folder).items() if name.parts[0] == "learned"}


def table(run):
    """The lines of a run without times, without its folder, and without what differs when a part was there before."""
    return [re.sub(r"(, learned before|, raced meanwhile)? +[\d.]+ s$", "", line).replace(str(run.pictures), "FOLDER")
            for line in run.lines if "the paper" not in line and not line.startswith("  view ")]


@pytest.fixture(scope="module")
def views(tmp_path_factory):
    path = tmp_path_factory.mktemp("data") / "views.npz"
    with pytest.raises(SystemExit) as exit:
        draw_data(["views", str(path), "--homes", "2", "--views", "64"])
    assert exit.value.code == 0
    return path


@pytest.fixture(scope="module")
def runs(tmp_path_factory, views):
    """Four runs in one folder: stopped by Ctrl-C, by a kill, and two that were left to end.

    The third finds an old picture in its way; the last, in this process, draws into a folder of its own.
    """
    out = tmp_path_factory.mktemp("demo") / "out"
    # What comes after the stop is long, or a busy machine would stop them too late.
    interrupted = stop(start(out, views, "--gcn-views=20000"), signal.SIGINT, out, "net")
    interrupted.files = files(out)
    killed = stop(start(out, views, "--episodes=50000"), signal.SIGKILL, out, "gcn")
    killed.files = files(out)
    (out / "demo").mkdir()
    (out / "demo" / "1-home.png").write_bytes(b"old")
    first = end(start(out, views))
    first.files, first.pictures = files(out), out / "demo"
    pictures = tmp_path_factory.mktemp("elsewhere") / "my pictures" / "flat"
    second = here("--views", views, "--out", out, "--pictures", pictures)
    second.files, second.pictures = files(out), pictures
    return SimpleNamespace(out=out, interrupted=interrupted, killed=killed, first=first, second=second)


def test_ctrl_c_in_the_middle_is_one_line_and_leaves_nothing_half_written(runs):
    assert runs.interrupted.status == 130
    assert runs.interrupted.err == "python -m gnl: interrupted; what was finished is kept\n"
    assert [name.stem.partition("-")[0] for name in runs.interrupted.files] == ["net"]


def test_what_was_finished_before_a_stop_is_whole_and_kept(runs):
    assert runs.killed.status == -signal.SIGKILL
    for stopped in (runs.interrupted, runs.killed):
        for name, content in stopped.files.items():
            if not name.name.startswith("."):  # what a kill cuts short has a temporary name
                assert runs.second.files[name] == content
                load_arrays(runs.out / name)


def test_a_run_after_ctrl_c_and_a_kill_completes(runs):
    assert runs.first.status == 0
    assert runs.first.err == ""
    assert sorted(name.stem.partition("-")[0] for name in learned(runs.out)) == PARTS


def test_a_run_prints_at_most_25_lines(runs):
    assert 10 <= len(runs.first.lines) <= 25


def test_a_run_names_every_stage_and_every_method(runs):
    heads = [line.split()[0] for line in runs.first.lines[1:]]
    assert [head for head in heads if head in ("net", "gcn", "nnql", "scan", "test", "draw")] == [
        "net", "gcn", "nnql", "scan", "test", "draw"]
    assert [head for head in heads if head in ("SV", "MV", "Scan", "Ours")] == ["SV", "MV", "Scan", "Ours"]


def test_a_run_draws_every_stage(runs):
    folder = runs.out / "demo"
    assert {path.name for path in folder.iterdir()} == PICTURES
    for name in PICTURES:
        with Image.open(folder / name) as picture:
            picture.load()
            assert min(picture.size) >= 100
            assert (getattr(picture, "n_frames", 1) >= 5) == (name == "episode.gif")


def test_a_second_run_learns_nothing_and_says_the_same(runs):
    assert runs.second.status == 0
    assert runs.second.err == ""
    assert table(runs.second) == table(runs.first)
    assert runs.second.files == runs.first.files
    for name in PICTURES:
        assert (runs.second.pictures / name).read_bytes() == (runs.first.pictures / name).read_bytes()


def test_a_part_that_was_there_says_so_and_a_new_one_does_not(runs):
    def old(run):
        return [line.split()[0] for line in run.lines if ", learned before " in line]

    assert old(runs.second) == ["net", "gcn", "nnql", "scan"]
    assert old(runs.first) == ["net", "gcn"]


def test_the_last_line_names_the_folder_of_the_pictures(runs):
    assert f"episode.gif in {runs.out / 'demo'} " in runs.first.lines[-1]


def test_the_pictures_go_where_they_are_told_to(runs):
    assert {path.name for path in runs.second.pictures.iterdir()} == PICTURES
    assert f"episode.gif in {runs.second.pictures} " in runs.second.lines[-1]
    assert runs.second.files.keys() == runs.first.files.keys()


@pytest.mark.parametrize(("plan", "folder"), [("", "out/demo"), ("a/flat.json", "out/demo-flat"),
                                              ("/my homes/the old, flat.v2.json", "out/demo-the old, flat.v2")])
def test_make_gives_each_home_of_ones_own_a_folder(plan, folder):
    last = begun_by_make(f"PLAN={plan}", "ARGS=--tests 3", "demo")[-1]
    assert last[last.index("--pictures") + 1] == folder
    assert last[last.index("--plan") + 1] == plan or not plan
    assert last[-2:] == ["--tests", "3"]


def test_every_method_has_the_same_starts_and_noise_and_costs_are_those_of_the_test_alone(monkeypatch, capsys):
    asked, told, senses = [], [], SimpleNamespace(seconds={"view": 9.0}, views=3)

    def run_all(senses, _robot, _grid, plan, starts, seed, progress):
        asked.append((plan, id(starts), seed))
        for share in (0.5, 1.0):
            progress(share, 0.25)
        senses.views, senses.seconds["view"] = senses.views + 10, senses.seconds.get("view", 0) + 0.02
        return SimpleNamespace(correct=np.eye(4, 5, dtype=bool))

    monkeypatch.setattr(demo.episode, "run_all", run_all)
    monkeypatch.setattr(demo.Stage, "__call__", lambda _stage, share, text: told.append((share, text)))
    starts = np.zeros((4, 3))
    demo.test(SimpleNamespace(seed=2), senses, None, None, {"MV": "m", "Scan": "s", "Ours": "o"}, starts)
    assert asked == [(plan, id(starts), 8) for plan in "mso"]
    shares, words = zip(*told, strict=True)
    assert shares == pytest.approx([1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6, 1])
    assert words == tuple(f"{name} right 25%" for name in ("MV", "MV", "Scan", "Scan", "Ours", "Ours"))
    assert "  view 2.00\n" in capsys.readouterr().out


def test_the_tests_begin_where_nothing_was_learned_and_every_method_has_its_name(monkeypatch):
    given = []
    monkeypatch.setattr(demo, "learn", lambda *_: (None, "store", [2, 0, 1, 1]))
    monkeypatch.setattr(demo.planners, "greedy", lambda store: f"greedy {store}")
    monkeypatch.setattr(demo, "show", lambda *_: None)
    monkeypatch.setattr(demo, "test", lambda *args: given.extend(args[-2:]))
    demo.play(SimpleNamespace(plan=FLAT, seed=3), demo.Scale(), None)
    plans, starts = given
    assert plans["Scan"](0, np.zeros((2, 1)), None).tolist() == [2, 2]
    assert plans["Ours"] == "greedy store"
    for stream in ([3], [3, 1], [3, 2]):  # of the GCN, of NNQL, of the race: learned.py
        learned_from = demo.World.load(FLAT).free_poses(len(starts), np.random.default_rng(stream))
        assert not np.isin(starts, learned_from).any()
    assert not np.isin(starts, demo.World.load(FLAT).free_poses(len(starts), np.random.default_rng(5))).any()


@pytest.fixture
def settings_of(monkeypatch, tmp_path, two_rooms):
    """What a run would learn its parts with: the settings in the names of the files of net, GCN, scan and store."""
    def settings_of(world=two_rooms, made_by="views", noise=1.0, **scale):
        settings, keep = [], lambda _folder, _name, settings_, *_: settings.append({**settings_})
        monkeypatch.setattr(parts_learned, "kept", lambda *args: keep(*args) or SimpleNamespace(values=[]))
        monkeypatch.setattr(parts_learned, "load_views", lambda path: (None, {"by": made_by}))
        monkeypatch.setattr(demo, "render", lambda *_: (None, None))
        for module, name in ((demo.segnet, "predict"), (demo.segnet, "accuracy"), (parts_learned, "top_places")):
            monkeypatch.setattr(module, name, lambda *_: (1, 1))
        monkeypatch.setattr(demo.Senses, "look_around", lambda *_: None)
        monkeypatch.setattr(parts_learned, "fixed_scan", lambda *args: keep(*args[:2], args[5]) or list)
        args = SimpleNamespace(out=tmp_path, views="", plan="", seed=0, noise=noise)
        demo.learn(args, demo.Scale(**scale), None, world, None, demo.PlaceGrid(world))
        return settings

    return settings_of


def test_all_that_the_demo_learns_from_is_in_the_names_of_its_files(settings_of):
    _, *others = map(parts_learned.digest, settings_of())  # of the GCN, the scan, the store
    for other in ({"world": make_home(3)}, {"made_by": "others"}, {"noise": 2.0}, {"net_epochs": 9}, {"gcn_epochs": 9}):
        assert not set(others) & set(map(parts_learned.digest, settings_of(**other))), other


@pytest.mark.parametrize(("batch", "rate"), [(32, 0.002), (128, 0.008)])
def test_the_classifier_learns_at_twice_the_papers_rate_for_as_large_a_batch(settings_of, batch, rate):
    _, of_gcn, *_ = settings_of(gcn_batch=batch)
    assert (of_gcn["batch"], of_gcn["rate"]) == (batch, pytest.approx(rate))


def test_labels_are_those_of_the_net_and_the_truth_and_ranks_mark_the_true_place(monkeypatch, tmp_path, two_rooms):
    shown, marked, labels, ranks = [], [], demo.draw.labels, demo.draw.ranks
    monkeypatch.setattr(demo.draw, "labels", lambda image, px: shown.append(image) or labels(image, px))
    monkeypatch.setattr(demo.draw, "ranks", lambda g, v, place, *how: marked.append(place) or ranks(g, v, place, *how))
    grid, g = demo.PlaceGrid(two_rooms), np.random.default_rng(0)
    senses = demo.Senses(two_rooms, demo.segnet.new_params(g), demo.gcn.GCN(grid.n_places, g, hidden=8))
    start = np.array([[2.0, 1.6, 0.2]])
    demo.draw_stages(tmp_path, senses, grid, start, np.random.default_rng(3))
    small, true = demo.render(two_rooms, start, np.random.default_rng(3), 64, senses.noise)
    np.testing.assert_array_equal(shown, [demo.segnet.predict(senses.net, small)[0], true[0]])
    assert marked == grid.place_of(start).tolist()


def test_the_view_that_is_shown_has_most_to_see_of_those_that_the_net_gets_right_as_on_average(
        monkeypatch, tmp_path, two_rooms):
    """A net that takes all for a wall gets a bare wall right, most of the next view, least where most things are."""
    shown, home = [], demo.draw.home
    monkeypatch.setattr(demo.draw, "home", lambda *args: shown.append(args[-1]) or home(*args))
    g, grid = np.random.default_rng(0), demo.PlaceGrid(two_rooms)
    net = {name: np.zeros_like(weights) for name, weights in demo.segnet.new_params(g).items()}
    net["head.b"].reshape(N_CLASSES, -1)[WALL] = 1
    senses = demo.Senses(two_rooms, net, demo.gcn.GCN(grid.n_places, g, hidden=8))
    starts = np.array([[2.9, 2.9, 1.3], [4.8, 1.6, -2.3], [4.3, 1.5, 3.1]])
    _, true = demo.render(two_rooms, starts, np.random.default_rng(0), 64, senses.noise)
    walls, n_things = (true == WALL).mean((1, 2)), np.diff(demo.scene_graph(true).starts)
    assert walls[0] > walls[1] > walls.mean() > walls[2]
    assert n_things[0] < n_things[1] < n_things[2]
    demo.draw_stages(tmp_path, senses, grid, starts, g)
    np.testing.assert_array_equal(shown, starts[1:2])


@pytest.mark.parametrize(("episodes", "shown"), [
    (["01100", "00011", "00111"], "00011"),  # wrong, wrong, ..., right, right: that one, though others come after it
    (["00000", "11111", "00001", "01110"], "00001"), (["00010", "11000", "00000"], "00010"), (["10000"], "10000"),
    (["10010", "01000"], "01000")])  # where none ends well, doubt at first is worth more than all between
def test_the_episode_that_is_shown_begins_in_doubt_and_ends_well_if_any_does(monkeypatch, episodes, shown):
    def collect(_senses, _robot, _grid, _plan, start, seed, _store):
        assert seed == [7, episodes.index(start)]
        return [SimpleNamespace(answer=int(right), place=1, of=start) for right in start]

    monkeypatch.setattr(demo.replay, "collect", collect)
    grid = SimpleNamespace(location_of=lambda place: place)
    looks = demo.telling_episode(None, None, grid, None, episodes, 7, lambda share: None)
    assert looks[0].of == shown


def test_an_answer_that_moves_to_the_robot_is_shown_rather_than_a_robot_that_moves_to_the_answer(monkeypatch):
    def collect(_senses, _robot, _grid, _plan, start, seed, _store):
        return [SimpleNamespace(answer=answer, place=place, of=start) for answer, place in zip(*start, strict=True)]

    monkeypatch.setattr(demo.replay, "collect", collect)
    grid = SimpleNamespace(location_of=lambda place: place // 12)
    stays, moves = ((13, 13, 14, 14), (1, 2, 14, 14)), ((13, 13, 14, 1), (1, 2, 3, 1))
    looks = demo.telling_episode(None, None, grid, None, [stays, moves], 7, lambda share: None)
    assert looks[0].of == moves


def test_the_table_holds_accuracies_and_their_differences_in_pairs(capsys):
    right = np.random.default_rng(0).random((3, 50, 5)) < np.array([0.4, 0.5, 0.6])[:, None, None]
    right[:, :, 0] = right[0, :, 0]
    methods = ("MV", "Scan", "Ours")
    demo.print_table({name: SimpleNamespace(correct=r) for name, r in zip(methods, right, strict=True)})
    lines = capsys.readouterr().out.splitlines()
    last = {"SV": 100 * right[0, :, 0].mean(), "MV": 100 * right[0, :, -1].mean(),
            "Scan": 100 * right[1, :, -1].mean(), "Ours": 100 * right[2, :, -1].mean()}
    assert [line.split()[0] for line in lines[1:]] == list(last)
    for line in lines[1:]:
        name, *numbers = re.findall(r"[A-Z]\w+|[+-]?\d+\.\d", line)
        shares, (a, b, mean, low, high) = numbers[:-5], numbers[-5:]
        assert float(shares[-1]) == pytest.approx(last[name], abs=0.05)
        assert len(shares) == (1 if name == "SV" else 5)
        assert float(mean) == pytest.approx(last[a] - last[b], abs=0.051)
        assert float(low) < float(mean) < float(high)


def a_song(path):
    path.write_text("la la la")


def missing(path):
    pass


def folder(path):
    path.mkdir()


def other_arrays(path):
    save_arrays(path, {}, weights=np.zeros(3))


def small_views(path):
    save_arrays(path, {}, rgb=np.zeros((8, 32, 32, 3), np.uint8), labels=np.zeros((8, 32, 32), np.uint8))


def unlike_views(path):
    save_arrays(path, {}, rgb=np.zeros((8, 64, 64, 3), np.uint8), labels=np.zeros((7, 64, 64), np.uint8))


def views_of_homes_in_words(path):
    rgb = np.zeros((8, 64, 64, 3), np.uint8)
    save_arrays(path, {"homes": "forty"}, rgb=rgb, labels=rgb[..., 0])


def views_of_eleven_classes(path):
    save_arrays(path, {}, rgb=np.zeros((8, 64, 64, 3), np.uint8), labels=np.full((8, 64, 64), 10, np.uint8))


def assert_one_line(capsys, arguments, *words):
    """Status 2 and one line on stderr."""
    with pytest.raises(SystemExit) as exit:
        main(["demo", *SMALLEST, *map(str, arguments)])
    err = capsys.readouterr().err
    assert exit.value.code == 2
    assert err.startswith("python -m gnl: ")
    assert err.count("\n") == 1
    for word in words:
        assert word in err


@pytest.mark.parametrize("option", ["--tests 0", "--tests 1", "--noise -1", "--noise nan", "--noise 11", "--seed -1",
                                    "--episodes 0", "--net-epochs 0", "--gcn-views 0", "--gcn-epochs 0",
                                    "--gcn-batch 0", "--scan-starts -3"])
def test_an_option_that_cannot_be_is_named(tmp_path, capsys, option):
    name, value = option.split()
    assert_one_line(capsys, ["--plan", FLAT, "--views", tmp_path / "v", "--out", tmp_path / "out", name, value],
                    f"{name}: expected ", f", found {value}")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("option", ["--out", "--pictures"])
def test_a_file_in_the_place_of_a_folder_is_named_before_anything_is_learned(tmp_path, capsys, option):
    (tmp_path / "file").write_text("la la la")
    assert_one_line(capsys, ["--plan", FLAT, "--views", tmp_path / "v", option, tmp_path / "file"],
                    f"{option}: expected a folder, found the file {tmp_path / 'file'}")


@pytest.mark.parametrize("option", ["--out", "--pictures"])
def test_a_folder_without_a_name_is_none(tmp_path, capsys, option):
    assert_one_line(capsys, ["--plan", FLAT, "--views", tmp_path / "v", option, ""],
                    f"{option}: expected a folder, found no name")


@pytest.mark.parametrize("make", [a_song, missing, folder], ids=lambda make: make.__name__)
def test_a_plan_that_is_none_is_named(tmp_path, capsys, make):
    make(tmp_path / "plan")
    assert_one_line(capsys, ["--plan", tmp_path / "plan", "--views", tmp_path / "v", "--out", tmp_path / "out"],
                    f"{tmp_path / 'plan'}: expected ")
    assert not (tmp_path / "out").exists()


def test_a_home_that_the_net_learns_from_is_refused(views, tmp_path, capsys):
    plan = tmp_path / "plan.json"
    make_home(1).save(plan)  # the views are of homes 0 and 1
    assert_one_line(capsys, ["--plan", plan, "--views", views, "--out", tmp_path / "out"],
                    f"{plan}: expected a home that the net does not learn from (HOUSE from 2 on), found home-1")
    assert not (tmp_path / "out").exists()


def test_the_first_home_that_the_net_does_not_learn_from_is_taken(views, tmp_path, monkeypatch):
    class Begun(Exception):
        """All has been looked through, and the net begins to learn."""

    def begin(*_):
        raise Begun

    monkeypatch.setattr(parts_learned, "segmentation_net", begin)
    args = SimpleNamespace(plan="plan.json", views=views, out=tmp_path, seed=0)
    with pytest.raises(Begun):  # the views are of homes 0 and 1
        demo.learn(args, demo.Scale(), None, make_home(2), None, None)


@pytest.mark.parametrize("make", [a_song, missing, folder, other_arrays, small_views, unlike_views,
                                  views_of_homes_in_words, views_of_eleven_classes], ids=lambda make: make.__name__)
def test_views_that_are_none_are_named(tmp_path, capsys, make):
    make(tmp_path / "views")
    assert_one_line(capsys, ["--plan", FLAT, "--views", tmp_path / "views", "--out", tmp_path / "out"],
                    f"{tmp_path / 'views'}: expected ")
    assert not (tmp_path / "out").exists()
