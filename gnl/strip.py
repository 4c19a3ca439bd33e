"""The semantic strip: which boxes the rays of a view cross, near to far.

One ray leaves the camera for each image column. In inverse depth everything is linear: with the camera at the
origin, x ahead and y to the left, the ray of slope s is p = (1, s) / w, and a side n . p = m of a box meets it at

    w = (n_x + n_y s) / m.

A convex box is entered at the least w over the sides that face the camera (m < 0) and left at the greatest w over
those that do not; it is hit where w_in > w_out. (Cyrus and Beck 1978, in inverse depth.)

    B views   C columns   N boxes   P crossings
    s (C,)            slope of each column's ray, +1 at the left rim of a 90 degree view
    w_in, w_out [1/m] inverse depth at entry and exit; depth is measured along the optical axis
"""

from dataclasses import dataclass

import numpy as np

FIELD_OF_VIEW_RAD = np.pi / 2  # CHOICE: Habitat's default
TOP, UNDERSIDE = 4, 5  # faces of a box; 0..3 are its sides, counter-clockwise from the end of its first axis
NEAREST_M = 0.05  # nearer things are cut off: the camera sits inside the robot
IN_FRONT_M = 1e-9


@dataclass(frozen=True)
class Strip:
    """Crossings of all views, in no order; ray = view * n_columns + column."""

    n_views: int
    n_columns: int
    ray: np.ndarray  # (P,) int
    w_in: np.ndarray  # (P,) [1/m]
    w_out: np.ndarray  # (P,) [1/m]
    box: np.ndarray  # (P,) int
    side: np.ndarray  # (P,) 0..3, the one by which the ray enters

    def dense(self):
        """Near to far as arrays (B, C, D): distance in, distance out [m, along the ray], box; inf and -1 where none."""
        order = np.lexsort((-self.w_in, self.ray))
        ray, box, w_in, w_out = (a[order] for a in (self.ray, self.box, self.w_in, self.w_out))
        d = np.arange(len(ray)) - np.searchsorted(ray, ray)  # how many the ray has crossed before
        shape = self.n_views * self.n_columns, int(d.max(initial=0)) + 1
        near, far, boxes = np.full(shape, np.inf), np.full(shape, np.inf), np.full(shape, -1)
        stretch = np.hypot(1, slopes(self.n_columns))[ray % self.n_columns]
        with np.errstate(divide="ignore"):
            near[ray, d], far[ray, d], boxes[ray, d] = stretch / w_in, stretch / w_out, box
        return tuple(a.reshape(self.n_views, self.n_columns, -1) for a in (near, far, boxes))


def slopes(n_columns):
    """Slope s = left / ahead of each column's ray, column 0 the leftmost: (C,)."""
    half = np.tan(FIELD_OF_VIEW_RAD / 2)
    return half * (1 - (2 * np.arange(n_columns) + 1) / n_columns)


