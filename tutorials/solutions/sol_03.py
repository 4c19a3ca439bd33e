"""Solutions of chapter 03."""

import numpy as np

HEIGHT_M = 1.25


def three_rows():
    """y = (1 - (z - h) w) H / 2."""
    return [(1 - (z - HEIGHT_M) / 2) * 256 for z in (0.8, 0.0, 2.05)]


def lowest_bit(n):
    """n ^ (n - 1) is ones up to the lowest bit of n."""
    return (n ^ (n - 1)).bit_length() - 1


def visible(begin, end, size):
    """The painter's way: from far to near, each over what is there."""
    shown = np.full(size, -1)
    for i in reversed(range(len(begin))):
        shown[begin[i]:end[i]] = i
    return shown


def top_of_wall(distance, s, z, size):
    """Rows go by depth, and depth is the distance over the length of (1, s)."""
    w = np.hypot(1, s) / np.asarray(distance)
    return (1 - (z - HEIGHT_M) * w) * size / 2
