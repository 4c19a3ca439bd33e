"""Plausible wrong answers to the exercises of chapter 03."""

import numpy as np

HEIGHT_M = 1.25


def upside_down():
    return [(1 + (z - HEIGHT_M) / 2) * 256 for z in (0.8, 0.0, 2.05)]


def camera_on_the_floor():
    return [(1 - z / 2) * 256 for z in (0.8, 0.0, 2.05)]


def whole_height():
    return [(1 - (z - HEIGHT_M) / 2) * 512 for z in (0.8, 0.0, 2.05)]


def highest_bit(n):
    return n.bit_length() - 1


def value_of_the_bit(n):
    return n & -n


def number_of_ones(n):
    return (n ^ (n - 1)).bit_length()


def near_to_far(begin, end, size):
    shown = np.full(size, -1)
    for i in range(len(begin)):
        shown[begin[i]:end[i]] = i
    return shown


def end_included(begin, end, size):
    shown = np.full(size, -1)
    for i in reversed(range(len(begin))):
        shown[begin[i]:end[i] + 1] = i
    return shown


def none_is_zero(begin, end, size):
    shown = np.zeros(size, int)
    for i in reversed(range(len(begin))):
        shown[begin[i]:end[i]] = i
    return shown


def stretched_twice(distance, s, z, size):
    w = 1 / (np.asarray(distance) * np.hypot(1, s))
    return (1 - (z - HEIGHT_M) * w) * size / 2


def slope_for_length(distance, s, z, size):
    w = (1 + np.abs(s)) / np.asarray(distance)
    return (1 - (z - HEIGHT_M) * w) * size / 2


def one_of_those_that_begin_together(begin, end, size):
    change = [0] * (size + 1)
    for i in range(len(begin)):
        change[begin[i]] ^= 1 << i
    ends = dict(zip(end, range(len(end)), strict=True))  # of equal ends one is left
    shown, on = np.full(size, -1), 0
    for row in range(size):
        on ^= change[row]
        if row in ends:
            on &= ~(1 << ends[row])
        shown[row] = (on & -on).bit_length() - 1
    return shown


WRONG = {"3.1": [upside_down, camera_on_the_floor, whole_height],
         "3.2": [highest_bit, value_of_the_bit, number_of_ones],
         "3.3": [near_to_far, end_included, none_is_zero, one_of_those_that_begin_together],
         "3.4": [stretched_twice, slope_for_length]}
