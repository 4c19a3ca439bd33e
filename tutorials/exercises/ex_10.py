"""Exercises of chapter 10. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main


def undone_by_chance():
    """Exercise 10.1: for a planner that draws left, right or forward at random: (share, probability), 0..1.

    share of its pairs of successive actions that undo a turn; probability that four actions hold no such pair; both
    to at least four decimal places
    """
    raise NotImplementedError("exercise 10.1")


def mcnemar(n_a, n_b):
    """Exercise 10.2: exact two-sided p from the numbers of pairs in which A alone and B alone was right: a float.

    1.0 if there are none
    """
    raise NotImplementedError("exercise 10.2")


def paired_interval(a, b):
    """Exercise 10.3: mean of a - b over pairs and its 95 % interval: (n,) of 0 and 1 -> (mean, low, high).

    There is a silent bug.
    """
    d = np.asarray(a, float) - np.asarray(b, float)
    half = 1.96 * d.var(ddof=1) / np.sqrt(len(d))
    return d.mean(), d.mean() - half, d.mean() + half


def cell_means(outcomes, drawn):
    """Exercise 10.4: mean of each round of a cluster bootstrap: (R,).

    outcomes (C, E) of C cells with E episodes each;  drawn (R, C) numbers of the cells that a round draws
    """
    raise NotImplementedError("exercise 10.4")


def option_values(rewards, near, length):
    """Exercise 10.5: V_L, the worth of n remembered steps of one action if it is repeated: (n,).

    V_d of a step, d = 1 .. L, is its reward / L (always this L) plus the mean of V_(d - 1) over the steps near it.

    rewards (n,);  near (n, k) numbers of the steps whose states are nearest to the state after each;  length L >= 1
    """
    raise NotImplementedError("exercise 10.5")


def grade_10_1(undone_by_chance):
    share, probability = undone_by_chance()
    expect("share of pairs that undo a turn", share, 2 / 9, 5e-5)
    expect("probability of none in four actions", probability, 41 / 81, 5e-5)


def grade_10_2(mcnemar):
    expect("5 against 1", mcnemar(5, 1), 0.21875)
    expect("1 against 5", mcnemar(1, 5), 0.21875)
    expect("6 against 0", mcnemar(6, 0), 0.03125)
    expect("3 against 3", mcnemar(3, 3), 1.0)
    expect("0 against 0", mcnemar(0, 0), 1.0)
    expect("700 against 690", mcnemar(700, 690), 0.809257, 1e-5)


def grade_10_3(paired_interval):
    expect("a = 1 1 0 1, b = 0 1 0 0", paired_interval([1, 1, 0, 1], [0, 1, 0, 0]), (0.5, -0.065803, 1.065803), 1e-4)
    expect("two that agree", paired_interval([1, 0, 1], [1, 0, 1]), (0.0, 0.0, 0.0))


def grade_10_4(cell_means):
    outcomes = np.array([[0.0, 2, 4], [5, 5, 5], [9, 0, 0]])
    expect("each cell once", cell_means(outcomes, np.array([[0, 1, 2]])), [10 / 3])
    expect("two rounds", cell_means(outcomes, np.array([[0, 0, 1], [2, 2, 2]])), [3, 3])
    expect("four rounds", cell_means(outcomes, np.array([[1, 1, 1], [0, 1, 1], [0, 0, 0], [2, 1, 0]])),
           [5, 4, 2, 10 / 3])
    outcomes, drawn = np.array([[0, 1, 1], [1, 0, 0]]), np.array([[0, 0], [0, 1], [1, 1]])
    expect("two cells of three episodes", cell_means(outcomes, drawn), [2 / 3, 1 / 2, 1 / 3])


def grade_10_5(option_values):
    rewards, near = np.array([1 / 2, 1, 1 / 3]), np.array([[1], [2], [0]])
    expect("one step", option_values(rewards, near, 1), [1 / 2, 1, 1 / 3])
    expect("two steps", option_values(rewards, near, 2), [3 / 4, 2 / 3, 5 / 12])
    expect("three steps", option_values(rewards, near, 3), [11 / 18] * 3)
    both = np.array([[1, 2], [2, 0], [0, 1]])
    expect("two neighbours", option_values(rewards, both, 2), [7 / 12, 17 / 24, 13 / 24])
    expect("two neighbours, three steps", option_values(rewards, both, 3), np.array([42, 51, 39]) / 72)


TASKS = {"10.1": (undone_by_chance, grade_10_1), "10.2": (mcnemar, grade_10_2), "10.3": (paired_interval, grade_10_3),
         "10.4": (cell_means, grade_10_4), "10.5": (option_values, grade_10_5)}

if __name__ == "__main__":
    main(TASKS)
