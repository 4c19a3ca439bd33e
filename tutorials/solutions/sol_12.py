"""Solutions of chapter 12."""

import numpy as np

from gnl.classes import from_ade20k


def with_box(plan, kind, x, y, width, depth, height):
    """A new dict with a new list; what is in the list is only read."""
    corners = [[x, y], [x + width, y], [x + width, y + depth], [x, y + depth]]
    return {**plan, "objects": [*plan.get("objects", []), {"class": kind, "polygon": corners, "height": height}]}


def steady():
    """The memory is set anew at every step 0, so it always fits the group that runs."""
    kept = None

    def plan(step, states, rng):
        nonlocal kept
        if step == 0:
            kept = rng.integers(2, size=len(states))
        return kept
    return plan


def log_words(counts, unseen=0.1):
    """Each row sums to 1 before the logarithm."""
    smooth = counts + unseen
    return np.log(smooth / smooth.sum(1, keepdims=True))


def from_zero_based(labels):
    """As int, so that 255 + 1 does not wrap round; then 256 is ADE20K's 0."""
    counted = np.asarray(labels).astype(int) + 1
    return from_ade20k(np.where(counted == 256, 0, counted))
