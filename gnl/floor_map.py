"""A home seen from above, to draw on in metres.

    px   of the finished picture, (column, row), row 0 at the top
    m    x to the right, y up; cells are named as on a chess board: columns A, B, ..., rows 1, 2, ...
"""

import numpy as np
from scipy.spatial import cKDTree

from .canvas import BELIEF, INK, PAPER, QUIET, ROBOT, TINTS, Canvas, colour_of, text_width
from .classes import WALL
from .free_space import box_distance
from .polygons import cover_polygon, footprints
from .strip import cast, slopes
from .world import ROBOT_HEIGHT_M, ROBOT_RADIUS_M, STEP_M

RIM_PX = 20  # around a map
NAME_PX, SMALL_PX, AIR_PX = 13, 11, 5  # names of rooms: size of the letters, in a narrow room, room around them


class Map(Canvas):
    """A home from above, with its cells if there is a PlaceGrid; as high as needed if no height is set.

    Hanging things are pale with a strong outline, flat ones just pale. Names of rooms stand above all else.
    """

    def __init__(self, world, width_px=640, height_px=None, grid=None):
        self.world, self.grid = world, grid
        low, high = np.reshape(world.bounds, (2, 2))
        if grid:
            high = np.maximum(high, grid.origin + np.array([grid.nx, grid.ny]) * grid.cell_m)
        room = np.array([width_px, height_px or np.inf]) - 2 * RIM_PX
        self.px_per_m = (room / (high - low)).min()
        self.upper_left, (width, height) = np.array([low[0], high[1]]), (high - low) * self.px_per_m
        super().__init__(width_px, height_px or height + 2 * RIM_PX)
        self.shift = np.array([self.width - width, self.height - height]) / 2
        self.marks, self.named = np.empty((0, 2)), None  # what names keep away from [m]; the names once settled
        self.letters = []  # of columns and rows: middle [px] and words
        self._floor()
        self._things()
        start, end = self.at((high[0] - 2, high[1])) - (0, 9), self.at(high) - (0, 9)
        self.line([start - (0, 4), start, end, end - (0, 4)])
        self.text(start - (5, 1), "2 m", 11, INK, "rm")

    def at(self, xy):
        """Where points are in the picture: (..., 2) m -> (..., 2) px."""
        return self.shift + (np.asarray(xy, float) - self.upper_left) * self.px_per_m * [1, -1]

    def _mark(self, xy):
        """The same for (n, 2) m, and from now on names of rooms keep away from there."""
        self.marks = np.append(self.marks, xy, 0)
        return self.at(xy)

    def sight(self, pose, colour=ROBOT):
        """What a robot at `pose` can see: its field of view as far as the walls, at most as far as the home is wide."""
        farthest_m = np.hypot(*np.subtract(self.world.bounds[2:], self.world.bounds[:2]))
        near = cast(self.world, np.array([pose]), 256).dense()[0][0]  # of each crossing; the last is usually a wall
        near = np.where(near < np.inf, near, -1).max(1, initial=-1)
        reach = np.where(near < 0, np.inf, near).clip(0, farthest_m)  # a ray that crosses nothing goes on
        rim = pose[:2] + reach[:, None] * _ahead(pose[2] + np.arctan(slopes(256)))
        self.polygon(self.at([pose[:2], *rim]), (*colour, 30), (*colour, 130))

    def robot(self, pose, colour=ROBOT):
        """A robot, and where it looks."""
        self.dial(self._mark([pose[:2]])[0], pose[2], max(ROBOT_RADIUS_M * self.px_per_m, 7), colour)

    def starts(self, poses, colour=ROBOT):
        """Many poses, each a little arrow."""
        for middle, pose in zip(self._mark(np.asarray(poses)[:, :2]), poses, strict=True):
            self.arrow(middle, pose[2], 16, colour, PAPER)

    def path(self, poses, colour=ROBOT):
        """The way along some poses, a dot at each."""
        points = self._mark(np.asarray(poses)[:, :2])
        self.line(points, (*colour, 170), 2)
        for point in points:
            self.disc(point, 3, colour, PAPER)

    def particles(self, particles, n=600, colour=BELIEF):
        """n dots, each particle (x, y, theta, weight) in proportion to its weight, with a hair that points ahead."""
        x, y, theta, weight = particles
        total = np.cumsum(weight, dtype=float)
        chosen = np.searchsorted(total, (np.arange(n) + 0.5) / n * total[-1])
        dots = np.stack([x, y], 1)[chosen]
        for dot, tip in zip(self._mark(dots), self.at(dots + 0.15 * _ahead(theta[chosen])), strict=True):
            self.line([dot, tip], (*colour, 70))
            self.disc(dot, 1.5, (*colour, 80))

    def belief(self, pooled, colour=BELIEF):
        """Belief in each place (K,): a rose in each cell, its petals the bearings, the darker the more belief."""
        for place in np.flatnonzero(pooled > 0.002):
            self.polygon(self.petal(place), (*PAPER, 170))  # so that it shows on dark things, too
            self.polygon(self.petal(place), (*colour, int(30 + 210 * pooled[place] ** 0.5)), (*INK, 200))

    def place(self, place, colour):
        """One place: its cell, and the petal of its bearing."""
        low = self.grid.corner_of(place)[:2]
        (x0, y1), (x1, y0) = self.at(low), self.at(low + self.grid.cell_m)
        corners = low + self.grid.cell_m * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
        self._mark(np.linspace(corners, np.roll(corners, 1, 0), 9).reshape(-1, 2))  # the frame, side after side
        self.box(x0, y0, x1, y1, None, colour, 3)
        self.polygon(self.petal(place), (*colour, 80), colour, 1.5)

    def petal(self, place):
        """Outline [px] of the bearings that belong to a place, around the middle of its cell."""
        g = self.grid
        middle = g.corner_of(place) + np.array([0.5, 0.5, 0]) * g.cell_m
        rim = middle[:2] + 0.46 * g.cell_m * _ahead(middle[2] + np.linspace(0, 2 * np.pi / g.n_bearings, 8))
        return self.at([middle[:2], *rim])

    @property
    def pale(self):
        """Which boxes of the world are drawn pale because they are not in the way: (N,) bool."""
        w = self.world
        return (w.label != WALL) & ((w.z[:, 0] >= ROBOT_HEIGHT_M) | (w.z[:, 1] <= STEP_M))

    def names(self):
        """Settle where the names of the rooms stand: away from what has been drawn so far."""
        self.named = self._spots_of_names()

    def picture(self):
        """The map, and above all else the names of columns, rows and rooms."""
        top, rooms = self.copy(), self._spots_of_names() if self.named is None else self.named
        for middle, name, px in self.letters + rooms:
            top.text(middle, name, px, QUIET, "mm", (*PAPER, 190))
        return Canvas.picture(top)

    def _floor(self):
        rooms, g = self.world.plan.get("rooms", []), self.grid
        kinds = sorted({str(room.get("type", "")) for room in rooms})
        for room in rooms:
            self.polygon(self.at(room["polygon"]), TINTS[kinds.index(str(room.get("type", ""))) % len(TINTS)])
        if g:
            size = np.array([g.nx, g.ny])
            for axis, name in ((0, column_name), (1, row_name)):
                along, across = np.eye(2)[axis], np.eye(2)[1 - axis]
                for i in range(size[axis] + 1):
                    ends = [i * along, i * along + size * across]
                    self.line(self.at(g.origin + np.array(ends) * g.cell_m), (*QUIET, 70))
                for i in range(size[axis]):
                    middle = self.at(g.origin + (i + 0.5) * along * g.cell_m) + across * [-10, 10]
                    self.letters.append((middle, name(i), 12))

    def _things(self):
        w, hangs, pale = self.world, self.world.z[:, 0] >= ROBOT_HEIGHT_M, self.pale
        for i in np.argsort(w.z[:, 1], kind="stable"):  # from above one sees the highest
            if w.label[i] != WALL:
                self.polygon(self._outline(i), colour_of(w.label[i], 70 if pale[i] else 255),
                             colour_of(w.label[i]) if hangs[i] else (*INK, 90))  # what hangs has a strong outline
        walls = np.flatnonzero((w.label == WALL) & (w.z[:, 0] <= 0))  # and not the wall above a door
        for colour, less_px in ((QUIET, 0), (colour_of(WALL), 1)):  # all rims first: no rim is left where walls meet
            for i in walls:
                self.polygon(self._outline(i, less_px), colour)

    def _outline(self, i, less_px=0):
        """Corners [px] of a box of the world, drawn in by `less_px` on each side."""
        half, angle = (self.world.half[i] - less_px / self.px_per_m).clip(0), self.world.angle[i]
        ahead, left = _ahead(angle) * half[0], _ahead(angle + np.pi / 2) * half[1]
        return self.at(self.world.centre[i] + np.array([ahead + left, left - ahead, -ahead - left, ahead - left]))

    def _spots_of_names(self):
        """Middle [px], name and size of letters of each room, clear of other names and away from things and marks."""
        named, marks = [], cKDTree(self.marks)
        taken = np.empty((0, 2, 2))  # middle and half size [m] of the names that have a spot
        for room in self.world.plan.get("rooms", []):
            name, found = str(room.get("type", "")), None
            for px in NAME_PX, SMALL_PX:
                half = np.array([text_width(name, px) / 2 + AIR_PX, px / 2 + AIR_PX]) / self.px_per_m
                spot, within = self._best_spot(room, half, taken, marks)
                if spot is not None:
                    found = spot, half, px
                if within:
                    break
            if found:
                spot, half, px = found
                taken = np.append(taken, [[spot, half]], 0)
                named.append((self.at(spot), name, px))
        return named

    def _best_spot(self, room, half, taken, marks):
        """Where in a room a name of this half size [m] stands best, and whether it stays within; None if nowhere."""
        w, spots = self.world, self.world.spots_in(room)
        spots = spots[(abs(spots[:, None] - taken[:, 0]) > half + taken[:, 1]).any(2).all(1)]
        if not len(spots):
            return None, False
        middle = (np.min(room["polygon"], 0) + np.max(room["polygon"], 0)) / 2
        along = (spots[:, None] + np.linspace(-1, 1, 7)[:, None] * half * [1, 0]).reshape(-1, 2)
        free = np.minimum(box_distance(along, w.centre, w.half, w.angle).min(1), marks.query(along)[0])
        free = free.reshape(-1, 7).min(1)
        beyond = box_distance(along, *footprints(cover_polygon(room["polygon"]))).min(1).reshape(-1, 7).max(1)
        best = (free - 2 * beyond - 0.05 * np.hypot(*(spots - middle).T)).argmax()
        return spots[best], not beyond[best]


def _ahead(theta):
    return np.stack([np.cos(theta), np.sin(theta)], -1)


def column_name(ix):
    return (chr(64 + ix // 26) if ix >= 26 else "") + chr(65 + ix % 26)


def row_name(iy):
    return str(iy + 1)
