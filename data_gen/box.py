"""Upright boxes that can be turned: the shape of all furniture while a home is being drawn.

A box has a front: it looks along its own +y, away from its back. A room is a box too, which looks away from
the wall with its door. `right` and `front` are metres from a box's centre as the box itself sees them.
"""

import math
from typing import NamedTuple

import numpy as np


class Box(NamedTuple):
    """Centre (x, y), angle, width along its own x, depth along its own y, height above z0; m and rad."""
    x: float
    y: float
    angle: float
    width: float
    depth: float
    height: float
    z0: float = 0.0


def shift(box, right, front):
    """The point (x, y) that a box sees at (right, front)."""
    c, s = math.cos(box.angle), math.sin(box.angle)
    return box.x + c * right - s * front, box.y + s * right + c * front


def seen(box, x, y):
    """Where a box sees the points (x, y), as (right, front); the inverse of shift."""
    c, s = math.cos(box.angle), math.sin(box.angle)
    return c * (x - box.x) + s * (y - box.y), c * (y - box.y) - s * (x - box.x)


def turned(box, quarters):
    """The same box, turned left by so many quarter turns: turned(room, k) has its wall k behind it."""
    w, d = (box.depth, box.width) if quarters % 2 else (box.width, box.depth)
    return box._replace(angle=box.angle + quarters * math.pi / 2, width=w, depth=d)


def outline(box):
    """(4, 2) corners of a box, counter-clockwise."""
    w, d = box.width / 2, box.depth / 2
    return np.array([shift(box, *corner) for corner in ((-w, -d), (w, -d), (w, d), (-w, d))])


def extent(box, angle):
    """Half of what a box measures along x and y axes that are turned by `angle`."""
    c, s = abs(math.cos(box.angle - angle)), abs(math.sin(box.angle - angle))
    return (c * box.width + s * box.depth) / 2, (s * box.width + c * box.depth) / 2


def inside(room, box, margin):
    """Whether a box keeps `margin` [m] from the edges of its room."""
    right, front = seen(room, box.x, box.y)
    x, y = extent(box, room.angle)
    return abs(right) + x <= room.width / 2 - margin and abs(front) + y <= room.depth / 2 - margin


def overlap(a, b):
    """Whether two boxes share space: not if an axis of either separates them. Touching is allowed."""
    if a.z0 >= b.z0 + b.height or b.z0 >= a.z0 + a.height:
        return False
    for box, other in ((a, b), (b, a)):
        right, front = seen(box, other.x, other.y)
        x, y = extent(other, box.angle)
        if abs(right) >= box.width / 2 + x or abs(front) >= box.depth / 2 + y:
            return False
    return True


def hits(box, others):
    """Whether a box shares space with any of the others."""
    return any(overlap(box, other) for other in others)


def distance(box, x, y):
    """Distance [m] of the points (x, y) to a box seen from above; 0 within it."""
    right, front = seen(box, x, y)
    return np.hypot(np.maximum(abs(right) - box.width / 2, 0), np.maximum(abs(front) - box.depth / 2, 0))
