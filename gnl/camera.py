"""The camera: from the semantic strip to a first-person view, its colours and its true labels.

An image column is a pile of surfaces, near to far: the front of each box that its ray crosses, and its top or its
underside. Each surface covers an interval of rows; a pixel shows the first surface, near to far, that covers it.

    H = C rows, columns   h camera height [m]   w inverse depth [1/m]   z height above the floor [m]
    row of a point:  y = (1 - (z - h) w / tan(fov / 2)) H / 2,   0 the upper rim of the image
"""

from dataclasses import dataclass

import numpy as np

from .classes import CEILING, FLOOR
from .photo import photograph
from .strip import FIELD_OF_VIEW_RAD, FRONT, NEAREST_M, TOP, UNDERSIDE, cast

HEIGHT_M = 1.25  # CHOICE: table tops seen from above, refrigerators from the front
SIZE_PX = 512
MOST_SURFACES = 62  # of one column, one bit each; what lies behind the 62 nearest is not drawn
CHUNK_RAYS = 2048  # rays cast at once: as many as stay in the cache


@dataclass(frozen=True)
class Surfaces:
    """What the columns of some views show: S surfaces, near to far in each ray, and R runs of pixels.

    Behind the surfaces of boxes come the ceiling of each ray and then the floor of each ray. A run is a piece of a
    column that shows one surface; runs lie one behind the other, column by column from the top, and fill the views.
    """

    ray: np.ndarray  # (S,) int, view * C + column
    box: np.ndarray  # (S,) int; N for a ceiling, N + 1 for a floor
    kind: np.ndarray  # (S,) FRONT, TOP or UNDERSIDE
    w: np.ndarray  # (S,) inverse depth of a front
    run_surface: np.ndarray  # (R,) int
    run_length: np.ndarray  # (R,) int, pixels

    def paint(self, of_surface, size):
        """Spread values of surfaces, (S,) or (S, F), over all pixels, column by column: (B, C, H) or (B, C, H, F)."""
        pixels = np.repeat(of_surface[self.run_surface], self.run_length, axis=0)
        return pixels.reshape(-1, size, size, *of_surface.shape[1:])


def render(world, poses, rng, size=SIZE_PX, noise=1.0):
    """First-person views and their true labels: poses (B, 3) -> rgb (B, H, H, 3) uint8, labels (B, H, H) uint8.

    size  : H; 64 gives the same view at an eighth of the resolution
    noise : appearance noise of the photograph (see photo.py); 0 is a clean drawing
    """
    poses = np.asarray(poses, float)
    rgb = np.empty((len(poses), size, size, 3), np.uint8)
    labels = np.empty((len(poses), size, size), np.uint8)
    for part in _chunks(len(poses), size):
        surfaces = look(world, poses[part], size)
        labels[part] = _labels(world, surfaces, size)
        rgb[part] = photograph(world, poses[part], surfaces, size, HEIGHT_M, rng, noise).transpose(0, 2, 1, 3)
    return rgb, labels


def true_labels(world, poses, size=SIZE_PX):
    """True labels alone: poses (B, 3) -> (B, H, H) uint8."""
    poses = np.asarray(poses, float)
    columns = np.empty((len(poses), size, size), np.uint8)  # an image as it is painted, column by column
    for part in _chunks(len(poses), size):
        columns[part] = _labels(world, look(world, poses[part], size), size).transpose(0, 2, 1)
    return columns.transpose(0, 2, 1)


def look(world, poses, size=SIZE_PX):
    """What each column of each view shows: poses (B, 3) -> Surfaces."""
    strip = cast(world, poses, size)
    pile = _pile(world, strip, size)
    return _visible(pile, len(poses) * size, size, len(world.label))


def row_of(z, w, size):
    """Row coordinate y [px] of height z [m] at inverse depth w [1/m]."""
    return (1 - (z - HEIGHT_M) * w / np.tan(FIELD_OF_VIEW_RAD / 2)) * (size / 2)


