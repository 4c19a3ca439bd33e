"""Solutions of chapter 01."""

import numpy as np


def numbers_of_places():
    """5 x 5, 6 x 5 and 7 x 5 cells of 12 bearings."""
    return 300, 360, 420


def corners(centre, half, angle):
    """The centre, and from there along both axes of the box."""
    ahead, left = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    signs = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    return centre + signs * half @ np.array([ahead, left])


def middle_of(place, origin, ny):
    """Digits of the place, the last first."""
    cell, ib = divmod(place, 12)
    ix, iy = divmod(cell, ny)
    return origin[0] + 2 * (ix + 0.5), origin[1] + 2 * (iy + 0.5), (ib + 0.5) * np.pi / 6


def distance_to_box(point, centre, half, angle):
    """The point turned by minus the angle of the box: the signs of the sines were wrong."""
    (x, y), (a, b) = np.subtract(point, centre), half
    u = x * np.cos(angle) + y * np.sin(angle)
    v = y * np.cos(angle) - x * np.sin(angle)
    return np.hypot(max(0.0, abs(u) - a), max(0.0, abs(v) - b))
