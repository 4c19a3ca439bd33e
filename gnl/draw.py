"""Pictures: homes, views, strips, graphs and ranks, with Pillow alone.

Every function returns a PIL.Image in RGB; lengths are in px of the finished picture. No stage of the algorithm needs
a picture, so this module may import all of them.
"""

import io

import numpy as np
from PIL import Image

from .canvas import (
    BAR,
    BELIEF,
    FAINT,
    INK,
    LINE_PX,
    PAPER,
    QUIET,
    RIGHT,
    ROBOT,
    WRONG,
    Canvas,
    colour_of,
    text_width,
)
from .classes import CLASSES, N_CLASSES, OTHER, PALETTE
from .files import write_whole
from .floor_map import Map, column_name, row_name
from .scene_graph import VIEW_PX, unpack_words

SIZES = ("small", "medium", "large")
LOCATIONS = ("upper left", "upper centre", "upper right", "left", "centre", "right",
             "lower left", "lower centre", "lower right")
MARKS = {  # symbols on maps and in strips, each drawn at (x, y) on a page
    "start": lambda page, x, y: page.arrow((x - 1, y), 0.4, 14, QUIET),
    "pale": lambda page, x, y: page.box(x - 7, y - 6, x + 7, y + 7, colour_of(OTHER, 70), QUIET),
    "robot": lambda page, x, y: page.dial((x, y), 0.4, 7, ROBOT),
    "sight": lambda page, x, y: page.polygon([(x - 7, y), (x + 7, y - 7), (x + 7, y + 7)], (*ROBOT, 40), (*ROBOT, 160)),
    "particles": lambda page, x, y: [page.disc((x + dx, y + dy), 1.5, BELIEF) for dx, dy in ((-4, 2), (0, -3), (4, 3))],
    "right": lambda page, x, y: page.box(x - 6, y - 6, x + 7, y + 7, None, RIGHT, 3),
    "wrong": lambda page, x, y: page.box(x - 6, y - 6, x + 7, y + 7, None, WRONG, 3),
    "hidden": lambda page, x, y: [page.line([(x - d, y + 6), (x + 6 - d, y - 6)], FAINT, 2) for d in (0, 4, 8)]}
FREE, HIDDEN = N_CLASSES, N_CLASSES + 1  # what a strip shows besides classes


def home(world, width_px=640, grid=None, starts=(), shown=None):
    """A home from above, the cells of its places, `starts` as little arrows, `shown` as a robot; below, legends."""
    canvas, marks = Map(world, width_px, grid=grid), {}
    if len(starts):
        canvas.starts(starts, QUIET)
        marks["start"] = f"the {len(starts)} starts of the test"
    if shown is not None:
        canvas.sight(shown)
        canvas.robot(shown)
        marks |= {"robot": "a robot", "sight": "what it sees in the next pictures"}
    if canvas.pale.any():
        marks["pale"] = "pale: hangs overhead or lies flat"
    keys = [legend(np.unique(world.label))] + ([legend([], marks)] if marks else [])
    return sheet([canvas.picture(), *keys], columns=1, margin=4)


def view(rgb, size_px=256):
    """A first-person view (H, W, 3), each of its pixels a square."""
    return Image.fromarray(np.asarray(rgb, np.uint8)).resize((size_px, size_px), Image.Resampling.NEAREST)


def labels(label_image, size_px=256):
    """Labels (H, W) in the colours of their classes."""
    return view(PALETTE[label_image], size_px)


def legend(classes=range(N_CLASSES), marks=None, size=12):
    """Colours and names of classes, then marks (of MARKS) and what they mean, in one line."""
    entries = [(colour_of(c), CLASSES[c]) for c in classes] + list((marks or {}).items())
    ends = np.cumsum([0] + [30 + text_width(words, size) for _, words in entries])
    canvas = Canvas(ends[-1], LINE_PX)
    for x, (symbol, words) in zip(ends, entries, strict=False):
        if symbol in MARKS:
            MARKS[symbol](canvas, x + 7, 9.5)
        else:
            canvas.box(x, 3, x + 13, 16, symbol, QUIET)
        canvas.text((x + 18, 10), words, size)
    return canvas.picture()


