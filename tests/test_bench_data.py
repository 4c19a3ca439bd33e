"""What the bench sets beside our filter is the same filter."""

import numpy as np

from data_gen.rooms import make_home
from gnl.particles import ParticleFilter
from gnl.places import PlaceGrid
from tests.bench_data import plain_filter


def systematic(weight, rng):
    """Indices of particles by one uniform number and the running sum of the weights."""
    return np.searchsorted(np.cumsum(weight), (rng.random() + np.arange(len(weight))) / len(weight)).clip(
        max=len(weight) - 1)


def test_the_plain_filter_believes_what_ours_does():
    grid, rng = PlaceGrid(make_home(800)), np.random.default_rng(0)
    likelihood = rng.dirichlet(np.full(grid.n_places, 0.1)) + 1e-3
    plain = plain_filter(grid, likelihood, np.random.default_rng(1), lambda weight: systematic(weight, rng))
    ours = ParticleFilter(grid, likelihood[None], np.random.default_rng(2))
    for _ in range(3):
        ours.resample()
        ours.predict([[0.5, 0.1]])
        ours.weigh(likelihood[None])
        theirs = plain()
        np.testing.assert_allclose(theirs, ours.belief()[0], atol=0.03)
        assert theirs.max() > 0.1
