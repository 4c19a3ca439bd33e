"""The camera: from the semantic strip to a first-person view, its colours and its true labels.

An image column is a pile of surfaces, near to far: the front of each box that its ray crosses, and its top or its
underside. Each surface covers an interval of rows; a pixel shows the first surface, near to far, that covers it.

    H = C rows, columns   h camera height [m]   w inverse depth [1/m]   z height above the floor [m]
    row of a point:  y = (1 - (z - h) w / tan(fov / 2)) H / 2,   0 the upper rim of the image
"""

from dataclasses import dataclass

import numpy as np

from .classes import CEILING, FLOOR, N_CLASSES
from .photo import photograph
from .strip import FACES, FIELD_OF_VIEW_RAD, NEAREST_M, TOP, UNDERSIDE, cast

HEIGHT_M = 1.25  # CHOICE: table tops seen from above, refrigerators from the front
SIZE_PX = 512
RAYS_AT_ONCE = 4096  # as many as stay near the processor
MOST_SURFACES = 61  # of one column, one bit each; what lies behind the 61 nearest is not drawn
CEILING_BIT, FLOOR_BIT, BOTH = MOST_SURFACES, MOST_SURFACES + 1, 63  # BOTH: the bits of ceiling and floor together
MASKS = np.append(1 << np.arange(63), 1 << CEILING_BIT | 1 << FLOOR_BIT)


