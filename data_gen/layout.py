"""Layouts of procedural homes: where the rooms lie, their walls, and the gaps between them.

A corridor runs from the front door through the flat with a strip of rooms on either side of it. In half of
the flats it ends at a living room that, with the kitchen, takes the whole far end. Living room, dining room
and kitchen open into each other without doors.

    W, D        m        width (x) and depth (y) of the footprint, before the flat is mirrored and turned
    wish        tuple    type of a room and the area wished for [m2]; the footprint decides how near it comes
    rooms       list     (type, rectangle), first what lies outside the front door, then the corridor
    rectangle   (4,) m   x0, y0, x1, y1 of a room, on the centre lines of its walls
    segment     (4,) m   x0, y0, x1, y1 of a wall or of a gap in it
"""

import itertools
import math
from typing import NamedTuple

import numpy as np

AREA_M2, SIDE_M, CORRIDOR_M, DOOR_M = (82, 128), (8.5, 13.0), (1.25, 1.7), 0.9
WISH_M2 = {"living room": (18, 26), "kitchen": (9, 14), "dining room": (10, 15), "bedroom": (11, 17),
           "study": (9, 13), "bathroom": (4.5, 8)}
EXTRAS = ("bedroom", "study", "bathroom", "dining room")  # besides what every home has
DAY = ("living room", "dining room", "kitchen")


class Gap(NamedTuple):
    """A gap in the wall between two rooms, given by their numbers: `left` and `right` of the segment."""
    segment: tuple
    right: int
    left: int
    kind: str  # "door", "front door" or "opening"


def draw_rooms(n_extras, rng):
    """Rooms of a home, as in the head of this module; None if the draw gives no good home."""
    kinds = ["living room", "kitchen", "bathroom", "bedroom", "bedroom"]
    kinds += rng.choice(EXTRAS, n_extras, replace=False).tolist()
    wishes = [(kind, rng.uniform(*WISH_M2[kind])) for kind in kinds]
    area = np.clip(total(wishes) * rng.uniform(1.1, 1.3), *AREA_M2)  # the corridor takes the rest
    W = rng.uniform(max(SIDE_M[0], area / SIDE_M[1]), min(SIDE_M[1], area / SIDE_M[0]))
    D, h = area / W, rng.uniform(*CORRIDOR_M)

    south, north, far_end = share_out(wishes, rng)
    end = W * (1 - total(far_end) / total(wishes))
    c = (D - h) * total(south) / (total(south) + total(north))
    rooms = [("outside", (-1.0, c, 0.0, c + h)), ("corridor", (0.0, c, end, c + h))]
    rooms += in_row(south, 0, end, 0, c) + in_row(north, 0, end, c + h, D)
    rooms += [(kind, (x0, y0, x1, y1)) for kind, (y0, x0, y1, x1) in in_row(far_end, 0, D, end, W)]
    for kind, (x0, y0, x1, y1) in rooms[2:]:
        into_kitchen = kind == "kitchen" and x0 == end and y0 < c + h and y1 > c
        if into_kitchen or not good_shape(kind, x1 - x0, y1 - y0):
            return None  # the corridor is to end at the living room
    kinds, rectangles = zip(*rooms, strict=True)
    return list(zip(kinds, turn(np.array(rectangles), W, D, rng), strict=True))


def share_out(wishes, rng):
    """The wishes of the rooms south of the corridor, north of it and at its far end, if they are there."""
    living, kitchen, *others = wishes
    rng.shuffle(others)
    dining = [wish for wish in others if wish[0] == "dining room"]
    others = [wish for wish in others if wish[0] != "dining room"]
    if rng.random() < 0.5:
        south, north, far_end = [], [], [living, kitchen][::rng.choice((-1, 1))]
        others += dining  # the last of its strip touches the far end
    else:
        south, north, far_end = [living, *dining, kitchen], [], []
    for wish in others:
        min(south, north, key=total).append(wish)
    return south, north, far_end


def good_shape(kind, width, depth):
    """Whether a room is neither too small nor too long."""
    least_side, least_area, longest = (1.7, 4.2, 3.0) if kind == "bathroom" else (2.5, 8.4, 2.4)
    short, long = sorted((width, depth))
    return short >= least_side and short * long >= least_area and long <= longest * short


def total(part):
    """Area wished for, of some rooms together."""
    return sum(area for _, area in part)


