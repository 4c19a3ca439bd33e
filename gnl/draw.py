"""Pictures: homes, views, strips, graphs, ranks and beliefs, with Pillow alone.

Every function returns a PIL.Image in RGB. No stage of the algorithm needs a picture, so this module may use all
of them. Pictures are drawn twice as large and then shrunk, which makes their lines smooth.

    px   of the finished picture, (column, row), row 0 at the top
    m    on maps, x to the right, y up; cells are named as on a chess board: columns A, B, ..., rows 1, 2, ...
"""

import copy
import io

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from .classes import CLASSES, N_CLASSES, PALETTE, WALL
from .files import write_whole
from .free_space import box_distance
from .polygons import cover_polygon
from .scene_graph import VIEW_PX, words_in_words
from .strip import cast, slopes
from .world import ROBOT_HEIGHT_M, ROBOT_RADIUS_M, STEP_M

PAPER, INK, QUIET, BAR, FAINT = (255, 255, 255), (38, 40, 46), (112, 116, 124), (158, 164, 174), (216, 219, 224)
ROBOT, BELIEF, RIGHT, WRONG, WALLS = (213, 94, 0), (92, 60, 160), (0, 140, 100), (196, 30, 58), (92, 94, 102)
TINTS = (250, 242, 226), (232, 243, 236), (234, 240, 249), (250, 236, 232), (242, 237, 248), (241, 243, 226)
SIZES = ("small", "medium", "large")
LOCATIONS = ("upper left", "upper centre", "upper right", "left", "centre", "right",
             "lower left", "lower centre", "lower right")
THINGS = range(3, N_CLASSES)  # what stands in a home, without its shell
SMOOTH, RIM_PX, LINE_PX = 2, 20, 19  # enlargement; around a map; from one line of text to the next


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

    def text(self, at, words, size=12, colour=INK, anchor="lm", halo=None):
        self.pen.text(_enlarged([at])[0], words, colour, ImageFont.load_default(SMOOTH * size), anchor,
                      stroke_width=SMOOTH if halo else 0, stroke_fill=halo)

    def paste(self, picture, x, y):
        large = picture.resize((SMOOTH * picture.width, SMOOTH * picture.height), Image.Resampling.NEAREST)
        self.image.paste(large, (SMOOTH * round(x), SMOOTH * round(y)))

    def picture(self):
        return self.image.reduce(SMOOTH)


