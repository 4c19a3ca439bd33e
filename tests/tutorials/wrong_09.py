"""Plausible wrong answers of chapter 09, each of which the grader must reject."""

import numpy as np


def without_revisit(states, values, query, k):
    nearest = np.argsort(np.linalg.norm(states - query, axis=1), kind="stable")[:k]
    return values[nearest].mean() if len(nearest) else 0.0


def entry_0_is_no_revisit(states, values, query, k):
    distance = np.linalg.norm(states - query, axis=1)
    itself = next((i for i, d in enumerate(distance) if d == 0), 0)
    if itself:
        return values[itself]
    return values[np.argsort(distance, kind="stable")[:k]].mean() if len(values) else 0.0


def sum_over_k(states, values, query, k):
    distance = np.linalg.norm(states - query, axis=1)
    nearest = np.argsort(distance, kind="stable")[:k]
    return values[nearest[0]] if len(nearest) and distance[nearest[0]] == 0 else values[nearest].sum() / k


def to_the_middle(query, low, high):
    return np.linalg.norm((abs(query - (low + high) / 2) - (high - low)).clip(0))


def forgets_the_end(q, reward, ahead, _done, alpha, gamma):
    return q + alpha * (reward + gamma * max(ahead) - q)


def mean_of_what_is_ahead(q, reward, ahead, done, alpha, gamma):
    return q + alpha * (reward + (not done) * gamma * np.mean(ahead) - q)


def step_without_q(q, reward, ahead, done, alpha, gamma):
    return alpha * (reward + (not done) * gamma * max(ahead) - q)


def nothing_is_below_zero(q, reward, ahead, done, alpha, gamma):
    return q + alpha * (reward + (not done) * gamma * max(0, *ahead) - q)


def around_the_block(states, values, query, k):
    distance = abs(states - query).sum(1)
    nearest = np.argsort(distance, kind="stable")[:k]
    if not len(values):
        return 0.0
    return values[nearest[0]] if distance[nearest[0]] == 0 else values[nearest].mean()


def few_before_met(states, values, query, k):
    if len(values) <= k:
        return values.mean() if len(values) else 0.0
    distance = np.sqrt(((states - query) ** 2).sum(1))
    nearest = np.argsort(distance, kind="stable")[:k]
    return values[nearest[0]] if distance[nearest[0]] == 0 else values[nearest].mean()


WRONG = {
    "9.1": [lambda: [0.125, 0.25, 0.5, 1], lambda: [0, 0, 0.5, 1], lambda: [0, 0.101, 0.45, 0.875]],
    "9.2": [forgets_the_end, mean_of_what_is_ahead, step_without_q, nothing_is_below_zero],
    "9.3": [without_revisit, entry_0_is_no_revisit, sum_over_k, around_the_block, few_before_met],
    "9.4": [to_the_middle, lambda query, low, high: np.abs(query.clip(low, high) - query).sum(),
            lambda query, low, high: ((query.clip(low, high) - query) ** 2).sum(),
            lambda query, low, high: np.hypot(*(query.clip(low, high) - query)[:2])],
    "9.5": [lambda K: (1 / np.arange(1, K + 1) ** 2).sum(), lambda K: 1 + (1 / np.arange(2, K + 1) ** 2).sum(),
            lambda K: 1 + (1 / np.arange(3, K) ** 2).sum()],
}
