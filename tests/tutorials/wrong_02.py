"""Plausible wrong answers to the exercises of chapter 02."""

import numpy as np


def distance_for_depth():
    distance = 2 * np.hypot(1, [0.75, 0.25, -0.25, -0.75])
    return 1 / distance, distance


def depth_for_distance():
    return np.full(4, 0.5), np.full(4, 2.0)


def slopes_at_the_rims():
    return np.full(4, 0.5), 2 * np.hypot(1, np.linspace(1, -1, 4))


def distances_for_depths(p, q):
    (s0, w0), (s1, w1) = ((y / x, 1 / np.hypot(x, y)) for x, y in (p, q))
    b = (w1 - w0) / (s1 - s0)
    return w0 - b * s0, b


def slope_first(p, q):
    (s0, w0), (s1, w1) = ((y / x, 1 / x) for x, y in (p, q))
    b = (w1 - w0) / (s1 - s0)
    return b, w0 - b * s0


def depth_linear_in_slope(p, q):
    (s0, x0), (s1, x1) = ((y / x, x) for x, y in (p, q))
    b = (x1 - x0) / (s1 - s0)
    return x0 - b * s0, b


def greatest_of_the_faces(faces, others, s):
    w_in = np.max([a + b * s for a, b in faces], axis=0)
    w_out = np.max([0 * s] + [a + b * s for a, b in others], axis=0)
    return np.where(w_in > w_out, w_in, 0)


def least_of_the_others(faces, others, s):
    w_in = np.min([a + b * s for a, b in faces], axis=0)
    w_out = np.min([a + b * s for a, b in others], axis=0)
    return np.where(w_in > w_out, w_in, 0)


def first_face_alone(faces, others, s):
    w_in = faces[0][0] + faces[0][1] * s
    w_out = np.max([a + b * s for a, b in others], axis=0)
    return np.where(w_in > w_out, w_in, 0)


def left_rims(n_columns):
    return 1 - 2 * np.arange(n_columns) / n_columns


def rightmost_first(n_columns):
    return (2 * np.arange(n_columns) + 1) / n_columns - 1


WRONG = {"2.1": [distance_for_depth, depth_for_distance, slopes_at_the_rims],
         "2.2": [distances_for_depths, slope_first, depth_linear_in_slope],
         "2.3": [greatest_of_the_faces, least_of_the_others, first_face_alone],
         "2.4": [left_rims, rightmost_first]}
