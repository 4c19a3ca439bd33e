"""The semantic strip: which boxes the rays of a view cross, near to far.

One ray leaves the camera for each image column. In inverse depth everything is linear: with the camera at the
origin, x ahead and y to the left, the ray of slope s is p = (1, s) / w, and it meets the line n . p = m at

    w = (n_x + n_y s) / m = a + b s.

The footprint of a box is where two slabs near_k < n_k . p < far_k meet; n_k is an axis of the box, turned away from
the camera. Where the camera is outside slab k (near_k > 0) it sees a face of the box: a ray enters by one of the at
most two near lines that are faces, in the columns between corners of the box, and leaves by the line of greatest w
among all others. (Slabs: Kay and Kajiya 1986; here in inverse depth.)

    B views   C columns   N boxes   V boxes in view, of all views   P crossings   k = 0, 1 axis of a box
    s                 slope of a column's ray, +1 at the left rim of a 90 degree view
    w_in, w_out [1/m] inverse depth at entry and exit; depth is measured along the optical axis
"""

from dataclasses import dataclass

import numpy as np

from .places import check_poses

FIELD_OF_VIEW_RAD = np.pi / 2  # CHOICE: 90 degrees, Habitat's default
TOP, UNDERSIDE, FACES = 4, 5, 6  # faces of a box; 0..3 are its sides, counter-clockwise from the end of its first axis
NEAREST_M = 0.05  # nearer things are cut off: the camera sits inside the robot
IN_FRONT_M = 1e-9


