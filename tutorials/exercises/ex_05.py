"""Exercises of chapter 05. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main


def predict():
    """Exercise 5.1: (words in ascending order, number of edges) of the second page."""
    raise NotImplementedError("exercise 5.1")


def word(label, x0, y0, x1, y1):
    """Exercise 5.2: the word (int) of a box of class `label`, half-open, whole px of the 512 x 512 view."""
    raise NotImplementedError("exercise 5.2")


def smallest_region(height, width):
    """Exercise 5.3: how many pixels (int) a region must have in an image of this size to be kept."""
    raise NotImplementedError("exercise 5.3")


def count_regions(labels):
    """Exercise 5.4: number of connected regions of an image (H, W). Right for most images; find the bug."""
    name = {}
    for y, x in np.ndindex(labels.shape):
        name[y, x] = (y, x)  # a new region, unless it goes on from the left or from above
        if x > 0 and labels[y, x - 1] == labels[y, x]:
            name[y, x] = name[y, x - 1]
        if y > 0 and labels[y - 1, x] == labels[y, x]:
            name[y, x] = name[y - 1, x]
    return len(set(name.values()))


def grade_5_1(predict):
    words, n_edges = predict()
    expect("number of words", len(words), 4)
    expect("words", words, [22, 43, 94, 119])
    expect("edges", n_edges, 4)


def grade_5_2(word):
    expect("the sofa of the chapter", word(6, 256, 320, 448, 448), 179)
    expect("S = S_o - 1", word(3, 0, 0, 127, 129), 81)
    expect("S = S_o", word(3, 0, 0, 128, 128), 90)
    expect("S = 6 S_o - 22", word(3, 0, 0, 313, 314), 90)
    expect("S = 6 S_o", word(3, 0, 0, 384, 256), 100)
    expect("a centre that is no whole number, just before the line", word(5, 120, 0, 221, 80), 135)
    expect("a centre just behind the line", word(5, 121, 0, 222, 80), 136)
    expect("just before and behind the other line", [word(0, 340, 0, 342, 1), word(0, 340, 0, 343, 1)], [1, 2])
    expect("the lines between rows", [word(0, 0, y, 1, y + 1) for y in (170, 171, 340, 341)], [0, 3, 3, 6])
    expect("right and high, left and low", [word(0, 400, 0, 500, 100), word(0, 0, 400, 100, 500)], [2, 6])


def grade_5_3(smallest_region):
    expect("the view itself", smallest_region(512, 512), 5000)
    expect("64 x 64", smallest_region(64, 64), 79)
    expect("8 x 8", smallest_region(8, 8), 2)
    expect("one that is not square", smallest_region(480, 640), 5860)


def grade_5_4(count_regions):
    expect("one colour", count_regions(np.zeros((3, 4), int)), 1)
    expect("two halves", count_regions(np.array([[0, 0, 1]] * 2)), 2)
    expect("pixels that touch at a corner", count_regions(np.array([[0, 1], [1, 0]])), 4)
    expect("a U in a field", count_regions(np.array([[1, 0, 1], [1, 0, 1], [1, 1, 1]])), 2)
    comb = np.indices((8, 9))[1] % 2
    comb[-1] = 0
    expect("a comb of five teeth", count_regions(comb), 5)
    wide = np.array([[1, 1, 0, 1, 1], [1, 0, 0, 0, 1], [1, 1, 1, 1, 1]])
    expect("a U with thick ends", count_regions(wide), 2)
    expect("a ring around one pixel", count_regions(np.array([[2, 2, 2], [2, 1, 2], [2, 2, 2]])), 2)
    maze = np.array([[0, 0, 0, 0, 1], [1, 0, 1, 1, 1], [1, 1, 1, 1, 0], [1, 1, 1, 0, 1], [1, 0, 1, 1, 1]])
    expect("one that goes around corners", count_regions(maze), 5)


TASKS = {
    "5.1": (predict, grade_5_1),
    "5.2": (word, grade_5_2),
    "5.3": (smallest_region, grade_5_3),
    "5.4": (count_regions, grade_5_4),
}

if __name__ == "__main__":
    main(TASKS)
