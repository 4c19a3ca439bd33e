"""Exercises of chapter 12. Fill in each function, then run this file."""

import copy
import json

import numpy as np
from grader import expect, main


def with_box(plan, kind, x, y, width, depth, height):
    """Exercise 12.1: a new floor plan with one more object of class `kind` and of that height, on the floor.

    Its lower left corner is (x, y), width [m] goes along x, depth along y. The plan that was given stays as it is.
    """
    raise NotImplementedError("exercise 12.1")


def steady():
    """Exercise 12.2: a planner plan(step, states, rng) -> actions (B,).

    At step 0 each robot draws left (0) or right (1) by `rng`, each with probability 1/2; it keeps to that for the
    episode.
    """
    raise NotImplementedError("exercise 12.2")


def log_words(counts, unseen=0.1):
    """Exercise 12.3: log P(w | k) from counts (K, W) of words seen in each place: (K, W). There is a silent bug.

    unseen : added to every count
    """
    smooth = counts + unseen
    return np.log(smooth / smooth.sum(0))


def from_zero_based(labels):
    """Exercise 12.4: labels 0..9 of the ten classes, from ADE20K indices counted from 0 (0 is wall), 255 for none."""
    raise NotImplementedError("exercise 12.4")


def grade_12_1(with_box):
    plan = {"walls": [[0, 0, 4, 0]], "objects": [{"class": "bed", "polygon": [[0, 0], [1, 0], [1, 2]], "height": 0.5}]}
    before = copy.deepcopy(plan)
    new = with_box(plan, "sofa", 1.0, 2.0, 2.5, 0.9, 0.8)
    expect("number of objects", len(new["objects"]), 2)
    expect("the old plan is as it was", plan == before, True)
    thing = new["objects"][1]
    expect("class", thing["class"], "sofa")
    expect("height", thing["height"], 0.8)
    expect("bottom", thing.get("z0", 0.0), 0.0)
    corners = np.array(thing["polygon"], float)
    expect("shape of the polygon", str(corners.shape), "(4, 2)")
    expect("corners, sorted", sorted(corners.tolist()), [[1.0, 2.0], [1.0, 2.9], [3.5, 2.0], [3.5, 2.9]])
    (x, y), (next_x, next_y) = corners.T, np.roll(corners, -1, 0).T
    expect("area, corners in their order", abs((x * next_y - y * next_x).sum()) / 2, 2.25)
    expect("all else is as it was", {**new, "objects": new["objects"][:1]} == plan, True)
    expect("it can be written as JSON", json.loads(json.dumps(new)) == new, True)
    bare = {"walls": [[0, 0, 4, 0]]}
    expect("a plan without objects", len(with_box(bare, "tv", 0, 0, 1, 1, 1)["objects"]), 1)
    expect("the old plan without objects is as it was", bare == {"walls": [[0, 0, 4, 0]]}, True)


def grade_12_2(steady):
    plan, rng, states = steady(), np.random.default_rng(0), np.zeros((4000, 3))
    first = np.array(plan(0, states, rng))
    expect("shape of the actions", str(first.shape), "(4000,)")
    expect("left and right alone", np.unique(first), [0, 1])
    expect("each for about half of the robots", abs(first.mean() - 0.5) < 0.04, True)
    for step in (1, 2, 3):
        expect(f"the same in step {step}", plan(step, states, rng), first)
    other = steady()
    drawn = np.array(other(0, states, np.random.default_rng(0)))
    expect("the same luck draws the same", drawn, first)
    other(0, states, np.random.default_rng(1))
    expect("another planner has a memory of its own", plan(1, states, rng), first)
    again = np.array(plan(0, states, rng))
    expect("drawn anew in the next episode", bool((again != first).any()), True)
    expect("robots of the next group", np.shape(plan(0, np.zeros((7, 3)), rng)), (7,))


def grade_12_3(log_words):
    counts = np.array([[3.0, 1, 0], [0, 0, 2]])
    kept = counts.copy()
    found = log_words(counts, 1.0)
    expect("the counts after that", counts, kept)
    expect("sum over the words of a place", np.exp(found).sum(1), [1, 1])
    expect("log P", found, np.log([[4 / 7, 2 / 7, 1 / 7], [1 / 5, 1 / 5, 3 / 5]]))
    expect("a place where nothing was seen", log_words(np.zeros((1, 4))), np.log([[0.25] * 4]))


def grade_12_4(from_zero_based):
    seen, wanted = [0, 3, 5, 7, 14, 15, 23, 50, 89, 149, 255], [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9]
    expect("as int", from_zero_based(np.array(seen)), wanted)
    expect("as uint8", from_zero_based(np.array(seen, np.uint8)), wanted)
    expect("an image", from_zero_based(np.array([[0, 255], [8, 7]], np.uint8)), [[0, 9], [9, 3]])


TASKS = {"12.1": (with_box, grade_12_1), "12.2": (steady, grade_12_2), "12.3": (log_words, grade_12_3),
         "12.4": (from_zero_based, grade_12_4)}

if __name__ == "__main__":
    main(TASKS)
