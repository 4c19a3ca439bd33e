"""What bench.py measures on: rays in pymunk, ranks like a classifier's, and a filter as one writes it first."""

import numpy as np
import pymunk

from gnl.particles import STD, ParticleFilter
from gnl.ranks import reciprocal_ranks
from gnl.strip import slopes


def ray_loop(world, poses):
    """A function that casts the 512 rays of each view at pymunk shapes of all boxes, one after the other."""
    space = pymunk.Space()
    for (x, y), (a, b), angle in zip(world.centre, world.half, world.angle, strict=True):
        turn = pymunk.Transform(np.cos(angle), np.sin(angle), -np.sin(angle), np.cos(angle), x, y)
        space.add(pymunk.Poly(space.static_body, [(a, b), (-a, b), (-a, -b), (a, -b)], turn))
    reach_m, everything = np.hypot(*np.subtract(world.bounds[2:], world.bounds[:2])), pymunk.ShapeFilter()
    rays = [((x, y), (x + reach_m * np.cos(t), y + reach_m * np.sin(t)))
            for x, y, theta in poses for t in theta + np.arctan(slopes(512))]

    def loop():
        for start, end in rays:
            space.segment_query_first(start, end, 0, everything)

    return loop


def views_like(n, n_places, rng):
    """Reciprocal ranks as a classifier gives them: views of n_places that come in 40 looks, told apart with noise."""
    look, place = rng.standard_normal((40, 12)), rng.integers(n_places, size=n)
    kind = look[rng.integers(40, size=n_places)] + 0.5 * rng.standard_normal((n_places, 12))
    return reciprocal_ranks((kind[place] + 0.25 * rng.standard_normal((n, 12))) @ kind.T)


def plain_filter(grid, likelihood, rng, resample):
    """A function that is one cycle of a filter, one line an equation; resample(weights) -> indices."""
    start = ParticleFilter(grid, likelihood[None], rng)
    poses = np.stack([start.x[0], start.y[0], start.theta[0]], 1).astype(float)
    weight, forward, turn = start.weight[0].astype(float), 0.5, 0.1

    def cycle():
        nonlocal poses, weight
        poses = poses[resample(weight)]
        poses[:, 0] += forward * np.cos(poses[:, 2])
        poses[:, 1] += forward * np.sin(poses[:, 2])
        poses[:, 2] += turn
        poses += rng.normal(0, (STD[0], STD[0], STD[1]), poses.shape)
        place = grid.place_of(poses)
        weight = likelihood[place]  # all weighed the same before
        weight /= weight.sum()
        return np.bincount(place, weight, grid.n_places)

    return cycle
