"""A home as upright boxes with a class and a colour, and where in it a robot has room.

Walls are thin boxes, an open door is a leaf at a right angle to its gap with wall above it, a polygon becomes the
boxes that cover it. Everything downstream (collision, rays, views) sees boxes only.

    centre (N, 2) m    half (N, 2) m     centre and half the side lengths of each box's footprint
    angle  (N,)   rad                    of its first side, counter-clockwise from +x
    z      (N, 2) m                      bottom and top
    label  (N,) uint8  colour (N, 3)     class of CLASSES; RGB in 0..1, as are floor_colour and ceiling_colour
    blocks (N,) bool                     what a robot cannot pass
    carries, covers (N,) bool            what has something standing on it or hanging above; what has something below
    bounds (x0, y0, x1, y1) m            of the walls
"""

import zlib

import numpy as np

from . import floor_plan
from .checks import check_count, check_finite
from .classes import CEILING, DOOR, FLOOR, WALL, class_of
from .free_space import FreeSpace, box_distance
from .polygons import cover_polygon, footprints

WALL_THICKNESS_M = 0.1
LEAF_THICKNESS_M = 0.04
THINNEST_M = 0.01  # a picture without depth still has two sides
ROBOT_RADIUS_M = 0.2
ROBOT_HEIGHT_M = 1.35  # the camera's 1.25 m and a little more: what hangs higher is no obstacle
LEAST_FREE = 1e-3  # share of a home's bounds; with less it is no use to go on drawing poses
STEP_M = 0.05  # what is flatter is driven over, such as a carpet

# Colours by class, for what bears none of its own: a mean, how far objects stray from it in brightness, and in hue.
# They overlap, `other` with all of them: the labels of a view are learned, not looked up.
COLOUR_MEAN = np.array([[.80, .77, .70], [.52, .41, .30], [.93, .93, .90], [.48, .58, .80], [.68, .45, .20],
                        [.42, .20, .12], [.64, .28, .32], [.70, .82, .94], [.07, .07, .10], [.50, .54, .42]])
BRIGHTNESS_STD = np.array([.05, .06, .02, .09, .07, .05, .09, .04, .02, .16])
HUE_STD = np.array([.02, .03, .01, .05, .04, .03, .06, .02, .01, .10])


