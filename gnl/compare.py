"""Comparing methods that ran on the same episodes: paired differences, with intervals.

    d_i = right_i(A) - right_i(B) in {-1, 0, 1},   interval = mean(d) +- 1.96 std(d) / sqrt(n)

Pairs share start, noise and particles, so d varies less than the difference of two independent percentages. Over
many cells the cells themselves vary, too: the bootstrap draws whole cells (clusters), not episodes.
"""

import numpy as np
from scipy.special import bdtr

from .checks import check_finite

Z95, Z80 = 1.959964, 0.841621  # 97.5 % and 80 % points of the standard normal
RESAMPLED = 10_000


def paired_difference(a, b):
    """Mean of a - b over pairs, and its 95 % interval: (n,) bool, (n,) bool -> mean, low, high."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    if a.shape != b.shape or a.ndim != 1 or len(a) < 2:
        raise ValueError(f"pairs: expected two equal lists of at least 2 outcomes, found {a.shape} and {b.shape}")
    check_finite("pairs", d := a - b)
    half = Z95 * d.std(ddof=1) / np.sqrt(len(d))
    return d.mean(), d.mean() - half, d.mean() + half


def over_cells(differences, rng):
    """Mean over cells and its 95 % interval by a bootstrap of whole cells: (C,) mean of each -> mean, low, high.

    A cell is drawn with all its episodes, for they share a home, a gap and what was learned there.
    """
    d = np.asarray(differences, float)
    if d.ndim != 1 or len(d) < 1:
        raise ValueError(f"differences: expected one for each cell, found shape {d.shape}")
    check_finite("differences", d)
    means = d[rng.integers(len(d), size=(RESAMPLED, len(d)))].mean(1)
    return d.mean(), *np.percentile(means, [2.5, 97.5])


def mcnemar(a, b):
    """Exact two-sided p that A and B are right equally often, from the pairs in which they differ (McNemar 1947).

        p = 2 P(X <= min(n_A, n_B)), at most 1,   X ~ Binomial(n_A + n_B, 1/2)

    n_A, n_B : pairs in which A alone, B alone was right
    """
    a, b = np.asarray(a), np.asarray(b)
    if a.shape != b.shape or a.ndim != 1 or not (np.isin(a, (0, 1)).all() and np.isin(b, (0, 1)).all()):
        raise ValueError(f"pairs: expected two lists of 0 and 1, equally long, found {a.dtype} {a.shape} "
                         f"and {b.dtype} {b.shape}")
    a, b = a.astype(bool), b.astype(bool)
    n_a, n_b = int((a & ~b).sum()), int((b & ~a).sum())
    return min(1.0, 2 * bdtr(min(n_a, n_b), n_a + n_b, 0.5))


def episodes_needed(difference, std):
    """Pairs needed to show a true difference at 95 % in 80 % of all experiments: ((1.96 + 0.84) std / difference)^2.

    std : standard deviation of d over pairs; if unpaired, with shares p and q right, sqrt(p (1 - p) + q (1 - q))
    """
    ratio = (Z95 + Z80) * std / difference if difference else np.inf
    if not abs(ratio) < 1e9:  # NaN compares as false
        raise ValueError("difference, std: expected finite numbers and a difference that some number of pairs would "
                         f"show, found {difference} and {std}")
    return int(np.ceil(ratio ** 2))


def in_points(mean, low, high):
    """A difference of shares and its interval as words, in percentage points: +1.0 [-0.2, +2.2]."""
    return f"{100 * mean:+.1f} [{100 * low:+.1f}, {100 * high:+.1f}]"
