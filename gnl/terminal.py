"""The terminal: one line for each stage of a run, one clear line for what cannot be done."""

import argparse
import multiprocessing
import os
import signal
import sys
import threading
import time
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module

CLEAR = "\r\x1b[K"  # back to the start of a terminal's line, and wipe it


class Parser(argparse.ArgumentParser):
    """A parser of command lines that complains in one line, and accepts options by their full names only."""

    def __init__(self, **options):
        super().__init__(allow_abbrev=False, **options)

    def error(self, message):
        """End with exit status 2."""
        self.exit(2, f"{self.prog}: {message} (see --help)\n")


def command_line(program, description, commands, argv=None):
    """Run the command that the words `argv` name, one of {name: (module, what it does)}.

    The module's add_arguments(parser) and run(args) are the command. The other modules are not imported: with SciPy
    and all that draws, a program, or a process that it starts, would take most of a second to begin.
    """
    argv = sys.argv[1:] if argv is None else argv
    parser = Parser(prog=program, description=description)
    parsers = parser.add_subparsers(required=True, metavar="COMMAND")

    def run():
        for name, (module, words) in commands.items():
            command = parsers.add_parser(name, help=words)
            if name in argv:
                module = import_module(module)
                module.add_arguments(command)
                command.set_defaults(run=module.run)
        args = parser.parse_args(argv)
        args.run(args)

    guarded(program, run)


def count(n, noun):
    """A number of things in words: 1 node, 2 nodes."""
    return f"{n} {noun}" + "s" * (n != 1)


def _clear(stream):
    """What wipes the last line of a stream; nothing where there is no terminal, or a dumb one."""
    return CLEAR if stream.isatty() and os.environ.get("TERM") != "dumb" else ""


class Stage:
    """A line on the terminal that lives while a stage runs; where there is no terminal, only its end is printed."""

    def __init__(self, name, stream=None):
        self.name, self.stream = name, stream or sys.stdout
        self.clear = _clear(self.stream)
        self.start, self.shown = time.perf_counter(), 0.0
        self.note("...")

    @property
    def seconds(self):
        """Since the stage began."""
        return time.perf_counter() - self.start

    def __call__(self, share, text=""):
        """Show the share done, 0..1, and a few words; at most five times a second."""
        if self.seconds - self.shown > 0.2 and share > 0:
            self.shown = self.seconds
            self.note(f"{share:4.0%}  {self.seconds:4.0f} s, {self.seconds * (1 / share - 1):.0f} s to go  {text}")

    def note(self, text):
        """Replace the line's text."""
        if self.clear:
            self.stream.write(f"{self.clear}{self.name:<8} {text}")
            self.stream.flush()

    def done(self, text):
        """Finish the line with the result and the time."""
        self.stream.write(f"{self.clear}{self.name:<8} {text:<76} {self.seconds:5.1f} s\n")
        self.stream.flush()


@contextmanager
def processes(n):
    """An executor of n processes beside this one, for use in a with statement; whatever ends this one ends them too.

    They only compute. Files are written by this process, so that nothing is left half-done where another one is ended.
    """
    here = signal.signal(signal.SIGINT, signal.SIG_IGN)  # inherited: Ctrl-C is for the first process to handle
    try:
        # Spawned, not forked: they must not inherit half a computation.
        pool = ProcessPoolExecutor(n, multiprocessing.get_context("spawn"), _end_with_the_first)
        for _ in range(n):
            pool.submit(int)  # a process is started when there is work and none is free
    finally:
        signal.signal(signal.SIGINT, here)
    try:
        yield pool
    except BaseException as error:
        if not isinstance(error, BrokenExecutor):
            # Older Pythons wait for ever to send the rest of a large job to processes that are no more (gh-94777).
            pool._call_queue._reader.close()
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def executor(n_processes, address=None):
    """Where jobs run: in n_processes beside this one, or on the cluster of a dask scheduler."""
    if address is None:
        with processes(n_processes) as pool:
            yield pool
        return
    try:
        from dask.distributed import Client
    except ImportError:
        raise ValueError("--dask: expected dask to be installed, pip install -e '.[cluster]'; found none") from None
    try:
        client = Client(address)
    except (ValueError, OSError) as error:
        raise ValueError(f"--dask: expected the address of a scheduler, found {address!r} ({error})") from None
    with client:
        try:
            client.submit(_is_there).result()
        except Exception as error:  # of whatever kind: it comes from another machine
            raise ValueError("--dask: expected a scheduler and workers whose Python has gnl, of this version, found "
                             f"{type(error).__name__}: {error}") from None
        yield client.get_executor()


def _is_there():
    """For a cluster to call: a worker that can has gnl."""
    return True


def _end_with_the_first():
    """Let a process end when the one that started it is no more, even by kill -9."""
    def watch():
        multiprocessing.parent_process().join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def guarded(program, run, *args):
    """run(*args) for the command line: a user's mistake is one line on stderr and exit status 2, no traceback."""
    # A kill, too, ends the run through its with statements.
    signal.signal(signal.SIGTERM, lambda number, _frame: sys.exit(128 + number))
    status, line = 0, None
    try:
        run(*args)
    except BrokenPipeError:  # whoever reads the output has read enough: `... | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(128 + signal.SIGPIPE)
    except (ValueError, OSError, MemoryError) as error:
        status, line = 2, str(error).replace("\n", " ")
    except ModuleNotFoundError as error:
        if not error.name or error.name.partition(".")[0] in (__package__, "data_gen"):
            raise
        status, line = 2, f"expected {error.name} to be installed, as `make` does in .venv, found none"
    except BrokenExecutor:
        status, line = 1, "a process beside this one was ended from outside; what was finished is kept"
    except KeyboardInterrupt:
        status, line = 128 + signal.SIGINT, "interrupted; what was finished is kept"
    if status:
        print(end=_clear(sys.stdout), flush=True)
        print(f"{program}: {line}", file=sys.stderr)
    sys.exit(status)