def strip(world, dense, width_px=512, height_px=250):
    """The semantic strip of one view: rays from left to right, distance upwards; hatched behind the last crossing.

    dense : near, far [m] and box of each crossing, (C, D) each: one view of Strip.dense();  width, height : of the plot
    """
    rays = np.arange(width_px) * len(dense[0]) // width_px
    near, far, box = (part[rays] for part in dense)
    crossed, H = box >= 0, height_px
    last = np.where(crossed, near, 0).max(1)
    farthest = max(1, int(np.ceil(last.max() + 0.3)))
    distance = farthest * (1 - (np.arange(H) + 0.5) / H)[:, None]  # of each row of the plot
    shown = np.where((distance < last) | (last == 0), FREE, HIDDEN)
    length = np.where(crossed, np.maximum(far - np.where(crossed, near, 0), 2.5 * farthest / H), -1)
    for d in np.argsort(-length, 1).T:  # the longest first, so that none hides another
        begin, long, label = (a[np.arange(len(d)), d] for a in (near, length, world.label[box]))
        inside = (distance >= begin) & (distance < begin + long)
        shown[inside] = np.broadcast_to(label, inside.shape)[inside]
    key = legend(np.unique(shown[shown < FREE]), {"hidden": "hidden by walls"})
    shown[(shown == HIDDEN) & (np.indices(shown.shape).sum(0) % 7 > 2)] = FREE  # hatched: walls are grey, too
    x0, y0 = 30, LINE_PX + 5
    canvas = Canvas(x0 + max(width_px + 1, key.width), y0 + H + 2 * LINE_PX + 10)
    canvas.paste(Image.fromarray(np.array([*PALETTE, PAPER, FAINT], np.uint8)[shown]), x0, y0)
    for metre in range(0, farthest + 1, 1 + farthest // 8):
        y = y0 + H * (1 - metre / farthest)
        canvas.line([(x0 - 4, y), (x0, y)], QUIET)
        canvas.text((x0 - 7, y), str(metre), 11, QUIET, "rm")
    canvas.box(x0 - 1, y0 - 1, x0 + width_px + 1, y0 + H + 1, None, QUIET)
    canvas.text((0, 9), "distance [m]", 12, QUIET)
    canvas.text((x0 + width_px / 2, y0 + H + 13), "ray, from left to right", 12, QUIET, "mm")
    canvas.paste(key, x0, y0 + H + LINE_PX + 8)
    return canvas.picture()


def graph(graphs, picture, full=True):
    """A scene graph over its view or labels: boxes, nodes at their middles, edges, and the word of each node.

    graphs : SceneGraphs of one view;  full : the whole word ("sofa, medium, lower left") or its class alone
    """
    canvas = Canvas(*picture.size)
    canvas.paste(Image.blend(picture, Image.new("RGB", picture.size, PAPER), 0.5), 0, 0)
    boxes = graphs.boxes * (picture.width / VIEW_PX) + [1, 1, -1, -1]
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    words = unpack_words(graphs.words)
    colours = [colour_of(label) for label, _, _ in words]
    names = [f"{CLASSES[c]}, {SIZES[s]}, {LOCATIONS[l]}" if full else CLASSES[c] for c, s, l in words]
    taken = np.hstack([middles - 6, middles + 6])  # the nodes; no name may cover them, or another name
    along, (a, b) = np.linspace(0, 1, 40)[:, None, None], middles[graphs.edges].swapaxes(0, 1)
    lines = (a + along * (b - a)).reshape(-1, 2)  # points of the edges; no name should cover them
    for middle, name in zip(middles, names, strict=True):
        width = text_width(name, 11) + 8
        taken = np.vstack([taken, _spot(middle, width, 16, taken, lines, picture.size)])
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


def ranks(grid, values, true_place=None, n=8, width_px=230, heads=("rank", "place", "1 / rank")):
    """The n places with the greatest values (K,), reciprocal ranks or beliefs: rank, cell, bearing, value.

    The true place is green, and stands last if it is not among them.
    """
    order = np.argsort(-values, kind="stable")
    shown = [(i + 1, p) for i, p in enumerate(order) if (i < n and values[p] > 0) or p == true_place]
    if len(shown) > n:
        shown = [*shown[:n - 1], shown[-1]]
    canvas = Canvas(width_px, LINE_PX * (len(shown) + 1) + 2)
    x_place, x_bar = 36, max(78, 50 + text_width(heads[1], 11))
    for x, head in zip((0, x_place, x_bar), heads, strict=True):
        canvas.text((x, 9), head, 11, QUIET)
    for i, (rank, place) in enumerate(shown):
        y, ink = LINE_PX * (i + 1) + 10, RIGHT if place == true_place else INK
        if place == true_place:
            canvas.box(0, y - 9, width_px, y + 9, (*RIGHT, 30))
        ix, iy = divmod(grid.location_of(place), grid.ny)
        end = x_bar + max(1.5, (width_px - x_bar - 36) * values[place] / max(values[order[0]], 1e-9))
        canvas.text((26, y), str(rank) if values[place] > 0 else "", 11, QUIET, "rm")
        canvas.text((x_place, y), column_name(ix) + row_name(iy), 12, ink)
        canvas.arrow((x_place + 30, y), (place % grid.n_bearings + 0.5) * 2 * np.pi / grid.n_bearings, 14, ink)
        canvas.polygon([(x_bar, y - 5), (end, y - 5), (end, y + 5), (x_bar, y + 5)], ink if ink == RIGHT else BAR)
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


def _spot(node, width, height, taken, lines, size):
    """Where a node's words go: near it, in the picture, covering as little as possible of boxes `taken` and `lines`."""
    def cost(box):
        low, high = np.maximum(box[:2], taken[:, :2]), np.minimum(box[2:], taken[:, 2:])
        overlap = (high - low).clip(0).prod(1).sum()
        covered = ((lines >= box[:2]) & (lines <= box[2:])).all(1).sum()
        return 1e3 * overlap + 2 * covered + abs(box[0] + width / 2 - node[0]) / 4 + abs(box[1] + height / 2 - node[1])

    lefts = np.clip(node[0] + np.array([8, -width / 2, -width - 8]), 1, size[0] - width - 1)
    tops = np.clip(node[1] - height / 2 + np.arange(-144, 145, 6), 1, size[1] - height - 1)
    return min(((x, y, x + width, y + height) for x in lefts for y in tops), key=cost)
