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
from .strip import FIELD_OF_VIEW_RAD, NEAREST_M, TOP, UNDERSIDE, cast

HEIGHT_M = 1.25  # CHOICE: table tops seen from above, refrigerators from the front
SIZE_PX = 512
MOST_SURFACES = 61  # of one column, one bit each; what lies behind the 61 nearest is not drawn
CEILING_BIT, FLOOR_BIT = MOST_SURFACES, MOST_SURFACES + 1
RAYS_AT_ONCE, RAYS_OF_PHOTO = 4096, 1024  # as many as stay near the processor; a photograph needs much room for each


@dataclass(frozen=True)
class Surfaces:
    """What the columns of some views show: S surfaces, near to far in each ray, and R runs of pixels.

    Behind the surfaces of boxes come the ceiling of each ray and then the floor of each ray. A run is a piece of a
    column that shows one surface; runs lie one behind the other, column by column from the top, and fill the views.
    """

    ray: np.ndarray  # (S,) int, view * C + column
    box: np.ndarray  # (S,) int; N for a ceiling, N + 1 for a floor
    face: np.ndarray  # (S,) one of the four sides, TOP or UNDERSIDE
    w: np.ndarray  # (S,) inverse depth of a side
    run_surface: np.ndarray  # (R,) int
    run_length: np.ndarray  # (R,) int, pixels

    def paint(self, of_surface, size):
        """Spread values of surfaces (S,) over all pixels, column by column: (B, C, H)."""
        return np.repeat(of_surface[self.run_surface], self.run_length).reshape(-1, size, size)


def render(world, poses, rng, size=SIZE_PX, noise=1.0):
    """First-person views and their true labels: poses (B, 3) -> rgb (B, H, H, 3) uint8, labels (B, H, H) uint8.

    size  : H; 64 gives the same view at an eighth of the resolution
    noise : appearance noise of the photograph (see photo.py); 0 is a clean drawing
    """
    poses = np.asarray(poses, float)
    rgb = np.empty((len(poses), size, size, 3), np.uint8)
    labels = np.empty((len(poses), size, size), np.uint8)
    for part in _chunks(len(poses), RAYS_OF_PHOTO // size):
        surfaces = look(world, poses[part], size)
        labels[part] = _labels(world, surfaces, size)
        rgb[part] = photograph(world, poses[part], surfaces, size, HEIGHT_M, rng, noise)
    return rgb, labels


def true_labels(world, poses, size=SIZE_PX):
    """True labels alone: poses (B, 3) -> (B, H, H) uint8."""
    poses = np.asarray(poses, float)
    columns = np.empty((len(poses), size, size), np.uint8)  # an image as it is painted, column by column
    for part in _chunks(len(poses), RAYS_AT_ONCE // size):
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
    """Surfaces of each ray, near to far: (ray, box, face, w, first row, end row), those without a pixel left out."""
    z0, z1 = (z[strip.box] for z in world.z.T)
    top, foot = row_of(z1, strip.w_in, size), row_of(z0, strip.w_in, size)
    capped = np.flatnonzero((z1 < HEIGHT_M) | (z0 > HEIGHT_M))
    from_above = z1[capped] < HEIGHT_M
    back = row_of(np.where(from_above, z1[capped], z0[capped]), strip.w_out[capped], size)

    begin = np.concatenate([top, np.where(from_above, back, foot[capped])])
    end = np.concatenate([foot, np.where(from_above, top[capped], back)])
    begin, end = (np.ceil(y - 0.5).clip(0, size).astype(int) for y in (begin, end))
    face = np.concatenate([strip.side, np.where(from_above, TOP, UNDERSIDE)])
    crossing = np.concatenate([np.arange(len(top)), capped])

    shown = np.flatnonzero(end > begin)
    crossing, face = crossing[shown], face[shown]
    # A top belongs right behind its front; but what stands on it comes between the two.
    late = (face >= TOP) & world.carries[strip.box[crossing]]
    nearness = np.where(late, strip.w_out[crossing], strip.w_in[crossing])
    # Sorting numbers of which the last digits are the place in the list is faster than asking for the order.
    far = ((1 - nearness * NEAREST_M) * 2 ** 30).astype(int)
    bits = len(shown).bit_length()
    order = np.sort(((strip.ray[crossing] << 31) + far << bits) + np.arange(len(shown))) & (1 << bits) - 1
    crossing, shown = crossing[order], shown[order]
    return strip.ray[crossing], strip.box[crossing], face[order], strip.w_in[crossing], begin[shown], end[shown]


def _visible(pile, n_rays, size, n_boxes):
    """Runs of the nearest surface in each column, from piles sorted near to far.

    Each surface of a column owns one bit, the nearest the lowest. Its first row switches the bit on, its end row
    off; between two such edges one sees the lowest bit that is on. The two highest are those of ceiling and floor:
    they change places where a column begins and at half its height.
    """
    ray, box, face, w, begin, end = pile
    S, H, column = len(ray), size, np.arange(n_rays)
    first = np.searchsorted(ray, column)  # of each ray's surfaces
    bit = np.arange(S) - first[ray]
    if S and bit.max() >= MOST_SURFACES:
        return _visible([a[bit < MOST_SURFACES] for a in pile], n_rays, size, n_boxes)

    both = 63  # stands for the bits of ceiling and floor together
    mask = np.append(1 << np.arange(63), 1 << CEILING_BIT | 1 << FLOOR_BIT)
    top, start = column * (H * 64) + both, ray * (H * 64) + bit
    edge = np.sort(np.concatenate([start + begin * 64, start + end * 64, top, top + H // 2 * 64]))
    pixel = edge >> 6
    on = np.bitwise_xor.accumulate(mask[edge & 63]) ^ 1 << FLOOR_BIT
    length = np.append(pixel[1:], n_rays * H) - pixel
    run = np.flatnonzero(length)
    on, ray_of_run = on[run], pixel[run] // H
    lowest = np.frexp((on & -on).astype(float))[1] - 1
    background = S + ray_of_run + np.where(lowest == FLOOR_BIT, n_rays, 0)
    surface = np.where(lowest >= CEILING_BIT, background, first[ray_of_run] + lowest)
    return Surfaces(np.concatenate([ray, column, column]),
                    np.concatenate([box, np.full(n_rays, n_boxes), np.full(n_rays, n_boxes + 1)]),
                    np.concatenate([face, np.full(n_rays, UNDERSIDE), np.full(n_rays, TOP)]),
                    np.concatenate([w, np.ones(2 * n_rays)]), surface, length[run])


def _labels(world, surfaces, size):
    of_box = np.append(world.label, np.array([CEILING, FLOOR], np.uint8))
    return surfaces.paint(of_box[surfaces.box], size).transpose(0, 2, 1)


def _chunks(n_views, at_once):
    step = max(1, at_once)
    return [slice(i, min(i + step, n_views)) for i in range(0, n_views, step)]
