"""Exercises of chapter 01. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main


def numbers_of_places():
    """Exercise 1.1: numbers of place classes in homes of 9.2 x 8.9 m, 12 x 10 m and 12.1 x 10 m; returns three ints."""
    raise NotImplementedError("exercise 1.1")


def corners(centre, half, angle):
    """Exercise 1.2: corners of a box's outline, (4, 2).

    centre (2,), half (2,) m and angle [rad] of a box; the corners are, in its frame, (+a, +b), (-a, +b), (-a, -b),
    (+a, -b), in this order.
    """
    raise NotImplementedError("exercise 1.2")


def middle_of(place, origin, ny):
    """Exercise 1.3: the pose (x, y, theta) in the middle of a place's cell, (3,); theta in [0, 2 pi).

    place = (ix * ny + iy) * 12 + ib; cells are 2 m x 2 m x 30 degrees and begin at `origin` (x0, y0)
    """
    raise NotImplementedError("exercise 1.3")


def distance_to_box(point, centre, half, angle):
    """Exercise 1.4: distance from a point (2,) to a box, 0 within it. There is a bug in here: mend it."""
    (x, y), (a, b) = np.subtract(point, centre), half
    u = x * np.cos(angle) - y * np.sin(angle)
    v = x * np.sin(angle) + y * np.cos(angle)
    return np.hypot(max(0.0, abs(u) - a), max(0.0, abs(v) - b))


def grade_1_1(numbers_of_places):
    expect("places of three homes", numbers_of_places(), [300, 360, 420])


def grade_1_2(corners):
    along_axes, quarter, turned = np.array([[[3, 1], [0.5, 0.2]], [[0, 0], [2, 1]], [[1, 2], [2, 1]]])
    expect("box along the axes", corners(*along_axes, 0.0), [[3.5, 1.2], [2.5, 1.2], [2.5, 0.8], [3.5, 0.8]])
    expect("a quarter turn", corners(*quarter, np.pi / 2), [[-1, 2], [-1, -2], [1, -2], [1, 2]])
    expect("turned by 0.3 rad", np.round(corners(*turned, 0.3), 4),
           [[2.6152, 3.5464], [-1.2062, 2.3643], [-0.6152, 0.4536], [3.2062, 1.6357]])


def grade_1_3(middle_of):
    expect("place 0", middle_of(0, (0.0, 0.0), 3), [1, 1, np.pi / 12])
    expect("place 56 of the two rooms", middle_of(56, (0.0, 0.0), 2), [5, 1, 17 * np.pi / 12])
    expect("place 131 of five rows from (-1, 2)", middle_of(131, (-1.0, 2.0), 5), [4, 3, 23 * np.pi / 12])
    expect("place 155 of five rows from (-1, 2)", middle_of(155, (-1.0, 2.0), 5), [4, 7, 23 * np.pi / 12])


def grade_1_4(distance_to_box):
    expect("a wall", distance_to_box((2.0, 1.0), (2.0, 0.0), (2.0, 0.05), 0.0), 0.95)
    expect("the table, from its tip", distance_to_box((2.0, 3.0), (3.0, 3.0), (0.5 ** 0.5 / 2,) * 2, np.pi / 4), 0.5)
    expect("in the middle", distance_to_box((1.0, 1.0), (1.0, 1.0), (0.3, 0.2), 0.7), 0.0)
    ahead = np.array([np.cos(0.5), np.sin(0.5)])
    expect("straight ahead of a turned box", distance_to_box(3 * ahead, (0.0, 0.0), (1.0, 0.2), 0.5), 2.0)
    expect("off its corner", distance_to_box(4 * ahead + 4.2 * ahead[::-1] * [-1, 1], (0.0, 0.0), (1.0, 0.2), 0.5), 5.0)


TASKS = {"1.1": (numbers_of_places, grade_1_1), "1.2": (corners, grade_1_2), "1.3": (middle_of, grade_1_3),
         "1.4": (distance_to_box, grade_1_4)}

if __name__ == "__main__":
    main(TASKS)
