"""Pictures: homes, views, strips, graphs, ranks and beliefs, with Pillow alone.

Every function returns a PIL.Image in RGB. Nothing of the algorithm depends on a picture, so this module may use
all of it. Pictures are drawn twice as large and then shrunk, which makes their lines smooth.

    px      of the finished picture, (column, row), row 0 at the top
    m       on maps: x to the right, y up; columns of places are A, B, ... and rows 1, 2, ... as on a chess board
"""

import io
import itertools

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from . import strip as strips
from .classes import BED, CLASSES, N_CLASSES, PALETTE, WALL
from .files import write_whole
from .free_space import box_distance
from .polygons import cover_polygon
from .robot import ACTIONS
from .scene_graph import VIEW_PX, words_in_words
from .world import ROBOT_HEIGHT_M, ROBOT_RADIUS_M, STEP_M

PAPER, INK, QUIET, FAINT = (255, 255, 255), (38, 40, 46), (116, 120, 128), (222, 224, 228)
ROBOT, BELIEF, RIGHT, WRONG = (213, 94, 0), (92, 60, 160), (0, 140, 100), (196, 30, 58)
WALLS, GROUND = (92, 94, 102), (250, 248, 243)
TINTS = ((250, 242, 226), (232, 243, 236), (234, 240, 249), (250, 236, 232), (242, 237, 248), (241, 243, 226))
SIZES = ("small", "medium", "large")
LOCATIONS = [f"{row}{column}" for row in ("upper ", "middle ", "lower ") for column in ("left", "centre", "right")]
LOCATIONS[4] = "centre"
SMOOTH = 2
RIM_PX, LINE_PX = 20, 18  # around a map; from one line of text to the next


class Canvas:
    """Paper to draw on; all places and lengths in px of the finished picture, colours RGB or RGBA."""

    def __init__(self, width, height, below=None):
        self.size = int(np.ceil(width)), int(np.ceil(height))
        self.image = Image.new("RGB", [SMOOTH * n for n in self.size], PAPER)
        if below is not None:
            self.image.paste(below.resize(self.image.size, Image.Resampling.NEAREST))
        self.pen = ImageDraw.Draw(self.image, "RGBA")  # translucent colours let shine through what lies below

    def polygon(self, points, fill=None, outline=None, width=1.0):
        self.pen.polygon(_enlarged(points), fill, outline, round(SMOOTH * width))

    def box(self, x0, y0, x1, y1, fill=None, outline=None, width=1.0, radius=0.0):
        corners = [SMOOTH * x0, SMOOTH * y0, SMOOTH * x1 - 1, SMOOTH * y1 - 1]
        self.pen.rounded_rectangle(corners, SMOOTH * radius, fill, outline, round(SMOOTH * width))

    def line(self, points, colour=INK, width=1.0):
        self.pen.line(_enlarged(points), colour, round(SMOOTH * width), "curve")

    def disc(self, centre, radius, fill, outline=None, width=1.0):
        self.pen.circle(_enlarged([centre])[0], SMOOTH * radius, fill, outline, round(SMOOTH * width))

    def arrow(self, middle, theta, length, colour=INK, width=1.5):
        """An arrow that points to the bearing theta, counter-clockwise from the right."""
        ahead, left = np.array([np.cos(theta), -np.sin(theta)]), np.array([-np.sin(theta), -np.cos(theta)])
        tip, head = middle + ahead * length / 2, max(4.0, 0.4 * length)
        self.line([middle - ahead * length / 2, tip - ahead * head * 0.7], colour, width)
        self.polygon([tip, tip - ahead * head + left * head / 2, tip - ahead * head - left * head / 2], colour)

    def text(self, at, words, size=12, colour=INK, anchor="lm", halo=None):
        self.pen.text(_enlarged([at])[0], words, colour, ImageFont.load_default(SMOOTH * size), anchor,
                      stroke_width=2 * SMOOTH if halo else 0, stroke_fill=halo)

    def picture(self):
        return self.image.reduce(SMOOTH)


