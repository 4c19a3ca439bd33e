"""The particle filter: a belief over poses that odometry moves and views sharpen (section IV-C).

    predict   x += forward cos(theta) + noise,  y += forward sin(theta) + noise,  theta += turn + noise
    weigh     weight *= likelihood of the particle's place in the latest view
    pool      belief(place) = sum of the weights of the particles in it
    resample  as many copies of a particle as its weight deserves (systematic, Kitagawa 1996)

    B filters side by side   M particles   K places
    x, y [m], theta [rad], weight, place: (B, M);  weights of a filter sum to 1
"""

import numpy as np

from .checks import check_count
from .ranks import best_first

N_PARTICLES = 5000
N_START_PLACES = 3
STD = 0.03, 0.03  # CHOICE: 3 cm and 0.03 rad, as the odometry; the paper names no motion noise
FLOOR = 1e-3  # CHOICE: 1e-3 for a place that the classifier rules out
AT_ONCE = 8  # filters: one NumPy call for all, and their particles fit in the cache


class ParticleFilter:
    """B beliefs over the poses of a home, one for each of B robots side by side.

    The filters share the offsets of their start and the noise of their motion: within a filter particles are
    independent, and that is all it needs. Particles know no walls; beyond the grid, the nearest cell counts.
    """

    def __init__(self, grid, likelihood, rng, n_particles=N_PARTICLES, n_start_places=N_START_PLACES, std=STD):
        """Guided start: particles uniform in the places that fit the first view best, weighed by how they fit.

        likelihood : (B, K), of each place given the first view
        std        : of the motion noise, two numbers: metres (along and across alike) and radians
        """
        likelihood = np.asarray(likelihood)
        if likelihood.ndim != 2:
            raise ValueError(f"likelihood: expected shape (B, K), found {likelihood.shape}")
        if np.shape(std) != (2,) or not (np.isfinite(std).all() and min(std) >= 0):
            raise ValueError(f"std: expected two finite numbers from 0 on, found {std}")
        B, M = len(likelihood), check_count("n_particles", n_particles, 1)
        k = min(check_count("n_start_places", n_start_places, 1), likelihood.shape[1])
        self.grid, self.rng, self.std = grid, rng, std
        best = best_first(likelihood)[:, :k]
        # Particles of one place lie in one block: were places to alternate (0, 1, 2, 0, 1, 2, ..), systematic
        # resampling, which takes every n-th particle, could take all from one place.
        block = np.arange(M) * k // M
        low = grid.corner_of(best).astype(np.float32).take(block, 1)
        spread = rng.random((M, 3), np.float32) * np.float32([grid.cell_m, grid.cell_m, 2 * np.pi / grid.n_bearings])
        self.x, self.y, self.theta = (low[..., i] + spread[:, i] for i in range(3))
        self.weight = np.full((B, M), 1 / M, np.float32)
        self.weigh(likelihood)

    def predict(self, odometry):
        """Move all particles as odometry says, (B, 2) forward [m] and turn [rad], and spread them by its noise."""
        odometry = np.asarray(odometry, np.float32)
        if odometry.shape != (len(self.x), 2) or not np.isfinite(odometry).all():
            raise ValueError(f"odometry: expected {len(self.x)} x 2 finite numbers, found shape {odometry.shape}, "
                             f"{np.isfinite(odometry).sum()} of them finite")
        noise = self.rng.standard_normal((3, self.x.shape[1]), np.float32)
        noise *= np.float32([[self.std[0]], [self.std[0]], [self.std[1]]])
        for group in self._groups():
            forward, turn = odometry[group].T[..., None]
            self.x[group] += forward * np.cos(self.theta[group]) + noise[0]
            self.y[group] += forward * np.sin(self.theta[group]) + noise[1]
            self.theta[group] += turn + noise[2]

    def weigh(self, likelihood):
        """Multiply each weight by the likelihood (B, K) of its particle's place; where all would be zero, keep them.

        Likelihoods are held in 32 bits: let the greatest be somewhere around 1.
        """
        likelihood = np.asarray(likelihood, np.float32)
        B, K = len(self.x), self.grid.n_places
        if likelihood.shape != (B, K) or not (np.isfinite(likelihood) & (likelihood >= 0)).all():
            raise ValueError(f"likelihood: expected {B} x {K} finite numbers from 0 on, found {likelihood.shape} "
                             f"from {likelihood.min(initial=0)} to {likelihood.max(initial=0)}")
        self.place = np.empty(self.x.shape, int)
        for group in self._groups():
            self.place[group] = self.grid.place_of_xyt(self.x[group], self.y[group], self.theta[group])
        for b, of_place in enumerate(likelihood):
            weight = self.weight[b] * of_place.take(self.place[b])
            total = weight.sum()
            if total > 0:  # a view that no particle can explain says nothing about which of them is right
                np.divide(weight, total, out=self.weight[b])

    def belief(self, pooling="sum"):
        """Pool the particles to places: (B, K), the sum of their weights, or their greatest ("max").

        Their places are those of the last `weigh`; for the belief that `predict` alone leads to, `weigh` by ones
        first.
        """
        if pooling not in ("sum", "max"):
            raise ValueError(f'pooling: expected "sum" or "max", found {pooling!r}')
        pooled = np.zeros((len(self.weight), self.grid.n_places))
        for b, (place, weight) in enumerate(zip(self.place, self.weight, strict=True)):
            if pooling == "sum":
                pooled[b] = np.bincount(place, weight.astype(float), self.grid.n_places)
            else:
                np.maximum.at(pooled[b], place, weight)
        return pooled

    def resample(self):
        """Draw M particles of equal weight: particle i gets floor or ceil of M weight_i copies, just that on average.

        One uniform number u per filter; particle i is copied once for each u + n (n integer) between the sums of
        M weight up to i - 1 and up to i.
        """
        B, M = self.weight.shape
        u, particles = self.rng.random(B), np.arange(M)
        for b in range(B):
            total = self.weight[b].cumsum(dtype=float)
            up_to = np.ceil(total * (M / total[-1]) - u[b]).clip(max=M).astype(int)  # copies of all up to this one
            up_to[-1] = M  # rounding must neither add a copy nor lose the last one
            drawn = particles.repeat(np.diff(up_to, prepend=0))
            for of_particle in (self.x, self.y, self.theta, self.place):
                of_particle[b] = of_particle[b].take(drawn)
        self.weight = np.full((B, M), 1 / M, np.float32)

    def _groups(self):
        """Slices of the filters, AT_ONCE in each."""
        return [slice(b, b + AT_ONCE) for b in range(0, len(self.weight), AT_ONCE)]
