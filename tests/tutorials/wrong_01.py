"""Plausible wrong answers to the exercises of chapter 01."""

import numpy as np


def rounded_down():
    return 4 * 4 * 12, 6 * 5 * 12, 6 * 5 * 12


def one_cell_too_many():
    return 300, 420, 420


def without_bearings():
    return 25, 30, 35


def turned_the_wrong_way(centre, half, angle):
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    return centre + signs * half @ np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def not_turned(centre, half, angle):
    return centre + np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * half


def whole_sides(centre, half, angle):
    ahead, left = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    return centre + np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * 2 * np.array(half) @ np.array([ahead, left])


def rows_first(place, origin, ny):
    cell, ib = divmod(place, 12)
    iy, ix = divmod(cell, ny)
    return origin[0] + 2 * ix + 1, origin[1] + 2 * iy + 1, (ib + 0.5) * np.pi / 6


def corner_of(place, origin, ny):
    cell, ib = divmod(place, 12)
    ix, iy = divmod(cell, ny)
    return origin[0] + 2 * ix, origin[1] + 2 * iy, ib * np.pi / 6


def origin_forgotten(place, origin, ny):
    cell, ib = divmod(place, 12)
    ix, iy = divmod(cell, ny)
    return 2 * ix + 1, 2 * iy + 1, (ib + 0.5) * np.pi / 6


def in_the_first_row(place, origin, ny):
    cell, ib = divmod(place, 12)
    return origin[0] + 2 * (cell // ny) + 1, origin[1] + 1, (ib + 0.5) * np.pi / 6


def not_turned_at_all(point, centre, half, angle):
    (x, y), (a, b) = np.subtract(point, centre), half
    return np.hypot(max(0.0, abs(x) - a), max(0.0, abs(y) - b))


def not_zero_within(point, centre, half, angle):
    (x, y), (a, b) = np.subtract(point, centre), half
    u, v = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
    return np.hypot(abs(u) - a, abs(v) - b)


def farther_side_alone(point, centre, half, angle):
    (x, y), (a, b) = np.subtract(point, centre), half
    u, v = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
    return max(0.0, abs(u) - a, abs(v) - b)


WRONG = {"1.1": [rounded_down, one_cell_too_many, without_bearings],
         "1.2": [turned_the_wrong_way, not_turned, whole_sides],
         "1.3": [rows_first, corner_of, origin_forgotten, in_the_first_row],
         "1.4": [not_turned_at_all, not_zero_within, farther_side_alone]}
