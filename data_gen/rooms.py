"""Procedural homes: a seed becomes a furnished flat of 80 to 130 m2 with 6 to 9 rooms.

They take the place of the paper's three scanned homes (section V) and of the images on which its segmentation
net was trained. layout.py draws the rooms, furnish.py fills each; here they become one floor plan.

    rooms   [(type, rectangle)], first what lies outside the front door, then the corridor
    gaps    [Gap] doors and openings
    key     int, seed of a room's furniture; rooms of the same key and type are alike
"""

import math
import numbers
import re
from pathlib import Path

import numpy as np

from gnl.files import check_file
from gnl.floor_plan import DOOR_HEIGHT_M, WALL_HEIGHT_M
from gnl.world import LEAF_THICKNESS_M, World

from .box import Box
from .furnish import furnish
from .layout import cut, direction, draw_gaps, draw_rooms, draw_walls

BEFORE_DOOR_M, BEFORE_OPENING_M = 0.95, 0.7  # floor kept clear on both sides; a leaf swings 0.9 m
IN_EVERY_HOME = {"bed", "table", "sofa", "refrigerator", "tv", "other"}
TRIES = 10000  # with nine rooms, one layout in forty is good


def add_arguments(parser):
    """Options of `python -m data_gen home`."""
    parser.add_argument("out", help="floor plan to write (.json)")
    parser.add_argument("--seed", type=int, default=800, help="which home: one seed, one home (800)")
    parser.add_argument("--aliasing", type=float, default=0.3, help="0..1, how alike rooms are (0.3)")


def run(args):
    """Write a procedural home as a floor plan; it may replace another one, but no other file."""
    check_file("out", args.out)
    if Path(args.out).exists() and not re.fullmatch(r"home-\d+", name := World.load(args.out).name):
        raise ValueError(f"{args.out}: expected a procedural home or nothing, found {name}")
    make_home(args.seed, args.aliasing).save(args.out)


def make_home(seed, aliasing=0.3):
    """The World of a home; arguments as for home_plan."""
    return World(home_plan(seed, aliasing))


def home_plan(seed, aliasing=0.3):
    """Floor plan of a furnished home in the format of gnl.floor_plan.

    seed     : int >= 0; one seed, one home
    aliasing : 0..1, share of the rooms that are furnished just like the others of their type
    """
    if not isinstance(seed, numbers.Integral) or seed < 0:
        raise ValueError(f"seed: expected an integer >= 0, found {seed!r}")
    if not isinstance(aliasing, numbers.Real) or not 0 <= aliasing <= 1:
        raise ValueError(f"aliasing: expected a number from 0 to 1, found {aliasing!r}")
    rng = np.random.default_rng(seed)
    n_extras = rng.integers(4)  # 6 to 9 rooms
    for _ in range(TRIES):
        rooms = draw_rooms(n_extras, rng)
        gaps = rooms and draw_gaps(rooms, rng)
        objects = gaps and draw_objects(rooms, gaps, aliasing, rng)
        if objects:
            return assemble(f"home-{seed}", rooms, gaps, objects)
    raise ValueError(f"seed {seed}: expected a home within {TRIES} tries, found none")


def draw_objects(rooms, gaps, aliasing, rng):
    """Furniture of all rooms; None if a room lacks the piece that defines its type, or the home one of the classes."""
    objects, keys = [], {}
    for index, (kind, rectangle) in enumerate(rooms[1:], 1):
        own_key, new_key, alike = rng.integers(2**32), rng.integers(2**32), rng.random() < aliasing
        common_key = keys.setdefault(kind, new_key)
        ways = [gap for gap in gaps if index in (gap.left, gap.right)]
        leaves = [leaf_of(gap) for gap in ways if gap.kind == "door" and gap.left == index]
        room = room_seen_from(ways[0], index, rectangle)
        things = furnish(room, kind, [passage(gap) for gap in ways], leaves, common_key if alike else own_key)
        if things is None:
            return None
        objects += things
    found = {thing["class"] for thing in objects}
    return objects if found == IN_EVERY_HOME else None


def room_seen_from(gap, index, rectangle):
    """Room `index` as a Box that looks away from the wall with this gap."""
    u, v, _ = direction(gap.segment)
    x0, y0, x1, y1 = rectangle
    w, d = (x1 - x0, y1 - y0) if v == 0 else (y1 - y0, x1 - x0)
    angle = math.atan2(v, u) + math.pi * (index == gap.right)
    return Box((x0 + x1) / 2, (y0 + y1) / 2, angle, w, d, WALL_HEIGHT_M)


def passage(gap):
    """What must stay clear on both sides of a gap."""
    (x0, y0, x1, y1), (u, v, length) = gap.segment, direction(gap.segment)
    opening = gap.kind == "opening"
    reach, height = (BEFORE_OPENING_M, WALL_HEIGHT_M) if opening else (BEFORE_DOOR_M, DOOR_HEIGHT_M)
    return Box((x0 + x1) / 2, (y0 + y1) / 2, math.atan2(v, u), length + LEAF_THICKNESS_M, 2 * reach, height)


def leaf_of(gap):
    """An open door's leaf: hinged at the first end of its segment, at a right angle to it, on its left."""
    (x, y, *_), (u, v, length) = gap.segment, direction(gap.segment)
    middle = x - v * length / 2, y + u * length / 2
    return Box(*middle, math.atan2(v, u), LEAF_THICKNESS_M, length, DOOR_HEIGHT_M)


def assemble(name, rooms, gaps, objects):
    """The floor plan as a plain dict."""
    segments = [gap.segment for gap in gaps]
    states = {"door": "open", "front door": "closed"}  # an opening has no door
    return {
        "name": name, "units": "m", "wall_height": WALL_HEIGHT_M,
        "walls": [part for wall in draw_walls(rooms) for part in cut(wall, segments)],
        "doors": [{"segment": list(gap.segment), "height": DOOR_HEIGHT_M, "state": states[gap.kind]}
                  for gap in gaps if gap.kind in states],
        "rooms": [{"type": kind, "polygon": [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]}
                  for kind, (x0, y0, x1, y1) in rooms[1:]],
        "objects": objects,
    }
