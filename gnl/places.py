"""Places: the paper's partition of location and bearing into classes (section IV-B).

A home is cut into cells of 2 m x 2 m x 30 degrees; each is one class that the classifier learns to name.

    K = nx * ny * 12                 number of places
    place = (ix * ny + iy) * 12 + ib  ix = 0..nx-1 along x, iy = 0..ny-1 along y, ib = 0..11 from theta = 0 on
"""

import numpy as np

from .checks import check_finite

CELL_M = 2.0
N_BEARINGS = 12
ROUNDING = 1e-10  # m, rad; a pose this near to the next cell is in it: a multiple of 30 degrees may come out a bit less


class PlaceGrid:
    """The grid of place classes over a world's bounds (x0, y0, x1, y1)."""

    def __init__(self, world, cell_m=CELL_M, n_bearings=N_BEARINGS):
        x0, y0, x1, y1 = world.bounds
        self.origin = float(x0), float(y0)
        if not cell_m > 0 or not isinstance(n_bearings, int | np.integer) or n_bearings < 1:
            raise ValueError(f"places: expected cells of more than 0 m and a whole number of bearings, "
                             f"found {cell_m} and {n_bearings}")
        self.cell_m, self.n_bearings = cell_m, n_bearings
        # A home of exactly 12 m has six columns, not seven: forgive a rounding error at the far wall.
        self.nx = max(1, int(np.ceil((x1 - x0) / cell_m - 1e-6)))
        self.ny = max(1, int(np.ceil((y1 - y0) / cell_m - 1e-6)))
        self.n_places = self.nx * self.ny * n_bearings

    def place_of(self, poses):
        """Place of each pose: (..., 3) -> (...,) int. A pose off the grid gets the nearest cell of the rim."""
        return self.place_of_xyt(*np.moveaxis(check_poses(poses) + ROUNDING, -1, 0))

    def place_of_xyt(self, x, y, theta):
        """The same from coordinates in arrays of their own, unchecked and without ROUNDING: for poses with noise."""
        ix = np.floor((x - self.origin[0]) * (1 / self.cell_m)).clip(0, self.nx - 1)
        iy = np.floor((y - self.origin[1]) * (1 / self.cell_m)).clip(0, self.ny - 1)
        ib = np.floor(theta * (self.n_bearings / (2 * np.pi)))
        ib -= self.n_bearings * np.floor(ib / self.n_bearings)  # as floats: many times faster than % on ints
        return ((ix * self.ny + iy) * self.n_bearings + ib).astype(int)

    def corner_of(self, places):
        """Lowest pose (x, y, theta) of each place's cell: (...,) -> (..., 3); theta in [0, 2 pi)."""
        cell, ib = np.divmod(places, self.n_bearings)
        ix, iy = np.divmod(cell, self.ny)
        x, y = self.origin[0] + ix * self.cell_m, self.origin[1] + iy * self.cell_m
        return np.stack([x, y, ib * (2 * np.pi / self.n_bearings)], -1)

    def location_of(self, places):
        """Location class of each place, its bearing forgotten: ix * ny + iy."""
        return np.asarray(places) // self.n_bearings


def check_poses(poses):
    """The poses as an array (..., 3) of floats; ValueError for another shape, NaN or infinity."""
    poses = np.asarray(poses, float)
    if poses.shape[-1:] != (3,):
        raise ValueError(f"poses: expected shape (..., 3), found {poses.shape}")
    check_finite("poses", poses)
    return poses


def wrap_angle(theta):
    """Angle(s) in (-pi, pi], up to rounding."""
    return -((np.pi - np.asarray(theta)) % (2 * np.pi) - np.pi)
