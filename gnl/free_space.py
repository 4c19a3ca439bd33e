"""What is inside a home, and where in it a robot has room: rasters of 5 cm.

    inside      what a ball 1.2 m across cannot roll into from beyond the walls, all doors shut
    clearance   metres from each raster cell to the nearest obstacle
"""

import numpy as np
from scipy import ndimage

RASTER_M = 0.05
GATE_M = 0.6  # radius of the ball, which is wider than an open front door
MARGIN_M = 2.0


class FreeSpace:
    """Rasters over a home's bounds, from the boxes of its walls and shut doors."""

    def __init__(self, bounds, centre, half, angle):
        x0, y0, x1, y1 = bounds
        self.origin = np.array([x0, y0]) - MARGIN_M
        self.shape = tuple(np.ceil((np.array([x1, y1]) + MARGIN_M - self.origin) / RASTER_M).astype(int))
        shell = self._fill(centre, half, angle)
        to_shell = ndimage.distance_transform_edt(~shell) * RASTER_M
        where_ball, _ = ndimage.label(to_shell > GATE_M)
        outside = ndimage.distance_transform_edt(where_ball != where_ball[0, 0]) * RASTER_M <= GATE_M
        self._inside = ~outside
        bounded = self._fill(np.array([[(x0 + x1) / 2, (y0 + y1) / 2]]), np.array([[x1 - x0, y1 - y0]]) / 2, [0.0])
        if self._inside.sum() < 0.3 * bounded.sum():
            self._inside = bounded  # CHOICE: a home with a side left open is inside up to its bounds
        self.clearance = to_shell

    def furnish(self, centre, half, angle):
        """Measure the clearance anew, with these boxes as the obstacles."""
        self.clearance = ndimage.distance_transform_edt(~self._fill(centre, half, angle)) * RASTER_M

    def inside(self, xy):
        """Whether each point is within the home: (n, 2) -> (n,) bool."""
        return self.look_up(self._inside, xy)

    def largest_region(self, radius_m):
        """The largest connected region in which a disc may stand, as a raster of bool."""
        regions, _ = ndimage.label(self._inside & (self.clearance > radius_m))
        sizes = np.bincount(regions.ravel(), minlength=2)
        return regions == 1 + sizes[1:].argmax()

    def look_up(self, raster, xy):
        """Value of a raster of bool at each point: (n, 2) -> (n,) bool; False beyond its rim."""
        cell = np.floor((np.asarray(xy, float) - self.origin) / RASTER_M).astype(int)
        known = ((cell >= 0) & (cell < self.shape)).all(-1)
        ix, iy = np.where(known[..., None], cell, 0).T
        return known & raster[ix, iy]

    def _fill(self, centre, half, angle):
        """Raster of the cells that boxes cover."""
        raster = np.zeros(self.shape, bool)
        for c, h, a in zip(centre, half, angle, strict=True):
            reach = np.hypot(*h) + RASTER_M
            low = np.floor((c - reach - self.origin) / RASTER_M).astype(int).clip(0)
            high = np.ceil((c + reach - self.origin) / RASTER_M).astype(int).clip(0)
            window = raster[low[0]:high[0], low[1]:high[1]]
            first = self.origin + (low + 0.5) * RASTER_M  # middle of the window's first cell
            x, y = (np.arange(n) * RASTER_M + f - m for n, f, m in zip(window.shape, first, c, strict=True))
            u, v = _along_sides(x[:, None], y, a)
            fat = np.maximum(h, RASTER_M / 1.4)  # so that a thin wall between two cell centres still fills one
            window |= (abs(u) <= fat[0]) & (abs(v) <= fat[1])
        return raster


def box_distance(xy, centre, half, angle):
    """Distance from points to boxes, 0 within: (n, 2) and N boxes -> (n, N) [m]."""
    u, v = _along_sides(*np.moveaxis(xy[:, None] - centre, -1, 0), angle)
    return np.hypot((abs(u) - half[:, 0]).clip(0), (abs(v) - half[:, 1]).clip(0))


def _along_sides(x, y, angle):
    """How far points (x, y) lie along the sides of boxes that are turned by `angle`."""
    return x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
