"""Plausible wrong answers to the exercises of chapter 00."""

import numpy as np


def first_look_forgotten():
    return 4, 4, 40_000


def an_action_too_many():
    return 5, 5, 50_000


def not_moved():
    product = np.array([0.2, 0.3, 0.5]) * [0.6, 0.3, 0.1]
    return product / product.sum()


def moved_the_other_way():
    product = np.array([0.2, 0.3, 0.5])[[1, 2, 0]] * [0.6, 0.3, 0.1]
    return product / product.sum()


def not_normalised():
    return np.array([0.5, 0.2, 0.3]) * [0.6, 0.3, 0.1]


def all_in_episode():
    return ["episode.py"] * 4


def places_of_the_world():
    return "robot.py", "world.py", "scene_graph.py", "particles.py"


WRONG = {"0.1": [first_look_forgotten, an_action_too_many], "0.2": [not_moved, moved_the_other_way, not_normalised],
         "0.3": [all_in_episode, places_of_the_world]}
