"""The terminal: one line for each stage of a run, one clear line for what cannot be done."""

import multiprocessing
import signal
import sys
import time


class Stage:
    """A line on the terminal that lives while a stage runs; where there is no terminal, only its end is printed."""

    def __init__(self, name, stream=None):
        self.name, self.stream = name, stream or sys.stdout
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
        if self.stream.isatty():
            self.stream.write(f"\r\x1b[K{self.name:<8} {text}")
            self.stream.flush()

    def done(self, text):
        """Fix the line: the result and the time."""
        start = "\r\x1b[K" if self.stream.isatty() else ""
        self.stream.write(f"{start}{self.name:<8} {text:<76} {self.seconds:5.1f} s\n")
        self.stream.flush()


def second_process():
    """A pool of one process beside this one, for use in a with statement; an interruption ends it too."""
    # Spawned, not forked: it must not inherit half a computation. Ctrl-C is for the first process to handle.
    return multiprocessing.get_context("spawn").Pool(1, signal.signal, (signal.SIGINT, signal.SIG_IGN))


def guarded(program, run, *args):
    """run(*args) for the command line: a user's mistake is one line on stderr and exit status 2, no traceback."""
    try:
        run(*args)
        status = 0
    except (ValueError, OSError) as error:
        print(f"{program}: {error}".replace("\n", " "), file=sys.stderr)
        status = 2
    except KeyboardInterrupt:
        print(f"{program}: interrupted; what was finished is kept", file=sys.stderr)
        status = 130
    sys.exit(status)
