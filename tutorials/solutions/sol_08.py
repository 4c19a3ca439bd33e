"""Solutions of chapter 08."""

import numpy as np


def predict_resampling():
    """The pieces of the ruler end at .4, 1.2, 2.4 and 4."""
    return [1, 2, 3, 3], [0, 1, 2, 3]


def systematic_resample(weights, u):
    """A mark on each unit, shifted by u; a mark on an end belongs to the next piece.

    For u just below 1 rounding puts the last mark on the end of the ruler: it belongs to the last piece there is.
    """
    total = np.cumsum(weights)
    M = len(total)
    marks = u + np.arange(M)
    return np.minimum(np.searchsorted(total * (M / total[-1]), marks, side="right"), np.flatnonzero(weights)[-1])


def effective(weights):
    """1 / sum of squared weights, once they sum to 1."""
    return weights.sum() ** 2 / (weights ** 2).sum()


def pool(places, weights, n_places):
    """`pooled[places] += weights` writes each place once, whatever it holds; bincount adds up."""
    return np.bincount(places, weights, n_places)


def bayes_step(belief, likelihood, p_move):
    """Predict, then weigh; a view that nothing explains changes nothing."""
    moved = p_move * np.roll(belief, 1) + (1 - p_move) * belief
    seen = moved * likelihood
    return seen / seen.sum() if seen.sum() > 0 else moved
