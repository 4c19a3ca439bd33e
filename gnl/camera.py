"""The camera: from the semantic strip to a first-person view, its colours and its true labels.

An image column is a pile of surfaces, near to far: the front of each box that its ray crosses, and the box's
top or underside. Each surface covers an interval of rows; a pixel shows the nearest surface that covers it.

    H = C rows, columns   h camera height [m]   w inverse depth [1/m]   z height above the floor [m]
    row of a point:  y = (1 - (z - h) w / tan(fov / 2)) H / 2,   0 the upper rim of the image
"""

from dataclasses import dataclass

import numpy as np

from .classes import CEILING, FLOOR
from .photo import check_noise, photograph
from .places import check_poses
from .strip import FACES, NEAREST_M, TOP, UNDERSIDE, cast, rim_slope

HEIGHT_M = 1.25  # CHOICE: 1.25 m: table tops seen from above, refrigerators from the front
SIZE_PX = 512
RAYS_AT_ONCE = 4096  # as many as fit in the processor's cache; twice as many where no photograph needs the room
A_LITTLE = 1e-6  # 1/m, in inverse depth: by this much a top counts as nearer than what it touches
MOST_SURFACES = 61  # of one column, one bit each; what lies behind the 61 nearest is not drawn
NO_SURFACE = 63  # bit of edges that belong to no surface; the lowest bit counts as this one, too, where none is on


