"""Solutions of chapter 11."""

import numpy as np
from scipy.stats import binom


def acceptance(n_tests, area_m2, t_xy_m, t_theta_deg):
    """Clear of all discs, and turned far enough; the mean wait for one success is 1 / share."""
    share = np.exp(-n_tests * np.pi * t_xy_m ** 2 / area_m2) * (1 - t_theta_deg / 180)
    return share, 10_000 / share


def beyond_gap(pose, tests, t_xy_m, t_theta_rad):
    """Both differences are against the test that is nearest in location."""
    distance = np.hypot(*(tests[:, :2] - pose[:2]).T)
    nearest = distance.argmin()
    turned = abs(np.angle(np.exp(1j * (pose[2] - tests[nearest, 2]))))
    return bool(distance[nearest] > t_xy_m and turned > t_theta_rad)


def take(now, before):
    """Every value differs from NaN, so every newborn pair is written down."""
    padded = np.append(before, np.full(len(now) - len(before), np.nan))
    return np.flatnonzero(padded != now)


def expected_best(p, n_episodes, n_checkpoints):
    """Sum of P(best count > x) over x = 0 .. n - 1, a share of n."""
    at_most = binom.cdf(np.arange(n_episodes), n_episodes, p)
    return (1 - at_most ** n_checkpoints).sum() / n_episodes
