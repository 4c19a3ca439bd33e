"""Floor plans: a home as plain JSON, loaded, checked and saved.

    {"name": "...", "units": "m", "wall_height": 2.5,
     "walls":   [[x0, y0, x1, y1], ...],
     "doors":   [{"segment": [x0, y0, x1, y1], "height": 2.0, "state": "open", "color": [r, g, b]}],
     "rooms":   [{"type": "bedroom", "polygon": [[x, y], ...]}],
     "objects": [{"class": "bed", "polygon": [[x, y], ...], "z0": 0.0, "height": 0.5, "color": [r, g, b]}],
     "colors":  {"wall": [r, g, b], "floor": [r, g, b], "ceiling": [r, g, b]}}

Metres; `height` is an object's own extent above `z0`; walls end where a door begins. Required are `walls`, a door's
segment, a room's polygon (3 to 400 corners), an object's class, polygon and height. Other keys are left as they are,
but whatever `colors` holds must be a colour. Each fault is one ValueError: file, place in the file, what was expected,
what was found.
"""

import json
import math

import numpy as np

from .files import write_whole
from .polygons import inner_corners

WALL_HEIGHT_M, LOWEST_WALL_M = 2.5, 1.35  # no lower than the robot
DOOR_HEIGHT_M = 2.0
LARGEST_HOME_M = 200.0
FARTHEST_M = 10_000.0  # from the origin: farther off, 32 bits hold a particle's place to no better than a millimetre
MOST_CORNERS, MOST_INNER = 400, 50  # of a polygon; the time to cover a jagged one grows with the cube of their number
HUGE = 1e9  # no number of a plan is greater
DEEPEST = 100  # lists and objects inside one another; the format needs five


def load(path):
    """Read and check the floor plan at `path`; returns the plan, a dict as in the head of this module."""
    try:
        with open(path, encoding="utf-8") as file:
            plan = json.load(file, object_pairs_hook=_once)
    except OSError as error:
        raise ValueError(f"{path}: expected a floor plan, found no readable file ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: expected JSON, found something else ({error})") from None
    outer = [[plan]]
    for _ in range(DEEPEST + 1):
        inner = [value for one in outer for value in (one.values() if isinstance(one, dict) else one)]
        outer = [value for value in inner if isinstance(value, (dict, list))]
    if outer:
        raise ValueError(f"{path}: expected at most {DEEPEST} lists or objects inside one another, found more")
    return check(plan, path)


def _once(pairs):
    """A dict of pairs whose keys are all different, or ValueError: of two equal keys `json` would keep the last."""
    found = {}
    for name, value in pairs:
        if name in found:
            raise ValueError(f"the key {name!r} twice in one object")
        found[name] = value
    return found


def save(plan, path):
    """Write `plan` as JSON, one wall, door, room or object per line."""
    def rows(value):
        if not (isinstance(value, list) and value):
            return json.dumps(value)
        return "[\n  " + ",\n  ".join(json.dumps(row) for row in value) + "]"
    text = "{" + ",\n ".join(f"{json.dumps(key)}: {rows(value)}" for key, value in plan.items()) + "}\n"
    write_whole(path, text.encode())


def check(plan, source="floor plan"):
    """Return `plan` if it is a floor plan as in the head of this module; ValueError naming the fault if not."""
    def fail(place, expected, found):
        raise ValueError(f"{source}: {place}: expected {expected}, found {json.dumps(found, default=repr)[:60]}")

    def number(value, place, at_least=-math.inf):
        real = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not (real and abs(value) < HUGE and value >= at_least):  # NaN compares as false
            fail(place, "a number" if at_least == -math.inf else f"a number >= {at_least:g}", value)

    def numbers(value, count, place):
        if not isinstance(value, (list, tuple)) or len(value) != count:
            fail(place, f"a list of {count} numbers", value)
        for item in value:
            number(item, place)

    def segment(value, place):
        numbers(value, 4, place)
        if math.dist(value[:2], value[2:]) < 1e-6:
            fail(place, "two different end points", value)

    def polygon(value, place):
        if not isinstance(value, (list, tuple)) or not 3 <= len(value) <= MOST_CORNERS:
            fail(place, f"a polygon of 3 to {MOST_CORNERS} points", value)
        for point in value:
            numbers(point, 2, place)
        n_inner = len(inner_corners(np.array(value, float)))
        if n_inner > MOST_INNER:
            fail(place, f"a polygon of at most {MOST_INNER} inner corners", n_inner)

    def colour(value, place):
        numbers(value, 3, place)
        if not all(0 <= part <= 255 for part in value):
            fail(place, "three numbers from 0 to 255", value)

    def items(key):
        value = plan.get(key, [])
        if not isinstance(value, (list, tuple)):
            fail(key, "a list", value)
        for i, item in enumerate(value):
            if not isinstance(item, dict):
                fail(f"{key}[{i}]", "an object", item)
            yield f"{key}[{i}]", item

    if not isinstance(plan, dict):
        fail("top level", "an object", plan)
    if plan.get("units", "m") != "m":
        fail("units", '"m"', plan["units"])
    number(plan.get("wall_height", WALL_HEIGHT_M), "wall_height", at_least=LOWEST_WALL_M)
    walls = plan.get("walls")
    if not isinstance(walls, (list, tuple)) or not walls:
        fail("walls", "a list of at least one wall", walls)
    for i, wall in enumerate(walls):
        segment(wall, f"walls[{i}]")
    for place, door in items("doors"):
        segment(door.get("segment"), f"{place}.segment")
        number(door.get("height", DOOR_HEIGHT_M), f"{place}.height", at_least=0.1)
        if door.get("state") not in (None, "open", "closed"):
            fail(f"{place}.state", '"open" or "closed"', door["state"])
        if "color" in door:
            colour(door["color"], f"{place}.color")
    for place, room in items("rooms"):
        polygon(room.get("polygon"), f"{place}.polygon")
    for place, thing in items("objects"):
        polygon(thing.get("polygon"), f"{place}.polygon")
        number(thing.get("z0", 0.0), f"{place}.z0")
        number(thing.get("height"), f"{place}.height", at_least=0.0)
        if not isinstance(thing.get("class"), str):
            fail(f"{place}.class", "a word", thing.get("class"))
        if "color" in thing:
            colour(thing["color"], f"{place}.color")
    if not isinstance(plan.get("colors", {}), dict):
        fail("colors", "an object", plan["colors"])
    for name, value in plan.get("colors", {}).items():
        colour(value, f"colors.{name}")
    ends = [end for wall in walls for end in (wall[:2], wall[2:])]
    for key in ("walls", "rooms", "objects"):
        things = [] if key == "walls" else plan.get(key, [])
        points = ends + [corner for thing in things for corner in thing["polygon"]]
        extent = max(max(line) - min(line) for line in zip(*points, strict=True))
        if extent > LARGEST_HOME_M:
            fail(key, f"a home of at most {LARGEST_HOME_M:g} m", round(extent, 1))
    farthest = max(abs(value) for end in ends for value in end)
    if farthest > FARTHEST_M:
        fail("walls", f"a home within {FARTHEST_M:g} m of the origin (move it there)", farthest)
    return plan
