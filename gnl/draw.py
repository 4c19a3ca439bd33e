"""Pictures: homes, views, strips, graphs, ranks and beliefs, with Pillow alone.

Every function returns a PIL.Image in RGB; lengths are in px of the finished picture. No stage of the algorithm needs
a picture, so this module may use all of them.
"""

import io

import numpy as np
from PIL import Image, ImageFont

from .classes import CLASSES, N_CLASSES, PALETTE
from .files import write_whole
from .floor_map import BAR, FAINT, INK, LINE_PX, PAPER, QUIET, RIGHT, Canvas, Map, colour_of, column_name, row_name
from .scene_graph import VIEW_PX, words_in_words

SIZES = ("small", "medium", "large")
LOCATIONS = ("upper left", "upper centre", "upper right", "left", "centre", "right",
             "lower left", "lower centre", "lower right")
THINGS = range(3, N_CLASSES)  # what stands in a home, without its shell


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
        canvas.box(x, 3, x + 13, 16, colour_of(c), QUIET)
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
    colours = [colour_of(label) for label, _, _ in words]
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
        canvas.text((30, y), column_name(ix) + row_name(iy), 12, ink)
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


def _spot(node, width, height, taken, size):
    """Where the words of a node go: near it, in the picture, as little as can be over the boxes `taken`."""
    def cost(box):
        low, high = np.maximum(box[:2], taken[:, :2]), np.minimum(box[2:], taken[:, 2:])
        overlap = (high - low).clip(0).prod(1).sum()
        return 1e3 * overlap + abs(box[0] + width / 2 - node[0]) / 4 + abs(box[1] + height / 2 - node[1])

    lefts = np.clip(node[0] + np.array([8, -width / 2, -width - 8]), 1, size[0] - width - 1)
    tops = np.clip(node[1] - height / 2 + np.arange(-144, 145, 6), 1, size[1] - height - 1)
    return min(((x, y, x + width, y + height) for x in lefts for y in tops), key=cost)