@dataclass(frozen=True)
class Surfaces:
    """What the columns of some views show: S surfaces of boxes, and R runs of pixels.

    A run is a piece of a column that shows one surface; runs come one after the other, column by column from the
    top, and fill the views. After the surfaces of boxes come two more, for all ceilings and for all floors.
    """

    face: np.ndarray  # (S + 2,) int, box * FACES + one of its sides, TOP or UNDERSIDE; box N ceiling, N + 1 floor
    w: np.ndarray  # (S + 2,) inverse depth of a side; 0 for what lies flat
    run_surface: np.ndarray  # (R,) int
    run_ray: np.ndarray  # (R,) int, view * C + column
    run_length: np.ndarray  # (R,) int, pixels

    def label_runs(self, world):
        """Class and length of each run."""
        of_box = np.append(world.label, np.array([CEILING, FLOOR], np.uint8))
        return of_box[self.face // FACES].take(self.run_surface), self.run_length


def render(world, poses, rng, size=SIZE_PX, noise=1.0, wanted=None):
    """First-person views and their true labels: poses (B, 3) -> rgb (n, H, H, 3) uint8, labels (n, H, H) uint8.

    size   : H; 64 gives the same views at an eighth of the resolution (if at most 8: more are drawn in parts)
    noise  : appearance noise of the photograph (see photo.py); 0 is a clean drawing
    wanted : (B,) bool, which views to draw: n of them, each as it would be among all B; all B if not given
    """
    poses, rgb, runs = _check(poses, size), [], []
    check_noise(noise)
    wanted = np.ones(len(poses), bool) if wanted is None else np.asarray(wanted)
    if wanted.shape != (len(poses),) or wanted.dtype != bool:
        raise ValueError(f"wanted: expected {len(poses)} of bool, found {wanted.dtype} {wanted.shape}")
    for part in _chunks(len(poses), size):
        seen = poses[part][wanted[part]]
        surfaces = look(world, seen, size)
        rgb.append(photograph(world, seen, surfaces, size, HEIGHT_M, rng, noise, wanted[part]))
        runs.append(surfaces.label_runs(world))
    return np.concatenate(rgb), _paint(runs, size)


def true_labels(world, poses, size=SIZE_PX):
    """True labels alone: poses (B, 3) -> (B, H, H) uint8."""
    poses = _check(poses, size)
    parts = _chunks(len(poses), size, 2 * RAYS_AT_ONCE)
    return _paint([look(world, poses[part], size).label_runs(world) for part in parts], size)


def _check(poses, size):
    """The poses as (B, 3) floats; ValueError if there is no view of that size from them."""
    if not isinstance(size, int | np.integer) or size < 2 or size % 2:
        raise ValueError(f"size: expected an even number of pixels, found {size}")
    return check_poses(poses).reshape(-1, 3)


def _paint(runs, size):
    """Images (B, H, H) uint8 of runs (label, length) in parts: all at once, one column after the other."""
    label, length = (np.concatenate(parts) for parts in zip(*runs, strict=True))
    return np.repeat(label, length).reshape(-1, size, size).transpose(0, 2, 1)


def look(world, poses, size=SIZE_PX):
    """What each column of each view shows: poses (B, 3) -> Surfaces."""
    return _visible(_pile(world, cast(world, poses, size), size), len(poses) * size, size, len(world.label))


def row_of(z, w, size):
    """Row coordinate y [px] of height z [m] at inverse depth w [1/m]."""
    return (1 - (z - HEIGHT_M) * w / rim_slope()) * (size / 2)


def _pile(world, strip, size):
    """Surfaces of each ray, near to far: (ray, face, w, first row, end row), those without a pixel left out."""
    box, w = strip.face // FACES, strip.w_in
    low, high = world.z.T.clip(0, world.wall_height)  # what goes through floor or ceiling ends there
    from_above, from_below = (high > 0) & (high < HEIGHT_M), (low > HEIGHT_M) & (low < world.wall_height)
    level, flat = np.where(from_above, high, low), np.where(from_above, TOP, UNDERSIDE)
    capped = np.flatnonzero((from_above | from_below).take(box))  # crossings that also show a top or an underside
    capped_box, w_front = box.take(capped), w.take(capped)
    w_back = np.maximum(strip.w_out(capped), strip.w_wall.take(strip.ray.take(capped)))  # no farther than the wall
    which = np.append(box, len(low) + capped_box)  # where the two heights of each surface stand in a list
    ray = np.append(strip.ray, strip.ray.take(capped))
    face = np.append(strip.face, capped_box * FACES + flat.take(capped_box))

    def row(z, w):  # the first pixel whose middle lies below
        return (row_of(z.take(which), w, size) + 0.5).clip(0, size).astype(np.int32)

    front, back = row(np.append(high, level), np.append(w, w_front)), row(np.append(low, level), np.append(w, w_back))
    begin, end = np.minimum(front, back), np.maximum(front, back)
    # A top belongs right behind its front; but what stands on it comes between the two, and so does what is below a box
    # whose underside one sees. What begins where the top ends, a wall or the next piece of furniture, comes behind it.
    # (Not done: the top of a thing that carries something should still come before what stands under that thing.)
    between = np.where(from_above, world.carries, world.covers).take(capped_box)
    nearness = np.append(w, np.where(between, w_back + A_LITTLE, w_front))

    # Ray by ray, near to far. Each face comes with its rays in order: a sort that merges such runs is fastest.
    shown = np.flatnonzero(end > begin)
    far = ((1 - nearness.take(shown) * NEAREST_M) * 2 ** 30).astype(int)
    shown = shown.take(((ray.take(shown) << 31) + far).argsort(kind="stable"))
    w = np.append(w, np.zeros(len(capped)))
    return ray.take(shown), face.take(shown), w.take(shown), begin.take(shown), end.take(shown)


def _visible(pile, n_rays, size, n_boxes):
    """Runs of the nearest surface in each column, from piles sorted near to far.

    Each surface of a column owns one bit, the nearest the lowest. Its first row switches the bit on, its end row
    off; between two such edges one sees the lowest bit that is on. Where none is, one sees the ceiling in the upper
    half of the column and the floor in the lower; edges of no surface separate the columns, and the two
    halves of a bare one.
    """
    ray, face, w, begin, end = pile
    S, H, half = len(ray), size, size // 2
    count = np.bincount(ray, minlength=n_rays)
    last = np.cumsum(count) - 1  # of each ray's surfaces
    first = last + 1 - count
    bit = np.arange(S) - first.take(ray)
    if count.max(initial=0) > MOST_SURFACES:
        return _visible([a[bit < MOST_SURFACES] for a in pile], n_rays, size, n_boxes)

    # Usually the last surface of a column, a wall, covers the row where ceiling and floor would meet.
    bare = (count == 0) | (np.append(begin, 0).take(last) > half) | (np.append(end, 0).take(last) < half)
    # An edge is one number, pixel * 64 + bit: sorted, edges run down the columns. Short numbers are sorted faster.
    short = np.int32 if n_rays * H < 1 << 25 else np.int64
    start, top = ((ray * H << 6) + bit).astype(short), ((np.arange(n_rays + 1) * H << 6) + NO_SURFACE).astype(short)
    edges = start + (begin << 6), start + (end << 6), top, top[:-1][bare] + (half << 6)
    edge = np.sort(np.concatenate(edges), kind="stable")  # four lists, each nearly in order: the sort merges them
    on = np.bitwise_xor.accumulate(np.uint64(1) << (edge & 63).astype(np.uint64))
    pixel = edge >> 6
    run = np.flatnonzero(pixel[1:] != pixel[:-1])
    on, begin = on.take(run), pixel.take(np.append(run, -1))
    begin, length = begin[:-1], begin[1:] - begin[:-1]
    run_ray = begin // H
    lowest = np.bitwise_count(on ^ (on - 1)) - 1  # on ^ (on - 1): the lowest bit that is on and all below it
    surface = first.take(run_ray) + lowest
    back = np.flatnonzero(lowest == NO_SURFACE)
    surface[back] = S + (begin[back] - run_ray[back] * H >= half)
    ceiling, floor = n_boxes * FACES + UNDERSIDE, (n_boxes + 1) * FACES + TOP
    return Surfaces(np.append(face, [ceiling, floor]), np.append(w, [0, 0]), surface, run_ray, length)


def _chunks(n_views, size, n_rays=RAYS_AT_ONCE):
    """Slices of the views, as many in each as fit in the cache; one even if there are no views."""
    step = max(1, n_rays // size)
    return [slice(i, i + step) for i in range(0, max(1, n_views), step)]
