"""Plausible wrong answers to the exercises of chapter 11."""

import numpy as np
from scipy.stats import binom


def full_circle(n, area, t, deg):
    share = np.exp(-n * np.pi * t ** 2 / area) * (1 - deg / 360)
    return share, 10_000 / share


def diameter(n, area, t, deg):
    share = np.exp(-n * np.pi * t ** 2 / 4 / area) * (1 - deg / 180)
    return share, 10_000 / share


def draws_of_the_share(n, area, t, deg):
    share = np.exp(-n * np.pi * t ** 2 / area) * (1 - deg / 180)
    return share, 10_000 * share


def no_wrap(pose, tests, t_xy, t_theta):
    distance = np.hypot(*(tests[:, :2] - pose[:2]).T)
    nearest = distance.argmin()
    return bool(distance[nearest] > t_xy and abs(pose[2] - tests[nearest, 2]) > t_theta)


def all_bearings(pose, tests, t_xy, t_theta):
    distance = np.hypot(*(tests[:, :2] - pose[:2]).T)
    turned = abs(np.angle(np.exp(1j * (pose[2] - tests[:, 2]))))
    return bool((distance > t_xy).all() and (turned > t_theta).all())


def either(pose, tests, t_xy, t_theta):
    distance = np.hypot(*(tests[:, :2] - pose[:2]).T)
    nearest = distance.argmin()
    turned = abs(np.angle(np.exp(1j * (pose[2] - tests[nearest, 2]))))
    return bool(distance[nearest] > t_xy or turned > t_theta)


def signed(pose, tests, t_xy, t_theta):
    distance = np.hypot(*(tests[:, :2] - pose[:2]).T)
    nearest = distance.argmin()
    turned = np.angle(np.exp(1j * (pose[2] - tests[nearest, 2])))
    return bool(distance[nearest] > t_xy and turned > t_theta)


def as_far_is_far_enough(pose, tests, t_xy, t_theta):
    distance = np.hypot(*(tests[:, :2] - pose[:2]).T)
    nearest = distance.argmin()
    turned = abs(np.angle(np.exp(1j * (pose[2] - tests[nearest, 2]))))
    return bool(distance[nearest] >= t_xy and turned > t_theta)


def only_old(now, before):
    return np.flatnonzero(now[:len(before)] != before)


def minus_one(now, before):
    return np.flatnonzero(np.append(before, np.full(len(now) - len(before), -1.0)) != now)


def all_of_them(now, before):
    return np.arange(len(now))


def at_least(p, n, c):
    return (1 - binom.cdf(np.arange(1, n + 1), n, p) ** c).sum() / n


def no_share(p, n, c):
    return (1 - binom.cdf(np.arange(n), n, p) ** c).sum()


def all_above(p, n, c):
    return ((1 - binom.cdf(np.arange(n), n, p)) ** c).sum() / n


WRONG = {"11.1": [full_circle, diameter, draws_of_the_share],
         "11.2": [no_wrap, all_bearings, either, signed, as_far_is_far_enough],
         "11.3": [only_old, minus_one, all_of_them], "11.4": [at_least, no_share, all_above]}
