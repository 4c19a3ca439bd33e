"""Reciprocal ranks: what a passive classifier hands to an active planner (section IV-B).

The scores of a classifier are good for their order, not for their size. The best place gets 1, the second 1/2, the
third 1/3: large where the classifier is confident, nearly zero for the many places that it rules out.

    s_k = 1 / rank of place k      B views   K places
"""

import numpy as np


def best_first(scores):
    """Places in the order of their scores, the greatest first, equal ones in the order of places: (B, K) -> (B, K)."""
    scores = np.asarray(scores)
    if not np.issubdtype(scores.dtype, np.floating):
        scores = scores.astype(float)  # an unsigned number has no negative
    if np.isnan(scores).any():
        raise ValueError(f"scores: expected numbers, found {np.isnan(scores).sum()} NaN")
    return np.argsort(-scores, axis=-1, kind="stable")


def ranks(scores):
    """Rank of each score, 1 the best; equal scores rank in the order of their places: (B, K) -> (B, K) int."""
    order = best_first(scores)
    rank = np.empty_like(order)
    np.put_along_axis(rank, order, np.arange(1, order.shape[-1] + 1), -1)
    return rank


def reciprocal_ranks(scores):
    """1 / rank of each score: (B, K) -> (B, K) float32, a permutation of (1, 1/2, ..., 1/K)."""
    return (1 / ranks(scores)).astype(np.float32)