@dataclass(frozen=True)
class Surfaces:
    """What the columns of some views show: S surfaces of boxes, and R runs of pixels.

    A run is a piece of a column that shows one surface; runs lie one behind the other, column by column from the
    top, and fill the views. Behind the surfaces of boxes come two more, for all ceilings and for all floors.
    """

    face: np.ndarray  # (S + 2,) int, box * FACES + one of its sides, TOP or UNDERSIDE; box N ceiling, N + 1 floor
    w: np.ndarray  # (S + 2,) inverse depth of a side; 0 for what lies flat
    run_surface: np.ndarray  # (R,) int
    run_ray: np.ndarray  # (R,) int, view * C + column
    run_length: np.ndarray  # (R,) int, pixels

    def labels(self, world):
        """Class and length of the runs, neighbours of one class made one: many short ones are slow to paint."""
        of_box = np.append(world.label, np.array([CEILING, FLOOR], np.uint8))
        label = of_box[self.face // FACES].take(self.run_surface)
        first = np.flatnonzero(np.diff(label, prepend=np.uint8(N_CLASSES)))
        return label[first], np.add.reduceat(self.run_length, first)


def render(world, poses, rng, size=SIZE_PX, noise=1.0):
    """First-person views and their true labels: poses (B, 3) -> rgb (B, H, H, 3) uint8, labels (B, H, H) uint8.

    size  : H; 64 gives the same view at an eighth of the resolution
    noise : appearance noise of the photograph (see photo.py); 0 is a clean drawing
    """
    poses = np.asarray(poses, float)
    rgb, runs = np.empty((len(poses), size, size, 3), np.uint8), []
    for part in _chunks(len(poses), size):
        surfaces = look(world, poses[part], size)
        rgb[part] = photograph(world, poses[part], surfaces, size, HEIGHT_M, rng, noise)
        runs.append(surfaces.labels(world))
    return rgb, _paint(runs, size)


def true_labels(world, poses, size=SIZE_PX):
    """True labels alone: poses (B, 3) -> (B, H, H) uint8."""
    poses = np.asarray(poses, float)
    return _paint([look(world, poses[part], size).labels(world) for part in _chunks(len(poses), size)], size)


def _paint(runs, size):
    """Images (B, H, H) uint8 of runs (label, length) in parts: all in one stroke, one column behind the other."""
    label, length = (np.concatenate(parts) for parts in zip(*runs, strict=True))
    return np.repeat(label, length).reshape(-1, size, size).transpose(0, 2, 1)


def look(world, poses, size=SIZE_PX):
    """What each column of each view shows: poses (B, 3) -> Surfaces."""
    return _visible(_pile(world, cast(world, poses, size), size), len(poses) * size, size, len(world.label))


def row_of(z, w, size):
    """Row coordinate y [px] of height z [m] at inverse depth w [1/m]."""
    return (1 - (z - HEIGHT_M) * w / np.tan(FIELD_OF_VIEW_RAD / 2)) * (size / 2)


def _pile(world, strip, size):
    """Surfaces of each ray, near to far: (ray, face, w, first row, end row), those without a pixel left out."""
    box, w = strip.box, strip.w_in
    low, high = world.z.T
    from_above, from_below = high < HEIGHT_M, low > HEIGHT_M
    capped = np.flatnonzero((from_above | from_below)[box])  # crossings that show a top or an underside, too
    w_front, w_back, capped_box = w[capped], strip.w_out(capped), box[capped]

    def row(z, w):  # the first pixel whose middle lies below
        return (row_of(z, w, size) + 0.5).clip(0, size).astype(np.int32)

    level = np.where(from_above, high, low)[capped_box]
    front, back = row(level, w_front), row(level, w_back)
    begin = np.append(row(high[box], w), np.minimum(front, back))
    end = np.append(row(low[box], w), np.maximum(front, back))
    ray = np.append(strip.ray, strip.ray[capped])
    face = np.append(box * FACES + strip.side, capped_box * FACES + np.where(from_above, TOP, UNDERSIDE)[capped_box])
    # A top belongs right behind its front; but what stands on it comes between the two.
    nearness = np.append(w, np.where(world.carries[capped_box], w_back, w_front))

    # Sorting numbers of which the last digits are the place in the list is faster than asking for the order.
    shown, bits = np.flatnonzero(end > begin), len(begin).bit_length()
    far = ((1 - nearness[shown] * NEAREST_M) * 2 ** 30).astype(int)
    number = np.sort(((ray[shown] << 31) + far << bits) + shown)
    shown = number & (1 << bits) - 1
    return number >> 31 + bits, face[shown], np.append(w, np.zeros(len(capped)))[shown], begin[shown], end[shown]


def _visible(pile, n_rays, size, n_boxes):
    """Runs of the nearest surface in each column, from piles sorted near to far.

    Each surface of a column owns one bit, the nearest the lowest. Its first row switches the bit on, its end row
    off; between two such edges one sees the lowest bit that is on. The two highest are those of ceiling and floor:
    they change places where a column begins and at half its height.
    """
    ray, face, w, begin, end = pile
    S, H, column = len(ray), size, np.arange(n_rays)
    count = np.bincount(ray, minlength=n_rays)
    first = np.cumsum(count) - count  # of each ray's surfaces
    bit = np.arange(S) - first[ray]
    if count.max(initial=0) > MOST_SURFACES:
        return _visible([a[bit < MOST_SURFACES] for a in pile], n_rays, size, n_boxes)

    # An edge is a number: its last six digits are the bit, the others the pixel. Short numbers are sorted faster.
    short = np.int32 if n_rays * H < 1 << 25 else np.int64
    start, top = ((ray * H << 6) + bit).astype(short), ((column * H << 6) + BOTH).astype(short)
    edge = np.sort(np.concatenate([start + (begin << 6), start + (end << 6), top, top + (H // 2 << 6)]))
    on = np.bitwise_xor.accumulate(MASKS.take(edge & 63)) ^ 1 << FLOOR_BIT
    pixel = edge >> 6
    length = np.append(pixel[1:], n_rays * H) - pixel
    run = np.flatnonzero(length != 0)
    on, run_ray = on[run], pixel[run] // H
    lowest = np.bitwise_count(on ^ on - 1) - 1  # the digits up to the lowest that is on, less that one
    surface = first.take(run_ray) + lowest
    back = np.flatnonzero(lowest >= CEILING_BIT)
    surface[back] = S + (lowest[back] == FLOOR_BIT)
    ceiling, floor = n_boxes * FACES + UNDERSIDE, (n_boxes + 1) * FACES + TOP
    return Surfaces(np.append(face, [ceiling, floor]), np.append(w, [0, 0]), surface, run_ray, length[run])


def _chunks(n_views, size):
    """Slices of the views, as many in each as stay near the processor; one even of no views."""
    step = max(1, RAYS_AT_ONCE // size)
    return [slice(i, min(i + step, n_views)) for i in range(0, max(1, n_views), step)]
