"""The terminal: a line a stage, one line for a mistake, and nothing more when the user has had enough."""

import contextlib
import io
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import heed_ctrl_c

from gnl import terminal
from gnl.terminal import Stage, guarded, processes

ERASE = "\r\x1b[K"  # to the start of the line, clear it


@pytest.fixture(autouse=True)
def no_dumb_terminal(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")


class Terminal(io.StringIO):
    def isatty(self):
        return True

    def screen(self):
        """What one sees: of each line that which was written after it was last erased."""
        return [line.rpartition(ERASE)[2] for line in self.getvalue().split("\n")]


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand: clock.now [s]."""
    clock = SimpleNamespace(now=100.0)
    monkeypatch.setattr(terminal, "time", SimpleNamespace(perf_counter=lambda: clock.now))
    return clock


def test_where_there_is_no_terminal_only_the_end_of_a_stage_is_printed(clock):
    stream = io.StringIO()
    stage = Stage("net", stream)
    clock.now += 12.0
    stage(0.5, "loss 0.31")
    assert stream.getvalue() == ""
    clock.now += 4.0
    stage.done("91% right")
    assert stream.getvalue() == "net      " + "91% right".ljust(76) + "  16.0 s\n"


def test_on_a_dumb_terminal_only_the_end_of_a_stage_is_printed(clock, monkeypatch):
    monkeypatch.setenv("TERM", "dumb")
    stream = Terminal()
    stage = Stage("net", stream)
    clock.now += 12.0
    stage(0.5, "loss 0.31")
    stage.done("91% right")
    assert stream.getvalue() == "net      " + "91% right".ljust(76) + "  12.0 s\n"


def test_on_a_terminal_a_stage_shows_how_far_it_is_and_leaves_one_line(clock):
    stream = Terminal()
    stage = Stage("net", stream)
    assert stream.screen() == ["net      ..."]
    clock.now += 2.0
    stage(0.25, "loss 0.31")
    assert stream.screen() == ["net       25%     2 s, 6 s to go  loss 0.31"]
    stage.done("91% right")
    assert stream.screen() == ["net      " + "91% right".ljust(76) + "   2.0 s", ""]


def test_a_live_line_changes_at_most_five_times_a_second(clock):
    stream = Terminal()
    stage = Stage("net", stream)
    for i in range(1000):
        clock.now += 0.001
        stage((i + 1) / 1000)
    assert 4 <= stream.getvalue().count("to go") <= 5


def test_a_stage_of_which_nothing_is_done_names_no_time_to_go(clock):
    stream = Terminal()
    stage = Stage("net", stream)
    clock.now += 1.0
    stage(0.0)
    assert stream.screen() == ["net      ..."]


def test_a_stage_speaks_on_stdout(capsys):
    Stage("net").done("91% right")
    assert capsys.readouterr().out.startswith("net      91% right")


def stop(error):
    raise error


def leave(run, *args):
    """Exit status of a guarded run."""
    with pytest.raises(SystemExit) as exit:
        guarded("python -m gnl", run, *args)
    return exit.value.code


def test_a_run_that_ends_well_has_status_0_and_says_nothing(capsys):
    heard = []
    assert leave(heard.append, "hello") == 0
    assert heard == ["hello"]
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("kind", [ValueError, OSError, FileNotFoundError, MemoryError])
def test_a_mistake_is_one_line_on_stderr_and_status_2(capsys, kind):
    assert leave(stop, kind("a.png: expected an image,\nfound\n\na song")) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("python -m gnl: a.png: expected an image, found ")
    assert err.endswith("a song\n")
    assert err.count("\n") == 1


def test_who_stops_listening_ends_the_run_with_the_status_of_a_broken_pipe():
    code = "from gnl.terminal import guarded; guarded('p', lambda: [print(i) for i in range(100_000)])"
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 128 + signal.SIGPIPE


@pytest.mark.parametrize("name", ["numpy", "PIL.Image"])
def test_a_library_that_is_lacking_is_named_in_one_line(capsys, name):
    assert leave(stop, ModuleNotFoundError("a long story", name=name)) == 2
    assert capsys.readouterr().err == (
        f"python -m gnl: expected {name} to be installed, as `make` does in .venv, found none\n")


def test_a_module_of_our_own_that_is_lacking_is_not_hidden():
    with pytest.raises(ModuleNotFoundError):
        guarded("python -m gnl", stop, ModuleNotFoundError("gnl.word", name="gnl.word"))


def test_what_was_printed_stands_before_the_last_words():
    code = "from gnl.terminal import guarded\ndef run(): print('net'); raise ValueError('a.png')\nguarded('p', run)"
    env = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    done = subprocess.run([sys.executable, "-c", code], env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True)
    assert done.stdout == "net\np: a.png\n"


def test_an_interruption_is_one_line_on_stderr_and_status_130(capsys):
    assert leave(stop, KeyboardInterrupt()) == 130
    out, err = capsys.readouterr()
    assert out == ""
    assert err == "python -m gnl: interrupted; what was finished is kept\n"


def test_a_fault_of_our_own_is_not_hidden():
    with pytest.raises(KeyError):
        guarded("python -m gnl", stop, KeyError("rgb"))


@pytest.mark.parametrize("end", [ValueError("a mistake"), KeyboardInterrupt()], ids=["mistake", "ctrl-c"])
def test_on_a_terminal_the_last_words_stand_on_a_line_of_their_own(monkeypatch, end):
    stream = Terminal()
    monkeypatch.setattr(sys, "stdout", stream)
    monkeypatch.setattr(sys, "stderr", stream)

    def run():
        Stage("net").note("25%")
        raise end

    leave(run)
    *_, words, after = stream.screen()
    assert words.startswith("python -m gnl: ")
    assert after == ""


def test_processes_work_beside_this_one_and_end_with_the_block():
    with processes(2) as pool:
        others = {process.pid for process in multiprocessing.active_children()}
        assert len(others) == 2
        assert pool.submit(os.getpid).result() in others - {os.getpid()}
    assert multiprocessing.active_children() == []


def test_work_that_has_not_begun_when_the_block_ends_is_never_begun():
    with processes(1) as pool:
        works = [pool.submit(time.sleep, 0.1) for _ in range(20)]
    assert works[-1].cancelled()


def test_ctrl_c_reaches_this_process_alone_from_the_moment_another_one_starts():
    here = signal.getsignal(signal.SIGINT)
    with processes(1) as pool:
        (process,) = multiprocessing.active_children()
        os.kill(process.pid, signal.SIGINT)
        assert pool.submit(os.getpid).result() == process.pid  # it still works
    assert signal.getsignal(signal.SIGINT) == here


def test_a_process_that_is_ended_from_outside_is_one_line():
    def run():
        with processes(1) as pool:
            work = pool.submit(time.sleep, 20)
            os.kill(multiprocessing.active_children()[0].pid, signal.SIGKILL)
            work.result()

    assert leave(run) == 1


RUN = """if True:
    import multiprocessing, time
    from gnl.terminal import guarded, processes

    def run():
        with processes(2) as pool:
            [pool.submit(int).result() for _ in range(9)]  # they are up
            works = WORKS
            print(*(process.pid for process in multiprocessing.active_children()), flush=True)
            for _ in range(400):  # a signal just before a sleep is handled after it
                time.sleep(0.05)

    guarded("test", run)"""


@pytest.mark.parametrize("works", [
    "[]", "[pool.submit(time.sleep, 20)]", "[pool.submit(time.sleep, 20) for _ in range(5)]",
    "pool.map(time.sleep, [20] * 500_000, chunksize=100_000)"], ids=["none", "one", "more", "too large for a pipe"])
@pytest.mark.parametrize("sign, status", [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGKILL, -9)])
def test_who_stops_this_process_stops_the_others_too_without_many_words(sign, status, works):
    with subprocess.Popen([sys.executable, "-c", RUN.replace("WORKS", works)], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, start_new_session=True,
                          preexec_fn=heed_ctrl_c) as process:
        others = [int(pid) for pid in process.stdout.readline().split()]
        try:
            process.send_signal(sign)
            assert process.wait(10) == status
            assert all(is_gone(pid) for pid in others)
            if sign != signal.SIGKILL:  # after that Python's own tracker of resources has a word to say
                said = "test: interrupted; what was finished is kept\n" if status == 130 else ""
                assert process.stderr.read() == said
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


def is_gone(pid, patience_s=5.0):
    """Whether a process ends by itself before long; one that is dead but not buried counts as gone."""
    end, file = time.monotonic() + patience_s, Path(f"/proc/{pid}/stat")
    while time.monotonic() < end:
        try:
            os.kill(pid, 0)
            if file.exists() and file.read_text().rpartition(")")[2].split()[0] == "Z":
                return True
        except (ProcessLookupError, FileNotFoundError):
            return True
        time.sleep(0.02)
    return False


@pytest.mark.parametrize(("threads", "wanted"), [(None, "1"), ("3", "3")])
def test_gnl_and_the_processes_beside_it_have_one_thread_of_blas_unless_told_otherwise(threads, wanted):
    code = ("import os; from gnl.terminal import processes\n"
            "if __name__ == '__main__':\n"
            "    name = 'OPENBLAS_NUM_THREADS'\n"
            "    with processes(1) as pool: print(os.environ[name], pool.submit(os.getenv, name).result())")
    env = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    env |= {"OPENBLAS_NUM_THREADS": threads} if threads else {}
    done = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, timeout=60)
    assert done.stdout.split() == [wanted, wanted]
