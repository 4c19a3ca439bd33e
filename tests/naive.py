"""The plain way to compute what gnl computes fast: slow, obvious, and the judge of the fast way."""

import numpy as np

from gnl.camera import HEIGHT_M
from gnl.classes import CEILING, FLOOR
from gnl.strip import FIELD_OF_VIEW_RAD, NEAREST_M


def nearest(points, queries, k):
    """The k nearest points of each query by looking at all, ties to the lower index; inf, -1 if too few."""
    points, queries = np.asarray(points, float), np.asarray(queries, float)
    distances, ids = np.full((len(queries), k), np.inf), np.full((len(queries), k), -1)
    for b, query in enumerate(queries):
        all_distances = np.sqrt(((points - query) ** 2).sum(axis=1))
        order = np.lexsort((np.arange(len(points)), all_distances))[:k]
        distances[b, :len(order)], ids[b, :len(order)] = all_distances[order], order
    return distances, ids


def pierce(world, box, start, directions):
    """Where rays enter and leave a box, in multiples of their directions: by slabs (Kay and Kajiya 1986).

    start (2,) and directions (..., 2) ask for the footprint, (3,) and (..., 3) for the box itself.
    A ray that misses enters after it leaves.
    """
    n, c, s = len(start), np.cos(world.angle[box]), np.sin(world.angle[box])
    into_frame = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])[:n, :n]
    start = into_frame @ (start - np.append(world.centre[box], 0.0)[:n])
    directions = directions @ into_frame.T
    low = np.append(-world.half[box], world.z[box, 0])[:n]
    high = np.append(world.half[box], world.z[box, 1])[:n]
    with np.errstate(divide="ignore"):
        one_plane, other_plane = (low - start) / directions, (high - start) / directions
    return np.minimum(one_plane, other_plane).max(-1), np.maximum(one_plane, other_plane).min(-1)


def slopes_of_pixels(n):
    """Left (of columns) or up (of rows) per metre ahead, at the middle of each pixel: (n,), 0 the outermost."""
    return np.tan(FIELD_OF_VIEW_RAD / 2) * (1 - (2 * np.arange(n) + 1) / n)


def strip(world, pose, n_columns):
    """Crossings of one view, ray by ray: a list, near to far, of (distance in, distance out, box) for each ray."""
    x, y, theta = pose
    rays = []
    for slope in slopes_of_pixels(n_columns):
        ahead, left = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])
        crossings, wall = [], np.inf
        for box in range(len(world.label)):
            near, far = pierce(world, box, np.array([x, y]), ahead + slope * left)
            near = max(near, NEAREST_M)
            if near < far:
                crossings.append((near * np.hypot(1, slope), far * np.hypot(1, slope), box))
                if world.z[box, 0] <= 0 and world.z[box, 1] >= world.wall_height:
                    wall = min(wall, crossings[-1][0])
        rays.append(sorted(crossing for crossing in crossings if crossing[0] <= wall))
    return rays


def labels(world, pose, size):
    """True labels of one view, (size, size): each pixel's ray shows what it meets first, a box, floor or ceiling."""
    x, y, theta = pose
    left, up = np.meshgrid(slopes_of_pixels(size), slopes_of_pixels(size))
    directions = np.stack([np.cos(theta) - left * np.sin(theta), np.sin(theta) + left * np.cos(theta), up], -1)
    label = np.where(up > 0, CEILING, FLOOR)
    nearest = np.where(up > 0, world.wall_height - HEIGHT_M, -HEIGHT_M) / up
    for box in range(len(world.label)):
        near, far = pierce(world, box, np.array([x, y, HEIGHT_M]), directions)
        near = near.clip(NEAREST_M)
        first = (near < far) & (near < nearest)
        label[first], nearest[first] = world.label[box], near[first]
    return label


def within_polygon(points, polygon):
    """Which points lie within a polygon: a ray to the right crosses its rim an odd number of times."""
    inside = np.zeros(len(points), bool)
    for i, (x, y) in enumerate(points):
        for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, 0), strict=True):
            if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0):
                inside[i] = not inside[i]
    return inside
