"""Charts of the report: a heat map of the gaps, learning curves, a histogram of checkpoints.

Blue is better, orange worse; a colour never stands without its number or name.
"""

import numpy as np

from .compare import over_cells
from .draw import sheet
from .floor_map import BAR, FAINT, INK, PAPER, QUIET, Canvas

BETTER, WORSE = np.array([0, 114, 178]), np.array([213, 94, 0])
LINES = {"Ours": (0, 114, 178), "MV": (112, 116, 124), "Scan": (0, 140, 100)}
CELL_PX, RIM_PX, STRONGEST = (54, 34), (64, 44), 15.0  # points at which a colour is full


def heat_maps(of_world, gaps_m, gaps_deg, title="Ours - MV, in points"):
    """Mean difference by gap for each world: {world: {(T_xy, T_theta): points}}."""
    maps = [_heat_map(points, gaps_m, gaps_deg) for points in of_world.values()]
    return sheet(maps, [f"home {world}: {title}" for world in of_world])


def _heat_map(points, gaps_m, gaps_deg):
    (w, h), (left, bottom) = CELL_PX, RIM_PX
    page = Canvas(left + w * len(gaps_m) + 4, h * len(gaps_deg) + bottom)
    for i, m in enumerate(gaps_m):
        page.text((left + w * (i + 0.5), h * len(gaps_deg) + 12), f"{m:g} m", 12, QUIET, "mm")
        for j, deg in enumerate(gaps_deg):
            x, y = left + w * i, h * (len(gaps_deg) - 1 - j)
            if i == 0:
                page.text((left - 6, y + h / 2), f"{deg:g} deg", 12, QUIET, "rm")
            value = points.get((m, deg))
            page.box(x + 1, y + 1, x + w - 1, y + h - 1, FAINT if value is None else shade(value))
            if value is not None:
                page.text((x + w / 2, y + h / 2), f"{value:+.1f}", 12, INK, "mm")
    page.text((left + w * len(gaps_m) / 2, h * len(gaps_deg) + 32), "least distance of a test start", 12, QUIET, "mm")
    return page.picture()


def shade(value):
    """From white at none to blue or orange at the strongest difference, light enough for its number."""
    share = 0.65 * min(1.0, abs(value) / STRONGEST)
    mixed = (1 - share) * np.array(PAPER) + share * (BETTER if value > 0 else WORSE)
    return tuple(mixed.round().astype(int).tolist())


def curves(of_world, width=300, height=190):
    """Right answers by checkpoint with 95 % intervals: {world: {method: (C, checkpoints) in 0..1}}."""
    both = np.concatenate([values.ravel() for methods in of_world.values() for values in methods.values()])
    low, high = 10 * np.floor(10 * both.min()), 10 * np.ceil(10 * both.max())
    return sheet([_curves(methods, low, high, width, height) for methods in of_world.values()],
                 [f"home {world}: right after five looks" for world in of_world])


def _curves(methods, low, high, width, height):
    left, right, bottom = 44, 52, 40
    page, n = Canvas(width, height), next(iter(methods.values())).shape[1]

    def at(checkpoint, percent):
        x = left + (width - left - right) * checkpoint / max(1, n - 1)
        return x, 8 + (height - bottom - 8) * (high - percent) / max(high - low, 1)

    for percent in range(int(low), int(high) + 1, 10):
        page.line([at(0, percent), at(n - 1, percent)], FAINT)
        page.text((left - 8, at(0, percent)[1]), f"{percent} %", 11, QUIET, "rm")
    for i in range(n):
        page.text((at(i, low)[0], height - bottom + 12), str(i + 1), 11, QUIET, "mm")
    page.text((left + (width - left - right) / 2, height - 10), "checkpoint", 12, QUIET, "mm")
    taken = []  # heights of the names, the upper one first so that they keep the order of their lines
    for name, values in sorted(methods.items(), key=lambda item: -item[1][:, -1].mean()):
        mean, below, above = 100 * np.array([over_cells(v, np.random.default_rng(0)) for v in values.T]).T
        if name == "Ours":
            band = [at(i, v) for i, v in enumerate(above)] + [at(i, v) for i, v in enumerate(below)][::-1]
            page.polygon(band, (*LINES[name], 50))
        page.line([at(i, v) for i, v in enumerate(mean)], LINES[name], 2)
        y = at(n - 1, mean[-1])[1]
        while any(abs(y - other) < 13 for other in taken):
            y += 1
        taken.append(y)
        page.text((at(n - 1, 0)[0] + 6, y), name, 12, LINES[name])
    return page.picture()


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
    page.text((width / 2, height - 10), "checkpoint that adaptation chose, cells", 12, QUIET, "mm")
    return page.picture()