class Map(Canvas):
    """A home seen from above, to draw on in metres; as high as it needs if no height is given.

    With a PlaceGrid it shows the cells. Hanging things are pale with a strong outline, flat ones pale.
    """

    def __init__(self, world, width_px=640, height_px=None, grid=None):
        self.world, self.grid = world, grid
        low, high = np.reshape(world.bounds, (2, 2))
        if grid:
            high = np.maximum(high, grid.origin + np.array([grid.nx, grid.ny]) * grid.cell_m)
        room = np.array([width_px, height_px or np.inf]) - 2 * RIM_PX
        self.px_per_m = (room / (high - low)).min()
        self.upper_left = np.array([low[0], high[1]])
        width, height = (high - low) * self.px_per_m
        super().__init__(width_px, height_px or height + 2 * RIM_PX)
        self.shift = np.array([self.width - width, self.height - height]) / 2
        self._floor()
        self._things()
        self._names()
        start, end = self.at((high[0] - 2, high[1])) - (0, 9), self.at(high) - (0, 9)
        self.line([start - (0, 4), start, end, end - (0, 4)])
        self.text(start - (5, 1), "2 m", 11, INK, "rm")

    def at(self, xy):
        """Where points are in the picture: (..., 2) m -> (..., 2) px."""
        return self.shift + (np.asarray(xy, float) - self.upper_left) * self.px_per_m * [1, -1]

    def sight(self, pose, colour=ROBOT, farthest_m=9.0):
        """What a robot at `pose` can see: its field of view as far as the walls."""
        near = cast(self.world, np.array([pose]), 256).dense()[0][0]  # of each ray's crossings; the last is a wall
        reach = np.where(near < np.inf, near, 0).max(1).clip(0, farthest_m)
        rim = pose[:2] + reach[:, None] * _ahead(pose[2] + np.arctan(slopes(256)))
        self.polygon(self.at([pose[:2], *rim]), (*colour, 40), (*colour, 100))

    def robot(self, pose, colour=ROBOT):
        """A robot, and where it looks."""
        radius = max(ROBOT_RADIUS_M * self.px_per_m, 7)
        self.disc(self.at(pose[:2]), radius, colour, PAPER, 1.5)
        self.arrow(self.at(pose[:2]), pose[2], 1.4 * radius, PAPER)

    def starts(self, poses, colour=ROBOT):
        """Many poses, each a little arrow."""
        for pose in poses:
            self.arrow(self.at(pose[:2]), pose[2], 15, colour)

    def path(self, poses, colour=ROBOT):
        """The way along some poses, a dot at each."""
        points = self.at(np.asarray(poses)[:, :2])
        self.line(points, (*colour, 170), 2)
        for point in points:
            self.disc(point, 3, colour, PAPER)

    def particles(self, particles, n=600, colour=BELIEF):
        """n of the particles (x, y, theta, weight), each as often as it weighs: dots, with a hair ahead."""
        x, y, theta, weight = particles
        total = np.cumsum(weight, dtype=float)
        chosen = np.searchsorted(total, (np.arange(n) + 0.5) / n * total[-1])
        dots = np.stack([x, y], 1)[chosen]
        for dot, tip in zip(self.at(dots), self.at(dots + 0.15 * _ahead(theta[chosen])), strict=True):
            self.line([dot, tip], (*colour, 70))
            self.disc(dot, 1.5, (*colour, 80))

    def belief(self, pooled, colour=BELIEF):
        """Belief in each place (K,): a rose in each cell, its petals the bearings, dark where belief is."""
        for place in np.flatnonzero(pooled > 0.002):
            self.polygon(self.petal(place), (*colour, int(30 + 210 * pooled[place] ** 0.5)))

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
            for axis, name in ((0, _column_name), (1, _row_name)):
                along, across = np.eye(2)[axis], np.eye(2)[1 - axis]
                for i in range(size[axis] + 1):
                    ends = [i * along, i * along + size * across]
                    self.line(self.at(g.origin + np.array(ends) * g.cell_m), (*QUIET, 70))
                for i in range(size[axis]):
                    middle = self.at(g.origin + (i + 0.5) * along * g.cell_m) + across * [-10, 10]
                    self.text(middle, name(i), 12, QUIET, "mm")

    def _things(self):
        w = self.world
        corners = w.half[:, None] * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        cos, sin = np.cos(w.angle)[:, None], np.sin(w.angle)[:, None]
        x, y = corners[..., 0] * cos - corners[..., 1] * sin, corners[..., 0] * sin + corners[..., 1] * cos
        corners = self.at(w.centre[:, None] + np.stack([x, y], -1))
        for i in np.argsort(w.z[:, 1], kind="stable"):  # from above one sees the highest
            if w.label[i] != WALL:
                flat, hangs = w.z[i, 1] <= STEP_M, w.z[i, 0] >= ROBOT_HEIGHT_M
                self.polygon(corners[i], _colour(w.label[i], 70 if flat or hangs else 255),
                             _colour(w.label[i]) if hangs else (*INK, 90))
            elif w.z[i, 0] <= 0:  # and not the wall above a door
                self.polygon(corners[i], WALLS, WALLS)

    def _names(self):
        """Name each room where the fewest things are in the way."""
        w = self.world
        for room in w.plan.get("rooms", []):
            name, parts = str(room.get("type", "")), np.array(cover_polygon(room["polygon"]))
            low, high = np.min(room["polygon"], 0), np.max(room["polygon"], 0)
            spots = np.stack(np.meshgrid(*map(np.arange, low + 0.1, high, [0.2, 0.2])), -1).reshape(-1, 2)
            spots = spots[box_distance(spots, parts[:, :2], parts[:, 2:4], parts[:, 4]).min(1) == 0]
            if not len(spots):
                continue  # a room too small for a name
            reach = ImageFont.load_default(13).getlength(name) / 2 / self.px_per_m
            along = (spots[:, None] + np.linspace(-reach, reach, 7)[:, None] * [1, 0]).reshape(-1, 2)
            free = box_distance(along, w.centre, w.half, w.angle).min(1).reshape(-1, 7).min(1)
            free -= 0.05 * np.hypot(*(spots - (low + high) / 2).T)
            self.text(self.at(spots[free.argmax()]), name, 13, QUIET, "mm", (*PAPER, 160))


def home(world, width_px=640, grid=None, starts=()):
    """A home from above, the cells of its places, poses as little arrows, and the colours of what stands in it."""
    plan = Map(world, width_px, grid=grid)
    plan.starts(starts)
    return sheet([plan.picture(), legend(THINGS)], columns=1, margin=4)