class Map:
    """A home seen from above, to draw on in metres: Map(world).robot(pose).picture().

    width_px, height_px : of the picture; without a height, as high as the home needs
    grid                : a PlaceGrid whose cells to show
    key                 : whether colours and scale are explained below the map
    """

    def __init__(self, world, width_px=640, height_px=None, grid=None, key=True):
        self.world, self.grid = world, grid
        x0, y0, x1, y1 = world.bounds
        if grid:
            x1, y1 = (max(end, o + n * grid.cell_m) for end, o, n in zip((x1, y1), grid.origin, (grid.nx, grid.ny),
                                                                         strict=True))
        below = _key_size(width_px - 2 * RIM_PX - 100)[1] + 6 if key else 0
        self.px_per_m = (width_px - 2 * RIM_PX) / (x1 - x0)
        if height_px:
            self.px_per_m = min(self.px_per_m, (height_px - 2 * RIM_PX - below) / (y1 - y0))
        self.low, self.high = np.array([x0, y0]), np.array([x1, y1])
        width, height = (self.high - self.low) * self.px_per_m
        self.left, self.top = (width_px - width) / 2, RIM_PX
        self.canvas = Canvas(width_px, height_px or height + 2 * RIM_PX + below)
        self._floor()
        self._grid()
        self._things()
        self._names()
        if key:
            self._key(self.top + height + RIM_PX + 2)

    def at(self, xy):
        """Pixel (column, row) of each point: (..., 2) m -> (..., 2) px."""
        xy = np.asarray(xy, float)
        return np.stack([self.left + (xy[..., 0] - self.low[0]) * self.px_per_m,
                         self.top + (self.high[1] - xy[..., 1]) * self.px_per_m], -1)

    def sight(self, pose, colour=ROBOT, farthest_m=8.0):
        """What a robot sees from its pose: its field of view, up to the walls."""
        near = strips.cast(self.world, np.array([pose]), 128).dense()[0][0]
        reach = np.where(near < np.inf, near, 0).max(1)  # nothing behind the nearest wall is in the strip
        reach = np.where(reach > 0, reach, farthest_m).clip(0, farthest_m)
        theta = pose[2] + np.arctan(strips.slopes(128))
        rim = np.array(pose[:2]) + reach[:, None] * np.stack([np.cos(theta), np.sin(theta)], 1)
        self.canvas.polygon(self.at([pose[:2], *rim]), (*colour, 44), (*colour, 90))
        return self

    def robot(self, pose, colour=ROBOT):
        """The robot itself: a disc, and where it looks."""
        radius, centre = max(ROBOT_RADIUS_M * self.px_per_m, 6.0), self.at(pose[:2])
        self.canvas.disc(centre, radius, colour, PAPER, 1.5)
        self.canvas.arrow(centre, pose[2], 1.3 * radius, PAPER)
        return self

    def starts(self, poses, colour=ROBOT):
        """Many poses, each a little arrow."""
        for pose in poses:
            self.canvas.arrow(self.at(pose[:2]), pose[2], 0.4 * self.px_per_m, colour, 1.5)
        return self

    def path(self, poses, colour=ROBOT):
        """The way a robot went, a dot at each of its poses."""
        points = self.at(np.asarray(poses)[:, :2])
        self.canvas.line(points, (*colour, 170), 2)
        for point in points:
            self.canvas.disc(point, 3, colour, PAPER)
        return self

    def particles(self, x, y, theta, weight, n=500, colour=BELIEF):
        """n of the particles, each as often as its weight says: a dot, and a hair that points where it looks."""
        total = np.cumsum(weight, dtype=float)
        chosen = np.searchsorted(total, (np.arange(n) + 0.5) / n * total[-1])
        x, y, theta = x[chosen], y[chosen], theta[chosen]
        hair = np.stack([x + 0.16 * np.cos(theta), y + 0.16 * np.sin(theta)], 1)
        for dot, tip in zip(self.at(np.stack([x, y], 1)), self.at(hair), strict=True):
            self.canvas.line([dot, tip], (*colour, 60), 1)
            self.canvas.disc(dot, 1.6, (*colour, 70))
        return self

    def belief(self, pooled, colour=BELIEF):
        """Belief in each place (K,): a rose in each cell, the petal of a bearing the darker the more belief it holds."""
        for place in np.flatnonzero(pooled > 0.002):
            self._petal(place, fill=(*colour, int(40 + 200 * pooled[place] ** 0.5)))
        return self

    def place(self, place, colour):
        """One place: the outline of its cell, and a petal to its bearing."""
        low = self.grid.corner_of(place)[:2]
        x0, y1, x1, y0 = (*self.at(low), *self.at(low + self.grid.cell_m))
        self.canvas.box(x0, y0, x1, y1, None, colour, 3, 3)
        self._petal(place, (*colour, 90), colour)
        return self

    def picture(self):
        return self.canvas.picture()

    def _petal(self, place, fill, outline=None):
        (x, y, theta), g = self.grid.corner_of(place), self.grid
        middle = np.array([x, y]) + g.cell_m / 2
        theta = theta + np.linspace(0, 2 * np.pi / g.n_bearings, 8)
        rim = middle + 0.46 * g.cell_m * np.stack([np.cos(theta), np.sin(theta)], 1)
        self.canvas.polygon(self.at([middle, *rim]), fill, outline)

    def _floor(self):
        rooms = self.world.plan.get("rooms", [])
        kinds = sorted({room.get("type", "") for room in rooms})
        for room in rooms:
            self.canvas.polygon(self.at(room["polygon"]), TINTS[kinds.index(room.get("type", "")) % len(TINTS)])

    def _grid(self):
        if not self.grid:
            return
        g, rim = self.grid, RIM_PX / 2
        for axis, n, across in ((0, g.nx, g.ny), (1, g.ny, g.nx)):
            for i in range(n + 1):
                ends = np.array([[i, 0], [i, across]], float)[:, [axis, 1 - axis]]
                self.canvas.line(self.at(g.origin + ends * g.cell_m), (*QUIET, 70))
            for i in range(n):
                middle = self.at(g.origin + np.array([i + 0.5, 0.0])[[axis, 1 - axis]] * g.cell_m)
                shift = (-rim, 0) if axis else (0, rim)
                self.canvas.text(middle + shift, str(i + 1) if axis else _letter(i), 12, QUIET, "mm")

    def _things(self):
        w = self.world
        for i in np.argsort(w.z[:, 1], kind="stable"):  # the lower first, as one sees them from above
            if w.label[i] == WALL:
                if w.z[i, 0] <= 0:  # else it is the wall above a door
                    self.canvas.polygon(self.at(_corners(w, i)), WALLS)
                continue
            flat, hangs = w.z[i, 1] <= STEP_M, w.z[i, 0] >= ROBOT_HEIGHT_M
            fill = _colour(w.label[i], 60 if flat or hangs else 255)
            self.canvas.polygon(self.at(_corners(w, i)), fill, _colour(w.label[i]) if hangs else (*INK, 90))

    def _names(self):
        """Names of the rooms, each where the fewest things are in its way."""
        w = self.world
        for room in w.plan.get("rooms", []):
            name, boxes = room.get("type", ""), np.array(cover_polygon(room["polygon"]))
            half = ImageFont.load_default(13).getlength(name) / 2 / self.px_per_m
            low, high = np.min(room["polygon"], 0), np.max(room["polygon"], 0)
            spots = np.stack(np.meshgrid(*(np.arange(a, b, 0.15) for a, b in zip(low, high, strict=True))), -1)
            along = spots.reshape(-1, 1, 2) + np.linspace(-half, half, 7)[:, None] * [1, 0]
            free = box_distance(along.reshape(-1, 2), w.centre, w.half, w.angle).min(1).reshape(-1, 7).min(1)
            free[box_distance(along[:, 3], boxes[:, :2], boxes[:, 2:4], boxes[:, 4]).min(1) > 0] = -1
            free -= 0.02 * np.hypot(*(along[:, 3] - boxes[0, :2]).T)  # of equal ones the one in the middle
            self.canvas.text(self.at(along[free.argmax(), 3]), name, 13, QUIET, "mm", (*PAPER, 150))

    def _key(self, y):
        bar = self.at([[0, 0], [1, 0], [2, 0]])[:, 0]
        bar += self.left - bar[0]
        for a, b, fill in zip(bar, bar[1:], (INK, PAPER), strict=False):
            self.canvas.box(a, y + 6, b, y + 11, fill, INK)
        self.canvas.text((bar[2] + 6, y + 9), "2 m", 12)
        _draw_key(self.canvas, bar[2] + 44, y, self.canvas.size[0] - bar[2] - 44 - RIM_PX)


def _enlarged(points):
    return [(SMOOTH * x, SMOOTH * y) for x, y in points]
