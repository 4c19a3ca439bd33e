"""Plausible wrong answers of chapter 08, each of which the grader must reject."""

import numpy as np


def marks_off_by_one(weights, u):
    total = np.cumsum(weights) / np.sum(weights)
    M = len(weights)
    return np.searchsorted(M * total, u + np.arange(1, M + 1)).clip(0, M - 1)


def entry_0_gets_the_mark_on_its_end(weights, u):
    total = np.cumsum(weights) / np.sum(weights)
    M = len(weights)
    return np.searchsorted(M * total, u + np.arange(M)).clip(0, M - 1)


def marks_in_a_ruler_of_length_one(weights, u):
    total = np.cumsum(weights)
    return np.searchsorted(total, (u + np.arange(len(weights))) / len(weights), side="right").clip(0, len(weights) - 1)


def the_last_mark_falls_off(weights, u):
    total = np.cumsum(weights)
    M = len(total)
    return np.minimum(np.searchsorted(total * (M / total[-1]), u + np.arange(M), side="right"), M - 1)


def greatest_weight(places, weights, n_places):
    pooled = np.zeros(n_places)
    np.maximum.at(pooled, places, weights)
    return pooled


def how_many(places, weights, n_places):
    return np.bincount(places, minlength=n_places) / len(places)


def weigh_before_moving(belief, likelihood, p_move):
    seen = belief * likelihood
    seen = seen / seen.sum() if seen.sum() else belief
    return p_move * np.roll(seen, 1) + (1 - p_move) * seen


def backwards(belief, likelihood, p_move):
    moved = p_move * np.roll(belief, -1) + (1 - p_move) * belief
    seen = moved * likelihood
    return seen / seen.sum() if seen.sum() else moved


def keeps_the_old_belief(belief, likelihood, p_move):
    moved = p_move * np.roll(belief, 1) + (1 - p_move) * belief
    seen = moved * likelihood
    return seen / seen.sum() if seen.sum() else belief


def asks_the_likelihood_alone(belief, likelihood, p_move):
    moved = p_move * np.roll(belief, 1) + (1 - p_move) * belief
    seen = moved * likelihood if likelihood.sum() else moved
    with np.errstate(invalid="ignore"):
        return seen / seen.sum()


WRONG = {
    "8.1": [lambda: ([1, 2, 2, 3], [0, 1, 2, 3]), lambda: ([2, 3, 4, 4], [1, 2, 3, 4]),
            lambda: ([0, 1, 2, 3], [0, 1, 2, 3])],
    "8.2": [marks_off_by_one, entry_0_gets_the_mark_on_its_end, marks_in_a_ruler_of_length_one,
            the_last_mark_falls_off],
    "8.3": [lambda weights: 1 / (weights ** 2).sum(), lambda weights: 1 / weights.sum() ** 2,
            lambda weights: (weights ** 2).sum() / weights.sum() ** 2],
    "8.4": [greatest_weight, how_many],
    "8.5": [weigh_before_moving, backwards, keeps_the_old_belief, asks_the_likelihood_alone],
}