def in_row(part, x0, x1, y0, y1):
    """Rooms side by side along x, their widths in proportion to the areas wished for."""
    cuts = np.cumsum([0.0, *(area for _, area in part)]) / max(total(part), 1) * (x1 - x0) + x0
    return [(kind, (a, y0, b, y1)) for (kind, _), a, b in zip(part, cuts[:-1], cuts[1:], strict=True)]


def turn(rectangles, W, D, rng):
    """Mirror and turn the rectangles (n, 4) of a W x D home at random; whole centimetres."""
    R, W, D = rectangles.round(2), round(W, 2), round(D, 2)
    if rng.random() < 0.5:
        R[:, [0, 2]] = W - R[:, [2, 0]]
    if rng.random() < 0.5:
        R[:, [1, 3]] = D - R[:, [3, 1]]
    if rng.random() < 0.5:
        R = R[:, [1, 0, 3, 2]]
    return R.round(2).tolist()


def shared_wall(a, b):
    """Segment that two rectangles have in common, with b on its left; None if they have none."""
    x0, y0, x1, y1 = max(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3])
    if x0 == x1 and y0 < y1:
        return (x0, y0, x0, y1) if b[2] == x0 else (x0, y1, x0, y0)
    if y0 == y1 and x0 < x1:
        return (x0, y0, x1, y0) if b[1] == y0 else (x1, y0, x0, y0)
    return None


def draw_walls(rooms):
    """Walls of a home before the gaps are cut: its outline and one between any two rooms that touch."""
    rectangles = [rectangle for _, rectangle in rooms[1:]]
    (x0, y0), (x1, y1) = np.min(rectangles, 0)[:2].tolist(), np.max(rectangles, 0)[2:].tolist()
    inner = (shared_wall(a, b) for a, b in itertools.combinations(rectangles, 2))
    return [(x0, y0, x1, y0), (x1, y0, x1, y1), (x1, y1, x0, y1), (x0, y1, x0, y0), *filter(None, inner)]


def draw_gaps(rooms, rng):
    """The front door, doors from the corridor into the rooms beside it, openings between the day rooms (DAY)."""
    gaps = []
    for (i, (kind, a)), (j, (other, b)) in itertools.combinations(enumerate(rooms), 2):
        wall = shared_wall(a, b)
        if not wall:
            continue
        _, _, length = direction(wall)
        corridors_end = i == 1 and other == "living room" and length < CORRIDOR_M[1] + 0.005  # whole centimetres
        if i == 0:
            gaps.append(Gap(part_of(wall, (length - DOOR_M) / 2, DOOR_M), i, j, "front door"))
        elif corridors_end or (kind in DAY and other in DAY and length > 1.5):
            width = min(length - 0.3, rng.uniform(1.0, 1.8))
            gaps.append(Gap(part_of(wall, rng.uniform(0.15, length - width - 0.15), width), i, j, "opening"))
        elif i == 1:  # hinged near the room's corner: the leaf stands open along the side wall
            gaps.append(Gap(part_of(wall, rng.uniform(0.12, 0.35), DOOR_M), i, j, "door"))
    return gaps


def cut(wall, gaps):
    """The parts of a wall that are left between those gaps (segments) that lie on it."""
    u, v, length = direction(wall)
    spans = []
    for gap in gaps:
        ends = [(x - wall[0], y - wall[1]) for x, y in (gap[:2], gap[2:])]
        along, aside = sorted(x * u + y * v for x, y in ends), max(abs(y * u - x * v) for x, y in ends)
        if aside < 1e-6 and along[1] > 0 and along[0] < length:
            spans.append(along)
    ends = [0.0, *itertools.chain(*sorted(spans)), length]
    return [list(part_of(wall, a, b - a)) for a, b in zip(ends[::2], ends[1::2], strict=True)]


def direction(segment):
    """Unit vector (u, v) from the first to the second point of a segment, and its length."""
    x0, y0, x1, y1 = segment
    length = math.dist((x0, y0), (x1, y1))
    return (x1 - x0) / length, (y1 - y0) / length, length


def part_of(segment, start, length):
    """The part of a segment that begins `start` [m] after its first point, rounded to 0.1 mm."""
    x, y, (u, v, _) = *segment[:2], direction(segment)
    ends = x + start * u, y + start * v, x + (start + length) * u, y + (start + length) * v
    return tuple(round(end, 4) for end in ends)
