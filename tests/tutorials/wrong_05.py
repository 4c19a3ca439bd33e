"""Wrong answers to the exercises of chapter 05, each of which its grader must reject."""

import numpy as np
from scipy import ndimage


def size_of_the_region():
    return [22, 43, 94, 110], 4  # a door of 4 cells taken for small


def all_pairs():
    return [22, 43, 94, 119], 6


def specks_too():
    return [22, 43, 94, 119, 248], 5


def word_of(label, x0, y0, x1, y1, medium=16384, large=6 * 16384, cell=512 / 3, by_column=False):
    S = (x1 - x0) * (y1 - y0)
    column, row = int((x0 + x1) / 2 // cell), int((y0 + y1) / 2 // cell)
    location = column * 3 + row if by_column else row * 3 + column
    return (label * 3 + (medium <= S) + (large <= S)) * 9 + location


def strictly_more(*box):
    return word_of(*box, medium=16385, large=6 * 16384 + 1)


def cells_of_170(*box):
    return word_of(*box, cell=170)


def cells_of_171(*box):
    return word_of(*box, cell=171)


def rows_at_200_and_300(label, x0, y0, x1, y1):
    row = int(y0 + y1 >= 400) + int(y0 + y1 >= 600)
    return word_of(label, x0, y0, x1, y1) // 9 * 9 + 3 * row + int((x0 + x1) / 2 * 3 // 512)


def down_before_across(*box):
    return word_of(*box, by_column=True)


def rounded_down(height, width):
    return 5000 * height * width // 512 ** 2


def one_more(height, width):
    return 5000 * height * width // 512 ** 2 + 1


def by_the_width(height, width):
    return -(-5000 * width ** 2 // 512 ** 2)


def by_corners_too(labels):
    return sum(ndimage.label(labels == c, np.ones((3, 3)))[1] for c in np.unique(labels))


def only_the_pixel_to_the_left(labels):
    name = {}
    for y, x in np.ndindex(labels.shape):
        name[y, x] = (y, x)
        if x > 0 and labels[y, x - 1] == labels[y, x]:
            name[y, x] = name[y, x - 1]
        if y > 0 and labels[y - 1, x] == labels[y, x]:
            if x > 0 and labels[y, x - 1] == labels[y, x]:
                name[y, x - 1] = name[y - 1, x]
            name[y, x] = name[y - 1, x]
    return len(set(name.values()))


def one_a_class(labels):
    return len(np.unique(labels))


def one_alias_a_name(labels):
    name, same = {}, {}
    for y, x in np.ndindex(labels.shape):
        near = [name[p] for p in ((y, x - 1), (y - 1, x)) if p in name and labels[p] == labels[y, x]]
        name[y, x] = min(near, default=len(name))
        if len(set(near)) == 2:
            same[max(near)] = min(near)  # and what it was the same as is forgotten

    def first(n):
        return first(same[n]) if n in same else n

    return len({first(n) for n in name.values()})


def meetings_taken_off(labels):
    new = merged = 0
    for y, x in np.ndindex(labels.shape):
        left = x > 0 and labels[y, x - 1] == labels[y, x]
        above = y > 0 and labels[y - 1, x] == labels[y, x]
        new += not (left or above)
        merged += left and above and labels[y - 1, x - 1] != labels[y, x]
    return new - merged


WRONG = {
    "5.1": [size_of_the_region, all_pairs, specks_too],
    "5.2": [strictly_more, cells_of_170, cells_of_171, rows_at_200_and_300, down_before_across],
    "5.3": [rounded_down, one_more, by_the_width],
    "5.4": [by_corners_too, only_the_pixel_to_the_left, one_a_class, one_alias_a_name, meetings_taken_off],
}
