"""Grades a file of exercises: task by task, what was got, what was expected, and where.

A file of exercises holds its stubs, and for each a function `grade_N_M(answer)` that calls `expect` and is given the
learner's function of the same number. Running the file grades it.
"""

import sys
import traceback

import numpy as np


class Wrong(Exception):
    """An answer that is not the expected one."""


def expect(what, got, expected, tolerance=1e-6):
    """Wrong unless `got` is `expected`, numbers and arrays within a tolerance."""
    got_array, expected_array = np.asarray(got), np.asarray(expected)
    if got_array.shape != expected_array.shape:
        raise Wrong(f"{what}: got shape {got_array.shape}, expected {expected_array.shape}")
    if expected_array.dtype.kind in "biufc" and got_array.dtype.kind == "O":
        got_array = got_array.astype(float)  # a Fraction is a number, too
    if expected_array.dtype.kind in "biufc" and got_array.dtype.kind in "biufc":
        same = np.isclose(got_array, expected_array, rtol=tolerance, atol=tolerance)
    else:
        same = got_array == expected_array
    if not np.all(same):
        where = f" at {tuple(int(i) for i in np.argwhere(~np.asarray(same))[0])}" if got_array.ndim else ""
        first = (got_array[~same].flat[0], expected_array[~same].flat[0]) if got_array.ndim else (got, expected)
        kind = f" (of type {got_array.dtype})" if str(first[0]) == str(first[1]) else ""
        raise Wrong(f"{what}{where}: got {first[0]}{kind}, expected {first[1]}")


def grade(tasks):
    """Grade tasks {number: (answer, grader)}: a line each; returns how many are right."""
    return sum(is_right(number, *task) for number, task in tasks.items())


def is_right(number, answer, grader):
    """Whether an answer passes its grader; prints what was seen."""
    def given(*arguments, **options):
        value = answer(*arguments, **options)
        if value is None:
            raise Wrong(f"{answer.__name__} returned None: is its return missing?")
        return value

    try:
        grader(given)
    except NotImplementedError as error:
        print(f"{number}  to do: {error}")
    except Wrong as wrong:
        print(f"{number}  not yet: {wrong}")
    except Exception as error:
        here = grader.__code__.co_filename  # the learner's file, not one of a library that it calls
        *_, line = (frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == here)
        print(f"{number}  not yet: {type(error).__name__} in line {line}: {error}")
    else:
        print(f"{number}  right")
        return True
    return False


def main(tasks):
    """Grade and leave: exit status 0 if all are right."""
    sys.exit(0 if grade(tasks) == len(tasks) else 1)
