"""Puts furniture into one room of a procedural home and leaves a robot the room to get everywhere in it.

A piece gets a few tries; it stays if it overlaps nothing and leaves the free floor connected, else the room
does without. Every position is drawn as seen from the room's door, so that two rooms furnished with one key
look alike to whoever enters them, however they are turned.

    x, y        (H, W) m   centres of the cells of a room's floor
    clearance   (H, W) m   distance of each cell from what stands in the robot's way
    latest      dict       name -> Box of the last piece of that name
"""

import math

import numpy as np
from scipy.ndimage import label

from gnl.world import ROBOT_HEIGHT_M, ROBOT_RADIUS_M, STEP_M, WALL_THICKNESS_M

from .box import Box, distance, hits, inside, outline, overlap, seen, shift, turned
from .furniture import PIECES, ROOMS

TRIES = 8  # for each piece; more would fill the last corners and cost time
BACK_M, MARGIN_M = 0.07, 0.06  # least distance to a wall's centre line: of a piece's back, of anything
FRONT_M = 0.5  # kept free before what stands at a wall, for doors, drawers and knees
CELL_M = 0.1
AT_WALL = ("wall", "corner", "facing")
ALONE = (*AT_WALL, "middle", "free")  # must keep off the fronts of others; a desk's own chair need not


def furnish(room, kind, keep_clear, leaves, key):
    """Objects of a room as floor-plan dicts, or None if the first piece, which defines its type, finds no place.

    room       : Box
    kind       : str, one of ROOMS
    keep_clear : [Box], the floor before and behind its doors and openings
    leaves     : [Box], its open doors
    key        : int; the same key, the same furniture
    """
    x, y, clearance = empty_floor(room)
    clearance = np.min([clearance, *(distance(leaf, x, y) for leaf in leaves)], axis=0)
    placed, fronts, latest, objects = list(leaves), [], {}, []
    for index, (name, rules, often) in enumerate(ROOMS[kind]):
        rng = np.random.default_rng((key, index))  # its own stream: what does not fit changes nothing later
        if rng.random() >= often:
            continue
        piece = draw_piece(name, rng)
        for rule, other in tries(rules, latest):
            if rule in ("beside", "round") and name in latest:
                piece = latest[name]  # a pair of nightstands, a set of chairs
            box = put(piece, rule, other, room, rng)
            if name != "carpet" and "carpet" in latest and overlap(box, latest["carpet"]):
                box = box._replace(z0=latest["carpet"].height)
            taken = placed + keep_clear + (fronts if rule in ALONE else [])
            if not inside(room, box, MARGIN_M) or hits(box, taken):
                continue
            if box.z0 < ROBOT_HEIGHT_M and box.z0 + box.height > STEP_M:  # it is in the robot's way
                front = before(box)
                left_over = np.minimum(clearance, distance(box, x, y))
                if (rule in AT_WALL and hits(front, placed)) or not in_one_part(left_over):
                    continue
                clearance = left_over
                if rule in AT_WALL:
                    fronts.append(front)
            placed.append(box)
            latest[name] = box
            objects.append(as_object(name, box))
            break
        else:
            if index == 0:
                return None
    return objects


def draw_piece(name, rng):
    """A piece of furniture, still at the origin."""
    _, *ranges = PIECES[name]
    width, depth, height, z0 = (rng.uniform(*least_most) for least_most in ranges)
    return Box(0, 0, 0, width, depth, height, z0)


def tries(rules, latest):
    """TRIES pairs (rule, Box it refers to), the best rule first; none if all refer to what is not there."""
    rules = [rule.partition(" ") for rule in rules.split(" or ")]
    pairs = [(rule, latest.get(other)) for rule, _, other in rules if not other or other in latest]
    return [pairs[i * len(pairs) // TRIES] for i in range(TRIES) if pairs]


def put(piece, rule, other, room, rng):
    """The piece at a place drawn by a rule of ROOMS; `other` is the Box that the rule refers to."""
    w, d = piece.width, piece.depth
    slide, slip = rng.uniform(-0.5, 0.5, 2)
    quarters, side, gap = int(rng.integers(4)), int(rng.choice((-1, 1))), rng.uniform(0.03, 0.4)
    view, angle = room, None
    if rule in ("wall", "corner"):
        view = turned(room, quarters)
        reach = max(view.width - w - 2 * BACK_M, 0)
        right, front = reach * (slide if rule == "wall" else side / 2), BACK_M + (d - view.depth) / 2
    elif rule == "facing":  # at the wall that `other` looks at
        view = turned(room, round((other.angle - room.angle) / (math.pi / 2)) + 2)
        (right, _), front = seen(view, other.x, other.y), BACK_M + (d - view.depth) / 2
    elif rule == "middle":
        view = turned(room, quarters)
        right, front = slide * view.width / 3, slip * view.depth / 3
        angle = view.angle + rng.normal(0, 0.06)
    elif rule == "free":
        right, front = slide * room.width, slip * room.depth
        angle = rng.uniform(-math.pi, math.pi)
    elif rule == "on":
        view, piece = other, piece._replace(z0=other.z0 + other.height)
        right, front = slide * max(other.width - w, 0), slip * max(other.depth - d, 0)
    elif rule == "above":  # and at the same wall
        view, right, front = other, slide * abs(other.width - w), (d - other.depth) / 2
    elif rule == "beside":
        view, right, front = other, side * (other.width + w + gap / 2) / 2, (d - other.depth) / 2
    else:  # "before" it or "round" it, looking at it
        view = turned(other, quarters if rule == "round" else 0)
        right, front = slide * max(view.width - w, 0) / 2, (view.depth + d) / 2 + gap
        angle = view.angle + math.pi
    x, y = shift(view, right, front)
    return piece._replace(x=x, y=y, angle=view.angle if angle is None else angle)


def before(box):
    """The floor in front of a box."""
    x, y = shift(box, 0, (box.depth + FRONT_M) / 2)
    return Box(x, y, box.angle, box.width, FRONT_M, ROBOT_HEIGHT_M, STEP_M)


def empty_floor(room):
    """Cells x, y of a room and their distance to its walls."""
    right, front = (np.arange((CELL_M - size) / 2, size / 2, CELL_M) for size in (room.width, room.depth))
    right, front = np.meshgrid(right, front)
    to_centre_line = np.minimum(room.width / 2 - abs(right), room.depth / 2 - abs(front))
    return *shift(room, right, front), to_centre_line - WALL_THICKNESS_M / 2


def in_one_part(clearance):
    """Whether the robot gets from any free cell to any other; half a cell is margin for the way between two centres."""
    return label(clearance > ROBOT_RADIUS_M + CELL_M / 2)[1] == 1


def as_object(name, box):
    """A box as an object of a floor plan."""
    return {"name": name, "class": PIECES[name][0], "polygon": outline(box).round(4).tolist(),
            "z0": round(box.z0, 4), "height": round(box.height, 4)}
