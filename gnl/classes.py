"""The ten words of the paper (section IV-A) and the translation from ADE20K's 150.

A label image holds the index of a class in CLASSES: 0 wall, 1 floor, ... 9 other.
"""

import numpy as np

# To add one: its name and its constant below, PALETTE, the three tables of colours in world.py, GRAIN in photo.py, and
# things of that class in data_gen/furniture.py; then learn anew. Tests that expect the paper's ten will fail.
CLASSES = ("wall", "floor", "ceiling", "bed", "door", "table", "sofa", "refrigerator", "tv", "other")
WALL, FLOOR, CEILING, BED, DOOR, TABLE, SOFA, REFRIGERATOR, TV, OTHER = range(len(CLASSES))
N_CLASSES = len(CLASSES)

# One colour a class, the same in every picture, distinct for colour-blind eyes too (after Okabe and Ito 2008,
# with three greys for the shell of a room).
PALETTE = np.array([
    [200, 200, 200], [92, 82, 74], [240, 238, 232], [0, 114, 178], [230, 159, 0],
    [0, 158, 115], [204, 121, 167], [86, 180, 233], [20, 20, 20], [240, 228, 66],
], np.uint8)


def class_of(name):
    """Index of a class by its name, without regard to case; a name that is no class is `other`."""
    name = str(name).strip().lower()
    return CLASSES.index(name) if name in CLASSES else OTHER


# Indices 1..150 of the ADE20K scene parsing benchmark that map to one of the ten; all others, and 0, are `other`.
# The strict reading: only the class itself ("bed"), not its relatives ("cradle").
ADE20K = {1: WALL, 4: FLOOR, 6: CEILING, 8: BED, 15: DOOR, 16: TABLE, 24: SOFA, 51: REFRIGERATOR, 90: TV}


def from_ade20k(labels):
    """Labels of the ten classes from ADE20K's indices 0..150, of any shape; ValueError for others."""
    labels = np.asarray(labels)
    if not np.issubdtype(labels.dtype, np.integer):
        raise ValueError(f"labels: expected whole numbers, found {labels.dtype}")
    if labels.size and not 0 <= labels.min() <= labels.max() <= 150:
        raise ValueError(f"labels: expected ADE20K's indices 0..150, found {labels.min()}..{labels.max()}")
    table = np.full(151, OTHER, np.uint8)
    table[list(ADE20K)] = list(ADE20K.values())
    return table[labels]
