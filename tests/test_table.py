"""The table at its smallest: the same bytes with one process, with two, after kills, on a cluster; and its refusals."""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import Future
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import begun_by_make, full_disk

from gnl import files, learned, segnet, table
from gnl.__main__ import main
from gnl.experiment import Cell, load_cell

TINIEST = table.Settings(episodes=10, tests=12, validation=2, net_homes=1, net_views=120, net_epochs=4, gcn_views=1200,
                          gcn_epochs=12, gcn_rate=0.01)
OPTIONS = ["--quick", "--worlds", "800", "801", "--gaps", "1.0/90", "--noise", "0.5"]
NAMES = ["800-1m-90deg-seed0", "801-1m-90deg-seed0"]


def command(out, *options):
    code = f"from gnl import table; table.QUICK = table.{TINIEST}; from gnl.__main__ import main; main()"
    return [sys.executable, "-W", "error", "-c", code, "table", *OPTIONS, "--out", str(out), *map(str, options)]


def run(out, *options):
    """A run to its end: exit status, output."""
    done = subprocess.run(command(out, *options), capture_output=True, text=True, timeout=200)
    return SimpleNamespace(status=done.returncode, out=done.stdout, err=done.stderr)


def cells(out):
    """Bytes of the finished cells."""
    return {path.name: path.read_bytes() for path in sorted((out / "cells").glob("[!.]*"))}


@pytest.fixture(autouse=True)
def tiniest(monkeypatch):
    """The same settings for the command in this process."""
    monkeypatch.setattr(table, "QUICK", TINIEST)


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """A run with one process that nobody disturbed."""
    out = tmp_path_factory.mktemp("table") / "one"
    done = run(out, "--jobs", 1)
    assert (done.status, done.err) == (0, "")
    return SimpleNamespace(folder=out, cells=cells(out), out=done.out)


@pytest.fixture
def prepared(reference, tmp_path):
    """A folder with homes, starts, net and GCN, but no cell yet."""
    out = tmp_path / "out"
    shutil.copytree(reference.folder, out, ignore=shutil.ignore_patterns("cells", "costs"))
    return out


def test_every_cell_is_a_file_with_all_that_is_needed_to_judge_it(reference):
    assert list(reference.cells) == [f"{name}.json" for name in NAMES]
    for name, data in reference.cells.items():
        result = json.loads(data)
        assert Cell(**result["cell"]).name == name.removesuffix(".json")
        assert len(result["sequence"]) == 4
        assert result["settings"]["noise"] == 0.5
        assert len(result["checkpoints"]) == len(result["validation"]) == 10
        for outcome, n in [(o, TINIEST.tests) for o in (*result["tests"].values(), *result["checkpoints"])] + [
                (o, TINIEST.validation) for o in result["validation"]]:
            assert [len(look) for look in outcome["place"]] == [n] * 5
            for right, where in zip(outcome["place"], outcome["location"], strict=True):
                assert set(right) <= {"0", "1"}
                assert all(w == "1" for r, w in zip(right, where, strict=True) if r == "1")  # who knows both knows one
        net, = reference.folder.glob("learned/net-*.npz")
        assert result["made from"]["net"] == learned.fingerprint(segnet.load(net)[0])
        beside = json.loads((reference.folder / "costs" / name).read_bytes())
        assert {"seconds", "views", "versions", "host", "peak MB"} <= beside.keys()
        assert beside["of training"]["views"] == 5 * TINIEST.episodes
        assert "labels" in beside["of stages"]


def test_some_answers_are_right_so_that_equal_bytes_say_something(reference):
    for data in reference.cells.values():
        result = json.loads(data)
        outcomes = *result["tests"].values(), *result["checkpoints"], *result["from training starts"].values()
        assert {"0", "1"} == set("".join(outcome["place"][-1] for outcome in outcomes))


def test_the_first_look_is_the_same_for_all_methods(reference):
    for data in reference.cells.values():
        result = json.loads(data)
        first = {outcome["place"][0] for outcome in (*result["tests"].values(), *result["checkpoints"])}
        assert len(first) == 1


