"""Exercises of chapter 11. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main


def acceptance(n_tests, area_m2, t_xy_m, t_theta_deg):
    """Exercise 11.1: forecast of the share of uniform poses beyond the gap, a float, by the exponential of the chapter,
    and the draws needed on average for 10,000 of them, a float: (share, draws)."""
    raise NotImplementedError("exercise 11.1")


def beyond_gap(pose, tests, t_xy_m, t_theta_rad):
    """Exercise 11.2: whether one pose (3,) is beyond the gap from the test starts (m, 3): a bool."""
    raise NotImplementedError("exercise 11.2")


def take(now, before):
    """Exercise 11.3: indices (int array) of the values that a checkpoint must write down. There is a silent bug.

    now (n,), before (m,) values at this checkpoint and at the one before, m <= n
    """
    padded = np.append(before, np.zeros(len(now) - len(before)))
    return np.flatnonzero(padded != now)


def expected_best(p, n_episodes, n_checkpoints):
    """Exercise 11.4: mean share of right answers that the best of equal checkpoints shows, a float.

    Each of n_checkpoints is right with probability p in each of its own n_episodes.
    """
    raise NotImplementedError("exercise 11.4")


def grade_11_1(acceptance):
    share, draws = acceptance(100, 38.0, 0.2, 90)
    expect("share at 0.2 m, 90 degrees", share, 0.359212, 1e-4)
    expect("draws at 0.2 m, 90 degrees", draws, 27838.7, 1e-4)
    expect("share without a test", acceptance(0, 38.0, 1.0, 0)[0], 1.0)
    expect("share at 0.5 m, 45 degrees, 10 tests", acceptance(10, 20.0, 0.5, 45)[0], 0.506424, 1e-4)


def grade_11_2(beyond_gap):
    tests = np.array([[0.0, 0, 0], [1.0, 0, np.radians(179)]])
    half = np.radians(30)
    expect("near in location", beyond_gap(np.array([0.1, 0, np.pi]), tests, 0.2, half), False)
    expect("far and turned", beyond_gap(np.array([0.3, 0, 1.0]), tests, 0.2, half), True)
    expect("far, hardly turned", beyond_gap(np.array([0.3, 0, 0.1]), tests, 0.2, half), False)
    expect("bearing of the farther test", beyond_gap(np.array([0.3, 0, np.pi]), tests, 0.2, half), True)
    expect("179 and -179 degrees", beyond_gap(np.array([0.7, 0, np.radians(-179)]), tests, 0.2, half), False)
    expect("turned to the right", beyond_gap(np.array([0.3, 0, -1.0]), tests, 0.2, half), True)
    expect("just as far as the gap", beyond_gap(np.array([0.25, 0, 1.0]), tests, 0.25, half), False)
    expect("beyond in y", beyond_gap(np.array([0.0, 0.3, 1.0]), tests, 0.2, half), True)


def grade_11_3(take):
    expect("a changed value", take(np.array([0.1, 0.3]), np.array([0.1, 0.2])), [1])
    expect("a pair born with 0.5", take(np.array([0.1, 0.5]), np.array([0.1])), [1])
    expect("a pair born with 0", take(np.array([0.1, 0.0]), np.array([0.1])), [1])
    expect("a value that became 0", take(np.array([0.0, 0.2]), np.array([0.1, 0.2])), [0])
    expect("the first checkpoint", take(np.array([0.0, -1.0]), np.empty(0)), [0, 1])
    expect("nothing new", take(np.array([0.0, -1.0]), np.array([0.0, -1.0])), np.empty(0, int))


def grade_11_4(expected_best):
    expect("one checkpoint", expected_best(0.3, 10, 1), 0.3)
    expect("two checkpoints, one episode", expected_best(0.5, 1, 2), 0.75)
    expect("ten checkpoints, ten episodes", expected_best(0.545, 10, 10), 0.779360, 1e-5)
    expect("ten checkpoints, a hundred episodes", expected_best(0.545, 100, 10), 0.621208, 1e-5)


TASKS = {"11.1": (acceptance, grade_11_1), "11.2": (beyond_gap, grade_11_2), "11.3": (take, grade_11_3),
         "11.4": (expected_best, grade_11_4)}

if __name__ == "__main__":
    main(TASKS)
