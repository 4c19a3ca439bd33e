"""Comparing two methods that ran on the same episodes: differences in pairs, with intervals.

    d_i = right_i(A) - right_i(B) in {-1, 0, 1},   interval = mean(d) +- 1.96 std(d) / sqrt(n)

Pairs share start, noise and particles, so d varies far less than the difference of two independent percentages.
"""

import numpy as np

Z95 = 1.959964  # 97.5 % point of the standard normal


def paired_difference(a, b):
    """Mean of a - b over pairs, and its 95 % interval: (n,) bool, (n,) bool -> mean, low, high."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    if a.shape != b.shape or a.ndim != 1 or len(a) < 2:
        raise ValueError(f"pairs: expected two equal lists of at least 2 outcomes, found {a.shape} and {b.shape}")
    d = a - b
    half = Z95 * d.std(ddof=1) / np.sqrt(len(d))
    return d.mean(), d.mean() - half, d.mean() + half