def _pile(world, strip, size):
    """Surfaces of each ray, near to far: (ray, box, kind, w, first row, end row), those without a pixel left out."""
    z0, z1 = world.z[strip.box].T
    top, foot = row_of(z1, strip.w_in, size), row_of(z0, strip.w_in, size)
    capped = np.flatnonzero((z1 < HEIGHT_M) | (z0 > HEIGHT_M))
    kind = np.where(z1[capped] < HEIGHT_M, TOP, UNDERSIDE)
    back = row_of(np.where(kind == TOP, z1[capped], z0[capped]), strip.w_out[capped], size)

    begin = np.concatenate([top, np.where(kind == TOP, back, foot[capped])])
    end = np.concatenate([foot, np.where(kind == TOP, top[capped], back)])
    begin, end = (np.ceil(y - 0.5).clip(0, size).astype(np.int64) for y in (begin, end))
    kind = np.concatenate([np.zeros(len(top), int), kind])
    crossing = np.concatenate([np.arange(len(top)), capped])

    shown = np.flatnonzero(end > begin)
    crossing, kind = crossing[shown], kind[shown]
    # A top belongs right behind its front; but what stands on it comes between the two.
    late = (kind != FRONT) & world.carries[strip.box[crossing]]
    nearness = np.where(late, strip.w_out[crossing], strip.w_in[crossing] - 1e-9 * kind)
    order = np.argsort(strip.ray[crossing] - nearness * (NEAREST_M / 2))
    crossing, shown = crossing[order], shown[order]
    return strip.ray[crossing], strip.box[crossing], kind[order], strip.w_in[crossing], begin[shown], end[shown]


def _visible(pile, n_rays, size, n_boxes):
    """Runs of the nearest surface in each column, from piles sorted near to far.

    Each surface of a column owns one bit, the nearest the lowest. Its first row switches the bit on, its end row
    off; between two such edges one sees the lowest bit that is on.
    """
    ray, box, kind, w, begin, end = pile
    S, H, column = len(ray), size, np.arange(n_rays)
    first = np.searchsorted(ray, column)  # of each ray's surfaces
    bit = np.arange(S) - first[ray]
    if S and bit.max() >= MOST_SURFACES:
        return _visible([a[bit < MOST_SURFACES] for a in pile], n_rays, size, n_boxes)

    none = 63  # the ceiling begins with each column, the floor at half its height; they own no bit
    pixel = np.concatenate([ray * H + begin, ray * H + end, column * H, column * H + H // 2])
    edge = np.sort(pixel * 64 + np.concatenate([bit, bit, np.full(2 * n_rays, none)]))  # one sort moves both
    pixel, bit = edge >> 6, edge & 63
    on = np.bitwise_xor.accumulate(np.where(bit == none, 0, np.left_shift(1, bit)))
    length = np.diff(pixel, append=n_rays * H)
    run = np.flatnonzero(length)
    pixel, on = pixel[run], on[run]
    lowest = np.frexp((on & -on).astype(float))[1] - 1
    ray_of_run, row = np.divmod(pixel, H)
    background = S + ray_of_run + np.where(row < H // 2, 0, n_rays)
    surface = np.where(on == 0, background, first[ray_of_run] + lowest)
    return Surfaces(np.concatenate([ray, column, column]),
                    np.concatenate([box, np.full(n_rays, n_boxes), np.full(n_rays, n_boxes + 1)]),
                    np.concatenate([kind, np.full(n_rays, UNDERSIDE), np.full(n_rays, TOP)]),
                    np.concatenate([w, np.ones(2 * n_rays)]), surface, length[run])


def _labels(world, surfaces, size):
    of_box = np.append(world.label, np.array([CEILING, FLOOR], np.uint8))
    return surfaces.paint(of_box[surfaces.box], size).transpose(0, 2, 1)


def _chunks(n_views, size):
    step = max(1, CHUNK_RAYS // size)
    return [slice(i, min(i + step, n_views)) for i in range(0, n_views, step)]
