"""Paper to draw on, and a home seen from above on it; all drawn twice as large and shrunk, so that lines are smooth.

    px   of the finished picture, (column, row), row 0 at the top
    m    on maps, x to the right, y up; cells are named as on a chess board: columns A, B, ..., rows 1, 2, ...
"""

import copy

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from scipy.spatial import cKDTree

from .classes import PALETTE, WALL
from .free_space import box_distance
from .polygons import cover_polygon
from .strip import cast, slopes
from .world import ROBOT_HEIGHT_M, ROBOT_RADIUS_M, STEP_M

PAPER, INK, QUIET, BAR, FAINT = (255, 255, 255), (38, 40, 46), (112, 116, 124), (158, 164, 174), (216, 219, 224)
ROBOT, BELIEF, RIGHT, WRONG = (213, 94, 0), (92, 60, 160), (0, 140, 100), (196, 30, 58)
TINTS = (250, 242, 226), (232, 243, 236), (234, 240, 249), (250, 236, 232), (242, 237, 248), (241, 243, 226)
SMOOTH, RIM_PX, LINE_PX = 2, 20, 19  # enlargement; around a map; from one line of text to the next
NAME_PX, AIR_PX = 13, 5  # names of rooms: size of the letters, room around them


class Canvas:
    """Paper to draw on; all places and lengths in px of the finished picture, colours RGB or RGBA."""

    def __init__(self, width, height):
        self.width, self.height = round(width), round(height)
        self.image = Image.new("RGB", (SMOOTH * self.width, SMOOTH * self.height), PAPER)
        self.pen = ImageDraw.Draw(self.image, "RGBA")  # what lies below shines through a translucent colour

    def polygon(self, points, fill=None, outline=None, width=1.0):
        self.pen.polygon(_enlarged(points), fill, outline, round(SMOOTH * width))

    def box(self, x0, y0, x1, y1, fill=None, outline=None, width=1.0):
        corners = [SMOOTH * x0, SMOOTH * y0, SMOOTH * x1 - 1, SMOOTH * y1 - 1]
        self.pen.rounded_rectangle(corners, 2 * SMOOTH, fill, outline, round(SMOOTH * width))

    def line(self, points, colour=INK, width=1.0):
        self.pen.line(_enlarged(points), colour, round(SMOOTH * width), "curve")

    def disc(self, middle, radius, fill, outline=None, width=1.0):
        self.pen.circle(_enlarged([middle])[0], SMOOTH * radius, fill, outline, round(SMOOTH * width))

    def arrow(self, middle, theta, length, colour=INK):
        """A dart that flies to the bearing theta, counter-clockwise from the right."""
        forward, aside = np.array([[1, -1, -0.6, -1], [0, 0.65, 0, -0.65]])[..., None] * length / 2
        ahead = np.array([np.cos(theta), -np.sin(theta)])
        self.polygon(middle + forward * ahead + aside * ahead[::-1] * [1, -1], colour)

    def dial(self, middle, theta, radius, colour):
        """A disc, and on it the bearing theta."""
        self.disc(middle, radius, colour, PAPER, 1.5)
        self.arrow(middle, theta, 1.4 * radius, PAPER)

    def text(self, at, words, size=12, colour=INK, anchor="lm", halo=None):
        self.pen.text(_enlarged([at])[0], words, colour, ImageFont.load_default(SMOOTH * size), anchor,
                      stroke_width=2 * SMOOTH if halo else 0, stroke_fill=halo)

    def paste(self, picture, x, y):
        large = picture.resize((SMOOTH * picture.width, SMOOTH * picture.height), Image.Resampling.NEAREST)
        self.image.paste(large, (SMOOTH * round(x), SMOOTH * round(y)))

    def picture(self):
        return self.image.reduce(SMOOTH)


