"""Exercises of chapter 09. Answer or mend each function, then run this file."""

import numpy as np
from grader import expect, main


def predict_three_walks():
    """Exercise 9.1: Q of going right in cells 0 to 3 after three walks with alpha 1 and gamma 0.5, four numbers."""
    raise NotImplementedError("exercise 9.1")


def updated(q, reward, ahead, done, alpha, gamma):
    """Exercise 9.2: Q(s, a) before, reward, Q-values of all actions in the next state (A,), done -> Q(s, a) after."""
    raise NotImplementedError("exercise 9.2")


def q_of_neighbours(states, values, query, k):
    """Exercise 9.3: states (n, K), oldest first, values (n,), query (K,) -> Q(s, a); ties go to the older pair."""
    raise NotImplementedError("exercise 9.3")


def distance_to_box(query, low, high):
    """Exercise 9.4, to be mended: query, corners low, high (dim,) -> distance to the nearest point of the box."""
    to_side = np.minimum(abs(query - low), abs(query - high))
    return np.sqrt((to_side ** 2).sum())


def most_in_common(K):
    """Exercise 9.5: greatest dot product of two permutations of 1, 1/2, ..., 1/K with their 1s in different places."""
    raise NotImplementedError("exercise 9.5")


def grade_9_1(predict_three_walks):
    expect("Q after three walks", predict_three_walks(), [0, 0.25, 0.5, 1])


def grade_9_2(updated):
    ahead = np.array([0.2, 0.6, -1.0])
    expect("on the way", updated(0.5, 1.0, ahead, False, 0.1, 0.9), 0.604)
    expect("at the end", updated(0.5, 1.0, ahead, True, 0.1, 0.9), 0.55)
    expect("a bad outlook", updated(0.0, -1.0, np.array([-0.5, -0.2]), False, 0.5, 0.5), -0.55)


def grade_9_3(q_of_neighbours):
    states = np.array([[0.0, 0], [3, 4], [1, 0], [0, 2], [9, 9]])
    values = np.array([1.0, 10, 2, 4, 100])
    expect("a new state, k = 3", q_of_neighbours(states, values, np.array([0.5, 0.5]), 3), 7 / 3)
    expect("a new state, k = 1", q_of_neighbours(states, values, np.array([3.0, 3.9]), 1), 10)
    expect("exact revisit of entry 0", q_of_neighbours(states, values, np.array([0.0, 0]), 4), 1)
    expect("exact revisit of entry 3", q_of_neighbours(states, values, np.array([0.0, 2]), 2), 4)
    expect("fewer than k", q_of_neighbours(states[:2], values[:2], np.array([1.0, 1]), 4), 5.5)
    expect("nothing stored", q_of_neighbours(states[:0], values[:0], np.array([1.0, 1]), 4), 0)
    states, values = np.array([[3, 0, 0], [2, 2, 0], [1.9, 1.9, 1.9]]), np.array([0.0, 2, 3])
    expect("the nearest as the crow flies", q_of_neighbours(states, values, np.zeros(3), 1), 2)
    expect("exact revisit, fewer than k", q_of_neighbours(states, values, states[2], 4), 3)
    expect("exact revisit of a pair worth 0", q_of_neighbours(states, values, states[0], 2), 0)
    expect("near is not the same", q_of_neighbours(states, values, np.array([3.01, 0, 0]), 2), 1)
    ties = np.where(np.arange(40) % 2, 1.0, -2.0)[:, None]
    expect("ties go to the older pair", q_of_neighbours(ties, np.arange(40.0), np.zeros(1), 3), 3)


def grade_9_4(distance_to_box):
    low, high = np.array([0.0, 0]), np.array([2.0, 4])
    expect("inside", distance_to_box(np.array([1.0, 1]), low, high), 0)
    expect("beside", distance_to_box(np.array([5.0, 2]), low, high), 3)
    expect("below", distance_to_box(np.array([1.5, -0.5]), low, high), 0.5)
    expect("beyond a corner", distance_to_box(np.array([-3.0, 8]), low, high), 5)
    expect("above a cube", distance_to_box(np.array([1.0, 1, 9]), np.zeros(3), np.full(3, 2.0)), 7)


def grade_9_5(most_in_common):
    expect("K = 2", most_in_common(2), 1)
    expect("K = 4", most_in_common(4), 1 + 1 / 9 + 1 / 16)
    expect("K = 360", most_in_common(360), (1 / np.arange(1, 361) ** 2).sum() - 0.25)


TASKS = {"9.1": (predict_three_walks, grade_9_1), "9.2": (updated, grade_9_2), "9.3": (q_of_neighbours, grade_9_3),
         "9.4": (distance_to_box, grade_9_4), "9.5": (most_in_common, grade_9_5)}

if __name__ == "__main__":
    main(TASKS)
