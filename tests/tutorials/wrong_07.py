"""Plausible wrong answers of chapter 07, each of which the grader must reject."""

import numpy as np


def rank(scores, axis=1):
    return np.argsort(np.argsort(-scores, axis=axis, kind="stable"), axis=axis) + 1


def ties_to_the_higher(scores):
    return np.argsort(np.argsort(scores, kind="stable")[::-1]) + 1


def by_probability(looks):
    p = np.exp(looks - looks.max(1, keepdims=True))
    return (p / p.sum(1, keepdims=True)).sum(0).argmax()


def moved_and_not_swapped(i, j):
    ranks = np.arange(1.0, max(i, j) + 1)
    moved = np.insert(np.delete(ranks, i - 1), j - 1, i)
    return np.hypot.reduce(1 / ranks - 1 / moved)


WRONG = {
    "7.1": [lambda: [2, 1, 1, 3, 1], lambda: [4, 3, 2, 5, 1], lambda: [2, 3, 5, 1, 4], lambda: [3, 0, 1, 4, 2]],
    "7.2": [lambda scores: 1 / rank(scores, axis=0), lambda scores: 1 / (np.argsort(-scores, axis=1) + 1),
            lambda scores: 1 / rank(-scores), rank],
    "7.3": [ties_to_the_higher, lambda scores: np.argsort(np.argsort(-scores, kind="stable")),
            lambda scores: np.argsort(np.argsort(scores, kind="stable")) + 1],
    "7.4": [lambda i, j: abs(1 / i - 1 / j), lambda i, j: 2 ** 0.5 * (1 / i - 1 / j),
            lambda i, j: 2 ** 0.5 * abs(i - j), lambda i, j: 2 * (1 / i - 1 / j) ** 2,
            lambda i, j: 2 ** 0.5 * (i != j) / (i * j), moved_and_not_swapped],
    "7.5": [lambda looks: looks.sum(0).argmax(), lambda looks: rank(looks).sum(0).argmin(),
            lambda looks: (1 / rank(looks, axis=0)).sum(0).argmax(), lambda looks: rank(looks).sum(0).argmax(),
            lambda looks: np.bincount(looks.argmax(1)).argmax(), by_probability],
}