class Map(Canvas):
    """A home from above, to draw on in metres; with a PlaceGrid its cells; as high as it needs if no height is set."""

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
        self.marks, self.named = np.empty((0, 2)), None  # what names keep away from [m], and where they are
        self._floor()
        self._things()
        start, end = self.at((high[0] - 2, high[1])) - (0, 9), self.at(high) - (0, 9)
        self.line([start - (0, 4), start, end, end - (0, 4)])
        self.text(start - (5, 1), "2 m", 11, INK, "rm")

    def at(self, xy, taken=False):
        """Where points are in the picture: (..., 2) m -> (..., 2) px. Names of rooms keep away from what is `taken`."""
        self.marks = np.append(self.marks, xy, 0) if taken else self.marks
        return self.shift + (np.asarray(xy, float) - self.upper_left) * self.px_per_m * [1, -1]

    def sight(self, pose, colour=ROBOT, farthest_m=9.0):
        """What a robot at `pose` can see: its field of view as far as the walls."""
        near = cast(self.world, np.array([pose]), 256).dense()[0][0]  # of each ray's crossings; the last is a wall
        reach = np.where(near < np.inf, near, 0).max(1).clip(0, farthest_m)
        rim = pose[:2] + reach[:, None] * _ahead(pose[2] + np.arctan(slopes(256)))
        self.polygon(self.at([pose[:2], *rim]), (*colour, 30), (*colour, 130))

    def robot(self, pose, colour=ROBOT):
        """A robot, and where it looks."""
        self.dial(self.at([pose[:2]], True)[0], pose[2], max(ROBOT_RADIUS_M * self.px_per_m, 7), colour)

    def starts(self, poses, colour=ROBOT):
        """Many poses, each a little arrow."""
        for middle, pose in zip(self.at(np.asarray(poses)[:, :2], True), poses, strict=True):
            self.arrow(middle, pose[2], 15, colour)

    def path(self, poses, colour=ROBOT):
        """The way along some poses, a dot at each."""
        points = self.at(np.asarray(poses)[:, :2], True)
        self.line(points, (*colour, 170), 2)
        for point in points:
            self.disc(point, 3, colour, PAPER)

    def particles(self, particles, n=600, colour=BELIEF):
        """n of the particles (x, y, theta, weight), each as often as it weighs: dots, with a hair ahead."""
        x, y, theta, weight = particles
        total = np.cumsum(weight, dtype=float)
        chosen = np.searchsorted(total, (np.arange(n) + 0.5) / n * total[-1])
        dots = np.stack([x, y], 1)[chosen]
        for dot, tip in zip(self.at(dots, True), self.at(dots + 0.15 * _ahead(theta[chosen])), strict=True):
            self.line([dot, tip], (*colour, 70))
            self.disc(dot, 1.5, (*colour, 80))

    def belief(self, pooled, colour=BELIEF):
        """Belief in each place (K,): a rose in each cell, its petals the bearings, dark where belief is."""
        for place in np.flatnonzero(pooled > 0.002):
            self.polygon(self.petal(place), (*PAPER, 170))  # on dark things, too, one shall see it
            self.polygon(self.petal(place), (*colour, int(30 + 210 * pooled[place] ** 0.5)), (*colour, 160))

    def place(self, place, colour):
        """One place: its cell, and the petal of its bearing."""
        low = self.grid.corner_of(place)[:2]
        (x0, y1), (x1, y0) = self.at(low), self.at(low + self.grid.cell_m)
        self.box(x0, y0, x1, y1, None, colour, 3)
        self.polygon(self.petal(place), (*colour, 80), colour, 1.5)

    def petal(self, place):
        """Outline [px] of the bearings that belong to a place, around the middle of its cell."""
        middle, g = self.grid.corner_of(place) + np.array([0.5, 0.5, 0]) * self.grid.cell_m, self.grid
        rim = middle[:2] + 0.46 * g.cell_m * _ahead(middle[2] + np.linspace(0, 2 * np.pi / g.n_bearings, 8))
        return self.at([middle[:2], *rim])

    @property
    def pale(self):
        """Which boxes of the world are drawn pale, for they are not in the way: (N,) bool."""
        w = self.world
        return (w.label != WALL) & ((w.z[:, 0] >= ROBOT_HEIGHT_M) | (w.z[:, 1] <= STEP_M))

    def names(self):
        """Settle where the names of the rooms stand: away from what has been drawn so far."""
        self.named = self._spots_of_names()

    def picture(self):
        """The map, and above all else the names of its rooms."""
        top = self.copy()
        for middle, name in self._spots_of_names() if self.named is None else self.named:
            top.text(middle, name, NAME_PX, QUIET, "mm", (*PAPER, 190))
        return Canvas.picture(top)

    def copy(self):
        """The map as it is now, to draw further on."""
        twin = copy.copy(self)
        twin.image = self.image.copy()
        twin.pen = ImageDraw.Draw(twin.image, "RGBA")
        return twin

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
                    self.text(middle, name(i), 12, QUIET, "mm")

    def _things(self):
        w, hangs, pale = self.world, self.world.z[:, 0] >= ROBOT_HEIGHT_M, self.pale
        for i in np.argsort(w.z[:, 1], kind="stable"):  # from above one sees the highest
            if w.label[i] != WALL:
                self.polygon(self._outline(i), colour_of(w.label[i], 70 if pale[i] else 255),
                             colour_of(w.label[i]) if hangs[i] else (*INK, 90))  # what hangs has a strong outline
        walls = np.flatnonzero((w.label == WALL) & (w.z[:, 0] <= 0))  # and not the wall above a door
        for colour, less_px in ((QUIET, 0), (colour_of(WALL), 1)):  # all rims first: they end where walls meet
            for i in walls:
                self.polygon(self._outline(i, less_px), colour)

    def _outline(self, i, less_px=0):
        """Corners [px] of a box of the world, somewhat smaller if it should be."""
        half, angle = (self.world.half[i] - less_px / self.px_per_m).clip(0), self.world.angle[i]
        ahead, left = _ahead(angle) * half[0], _ahead(angle + np.pi / 2) * half[1]
        return self.at(self.world.centre[i] + np.array([ahead + left, left - ahead, -ahead - left, ahead - left]))

    def _spots_of_names(self):
        """The middle [px] and name of each room, where few things or marks are in the way and no other name is."""
        w, named, marks = self.world, [], cKDTree(self.marks)
        taken = np.empty((0, 2, 2))  # middle and half size [m] of the names that have a spot
        for room in w.plan.get("rooms", []):
            name, parts = str(room.get("type", "")), np.array(cover_polygon(room["polygon"]))
            size = np.array([text_width(name, NAME_PX) / 2 + AIR_PX, NAME_PX / 2 + AIR_PX]) / self.px_per_m
            low, high = np.min(room["polygon"], 0), np.max(room["polygon"], 0)
            spots = np.stack(np.meshgrid(*map(np.arange, low + 0.1, high, [0.2, 0.2])), -1).reshape(-1, 2)
            spots = spots[box_distance(spots, parts[:, :2], parts[:, 2:4], parts[:, 4]).min(1) == 0]
            spots = spots[(abs(spots[:, None] - taken[:, 0]) > size + taken[:, 1]).any(2).all(1)]
            if not len(spots):
                continue  # no room for a name
            along = (spots[:, None] + np.linspace(-1, 1, 7)[:, None] * size * [1, 0]).reshape(-1, 2)
            free = np.minimum(box_distance(along, w.centre, w.half, w.angle).min(1), marks.query(along)[0])
            free = free.reshape(-1, 7).min(1)
            beyond = box_distance(along, parts[:, :2], parts[:, 2:4], parts[:, 4]).min(1).reshape(-1, 7).max(1)
            best = spots[(free - 2 * beyond - 0.05 * np.hypot(*(spots - (low + high) / 2).T)).argmax()]
            taken = np.append(taken, [[best, size]], 0)
            named.append((self.at(best), name))
        return named


def colour_of(label, alpha=255):
    return *PALETTE[label].tolist(), alpha


def _ahead(theta):
    return np.stack([np.cos(theta), np.sin(theta)], -1)


def text_width(words, size):
    """Width of a text as it is drawn [px]."""
    return ImageFont.load_default(SMOOTH * size).getlength(words) / SMOOTH


def column_name(ix):
    return (chr(64 + ix // 26) if ix >= 26 else "") + chr(65 + ix % 26)


def row_name(iy):
    return str(iy + 1)


def _enlarged(points):
    return [(SMOOTH * float(x), SMOOTH * float(y)) for x, y in points]
