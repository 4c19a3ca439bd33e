"""The gap between training poses and test poses (section III, "cross-view").

    T_xy [m], T_theta [rad]   the gap     poses (n, 3), tests (m, 3): x [m], y [m], theta [rad]
"""

import numpy as np
from scipy.spatial import cKDTree

from .places import wrap_angle

DRAWN_AT_ONCE, FEWEST = 200_000, 1e-5  # poses; share of them that must qualify, or there is no room to learn in


def beyond_gap(poses, tests, t_xy_m, t_theta_rad):
    """Whether each pose is farther than T_xy from the nearest test start, and turned by more than T_theta from it."""
    # CHOICE: the nearest test start is the nearest in location; both differences are against that one.
    distance, nearest = cKDTree(tests[:, :2]).query(poses[:, :2])
    turned = abs(wrap_angle(poses[:, 2] - tests[nearest, 2]))
    return (distance > t_xy_m) & (turned > t_theta_rad)


def poses_beyond(world, tests, t_xy_m, t_theta_rad, n, rng, gap=beyond_gap):
    """n poses uniform over the free space beyond the gap from the tests: (n, 3).

    gap : a function like `beyond_gap`, which says which poses are beyond it

    ValueError, with their share, if too few of the poses drawn are beyond it
    """
    poses, drawn = np.empty((0, 3)), 0
    while len(poses) < n:
        draw = rng.uniform((*world.bounds[:2], -np.pi), (*world.bounds[2:], np.pi), (DRAWN_AT_ONCE, 3))
        draw = draw[gap(draw, tests, t_xy_m, t_theta_rad)]
        poses = np.vstack([poses, draw[world.is_reachable(draw[:, :2])]])
        drawn += DRAWN_AT_ONCE
        if len(poses) < FEWEST * drawn:
            raise ValueError(f"{world.name}: expected room for starts {t_xy_m:g} m and {np.degrees(t_theta_rad):.0f} "
                             f"degrees off the nearest of {len(tests)} test starts, found {len(poses)} among {drawn} "
                             f"poses drawn, {len(poses) / drawn:.3%}")
    return poses[:n]
