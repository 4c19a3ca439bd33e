"""Plausible wrong answers to the exercises of chapter 10."""

import math

import numpy as np


def one_of_nine():
    return 1 / 9, 41 / 81


def pairs_as_if_independent():
    return 2 / 9, (7 / 9) ** 3


def four_pairs():
    return 2 / 9, 99 / 243


def one_sided(n_a, n_b):
    n = n_a + n_b
    return sum(math.comb(n, k) for k in range(min(n_a, n_b) + 1)) / 2 ** n


def not_the_seen_one(n_a, n_b):
    n = n_a + n_b
    return min(1.0, 2 * sum(math.comb(n, k) for k in range(min(n_a, n_b))) / 2 ** n)


def above_one(n_a, n_b):
    n = n_a + n_b
    return 2 * sum(math.comb(n, k) for k in range(min(n_a, n_b) + 1)) / 2 ** n


def lower_tail_of_a(n_a, n_b):
    n = n_a + n_b
    return min(1.0, 2 * sum(math.comb(n, k) for k in range(n_a + 1)) / 2 ** n)


def as_if_not_paired(a, b):
    a, b = np.asarray(a, float), np.asarray(b, float)
    mean, half = (a - b).mean(), 1.96 * np.hypot(a.std(ddof=1), b.std(ddof=1)) / np.sqrt(len(a))
    return mean, mean - half, mean + half


def of_one_episode(a, b):
    d = np.asarray(a, float) - np.asarray(b, float)
    half = 1.96 * d.std(ddof=1)
    return d.mean(), d.mean() - half, d.mean() + half


def by_n(a, b):
    d = np.asarray(a, float) - np.asarray(b, float)
    half = 1.96 * d.std() / np.sqrt(len(d))
    return d.mean(), d.mean() - half, d.mean() + half


def wrong_axis(outcomes, drawn):
    return outcomes.mean(0)[drawn].mean(1)


def over_rounds(outcomes, drawn):
    return outcomes.mean(1)[drawn].mean(0)


def no_repeats(outcomes, drawn):
    return np.array([outcomes[np.unique(row)].mean() for row in drawn])


def one_step_too_many(rewards, near, length):
    reward = ahead = np.asarray(rewards) / length
    for _ in range(length):
        ahead = reward + ahead[near].mean(1)
    return ahead


def not_shared_out(rewards, near, length):
    ahead = rewards
    for _ in range(length - 1):
        ahead = rewards + ahead[near].mean(1)
    return ahead


def nearest_alone(rewards, near, length):
    reward = ahead = np.asarray(rewards) / length
    for _ in range(length - 1):
        ahead = reward + ahead[near[:, 0]]
    return ahead


def along_the_first(rewards, near, length):
    values = reward = rewards / length
    for _ in range(length - 1):
        values, near = values + reward[near].mean(1), near[near[:, 0]]
    return values


def over_square(outcomes, drawn):
    return outcomes[drawn].sum((1, 2)) / outcomes.shape[1] ** 2


WRONG = {"10.1": [one_of_nine, pairs_as_if_independent, four_pairs],
         "10.2": [one_sided, not_the_seen_one, above_one, lower_tail_of_a],
         "10.3": [as_if_not_paired, of_one_episode, by_n], "10.4": [wrong_axis, over_rounds, no_repeats, over_square],
         "10.5": [one_step_too_many, not_shared_out, nearest_alone, along_the_first]}
