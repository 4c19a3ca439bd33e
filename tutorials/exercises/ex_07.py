"""Exercises of chapter 07. Answer or mend each function, then run this file."""

import numpy as np
from grader import expect, main


def predict_ranks():
    """Exercise 7.1: the ranks of the scores (2, 5, 5, -1, 5), a list of five."""
    raise NotImplementedError("exercise 7.1")


def reciprocal(scores):
    """Exercise 7.2: scores (B, K) -> 1 / rank of each within its row (B, K), ties to the lower place."""
    raise NotImplementedError("exercise 7.2")


def ranks_of(scores):
    """Exercise 7.3, to be mended: scores (K,) -> rank of each, 1 the best, ties to the lower place, (K,) int."""
    return np.argsort(-scores, kind="stable") + 1


def swap_distance(i, j):
    """Exercise 7.4: distance between two reciprocal-rank vectors that differ by a swap of the places ranked i and j."""
    raise NotImplementedError("exercise 7.4")


def fuse(looks):
    """Exercise 7.5: scores (V, K) of V looks -> the place of the greatest sum of reciprocal ranks.

    Equal scores of a look rank the lower place first.
    """
    raise NotImplementedError("exercise 7.5")


def grade_7_1(predict_ranks):
    expect("ranks", predict_ranks(), [4, 1, 2, 5, 3])


def grade_7_2(reciprocal):
    scores = np.array([[0.1, 0.7, 0.2], [5.0, 9, 9]])
    expect("by hand", reciprocal(scores), [[1 / 3, 1, 1 / 2], [1 / 3, 1, 1 / 2]])
    expect("all equal", reciprocal(np.zeros((2, 4))), [[1, 1 / 2, 1 / 3, 1 / 4]] * 2)
    rng = np.random.default_rng(0)
    expect("another scale", reciprocal(np.exp(3 * scores)), [[1 / 3, 1, 1 / 2], [1 / 3, 1, 1 / 2]])
    drawn = rng.permuted(np.tile(np.arange(7.0), (3, 1)), axis=1)
    expect("a permutation in each row", reciprocal(drawn), 1 / (7 - drawn))
    ranks = np.array([np.arange(21, 41), np.arange(1, 21)]).T.reshape(1, 40)  # 21, 1, 22, 2, ...
    expect("many ties", reciprocal(np.arange(40)[None] % 2.0), 1 / ranks)


def grade_7_3(ranks_of):
    expect("by hand", ranks_of(np.array([0.1, 0.7, 0.2])), [3, 1, 2])
    expect("a cycle of four", ranks_of(np.array([1.0, 4, 3, 2])), [4, 1, 2, 3])
    expect("ties", ranks_of(np.array([2.0, 5, 5, -1, 5])), [4, 1, 2, 5, 3])
    expect("many ties", ranks_of(np.arange(40) % 2.0), np.array([np.arange(21, 41), np.arange(1, 21)]).T.ravel())


def grade_7_4(swap_distance):
    expect("first and second", swap_distance(1, 2), 2 ** 0.5 / 2)
    expect("fifth and sixth", swap_distance(5, 6), 2 ** 0.5 / 30)
    expect("sixth and fifth", swap_distance(6, 5), 2 ** 0.5 / 30)
    expect("second and fifth", swap_distance(2, 5), 0.3 * 2 ** 0.5)
    expect("nothing changed", swap_distance(3, 3), 0)


def grade_7_5(fuse):
    expect("two agree", fuse(np.array([[9.0, 8, 7, 6], [6, 9, 8, 7], [6, 9, 7, 8]])), 1)
    expect("one has much greater scores", fuse(np.array([[100.0, 2, 3, 4], [1, 2, 3, 9], [2, 3, 1, 9]])), 3)
    expect("one look is far off", fuse(np.array([[9.0, 8, 7, 6, 5], [9, 8, 7, 6, 5], [1, 8, 9, 6, 5]])), 0)
    expect("three first places", fuse(np.array([[9.0, 8, 7, 6], [6, 8, 7, 9], [7, 8, 9, 6]])), 2)
    expect("entry 0", fuse(np.array([[3.0, 2, 1]])), 0)
    expect("one is sure, two are not", fuse(np.array([[9, 1, 0], [1, 1.2, 1.1], [1, 1.2, 1.1]])), 1)
    expect("ties to the lower place", fuse(np.array([[0.0, 1, 1], [1, 2, 1], [2, 0, 2]])), 1)


TASKS = {"7.1": (predict_ranks, grade_7_1), "7.2": (reciprocal, grade_7_2), "7.3": (ranks_of, grade_7_3),
         "7.4": (swap_distance, grade_7_4), "7.5": (fuse, grade_7_5)}

if __name__ == "__main__":
    main(TASKS)
