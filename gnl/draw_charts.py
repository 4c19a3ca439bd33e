"""Charts: a heat map of the gaps, learning curves and other lines, a histogram of checkpoints.

Blue is better, orange worse; a colour never stands without its number or name.
"""

import itertools

import numpy as np

from .canvas import BAR, BELIEF, FAINT, INK, PAPER, QUIET, ROBOT, Canvas
from .compare import over_cells
from .draw import sheet

BETTER, WORSE = np.array([0, 114, 178]), np.array([213, 94, 0])
LINES = {"Ours": (0, 114, 178), "MV": (112, 116, 124), "Scan": (0, 140, 100), "Ours+": (213, 94, 0)}
USUAL = BELIEF, ROBOT, INK, QUIET
CELL_PX, RIM_PX, STRONGEST = (41, 34), (52, 44), 15.0  # points at which a colour is at its strongest


def heat_maps(of_world, gaps_m, gaps_deg):
    """Mean difference by gap for each world: {world: {(T_xy, T_theta): points}}."""
    maps = [_heat_map(points, gaps_m, gaps_deg) for points in of_world.values()]
    return sheet(maps, [f"home {world}: Ours - MV, in points" for world in of_world])


def _heat_map(points, gaps_m, gaps_deg):
    (w, h), (left, bottom) = CELL_PX, RIM_PX
    page = Canvas(left + w * len(gaps_m) + 2, h * len(gaps_deg) + bottom)
    for i, m in enumerate(gaps_m):
        page.text((left + w * (i + 0.5), h * len(gaps_deg) + 12), f"{m:g} m", 12, QUIET, "mm")
        for j, deg in enumerate(gaps_deg):
            x, y = left + w * i, h * (len(gaps_deg) - 1 - j)
            if i == 0:
                page.text((left - 6, y + h / 2), f"{deg:g} deg", 12, QUIET, "rm")
            value = points.get((m, deg))
            page.box(x + 1, y + 1, x + w - 1, y + h - 1, FAINT if value is None else shade(value))
            if value is not None:
                page.text((x + w / 2, y + h / 2), f"{round(value, 1) + 0.0:+g}", 12, INK, "mm")
    words = "least distance (and turn) to a test start"
    page.text((left + w * len(gaps_m) / 2, h * len(gaps_deg) + 32), words, 12, QUIET, "mm")
    return page.picture()


def shade(value):
    """White for no difference, blue or orange for the strongest; light enough to read its number on."""
    share = 0.65 * min(1.0, abs(value) / STRONGEST)
    mixed = (1 - share) * np.array(PAPER) + share * (BETTER if value > 0 else WORSE)
    return tuple(mixed.round().astype(int).tolist())


def curves(of_world, width=260, height=190):
    """Right answers by checkpoint, Ours with its 95 % interval: {world: {method: (C, checkpoints) in 0..1}}."""
    plots = {}
    for world, methods in of_world.items():
        n, plots[world] = next(iter(methods.values())).shape[1], {}  # n checkpoints in every world
        for name, values in methods.items():
            mean, *band = 100 * np.array([over_cells(v, np.random.default_rng(0)) for v in values.T]).T
            plots[world][name] = range(n), mean, *(band if name == "Ours" else [])
    shown = np.concatenate([line for plot in plots.values() for _, *of_name in plot.values() for line in of_name])
    high = min(100, 10 * int(shown.max() // 10 + 1))
    low = min(10 * int(shown.min() // 10), high - 10)
    ticks = {i: str(i + 1) for i in range(n)}, {percent: f"{percent} %" for percent in range(low, high + 1, 10)}
    return sheet([lines(plot, *ticks, "checkpoint", width, height, LINES) for plot in plots.values()],
                 [f"home {world}: share right after five looks" for world in plots])


def lines(of_name, x_ticks, y_ticks, x_name, width=460, height=240, colours=(), names_px=52, y_name=""):
    """Lines, each with its name at its end; x_ticks, y_ticks: {value: words}, from the least to the greatest.

    of_name  : {name: (x, y)}, or (x, y, low, high) for a band around the line; a single point is a dot
    colours  : {name: colour}; the others take the usual ones in turn
    names_px : room for the names at the right
    """
    left, top, bottom = 44, 8 + 18 * bool(y_name), 40
    page, (x0, *_, x1), (y0, *_, y1) = Canvas(width, height), list(x_ticks), list(y_ticks)

    def at(x, y):
        return (left + (width - left - names_px) * (x - x0) / (x1 - x0),
                top + (height - bottom - top) * (y1 - y) / (y1 - y0))

    for y, words in y_ticks.items():
        spot = np.floor(at(x0, y)) + 0.5  # the middle of a pixel: a thin line is not smeared over two
        page.line([spot, (at(x1, y)[0], spot[1])], FAINT)
        page.text((left - 8, at(x0, y)[1]), words, 11, QUIET, "rm")
    for x, words in x_ticks.items():
        page.text((at(x, y0)[0], height - bottom + 14), words, 11, QUIET, "mm")
    page.text((left + (width - left - names_px) / 2, height - 10), x_name, 12, QUIET, "mm")
    page.text((8, 10), y_name, 12, QUIET)
    colour_of = dict(zip(of_name, itertools.cycle(USUAL), strict=False)) | dict(colours)
    taken = []  # heights of the names, the upper one first so that they keep the order of their lines
    from_above = sorted(of_name.items(), key=lambda item: -item[1][1][-1])
    spots_of = {name: [at(*spot) for spot in zip(x, y, strict=True)] for name, (x, y, *_) in from_above}
    for i, (name, (x, _, *band)) in enumerate(from_above):
        spots, later = spots_of[name], [spots_of[other] for other, _ in from_above[i + 1:]]
        if band:
            low, high = ([at(*spot) for spot in zip(x, edge, strict=True)] for edge in band)
            page.polygon(high + low[::-1], (*colour_of[name], 50))
        if len(spots) > 1:
            page.line(spots, colour_of[name], 5 if any(_alike(spots, other) for other in later) else 2)
        else:
            page.disc(spots[0], 4, colour_of[name])
        height_of_name = spots[-1][1]
        while any(abs(height_of_name - other) < 13 for other in taken):
            height_of_name += 1
        taken.append(height_of_name)
        page.text((spots[-1][0] + (6 if len(spots) > 1 else 9), height_of_name), name, 12, colour_of[name])
    return page.picture()


def _alike(spots, others, px=2):
    """Whether two lines run so close that the one drawn later hides the other, but for a rim."""
    return len(spots) == len(others) and np.abs(np.subtract(spots, others)).max() < px


def histogram(chosen, n=10, width=420, height=180):
    """How often each checkpoint was chosen: {checkpoint: times}."""
    page, left, bottom, most = Canvas(width, height), 16, 44, max(chosen.values())
    step = (width - 2 * left) / n
    for i in range(n):
        x, top = left + step * i, 22 + (height - bottom - 22) * (1 - chosen.get(i, 0) / most)
        if chosen.get(i, 0):
            page.box(x + 4, top, x + step - 4, height - bottom, BAR)
        page.text((x + step / 2, top - 9), str(chosen.get(i, 0)), 12, INK, "mm")
        page.text((x + step / 2, height - bottom + 12), str(i + 1), 12, QUIET, "mm")
    page.text((width / 2, height - 10), "checkpoint; above, in how many cells adaptation chose it", 12, QUIET, "mm")
    return page.picture()
