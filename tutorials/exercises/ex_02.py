"""Exercises of chapter 02. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main


def wall_ahead():
    """Exercise 2.1: a wall 2 m straight ahead, the line x = 2; four columns, 90 degrees of view.

    returns : the inverse depth in each column (4,), and the distance along the ray in each column (4,)
    """
    raise NotImplementedError("exercise 2.1")


def line_through(p, q):
    """Exercise 2.2: (a, b) of the line through two points (x, y), x > 0 ahead, y to the left: on it w = a + b s."""
    raise NotImplementedError("exercise 2.2")


def cross(faces, others, s):
    """Exercise 2.3: inverse depth at which rays enter a box, 0 where they miss it: (C,).

    faces (F, 2), others (O, 2) : lines (a, b) of the faces that the camera sees, and the other lines;  s (C,) slopes
    """
    raise NotImplementedError("exercise 2.3")


def my_slopes(n_columns):
    """Exercise 2.4: slopes of the rays of 90 degrees, column 0 the leftmost. There is a bug in here: mend it."""
    return np.linspace(1, -1, n_columns)


def grade_2_1(wall_ahead):
    w, distance = wall_ahead()
    expect("inverse depths", w, [0.5, 0.5, 0.5, 0.5])
    expect("distances along the rays", np.round(distance, 3), [2.5, 2.062, 2.062, 2.5])


def grade_2_2(line_through):
    expect("the wall x + y = 4", line_through((3.0, 1.0), (1.0, 3.0)), [0.25, 0.25])
    expect("the wall x = 2", line_through((2.0, -1.0), (2.0, 5.0)), [0.5, 0.0])
    expect("the wall y = -0.5", line_through((2.0, -0.5), (4.0, -0.5)), [0.0, -2.0])
    expect("the wall 3 x - 2 y = 5", line_through((3.0, 2.0), (5.0, 5.0)), [0.6, -0.4])


def grade_2_3(cross):
    s = np.array([0.875, 0.625, 0.375, 0.125, -0.125, -0.375, -0.625, -0.875])
    box = np.array([[0.5, 0.0]]), np.array([[1 / 3, 0.0], [0.0, 1.0], [0.0, -2.0]])
    expect("the box of the chapter", cross(*box, s), [0, 0, 0.5, 0.5, 0.5, 0, 0, 0])
    corner = np.array([[0.4, 0.4], [0.4, -0.4]]), np.array([[0.2, 0.2], [0.2, -0.2]])
    expect("a box that shows a corner", cross(*corner, s[2:6]), [0, 0.35, 0.35, 0])
    behind = np.array([[-1.0, 0.0]]), np.array([[-0.5, 0.0], [0.0, 1.0], [0.0, -1.0]])
    expect("a box behind the camera", cross(*behind, s[:2]), [0, 0])


def grade_2_4(my_slopes):
    expect("four slopes", my_slopes(4), [0.75, 0.25, -0.25, -0.75])
    expect("one column looks straight ahead", my_slopes(1), [0])
    expect("two of 512", np.asarray(my_slopes(512))[[0, 256]], [511 / 512, -1 / 512])


TASKS = {"2.1": (wall_ahead, grade_2_1), "2.2": (line_through, grade_2_2), "2.3": (cross, grade_2_3),
         "2.4": (my_slopes, grade_2_4)}

if __name__ == "__main__":
    main(TASKS)
