"""The particle filter: a belief over poses that odometry moves and views sharpen (section IV-C).

    predict   x += forward cos(theta) + noise,  y += forward sin(theta) + noise,  theta += turn + noise
    weigh     weight *= likelihood of the particle's place in the latest view
    pool      belief(place) = sum of the weights of the particles in it
    resample  as many copies of a particle as its weight deserves (systematic, Kitagawa 1996)

    B filters side by side   M particles   K places
    x, y [m], theta [rad], weight, place: (B, M);  weights of a filter sum to 1
"""

import numpy as np

N_PARTICLES = 5000
N_START_PLACES = 3
STD_M, STD_RAD = 0.03, 0.03  # CHOICE: motion noise of the filter; the paper names none
FLOOR = 1e-3  # CHOICE: likelihood of a place that the classifier rules out


class ParticleFilter:
    """B beliefs over the poses of a home, one for each of B robots side by side.

    All B filters share their random numbers: within a filter particles are independent, and that is all it needs.
    """

    def __init__(self, grid, likelihood, rng, n_particles=N_PARTICLES, n_start_places=N_START_PLACES):
        """Guided start: particles uniform in the places that fit the first view best, weighed by how they fit.

        likelihood : (B, K), of each place given the first view
        """
        B, M, k = len(likelihood), n_particles, min(n_start_places, likelihood.shape[1])
        self.grid, self.rng = grid, rng
        best = np.argsort(-likelihood, axis=1, kind="stable")[:, :k]
        # In k blocks, one a place: were they to take turns, equal steps along them would miss the same place each time.
        place = best[:, np.arange(M) * k // M]
        low = grid.corner_of(place).astype(np.float32)
        spread = rng.random((M, 3), np.float32) * np.float32([grid.cell_m, grid.cell_m, 2 * np.pi / grid.n_bearings])
        self.x, self.y, self.theta = (low[..., i] + spread[:, i] for i in range(3))
        self.weight = np.full((B, M), 1 / M, np.float32)
        self.weigh(likelihood)

    def predict(self, odometry):
        """Move all particles as odometry says, (B, 2) forward [m] and turn [rad], and spread them by its noise."""
        forward, turn = np.asarray(odometry, np.float32).T[..., None]
        noise = self.rng.standard_normal((3, self.x.shape[1]), np.float32)
        noise *= np.float32([[STD_M], [STD_M], [STD_RAD]])
        self.x += forward * np.cos(self.theta) + noise[0]
        self.y += forward * np.sin(self.theta) + noise[1]
        self.theta += turn + noise[2]

    def weigh(self, likelihood):
        """Multiply each weight by the likelihood (B, K) of its particle's place; where all are zero, keep them."""
        B, K = likelihood.shape
        self.place = self.grid.place_of_xyt(self.x, self.y, self.theta)
        flat = self.place + K * np.arange(B)[:, None]
        weight = self.weight * likelihood.astype(np.float32).ravel()[flat]
        total = weight.sum(1, keepdims=True)
        # A view that no particle can explain says nothing about which of them is right.
        self.weight = np.where(total > 0, weight / np.where(total > 0, total, 1), self.weight)

    def belief(self, n_places, pooling="sum"):
        """Pool the particles to places: (B, K), the sum of their weights, or their greatest ("max")."""
        B = len(self.weight)
        flat = (self.place + n_places * np.arange(B)[:, None]).ravel()
        if pooling == "sum":
            return np.bincount(flat, self.weight.ravel(), B * n_places).reshape(B, n_places)
        if pooling != "max":
            raise ValueError(f'pooling: expected "sum" or "max", found {pooling!r}')
        greatest = np.zeros(B * n_places)
        np.maximum.at(greatest, flat, self.weight.ravel())
        return greatest.reshape(B, n_places)

    def resample(self):
        """Draw M particles of equal weight: particle i gets floor or ceil of M weight_i copies, on average exactly.

        One uniform number u a filter; particle i is copied once for each u + n (n integer) between the sums of
        M weight up to i - 1 and up to i.
        """
        B, M = self.weight.shape
        total = np.cumsum(self.weight, 1, dtype=np.float64)
        total *= M / total[:, -1:]
        mark = np.ceil(total - self.rng.random((B, 1))).astype(int)
        mark[:, -1] = M  # rounding must not lose the last one
        copies = np.diff(mark, axis=1, prepend=0).ravel()
        for name in ("x", "y", "theta", "place"):
            setattr(self, name, np.repeat(getattr(self, name).ravel(), copies).reshape(B, M))
        self.weight = np.full((B, M), 1 / M, np.float32)

    def fork(self, n):
        """Each belief n times, one beside the other, to try n actions from it; shares the random numbers."""
        copy = object.__new__(ParticleFilter)
        copy.__dict__ = {name: np.repeat(value, n, axis=0) if isinstance(value, np.ndarray) else value
                         for name, value in self.__dict__.items()}
        return copy