@dataclass(frozen=True)
class Strip:
    """Crossings of all views, in no order; ray = view * n_columns + column."""

    n_views: int
    n_columns: int
    ray: np.ndarray  # (P,) int
    w_in: np.ndarray  # (P,) [1/m]
    face: np.ndarray  # (P,) int, box * FACES + the side 0..3 by which the ray enters
    seen: np.ndarray  # (P,) int, which of the boxes in view it is
    exits: np.ndarray  # (4, 2, V) lines (a, b) by one of which a ray leaves the box
    slope: np.ndarray  # (B * C,) of each ray
    w_wall: np.ndarray  # (B * C,) where each ray enters its nearest full-height wall; 0 where there is none

    def w_out(self, chosen=slice(None)):
        """Inverse depth where the rays of chosen crossings leave their boxes; few users need all of it."""
        return _greatest(self.exits, self.seen[chosen], self.slope.take(self.ray[chosen]))

    def dense(self):
        """Near to far as arrays (B, C, D): distance in, distance out [m, along the ray], box; inf and -1 where none."""
        order = np.lexsort((-self.w_in, self.ray))
        ray, box, w_in, w_out = (a[order] for a in (self.ray, self.face // FACES, self.w_in, self.w_out()))
        d = np.arange(len(ray)) - np.searchsorted(ray, ray)  # how many the ray has crossed before
        shape = self.n_views * self.n_columns, int(d.max(initial=0)) + 1
        near, far, boxes = np.full(shape, np.inf), np.full(shape, np.inf), np.full(shape, -1)
        stretch = np.hypot(1, slopes(self.n_columns))[ray % self.n_columns]
        with np.errstate(divide="ignore"):
            near[ray, d], far[ray, d], boxes[ray, d] = stretch / w_in, stretch / w_out, box
        return tuple(a.reshape(self.n_views, self.n_columns, shape[1]) for a in (near, far, boxes))


def rim_slope():
    """Slope of a ray at the left or upper rim of a view: tan(fov / 2)."""
    if not 0 < FIELD_OF_VIEW_RAD < np.pi:
        raise ValueError(f"field of view: expected more than 0 and less than pi, found {FIELD_OF_VIEW_RAD}")
    return np.tan(FIELD_OF_VIEW_RAD / 2)


def slopes(n_columns):
    """Slope s = left / ahead of each column's ray, column 0 the leftmost: (C,)."""
    return rim_slope() * (1 - (2 * np.arange(n_columns) + 1) / n_columns)


def cast(world, poses, n_columns=512):
    """Semantic strip of each pose: poses (B, 3) -> Strip. Nothing behind the nearest full-height wall is kept."""
    poses = check_poses(poses).reshape(-1, 3)
    B, C = len(poses), n_columns
    view, box, axes, near, far, away = _boxes_in_view(world, poses)
    V, outside = len(box), near > 0
    begin, end = _columns_of_faces(axes, near, far, C)
    near_lines, far_lines = axes / near, axes / far  # (a, b) of both axes, (2, 2, V)
    exits = np.concatenate([far_lines, near_lines * ~outside], 1).transpose(1, 0, 2)
    # A box around the camera shows no face: its first one stands in, at the distance where all is cut off.
    inside = ~(outside[0] | outside[1])
    near_lines[:, 0, inside] = [[1 / NEAREST_M], [0]]

    # Faces that fill at least one column, face k of box v in view as k * V + v; those of full-height walls first.
    closes = ((world.z[:, 0] <= 0) & (world.z[:, 1] >= world.wall_height)).take(box)
    walls, others = np.flatnonzero((end > begin) & closes), np.flatnonzero((end > begin) & ~closes)
    face = np.append(walls, others)
    a, b = near_lines[0].take(face), near_lines[1].take(face)
    seen, begin, count = face - V * (face >= V), begin.take(face), (end - begin).take(face)

    # Each face becomes one crossing for each of its columns: what belongs to the face is repeated, and its rays,
    # which begin at view * C + begin, count up from crossing to crossing.
    first_crossing = np.cumsum(count) - count
    ray = np.repeat(view.take(seen) * C + begin - first_crossing, count)
    ray += np.arange(len(ray))
    slope = np.tile(slopes(C), B)
    w_in = slope.take(ray)
    w_in *= np.repeat(b, count)
    w_in += np.repeat(a, count)
    owner = np.repeat(np.arange(len(face)), count)
    near_by = np.flatnonzero(w_in >= 1 / NEAREST_M)
    if len(near_by):
        w_out = _greatest(exits, seen[owner[near_by]], slope[ray[near_by]])
        w_in[near_by] = np.where(w_out < 1 / NEAREST_M, 1 / NEAREST_M, -1)  # -1: cut off from front to back

    n_wall = count[:len(walls)].sum()
    w_wall = np.zeros(B * C)
    np.maximum.at(w_wall, ray[:n_wall], w_in[:n_wall])
    kept = np.flatnonzero(w_in >= w_wall.take(ray))
    owner = owner.take(kept)
    side = (face >= V) + 2 * away.take(face)  # where the box's own axis points away one sees its other end
    shown = box.take(seen) * FACES + side
    return Strip(B, C, ray.take(kept), w_in.take(kept), shown.take(owner), seen.take(owner), exits, slope, w_wall)


def _boxes_in_view(world, poses):
    """Boxes of which some part may be in view, and their slabs as the camera sees them.

    returns : view, box (V,);  (2, 2, V): how far n_k points ahead and to the left;  (2, V) each: near_k, far_k [m];
              whether n_k is the box's own axis and not its opposite
    """
    x, y, theta = (poses[:, i, None] for i in range(3))
    dx, dy = world.centre[:, 0] - x, world.centre[:, 1] - y
    ahead, left = np.cos(theta) * dx + np.sin(theta) * dy, np.cos(theta) * dy - np.sin(theta) * dx
    # A circle around the box reaches into the view.
    edge = FIELD_OF_VIEW_RAD / 2
    pair = np.flatnonzero(abs(left) * np.cos(edge) - ahead * np.sin(edge) < np.hypot(*world.half.T))
    view, box = np.divmod(pair, len(world.label))
    ahead, left, turn = ahead.take(pair), left.take(pair), world.angle.take(box) - theta.take(view)
    cos, sin = np.cos(turn), np.sin(turn)
    middle = np.array([cos * ahead + sin * left, cos * left - sin * ahead])
    sign, half = np.copysign(1, middle), np.array([side.take(box) for side in world.half.T])
    middle = abs(middle)
    near, far = middle - half, middle + half
    near[abs(near) < 1e-12] = -1e-12  # in the plane of a side one does not see it
    return view, box, sign * np.array([[cos, -sin], [sin, cos]]), near, far, sign > 0


def _columns_of_faces(axes, near, far, n_columns):
    """First and end column of the faces k of each box, (2, V) each, of slabs as _boxes_in_view gives them.

    From face 0 to face 1 one passes three corners: where the outline begins, where the faces meet, where it ends.
    With one face alone two of the three are the same corner.
    """
    C, outside, (ahead, left) = n_columns, near > 0, axes
    along_0 = np.array([near[0], near[0], np.where(outside[1], far[0], near[0])])
    along_1 = np.array([np.where(outside[0], far[1], near[1]), near[1], near[1]])
    x, y = along_0 * ahead[0] + along_1 * ahead[1], along_0 * left[0] + along_1 * left[1]
    front = x > IN_FRONT_M
    column = np.ceil((1 - y / np.where(front, x, 1) / rim_slope()) * C / 2 - 0.5)
    # A corner behind the camera is out of view on its own side of the box; the middle one, on that of the end behind.
    first = np.where(ahead[0] * left[1] > ahead[1] * left[0], 0, C)
    behind = np.array([first, np.where(front[0], C - first, first), C - first])
    column = np.where(front, column, behind).clip(0, C).astype(int)
    inside = ~(outside[0] | outside[1])
    column[:, inside] = [[0], [C], [C]]
    shown = front[0] | front[2] | inside
    return np.minimum(column[:-1], column[1:]), np.maximum(column[:-1], column[1:]) * shown


def _greatest(lines, seen, s):
    """Greatest a + b s, at least 0, of the lines (n, 2, V) of some boxes at slopes s."""
    greatest = np.zeros(len(s))
    for a, b in lines:
        w = b.take(seen)
        w *= s
        w += a.take(seen)
        np.maximum(greatest, w, out=greatest)
    return greatest
