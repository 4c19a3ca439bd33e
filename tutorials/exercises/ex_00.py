"""Exercises of chapter 00. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main


def counts():
    """Exercise 0.1: looks in an episode of L = 4 cycles, actions in it, looks in 10,000 such episodes: three ints."""
    raise NotImplementedError("exercise 0.1")


def belief_by_hand():
    """Exercise 0.2: belief in A, B and C after the second view, three numbers, to two decimal places."""
    raise NotImplementedError("exercise 0.2")


def files():
    """Exercise 0.3: the names of four files, such as "camera.py".

    For: (a) turns of 45 degrees, (b) cells of 1 m x 1 m, (c) which words are neighbours, (d) the number of particles.
    """
    raise NotImplementedError("exercise 0.3")


def grade_0_1(counts):
    expect("looks, actions, looks while learning", counts(), [5, 4, 50_000])


def grade_0_2(belief_by_hand):
    expect("belief in A, B, C", np.round(belief_by_hand(), 2), [0.77, 0.15, 0.08])


def grade_0_3(files):
    expect("files for (a), (b), (c), (d)", [str(name).split("/")[-1].removesuffix(".py") for name in files()],
           ["robot", "places", "scene_graph", "particles"])


TASKS = {"0.1": (counts, grade_0_1), "0.2": (belief_by_hand, grade_0_2), "0.3": (files, grade_0_3)}

if __name__ == "__main__":
    main(TASKS)
