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
    poses, B, C = np.asarray(poses, float), len(poses), n_columns
    view, box, corners, sides = _boxes_ahead(world, poses)
    begin, end, nearest = _columns(*corners, C)
    begin, end = view * C + begin, view * C + end
    in_view = end > begin

    def cross(chosen):
        return _cross(sides[:, :, chosen], begin[chosen], (end - begin)[chosen], box[chosen], np.tile(slopes(C), B))

    closes = ((world.z[:, 0] <= 0) & (world.z[:, 1] >= world.wall_height))[box]
    walls = cross(np.flatnonzero(closes & in_view))
    horizon = np.zeros(B * C + 1)  # the nearest full-height wall on each ray
    np.maximum.at(horizon, walls[0], walls[1])

    # Of the other boxes most stand in other rooms: behind all the walls in their columns.
    others = np.flatnonzero(~closes & in_view)
    ranges = np.stack([begin[others], end[others]], 1).ravel()
    farthest_wall = np.minimum.reduceat(horizon, ranges)[::2] if len(others) else 0
    both = zip(walls, cross(others[nearest[others] >= farthest_wall]), strict=True)
    ray, w_in, *rest = map(np.concatenate, both)
    kept = np.flatnonzero(w_in >= horizon[ray])
    return Strip(B, C, *(a[kept] for a in (ray, w_in, *rest)))


def _boxes_ahead(world, poses):
    """Pairs of a view and a box that may be in it, and the box as its camera sees it, 0..3 as the sides are numbered.

    returns : view (n,), box (n,); corners (ahead, left) [m], (2, 4, n);
              outward normals (n_x, n_y) and offsets m [m] of the sides n . p = m, (3, 4, n)
    """
    x, y, theta = poses.T
    cos, sin = np.cos(theta), np.sin(theta)
    ahead = np.outer(cos, world.centre[:, 0]) + np.outer(sin, world.centre[:, 1]) - (cos * x + sin * y)[:, None]
    left = np.outer(cos, world.centre[:, 1]) - np.outer(sin, world.centre[:, 0]) - (cos * y - sin * x)[:, None]
    # The view is the wedge |left| <= ahead tan(fov / 2): the circle around the box must reach into it.
    circle = np.hypot(*world.half.T) / np.cos(FIELD_OF_VIEW_RAD / 2)
    view, box = np.nonzero(abs(left) - np.tan(FIELD_OF_VIEW_RAD / 2) * ahead < circle)

    cx, cy, turn = ahead[view, box], left[view, box], world.angle[box] - theta[view]
    ex, ey = np.cos(turn), np.sin(turn)  # the box's first axis; its second is (-ey, ex)
    h1, h2 = world.half[box].T
    ux, uy, vx, vy = h1 * ex, h1 * ey, -h2 * ey, h2 * ex
    along, across = cx * ex + cy * ey, cy * ex - cx * ey
    corners = np.array([[cx + ux + vx, cx - ux + vx, cx - ux - vx, cx + ux - vx],
                        [cy + uy + vy, cy - uy + vy, cy - uy - vy, cy + uy - vy]])
    m = np.array([h1 + along, h2 + across, h1 - along, h2 - across])
    m[abs(m) < 1e-12] = 1e-12  # in the plane of a side one does not see it
    return view, box, corners, np.array([[ex, -ey, -ex, ey], [ey, ex, -ey, -ex], m])


def _columns(ahead, left, n_columns):
    """Columns [begin, end) that boxes can cover, and their greatest inverse depth, from their corners (4, n)."""
    half = np.tan(FIELD_OF_VIEW_RAD / 2)
    # A corner behind the camera lies at infinity on its side; what is all behind covers no column.
    s = np.where(ahead > 1e-9, left / np.maximum(ahead, 1e-9), np.copysign(np.inf, left))
    begin, end = (np.ceil((1 - edge / half) * n_columns / 2 - 0.5).clip(0, n_columns).astype(int)
                  for edge in (s.max(0), np.nextafter(s.min(0), -np.inf)))
    end[ahead.max(0) <= 1e-9] = 0
    return begin, end, 1 / np.maximum(ahead.min(0), 1e-9)


def _cross(sides, begin, count, box, slope_of_ray):
    """Rays begin ... begin + count - 1 of each box with its four sides (3, 4, n): ray, w_in, w_out, box, side."""
    normal_x, normal_y, m = sides
    a, b = normal_x / m, normal_y / m  # each side is a line w = a + b s over the columns of its box
    facing = m < 0
    ray = np.arange(count.sum()) + np.repeat(begin - np.cumsum(count) + count, count)
    s = slope_of_ray[ray]

    def spread(a, b):
        return np.repeat(a, count) + np.repeat(b, count) * s

    # Of two opposite sides, k and k + 2, at most one faces the camera.
    entries, numbers = [], []
    for k in (0, 1):
        pick = np.where(facing[k], k, k + 2), np.arange(len(box))
        either = facing[pick]
        entries.append(spread(np.where(either, a[pick], np.inf), np.where(either, b[pick], 0)))
        numbers.append(np.repeat(pick[0], count))
    side = np.where(entries[0] < entries[1], *numbers)
    w_in = np.minimum(np.minimum(*entries), 1 / NEAREST_M)
    w_out = np.zeros(len(s))
    for k in range(4):
        np.maximum(w_out, spread(np.where(facing[k], 0, a[k]), np.where(facing[k], 0, b[k])), out=w_out)
    hit = np.flatnonzero(w_in > w_out)
    return ray[hit], w_in[hit], w_out[hit], np.repeat(box, count)[hit], side[hit]