def belief_on_map(world, grid, pooled, particles, pose, width_px=640):
    """Where a filter thinks it is: belief in places (K,), particles (x, y, theta, weight), the true pose."""
    plan = Map(world, width_px, grid=grid)
    plan.belief(pooled)
    plan.particles(particles)
    plan.robot(pose)
    return plan.picture()


def view(rgb, size_px=256):
    """A first-person view (H, W, 3), each of its pixels a square."""
    return Image.fromarray(np.asarray(rgb, np.uint8)).resize((size_px, size_px), Image.Resampling.NEAREST)


def labels(label_image, size_px=256):
    """Labels (H, W) in the colours of their classes."""
    return view(PALETTE[label_image], size_px)


def legend(classes=range(N_CLASSES), size=12):
    """Colours and names of classes in one line."""
    font = ImageFont.load_default(size)
    ends = np.cumsum([0] + [30 + font.getlength(CLASSES[c]) for c in classes])
    canvas = Canvas(ends[-1], LINE_PX)
    for x, c in zip(ends, classes, strict=False):
        canvas.box(x, 3, x + 13, 16, _colour(c), QUIET)
        canvas.text((x + 18, 10), CLASSES[c], size)
    return canvas.picture()


def strip(world, dense, width_px=384, height_px=256):
    """The semantic strip of one view: rays from left to right, distance upwards; behind the last crossing grey.

    dense : near, far [m] and box of each crossing, (C, D) each: one view of Strip.dense()
    """
    near, far, box = dense
    crossed, rim, H = box >= 0, 34, height_px - 12
    last = np.where(crossed, near, 0).max(1)
    farthest = max(1, int(np.ceil(last.max() + 0.3)))
    distance = farthest * (1 - (np.arange(H) + 0.5) / H)[:, None]  # of each row of the picture
    rows = np.where((distance < last) | (last == 0), 1, 0)[..., None] * (np.array(PAPER) - FAINT) + FAINT
    length = np.where(crossed, np.maximum(far - np.where(crossed, near, 0), 2.5 * farthest / H), -1)
    for d in np.argsort(-length, 1).T:  # the longest first, so that none hides another
        begin, long, label = (a[np.arange(len(d)), d] for a in (near, length, world.label[box]))
        inside = (distance >= begin) & (distance < begin + long)
        rows[inside] = PALETTE[np.broadcast_to(label, inside.shape)[inside]]
    canvas = Canvas(width_px, height_px)
    canvas.paste(Image.fromarray(rows.astype(np.uint8)).resize((width_px - rim - 1, H)), rim, 6)
    for metre in range(0, farthest + 1, 1 + farthest // 8):
        y = 6 + H * (1 - metre / farthest)
        canvas.line([(rim - 4, y), (rim, y)], QUIET)
        canvas.text((rim - 7, y), f"{metre} m", 11, QUIET, "rm")
    canvas.box(rim, 6, width_px - 1, 6 + H, None, QUIET)
    return canvas.picture()


def graph(graphs, picture, full=True):
    """A scene graph over its view or labels: boxes, nodes at their middles, edges, and the word of each node.

    graphs : SceneGraphs of one view;  full : the whole word ("sofa, medium, lower left") or its class alone
    """
    canvas = Canvas(*picture.size)
    canvas.paste(Image.blend(picture, Image.new("RGB", picture.size, PAPER), 0.5), 0, 0)
    boxes = graphs.boxes * (picture.width / VIEW_PX) + [1, 1, -1, -1]
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    words = words_in_words(graphs.words)
    colours = [_colour(label) for label, _, _ in words]
    names = [f"{CLASSES[c]}, {SIZES[s]}, {LOCATIONS[l]}" if full else CLASSES[c] for c, s, l in words]
    taken = np.hstack([middles - 6, middles + 6])  # the nodes; no name shall cover them, nor another name
    for middle, name in zip(middles, names, strict=True):
        width = ImageFont.load_default(11).getlength(name) + 8
        taken = np.vstack([taken, _spot(middle, width, 16, taken, picture.size)])
    plates = taken[len(middles):]

    for box, colour in zip(boxes, colours, strict=True):
        canvas.box(*box, None, (*INK, 80), 4)
        canvas.box(*(box + [1, 1, -1, -1]), None, colour, 2)
    for i, j in graphs.edges:
        canvas.line(middles[[i, j]], (*INK, 150), 1.5)
    for middle, plate, colour in zip(middles, plates, colours, strict=True):
        canvas.line([middle, middle.clip(plate[:2], plate[2:])])
        canvas.disc(middle, 5, colour, INK, 1.5)
    for plate, name, colour in zip(plates, names, colours, strict=True):
        canvas.box(*plate, (*PAPER, 225), colour)
        canvas.text((plate[0] + 4, (plate[1] + plate[3]) / 2), name, 11)
    return canvas.picture()


def ranks(grid, values, true_place=None, n=8, width_px=230):
    """The n places of the greatest values (K,), reciprocal ranks or beliefs: rank, cell, bearing, value.

    The true place is green, and stands last if it is not among them.
    """
    order = np.argsort(-values, kind="stable")
    shown = [(i + 1, p) for i, p in enumerate(order) if (i < n and values[p] > 0) or p == true_place]
    if len(shown) > n:
        shown = [*shown[:n - 1], shown[-1]]
    canvas = Canvas(width_px, LINE_PX * len(shown) + 2)
    for i, (rank, place) in enumerate(shown):
        y, ink = LINE_PX * i + 10, RIGHT if place == true_place else INK
        if place == true_place:
            canvas.box(0, y - 9, width_px, y + 9, (*RIGHT, 30))
        ix, iy = divmod(grid.location_of(place), grid.ny)
        end = 72 + max(1.5, (width_px - 72 - 36) * values[place] / max(values[order[0]], 1e-9))
        canvas.text((22, y), str(rank) if values[place] > 0 else "", 11, QUIET, "rm")
        canvas.text((30, y), _column_name(ix) + _row_name(iy), 12, ink)
        canvas.arrow((60, y), (place % grid.n_bearings + 0.5) * 2 * np.pi / grid.n_bearings, 14, ink)
        canvas.polygon([(72, y - 5), (end, y - 5), (end, y + 5), (72, y + 5)], ink if ink == RIGHT else BAR)
        canvas.text((end + 5, y), f"{values[place]:.2f}", 11, ink)
    return canvas.picture()


def save_png(picture, path):
    """Write a picture, whole or not at all."""
    data = io.BytesIO()
    picture.save(data, "PNG", optimize=True)
    write_whole(path, data.getvalue())


def sheet(pictures, titles=None, columns=None, margin=12):
    """Pictures in rows of `columns`, each below its title."""
    titles = titles or [""] * len(pictures)
    columns = columns or len(pictures)
    head = LINE_PX + 4 if any(titles) else 0
    rows = [pictures[i:i + columns] for i in range(0, len(pictures), columns)]
    widths = [max(p.width for p in pictures[i::columns]) for i in range(columns)]
    heights = [max(p.height for p in row) + head for row in rows]
    canvas = Canvas(sum(widths) + margin * (columns + 1), sum(heights) + margin * (len(rows) + 1))
    for i, (picture, title) in enumerate(zip(pictures, titles, strict=True)):
        row, column = divmod(i, columns)
        x, y = sum(widths[:column]) + margin * (column + 1), sum(heights[:row]) + margin * (row + 1)
        canvas.text((x, y + 9), title, 13)
        canvas.paste(picture, x, y + head)
    return canvas.picture()


def _colour(label, alpha=255):
    return *PALETTE[label].tolist(), alpha


def _ahead(theta):
    return np.stack([np.cos(theta), np.sin(theta)], -1)


def _column_name(ix):
    return (chr(64 + ix // 26) if ix >= 26 else "") + chr(65 + ix % 26)


def _row_name(iy):
    return str(iy + 1)


def _enlarged(points):
    return [(SMOOTH * float(x), SMOOTH * float(y)) for x, y in points]


def _spot(node, width, height, taken, size):
    """Where the words of a node go: near it, in the picture, as little as can be over the boxes `taken`."""
    def cost(box):
        low, high = np.maximum(box[:2], taken[:, :2]), np.minimum(box[2:], taken[:, 2:])
        overlap = (high - low).clip(0).prod(1).sum()
        return 1e3 * overlap + abs(box[0] + width / 2 - node[0]) / 4 + abs(box[1] + height / 2 - node[1])

    lefts = np.clip(node[0] + np.array([8, -width / 2, -width - 8]), 1, size[0] - width - 1)
    tops = np.clip(node[1] - height / 2 + np.arange(-144, 145, 6), 1, size[1] - height - 1)
    return min(((x, y, x + width, y + height) for x in lefts for y in tops), key=cost)
