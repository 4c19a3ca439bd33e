"""Solutions of chapter 10."""

import math

import numpy as np


def undone_by_chance():
    """LR and RL of nine pairs. Of n sequences that undo nothing t end in a turn: the next ones are 3 n - t."""
    n, turns = 3, 2
    for _ in range(3):
        n, turns = 3 * n - turns, 2 * (n - turns) + turns  # after a turn only the same turn is left of the two
    return 2 / 9, n / 3 ** 4


def mcnemar(n_a, n_b):
    """Both tails of n fair tosses, at most 1."""
    n = n_a + n_b
    return min(1.0, 2 * sum(math.comb(n, k) for k in range(min(n_a, n_b) + 1)) / 2 ** n)


def paired_interval(a, b):
    """The standard deviation has the unit of d; a variance has its square."""
    d = np.asarray(a, float) - np.asarray(b, float)
    half = 1.96 * d.std(ddof=1) / np.sqrt(len(d))
    return d.mean(), d.mean() - half, d.mean() + half


def cell_means(outcomes, drawn):
    """One mean a cell, then those that were drawn."""
    return outcomes.mean(1)[drawn].mean(1)


def option_values(rewards, near, length):
    """V_d = r / L + mean of V_(d-1) over the neighbours."""
    reward = np.asarray(rewards) / length
    ahead = reward
    for _ in range(length - 1):
        ahead = reward + ahead[near].mean(1)
    return ahead