def cast(world, poses, n_columns=512):
    """Semantic strip of each pose: poses (B, 3) -> Strip. Nothing behind the nearest full-height wall is kept."""
    B, C, N = len(poses), n_columns, len(world.label)
    ahead, left, normal_x, normal_y, offset = _sides(world, poses)  # (4, B * N) each

    # Columns that a box can cover, of those with a corner in front of the camera.
    seen = np.flatnonzero(ahead.max(0) > IN_FRONT_M)  # view * N + box
    rims = (1 - np.stack(_slopes_of(ahead[:, seen], left[:, seen])) / np.tan(FIELD_OF_VIEW_RAD / 2)) * C / 2 - 0.5
    begin, end = np.ceil(rims[0]).clip(0, C).astype(int), (np.floor(rims[1]) + 1).clip(0, C).astype(int)
    within = np.flatnonzero(end > begin)
    seen, begin, count = seen[within], begin[within], (end - begin)[within]
    view, box = np.divmod(seen, N)

    # Each side is a line w = a + b s. Spread the lines over the columns of their box and clip with them.
    m = offset[:, seen]
    m[abs(m) < 1e-12] = 1e-12  # in the plane of a side one does not see it
    a, b = normal_x[:, seen] / m, normal_y[:, seen] / m
    column = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count - begin, count)
    s = slopes(C)[column]

    def spread(a, b):
        return np.repeat(a, count) + np.repeat(b, count) * s

    facing = m < 0  # of two opposite sides, k and k + 2, at most one
    side = [np.where(facing[k], k, k + 2) for k in (0, 1)]
    w_in = []
    for k in side:
        either = np.choose(k, facing)
        w_in.append(spread(np.where(either, np.choose(k, a), np.inf), np.where(either, np.choose(k, b), 0)))
    second = w_in[1] < w_in[0]
    w_in = np.minimum(np.minimum(*w_in), 1 / NEAREST_M)
    w_out = np.zeros(len(s))
    for k in range(4):
        np.maximum(w_out, spread(np.where(facing[k], 0, a[k]), np.where(facing[k], 0, b[k])), out=w_out)

    ray, hit = np.repeat(view * C, count) + column, w_in > w_out
    closes = (world.z[:, 0] <= 0) & (world.z[:, 1] >= world.wall_height)
    wall = np.flatnonzero(np.repeat(closes[box], count) & hit)
    horizon = np.zeros(B * C)  # the nearest full-height wall on each ray
    np.maximum.at(horizon, ray[wall], w_in[wall])
    kept = np.flatnonzero(hit & (w_in >= horizon[ray]))
    owner = np.repeat(np.arange(len(seen)), count)[kept]
    side = np.where(second[kept], side[1][owner], side[0][owner])
    return Strip(B, C, ray[kept], w_in[kept], w_out[kept], box[owner], side)


def _slopes_of(ahead, left):
    """Greatest and least slope of boxes, (n,) each, from their corners (4, n), of which one at least is in front."""
    front = ahead > IN_FRONT_M
    # Where a side goes from before the camera to behind it, the box reaches out of the view to left or right.
    next_ahead, next_left = np.roll(ahead, -1, 0), np.roll(left, -1, 0)
    leaves = front != np.roll(front, -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        corner = np.where(front, left / ahead, np.nan)
        crossing = (left * next_ahead - next_left * ahead) / (next_ahead - ahead)
        rim = np.where(leaves, np.copysign(np.inf, crossing), np.nan)
    s = np.concatenate([corner, rim])
    return np.fmax.reduce(s, 0), np.fmin.reduce(s, 0)  # these pass over nan


def _sides(world, poses):
    """Corners and sides of all boxes as each camera sees them, as arrays (4, B * N).

    returns : corners (ahead, left) [m]; outward normals (n_x, n_y) and offsets m [m] of the sides n . p = m
    """
    x, y, theta = (np.asarray(poses, float)[:, i, None] for i in range(3))
    cos, sin = np.cos(theta), np.sin(theta)
    dx, dy = world.centre[:, 0] - x, world.centre[:, 1] - y
    cx, cy = (cos * dx + sin * dy).ravel(), (cos * dy - sin * dx).ravel()
    turn = (world.angle - theta).ravel()
    ex, ey = np.cos(turn), np.sin(turn)  # the box's first axis; its second is (-ey, ex)
    h1, h2 = (np.tile(h, len(poses)) for h in world.half.T)
    ux, uy, vx, vy = h1 * ex, h1 * ey, -h2 * ey, h2 * ex
    along, across = cx * ex + cy * ey, cy * ex - cx * ey
    return (np.stack([cx + ux + vx, cx - ux + vx, cx - ux - vx, cx + ux - vx]),
            np.stack([cy + uy + vy, cy - uy + vy, cy - uy - vy, cy + uy - vy]),
            np.stack([ex, -ey, -ex, ey]), np.stack([ey, ex, -ey, -ex]),
            np.stack([h1 + along, h2 + across, h1 - along, h2 - across]))