class World:
    """A home made of boxes, from a floor plan (a dict as in floor_plan.py)."""

    def __init__(self, plan):
        self.plan = plan = floor_plan.check(plan)
        self.name = str(plan.get("name", "home"))
        self.wall_height = float(plan.get("wall_height", floor_plan.WALL_HEIGHT_M))
        ends = np.array(plan["walls"], float).reshape(-1, 2)
        self.bounds = (*ends.min(0), *ends.max(0))
        # Colours belong to the home, not to a run.
        rng = np.random.default_rng(zlib.crc32(self.name.encode(errors="replace")))
        shell = plan.get("colors", {})
        self.floor_colour = _colour(FLOOR, shell.get("floor"), rng)
        self.ceiling_colour = _colour(CEILING, shell.get("ceiling"), rng)
        wall_colour = _colour(WALL, shell.get("wall"), rng)

        walls = [_panel(wall, WALL_THICKNESS_M, 0.0, self.wall_height, WALL, wall_colour) for wall in plan["walls"]]
        doors = plan.get("doors", [])
        shut = [_panel(d["segment"], WALL_THICKNESS_M, 0.0, self.wall_height, DOOR, wall_colour) for d in doors]
        self.free_space = FreeSpace(self.bounds, *footprints(walls + shut))
        boxes = walls + [box for door in doors for box in self._door(door, walls, wall_colour, rng)]
        gaps = np.array([d["segment"] for d in doors], float).reshape(-1, 2, 2).mean(1)
        for thing in plan.get("objects", []):
            # CHOICE: a door among the objects that fills a gap is that door's leaf, told twice: the door decides.
            label, z0, middle = class_of(thing["class"]), thing.get("z0", 0.0), np.mean(thing["polygon"], 0)
            if label == DOOR and (np.hypot(*(gaps - middle).T) < 0.2).any():
                continue
            colour = _colour(label, thing.get("color"), rng)
            boxes += [(*box, z0, z0 + thing["height"], label, *colour) for box in cover_polygon(thing["polygon"])]

        boxes = np.array(boxes, float)
        self.centre, self.half, self.angle = footprints(boxes)
        self.half = self.half.clip(THINNEST_M / 2)
        self.z, self.label, self.colour = boxes[:, 5:7], boxes[:, 7].astype(np.uint8), boxes[:, 8:11]
        self.z[:, 1] = self.z[:, 1].clip(self.z[:, 0] + THINNEST_M)
        self.carries, self.covers = self._stacks()
        self.blocks = (self.z[:, 0] < ROBOT_HEIGHT_M) & (self.z[:, 1] > STEP_M)
        self.free_space.furnish(self.centre[self.blocks], self.half[self.blocks], self.angle[self.blocks])

    @classmethod
    def load(cls, path):
        """The home of the floor plan at `path`; ValueError that names the fault."""
        return cls(floor_plan.load(path))

    def save(self, path):
        """Write the floor plan, whole or not at all."""
        floor_plan.save(self.plan, path)

    def is_free(self, xy, radius_m=ROBOT_RADIUS_M):
        """Whether a disc at each point is inside the home and touches nothing: (n, 2) -> (n,) bool."""
        xy, b = _check_xy(xy), self.blocks
        distance = box_distance(xy, self.centre[b], self.half[b], self.angle[b]).min(1, initial=np.inf)
        return self.free_space.inside(xy) & (distance > radius_m)

    def is_reachable(self, xy, radius_m=ROBOT_RADIUS_M):
        """Whether a disc at each point is free and in the largest region that it can roam: (n, 2) -> (n,) bool."""
        xy = _check_xy(xy)
        reachable = self.free_space.look_up(self.free_space.largest_region(radius_m), xy)
        reachable[reachable] = self.is_free(xy[reachable], radius_m)
        return reachable

    def spots_in(self, room, step_m=0.2):
        """Points of a raster within a room of the plan: (n, 2)."""
        parts = cover_polygon(room["polygon"])
        low, high = np.min(room["polygon"], 0), np.max(room["polygon"], 0)
        x, y = (np.arange(a + step_m / 2, b, step_m) for a, b in zip(low, high, strict=True))
        spots = np.stack(np.meshgrid(x, y), -1).reshape(-1, 2)
        return spots[box_distance(spots, *footprints(parts)).min(1) == 0]

    def out_of_reach(self):
        """Types of the rooms that no robot gets into: a doorway may be missing."""
        return [str(room.get("type", "room")) for room in self.plan.get("rooms", [])
                if not self.is_reachable(self.spots_in(room)).any()]

    def free_poses(self, n, rng, radius_m=ROBOT_RADIUS_M):
        """n poses uniform over the largest region of free space, bearings uniform: (n, 3)."""
        n, poses, drawn = check_count("n", n, 0), np.empty((0, 3)), 0
        while len(poses) < n:
            draw = rng.uniform((*self.bounds[:2], -np.pi), (*self.bounds[2:], np.pi), (4 * n + 1000, 3))
            poses = np.vstack([poses, draw[self.is_reachable(draw[:, :2], radius_m)]])
            drawn += len(draw)
            if len(poses) < LEAST_FREE * drawn:
                raise ValueError(f"{self.name!r}: expected free space for a disc of {radius_m:g} m, "
                                 f"found {len(poses)} free among {drawn} points")
        return poses[:n]

    def _stacks(self):
        """Which boxes have something above their top, and which below their bottom: (N,) bool each.

        That is judged by axis-parallel rectangles around them.
        """
        reach = abs(np.cos(self.angle)) * self.half.T + abs(np.sin(self.angle)) * self.half.T[::-1]  # along x and y
        near = [abs(np.subtract.outer(c, c)) < np.add.outer(r, r) for c, r in zip(self.centre.T, reach, strict=True)]
        above = self.z[None, :, 0] > self.z[:, None, 1] - 0.01
        return [(near[0] & near[1] & beyond).any(1) for beyond in (above, above.T)]

    def _door(self, door, walls, wall_colour, rng):
        """Boxes of a door: its leaf, shut or swung to the left about the segment's first end; the wall above it."""
        segment, height = np.array(door["segment"], float), door.get("height", floor_plan.DOOR_HEIGHT_M)
        hinge, end = segment.reshape(2, 2)
        along = (end - hinge) / np.hypot(*(end - hinge))
        left, middle = np.array([-along[1], along[0]]), (hinge + end) / 2
        leads_out = not self.free_space.inside(middle + 0.4 * np.array([left, -left])).all()
        # CHOICE: a door of which the plan says nothing is open, but a front door is shut.
        is_open = (door.get("state") or ("closed" if leads_out else "open")) == "open"
        # A segment along a wall is no gap but a folding door standing open. (One spot alone walled: a wall ends in it.)
        spots = hinge + np.array([[0.25], [0.5], [0.75]]) * (end - hinge)
        walled = box_distance(spots, *footprints(walls)).min(1) < 0.1
        folded = walled[1] and walled.sum() > 1
        if is_open and not folded:
            end = hinge + left * np.hypot(*(end - hinge))
        boxes = [_panel((*hinge, *end), LEAF_THICKNESS_M, 0.0, height, DOOR, _colour(DOOR, door.get("color"), rng))]
        if height < self.wall_height and not folded:
            boxes.append(_panel(segment, WALL_THICKNESS_M, height, self.wall_height, WALL, wall_colour))
        return boxes


def _check_xy(xy):
    """The points as floats (n, 2); ValueError for another shape, NaN or infinity."""
    xy = np.asarray(xy, float)
    if xy.size and xy.shape[-1:] != (2,):
        raise ValueError(f"xy: expected shape (n, 2), found {xy.shape}")
    check_finite("xy", xy)
    return xy.reshape(-1, 2)


def _panel(segment, thickness, z0, z1, label, colour):
    """An upright board along a segment as a row (x, y, half length, half width, angle, z0, z1, label, r, g, b)."""
    x0, y0, x1, y1 = segment
    length, angle = np.hypot(x1 - x0, y1 - y0), np.arctan2(y1 - y0, x1 - x0)
    return ((x0 + x1) / 2, (y0 + y1) / 2, length / 2, thickness / 2, angle, z0, z1, label, *colour)


def _colour(label, given, rng):
    """The given RGB (0..255) or one drawn for the class, in 0..1. Draws in any case, so later ones keep theirs."""
    drawn = COLOUR_MEAN[label] + BRIGHTNESS_STD[label] * rng.normal() + HUE_STD[label] * rng.normal(size=3)
    drawn = drawn.clip(0.03, 0.97)
    return drawn if given is None else np.array(given) / 255
