"""From a polygon to the rotated rectangles that cover it: one for a plain shape, several for an L or a U."""

import numpy as np

WORTH_CUTTING = 0.9  # a concave polygon is cut if that shrinks its cover to less than this share


def cover_polygon(polygon):
    """Rectangles that together cover `polygon`, as rows (x, y, half length, half width, angle).

    A convex polygon gets its smallest rectangle. A concave one is cut from the best of its inner
    corners, along a side that ends there, and its pieces likewise, if their rectangles are clearly smaller in all.
    """
    polygon = np.asarray(polygon, float)
    whole = smallest_rectangle(polygon)
    cuts = [cut for cut in (_cut(polygon, i) for i in inner_corners(polygon)) if cut]
    if not cuts:
        return [whole]
    best = min(cuts, key=lambda pieces: sum(_area(smallest_rectangle(piece)) for piece in pieces))
    boxes = [box for piece in best for box in cover_polygon(piece)]
    return boxes if sum(map(_area, boxes)) < WORTH_CUTTING * _area(whole) else [whole]


def footprints(rectangles):
    """Centre (N, 2), half the sides (N, 2) and angle (N,) of rows that begin as those of `cover_polygon`."""
    rows = np.asarray(rectangles)
    return rows[:, 0:2], rows[:, 2:4], rows[:, 4]


def smallest_rectangle(points):
    """Rectangle of least area around `points` (n, 2), of those with a side along one of theirs."""
    sides = np.roll(points, -1, 0) - points
    sides = sides[np.hypot(*sides.T) > 1e-9]
    angles = np.unique(np.round(np.arctan2(sides[:, 1], sides[:, 0]) % (np.pi / 2), 9)) if len(sides) else [0.0]

    def around(angle):
        axes = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        low, high = (points @ axes.T).min(0), (points @ axes.T).max(0)
        return (*((low + high) / 2 @ axes), *((high - low) / 2), angle)

    return min(map(around, angles), key=_area)


def _area(rectangle):
    return 4 * rectangle[2] * rectangle[3]


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def inner_corners(polygon):
    """Indices of the inner (reflex) corners: they turn against the polygon's orientation."""
    before, after = polygon - np.roll(polygon, 1, 0), np.roll(polygon, -1, 0) - polygon
    turning = _cross(before, after)
    around = _cross(polygon, np.roll(polygon, -1, 0)).sum()
    return np.flatnonzero(turning * np.sign(around) < -1e-9)


def _cut(polygon, i):
    """Two pieces of `polygon`, cut from inner corner i straight on along the side that arrives there."""
    P, n = np.roll(polygon, -i, 0), len(polygon)  # P[0] is the corner, P[-1] the point before it
    d = P[0] - P[-1]
    hits = []  # (how far along the cut, side j, point)
    for j in range(1, n - 1):
        side = P[j + 1] - P[j]
        slope = _cross(d, side)
        if abs(slope) > 1e-12:
            t, u = _cross(P[j] - P[0], side) / slope, _cross(P[j] - P[0], d) / slope
            if t > 1e-9 and -1e-9 <= u <= 1 + 1e-9:
                hits.append((t, j, P[0] + t * d))
    if not hits:
        return ()
    _, j, X = min(hits, key=lambda hit: hit[0])
    return np.vstack([P[:j + 1], X]), np.vstack([P[0], X, P[j + 1:]])