def test_two_processes_give_the_same_bytes_however_often_they_are_killed(reference, tmp_path):
    """From nothing, killed as soon as a stage has left something, and early and late in the cells."""
    out = tmp_path / "out"
    for stage in ("data/home-801*", "learned/net*", "learned/gcn*", "costs/*", "cells/801*"):
        process = subprocess.Popen(command(out, "--jobs", 2), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            while not list(out.glob(stage)) and process.poll() is None:
                time.sleep(0.01)
        finally:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        assert cells(out).items() <= reference.cells.items()
    done = run(out, "--jobs", 2)
    assert (done.status, done.err) == (0, "")
    assert cells(out) == reference.cells


def test_a_second_run_has_nothing_to_do(reference, capsys):
    before = {path: path.stat().st_mtime_ns for path in reference.folder.glob("cells/*")}
    assert main_here(reference.folder, "--jobs", 8) == 0
    assert capsys.readouterr() == (f"2 cells in {reference.folder / 'cells'}\n", "")
    assert before == {path: path.stat().st_mtime_ns for path in reference.folder.glob("cells/*")}


def test_a_cluster_gives_the_same_bytes(reference, prepared):
    from dask.distributed import LocalCluster

    with LocalCluster(n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster:
        main_here(prepared, "--dask", cluster.scheduler_address)
    assert cells(prepared) == reference.cells


def test_a_cell_without_its_costs_is_done_again(reference, done):
    (done / "costs" / f"{NAMES[0]}.json").unlink()
    assert main_here(done, "--jobs", 1) == 0
    assert (done / "costs" / f"{NAMES[0]}.json").exists()
    assert cells(done) == reference.cells


def main_here(out, *options):
    """The command in this process: its exit status."""
    with pytest.raises(SystemExit) as exit:
        main(["table", *OPTIONS, "--out", str(out), *map(str, options)])
    return exit.value.code


@pytest.fixture
def done(reference, prepared):
    """A folder in which all is done."""
    for folder in ("cells", "costs"):
        shutil.copytree(reference.folder / folder, prepared / folder)
    return prepared


def test_a_damaged_cell_is_named_set_aside_and_done_again(reference, done, capsys):
    damaged = done / "cells" / f"{NAMES[1]}.json"
    damaged.write_bytes(reference.cells[damaged.name][:100])
    assert main_here(done, "--jobs", 1) == 0
    err = capsys.readouterr().err
    assert err.startswith(f"{damaged}: expected ")
    assert err.count("\n") == 1
    assert damaged.with_suffix(".damaged").read_bytes() == reference.cells[damaged.name][:100]
    assert damaged.read_bytes() == reference.cells[damaged.name]


@pytest.mark.parametrize(("kind", "change"), [
    ("cells", {"checkpoints": []}), ("cells", {"tests": {}}), ("cells", {"from training starts": {}}),
    ("cells", {"cell": {"world": "800", "t_xy_m": 1, "t_theta_deg": 90, "seed": 0}}),
    ("cells", {"cell": {"world": 800, "t_xy_m": 1, "t_theta_deg": "90", "seed": 0}}), ("costs", {"versions": []}),
    ("costs", {"machine": 5}), ("cells", {"validation": None}),
    ("cells", {"cell": {"world": 800, "t_xy_m": 1, "t_theta_deg": 70, "seed": 0}}), ("cells", {"cell": "800"}),
    ("cells", {"settings": {"tests": 13}}), ("costs", {"of stages": {}}), ("costs", {"seconds": "many"}),
    ("costs", {"seconds": 10 ** 400}), ("costs", {"versions": 3}), ("costs", {"views": 0})])
def test_no_damaged_file_is_taken_for_a_finished_cell_and_both_are_kept(done, capsys, kind, change):
    both = [done / folder / f"{NAMES[0]}.json" for folder in ("cells", "costs")]
    assert table.finished(done, NAMES[0], load_cell)
    damaged = done / kind / f"{NAMES[0]}.json"
    files.save_json(damaged, json.loads(damaged.read_bytes()) | change)
    there = damaged.read_bytes()
    assert not table.finished(done, NAMES[0], load_cell)
    what = {"cells": "outcomes", "costs": "costs"}[kind]
    assert capsys.readouterr().err.startswith(f"{damaged}: expected the {what} of a cell, found ")
    assert damaged.with_suffix(".damaged").read_bytes() == there
    assert all(file.with_suffix(".damaged").exists() and not file.exists() for file in both)


@pytest.mark.parametrize("change", [
    lambda mv: mv.pop("location"), lambda mv: mv["place"].pop(), lambda mv: mv["location"].append("01" * 6),
    lambda mv: mv.update(place=["x" * 12] * 5), lambda mv: mv.update(place=["0" * 11] * 5, location=["0" * 11] * 5)],
    ids=["no location", "four looks", "six looks", "neither right nor wrong", "fewer episodes"])
def test_no_outcome_that_the_report_could_not_read_is_taken_for_one(done, capsys, change):
    path = done / "cells" / f"{NAMES[0]}.json"
    result = json.loads(path.read_bytes())
    change(result["tests"]["MV"])
    files.save_json(path, result)
    assert not table.finished(done, NAMES[0], load_cell)
    assert capsys.readouterr().err.startswith(f"{path}: expected the outcomes of a cell, found ")


@pytest.mark.parametrize("change", [
    lambda starts: starts.pop("tests"), lambda starts: starts.update(tests=starts["tests"][:1]),
    lambda starts: starts.update(training=starts["training"] * np.nan),
    lambda starts: starts.update(training=starts["training"].astype(str))], ids=["none", "one", "no numbers", "words"])
def test_starts_that_are_not_those_of_the_settings_are_named(prepared, capsys, change):
    path = prepared / "data" / f"starts-{NAMES[0]}.npz"
    starts, made_by = files.load_arrays(path)
    change(starts)
    files.save_arrays(path, made_by, **starts)
    assert main_here(prepared, "--jobs", 1) == 2
    assert f"python -m gnl: {path}: expected start poses " in capsys.readouterr().err


def test_a_home_of_another_name_is_refused(prepared, capsys):
    path = prepared / "data" / "home-800.json"
    shutil.copy(prepared / "data" / "home-801.json", path)
    assert main_here(prepared, "--jobs", 1) == 2
    assert f"python -m gnl: {path}: expected home-800, found home-801" in capsys.readouterr().err


def test_a_finished_cell_of_another_net_is_refused_before_others_are_begun(done, capsys):
    other, lacking = (done / "cells" / f"{name}.json" for name in ("800-1m-90deg-seed0", "800-1m-90deg-seed1"))
    found = json.loads(other.read_bytes())
    files.save_json(other, found | {"made from": found["made from"] | {"net": "12345678"}})
    with pytest.raises(SystemExit) as exit:
        main(["table", *OPTIONS, "--out", str(done), "--jobs", "1", "--repeats", "2"])
    assert exit.value.code == 2
    expected, there = capsys.readouterr().err.split(", as new ones are, found one made from ")
    assert f"{other}: expected a cell made from " in expected
    assert f"'net': '{found['made from']['net']}'" in expected
    assert "'net': '12345678'" in there
    assert not lacking.exists()


def test_a_finished_cell_of_other_settings_is_refused_even_where_the_folder_does_not_tell(done, capsys):
    (done / "settings.json").unlink()
    assert main_here(done, "--tests", 7) == 2
    path = done / "cells" / f"{NAMES[0]}.json"
    assert capsys.readouterr().err == (f"python -m gnl: {path}: expected results of tests 7, found some of 12; "
                                       "name another folder with --out\n")
    assert not (done / "settings.json").exists()


@pytest.mark.parametrize(("options", "words"), [
    (["--worlds", "17"], "--worlds: expected seeds of homes, 800 or more, found '17'"),
    (["--worlds", "\u00b2"], "--worlds: expected seeds of homes, 800 or more, found '\u00b2'"),
    (["--worlds", "kitchen"], "--worlds: expected seeds of homes, 800 or more, found 'kitchen'"),
    (["--worlds", "800", "801", "0800"], "--worlds: expected each once, found 800 801 0800"),
    (["--gaps", "0.2/10", "1.0/90", "0.2/10"], "--gaps: expected each once, found 0.2/10 1.0/90 0.2/10"),
    (["--gaps", "0.3/10"], "found '0.3/10'"), (["--gaps", "near"], "found 'near'"),
    (["--jobs", "0"], "--jobs: expected at least 1, found 0"), (["--jobs", "-2"], "found -2"),
    (["--episodes", "9"], "--episodes: expected at least 10, found 9"),
    (["--episodes", "25"], "--episodes: expected a multiple of 10, found 25"),
    (["--tests", "1"], "--tests: expected at least 2, found 1"), (["--seed", "-1"], "--seed: expected at least 0"),
    (["--repeats", "0"], "--repeats: expected at least 1, found 0"), (["--noise", "-1"], "--noise: expected 0..10")])
def test_an_option_that_cannot_be_is_one_line_and_nothing_is_written(tmp_path, capsys, options, words):
    assert main_here(tmp_path / "out", *options) == 2
    err = capsys.readouterr().err
    assert err.startswith("python -m gnl: --")
    assert words in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_results_of_other_settings_are_refused_by_the_name_of_the_setting(reference, capsys):
    assert main_here(reference.folder, "--episodes", "30") == 2
    err = capsys.readouterr().err
    assert "expected results of episodes 30, found some of 10" in err
    assert err.count("\n") == 1
    assert cells(reference.folder) == reference.cells


@pytest.mark.parametrize("damage", [b"", b"[1]", b'{"episodes": 10'])
def test_damaged_settings_are_named(tmp_path, capsys, damage):
    (tmp_path / "settings.json").write_bytes(damage)
    assert main_here(tmp_path) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"python -m gnl: {tmp_path / 'settings.json'}: expected settings, found ")
    assert err.count("\n") == 1
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [damage]


class AtOnce:
    """An executor that does what it is told before it answers."""

    def submit(self, function):
        future = Future()
        try:
            future.set_result(function())
        except ArithmeticError as error:
            future.set_exception(error)
        return future


def test_what_is_finished_is_kept_though_others_failed(tmp_path):
    jobs = [*((f"bad {i}", lambda: 1 / 0) for i in range(9)), ("good", lambda: ({"name": "good"}, {}))]
    with pytest.raises(ZeroDivisionError):
        table.run_jobs(tmp_path, jobs, 10, AtOnce(), "table")
    assert {path.name for path in tmp_path.glob("*/*")} == {"good.json"}


def test_what_is_finished_is_kept_though_the_next_job_cannot_be_made(tmp_path):
    def jobs():
        yield "good", lambda: ({"name": "good"}, {})
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        table.run_jobs(tmp_path, jobs(), 10, AtOnce(), "table")
    assert {path.name for path in tmp_path.glob("*/*")} == {"good.json"}


def test_what_is_finished_is_written_while_the_next_job_is_made(tmp_path):
    def jobs():
        yield "good", lambda: ({"name": "good"}, {})
        written.extend(path.name for path in tmp_path.glob("*/*"))
        yield "other", lambda: ({"name": "other"}, {})

    written = []
    table.run_jobs(tmp_path, jobs(), 10, AtOnce(), "table")
    assert written == ["good.json", "good.json"]  # outcomes and costs


def test_the_speed_that_is_shown_is_of_the_cells_done_since_the_stage_began(tmp_path, monkeypatch):
    class AtOnceOrSoon(AtOnce):
        def submit(self, function):
            if function():
                return super().submit(function)
            future = Future()
            threading.Timer(0.2, future.set_result, [({}, {})]).start()
            return future

    class Shown(list):
        seconds, note, done = 2.0, list.append, list.append

        def __call__(self, *words):
            self.append(words)

    monkeypatch.setattr(table, "Stage", lambda _: shown)
    shown = Shown()
    table.run_jobs(tmp_path, [("now", lambda: ({}, {})), ("soon", lambda: None)], 10, AtOnceOrSoon(), "table")
    assert list(dict.fromkeys(shown)) == ["1 of 2 cells", (0, "1 of 2 cells, 0 episodes/s"),
                                          "2 cells of 10 episodes each"]


def test_a_folder_that_holds_nothing_yet_takes_other_settings(tmp_path):
    table.agree(tmp_path, {"tests": 7})
    (tmp_path / "settings.json").write_text('{"tests": 12}')
    table.agree(tmp_path, {"tests": 7})
    for there in "cells/a.json", "data/starts-a.npz":
        (tmp_path / there).parent.mkdir()
        (tmp_path / there).write_text("")
        with pytest.raises(ValueError, match="expected results of tests 7, found some of 12"):
            table.agree(tmp_path, {"tests": 7})
        (tmp_path / there).unlink()


@pytest.mark.parametrize(("name", "gap"), [("1.0/90", (1.0, 90)), ("1/90", (1.0, 90)), ("0.2/10", (0.2, 10))])
def test_a_gap_is_known_by_its_name_and_as_files_name_it(name, gap):
    assert table.gap_of(name) == gap


def test_the_quick_table_is_two_cells_of_one_home():
    args = SimpleNamespace(worlds=table.WORLDS, gaps=None, episodes=None, tests=None, noise=None, seed=0, repeats=1,
                           jobs=1, quick=True)
    settings, cells = table.check(args)
    assert settings == table.QUICK
    assert cells == [Cell(800, 0.2, 10, 0), Cell(800, 1.0, 90, 0)]


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nowhere"])
def test_where_nobody_listens_is_one_line(prepared, capsys, address):
    import dask.distributed

    with dask.config.set({"distributed.comm.timeouts.connect": "200ms"}):
        assert main_here(prepared, "--dask", address) == 2
    err = capsys.readouterr().err
    assert f"--dask: expected the address of a scheduler, found '{address}'" in err
    assert err.count("\n") == 1


def test_a_cluster_that_lacks_gnl_is_one_line(prepared, capsys, monkeypatch):
    import dask.distributed

    class Client(contextlib.nullcontext):
        def submit(self, function):
            future = Future()
            future.set_exception(ModuleNotFoundError("No module named 'gnl'"))
            return future

    monkeypatch.setattr(dask.distributed, "Client", lambda address: Client())
    assert main_here(prepared, "--dask", "tcp://127.0.0.1:9") == 2
    err = capsys.readouterr().err
    assert err == ("python -m gnl: --dask: expected a scheduler and workers whose Python has gnl, of this version, "
                   "found ModuleNotFoundError: No module named 'gnl'\n")


def test_a_folder_without_a_name_is_refused(capsys):
    assert main_here("") == 2
    assert capsys.readouterr().err == "python -m gnl: --out: expected a folder, found no name\n"


def test_a_full_disk_is_one_line_and_nothing_is_lost(reference, prepared, capsys, monkeypatch):
    """One cell was finished before; of the other no byte can be written."""
    write, (first, _) = files.write_whole, reference.cells
    for folder in ("cells", "costs"):
        (prepared / folder).mkdir()
        shutil.copy(reference.folder / folder / first, prepared / folder)

    def full(path, data):
        with monkeypatch.context() as disk:
            if path.parent.name == "cells":
                disk.setattr(files.os, "fdopen", full_disk)
            write(path, data)

    monkeypatch.setattr(files, "write_whole", full)
    assert main_here(prepared, "--jobs", 1) == 2
    err = capsys.readouterr().err
    assert f"No space left on device: '{prepared / 'cells' / NAMES[1]}.json'" in err
    assert err.count("\n") == 1
    assert cells(prepared) == {first: reference.cells[first]}
    monkeypatch.setattr(files, "write_whole", write)
    assert main_here(prepared, "--jobs", 1) == 0
    assert cells(prepared) == reference.cells


@pytest.mark.parametrize(("words", "folder"), [([], "out/table"), (["ARGS=--quick"], "out/table-quick"),
                                               (["ARGS=--quick", "TABLE=out/mine"], "out/mine")])
def test_make_keeps_a_quick_table_apart_from_the_whole_and_reports_on_what_it_made(words, folder):
    begun = begun_by_make(*words, "table")
    assert [argv[:5] for argv in begun] == [["-m", "gnl", command, "--out", folder] for command in ("table", "report")]


def test_make_table_takes_its_folder_from_one_place_alone():
    with pytest.raises(subprocess.CalledProcessError) as error:
        begun_by_make("ARGS=--quick --out here", "table")
    assert 'ARGS: expected no --out, found "--quick --out here"; name the folder with TABLE=' in error.value.stderr


def test_the_whole_table_is_75_cells_and_repeats_multiply_it():
    args = SimpleNamespace(worlds=table.WORLDS, gaps=None, episodes=None, tests=None, noise=None, seed=3, repeats=2,
                           jobs=1, quick=False)
    settings, cells = table.check(args)
    assert settings == table.Settings()
    assert len(set(cells)) == 150
    assert {cell.world for cell in cells} == {800, 801, 809}
    assert {cell.seed for cell in cells} == {3, 4}
    assert len({(cell.t_xy_m, cell.t_theta_deg) for cell in cells}) == 25


def test_no_noise_is_a_noise_that_can_be_asked_for():
    args = SimpleNamespace(worlds=table.WORLDS, gaps=None, episodes=None, tests=None, noise=0.0, seed=0, repeats=1,
                           jobs=1, quick=True)
    assert table.check(args)[0].noise == 0
