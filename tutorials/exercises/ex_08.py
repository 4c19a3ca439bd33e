"""Exercises of chapter 08. Answer or mend each function, then run this file."""

import numpy as np
from grader import expect, main


def predict_resampling():
    """Exercise 8.1: two lists, the particles drawn for weights .1 .2 .3 .4 with u = 0.5 and with u = 0.05."""
    raise NotImplementedError("exercise 8.1")


def systematic_resample(weights, u):
    """Exercise 8.2: weights (M,) >= 0 of any sum > 0, u in [0, 1) -> particle of each copy, (M,) int, ascending."""
    raise NotImplementedError("exercise 8.2")


def effective(weights):
    """Exercise 8.3: weights (M,) >= 0 of any sum > 0 -> the number of effective particles, 1 .. M."""
    raise NotImplementedError("exercise 8.3")


def pool(places, weights, n_places):
    """Exercise 8.4, to be mended: places (M,), weights (M,) -> the sum of the weights in each place, (n_places,)."""
    pooled = np.zeros(n_places)
    pooled[places] += weights
    return pooled


def bayes_step(belief, likelihood, p_move):
    """Exercise 8.5: belief (N,) on a ring, likelihood (N,) >= 0 -> belief after moving and seeing (N,)."""
    raise NotImplementedError("exercise 8.5")


def grade_8_1(predict_resampling):
    half, early = predict_resampling()
    expect("drawn for u = 0.5", half, [1, 2, 3, 3])
    expect("drawn for u = 0.05", early, [0, 1, 2, 3])


def grade_8_2(systematic_resample):
    expect("equal weights", systematic_resample(np.full(4, 0.25), 0.5), [0, 1, 2, 3])
    expect("the four of the chapter, u = 0.4", systematic_resample(np.array([3, 1, 1, 1]) / 6, 0.4), [0, 0, 1, 3])
    expect("weights 1 2 3 4, u = 0.5", systematic_resample(np.array([1.0, 2, 3, 4]), 0.5), [1, 2, 3, 3])
    expect("no weight at entry 0, u = 0", systematic_resample(np.array([0, 0.5, 0.5]), 0.0)[0], 1)
    just_below_1 = np.nextafter(1, 0)
    expect("no weight at entry 3, u just below 1", systematic_resample(np.array([1.0, 1, 1, 0]), just_below_1)[-1], 2)
    weights, copies = np.array([0.05, 0.6, 0, 0.25, 0.1]), np.zeros(5)
    for u in (np.arange(500) + 0.5) / 500:
        copies += np.bincount(systematic_resample(weights, u), minlength=5) / 500
    expect("mean copies over all u", copies, 5 * weights, 0.01)


def grade_8_3(effective):
    expect("four equal weights", effective(np.full(4, 0.25)), 4)
    expect("all on one particle", effective(np.array([0, 0, 1.0])), 1)
    expect("the four of the chapter", effective(np.array([3, 1, 1, 1]) / 6), 3)
    expect("weights that sum to 6", effective(np.array([3.0, 1, 1, 1])), 3)


def grade_8_4(pool):
    places, weights = np.array([2, 0, 2, 2, 4]), np.array([0.1, 0.2, 0.3, 0.15, 0.25])
    expect("pooled", pool(places, weights, 6), [0.2, 0, 0.55, 0, 0.25, 0])
    expect("pooled, other places", pool(np.array([1, 1]), np.array([0.5, 0.5]), 2), [0, 1])


def grade_8_5(bayes_step):
    start = np.array([0.5, 0.3, 0.2])
    expect("who surely moves is one cell on", bayes_step(np.array([1.0, 0, 0]), np.ones(3), 1.0), [0, 1, 0])
    expect("all views alike", bayes_step(start, np.ones(3), 0.8), [0.26, 0.46, 0.28])
    expect("a view of cell 1 or 2", bayes_step(start, np.array([0, 0.5, 1]), 0.8), np.array([0, 0.23, 0.28]) / 0.51)
    expect("a view that nothing explains", bayes_step(start, np.zeros(3), 1.0), [0.2, 0.5, 0.3])
    certain, elsewhere = np.array([1.0, 0, 0]), np.array([1.0, 0, 1.0])
    expect("a view that rules out where the robot must be", bayes_step(certain, elsewhere, 1.0), [0, 1, 0])
    expect("belief that was put in", start, [0.5, 0.3, 0.2])


TASKS = {"8.1": (predict_resampling, grade_8_1), "8.2": (systematic_resample, grade_8_2), "8.3": (effective, grade_8_3),
         "8.4": (pool, grade_8_4), "8.5": (bayes_step, grade_8_5)}

if __name__ == "__main__":
    main(TASKS)
