"""Exercises of chapter 03. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main

HEIGHT_M = 1.25  # of the camera


def three_rows():
    """Exercise 3.1: row coordinates y at depth 2 m in an image of 512 rows and 90 degrees.

    returns : y of the top of a sofa (0.8 m), of its foot (0 m), of the underside of a lamp (2.05 m)
    """
    raise NotImplementedError("exercise 3.1")


def lowest_bit(n):
    """Exercise 3.2: index of the lowest bit that is on, of an int n > 0: 1 -> 0, 2 -> 1, 12 -> 2."""
    raise NotImplementedError("exercise 3.2")


def visible(begin, end, size):
    """Exercise 3.3: which surface each of `size` rows shows, -1 for none: (size,) int.

    begin, end (S,) : surface i covers the rows begin[i] to end[i] - 1; surface 0 is the nearest
    """
    raise NotImplementedError("exercise 3.3")


def top_of_wall(distance, s, z, size):
    """Exercise 3.4: row coordinate of a wall's top in each column, (C,). There is a bug in here: mend it.

    distance (C,) m along the rays of slopes s (C,);  z [m] height of the wall;  size rows in the image
    """
    w = 1 / np.asarray(distance)
    return (1 - (z - HEIGHT_M) * w) * size / 2


def grade_3_1(three_rows):
    expect("sofa's top, its foot, lamp", np.round(three_rows(), 1), [313.6, 416.0, 153.6])


def grade_3_2(lowest_bit):
    for n, expected in ((1, 0), (2, 1), (3, 0), (12, 2), (40, 3), (2 ** 61 + 2 ** 60, 60), (2 ** 62 - 1, 0)):
        expect(f"lowest bit of {n:b}", lowest_bit(n), expected)


def grade_3_3(visible):
    def column(*intervals):
        return np.array(intervals, int).reshape(-1, 2).T

    expect("the column of the chapter", visible(*column((10, 13), (9, 10), (6, 11), (0, 8), (8, 16)), 16),
           [3] * 6 + [2] * 3 + [1] + [0] * 3 + [4] * 3)
    expect("nothing there", visible(*column(), 3), [-1, -1, -1])
    expect("a gap, and one behind another", visible(*column((1, 3), (0, 2), (5, 6)), 6), [1, 0, 0, -1, -1, 2])
    expect("three that begin or end together", visible(*column((0, 2), (0, 4), (1, 4)), 5), [0, 0, 1, 1, -1])
    expect("a far one behind two near ones", visible(*column((0, 2), (4, 5), (1, 6)), 7), [0, 0, 2, 2, 1, 2, -1])


def grade_3_4(top_of_wall):
    s = np.array([0.75, 0.25, -0.25, -0.75])
    expect("a wall 2 m straight ahead", top_of_wall(2 * np.hypot(1, s), s, 2.5, 512), [96, 96, 96, 96])
    w = (1 + s) / 4
    distance = np.hypot(1, s) / w
    kept = distance.copy()
    expect("the wall x + y = 4", top_of_wall(distance, s, 2.25, 16), [4.5, 5.5, 6.5, 7.5])
    expect("the distances after that", distance, kept)


TASKS = {"3.1": (three_rows, grade_3_1), "3.2": (lowest_bit, grade_3_2), "3.3": (visible, grade_3_3),
         "3.4": (top_of_wall, grade_3_4)}

if __name__ == "__main__":
    main(TASKS)
