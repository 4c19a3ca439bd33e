"""The plain way to compute what gnl learns with and decides by: loops, dense algebra, exact fractions."""

from fractions import Fraction

import numpy as np
from scipy import ndimage
from scipy.stats import norm


def conv(x, w, b):
    """3 x 3 convolution of x (B, H, W, C) with a border of zeros, one product at a time."""
    B, H, W, C = x.shape
    out = np.zeros((B, H, W, w.shape[3])) + b
    for image, i, j, f in np.ndindex(out.shape):
        for u in range(3):
            for v in range(3):
                row, column = i + u - 1, j + v - 1
                if 0 <= row < H and 0 <= column < W:
                    out[image, i, j, f] += x[image, row, column] @ w[u, v, :, f]
    return out


def adam(x, gradients, rate, beta1=0.9, beta2=0.999, eps=1e-8):
    """Where the numbers x end up after a list of gradients, one number at a time (Kingma and Ba 2015, section 2)."""
    x = list(x)
    for n in range(len(x)):
        m = v = 0.0
        for t, g in enumerate(gradients, 1):
            m = beta1 * m + (1 - beta1) * g[n]
            v = beta2 * v + (1 - beta2) * g[n] ** 2
            step = rate * np.sqrt(1 - beta2 ** t) / (1 - beta1 ** t)
            x[n] -= step * m / (np.sqrt(v) + eps)
    return np.array(x)


def regions(labels):
    """Connected regions of one class of an image (H, W): a list of (class, area, (x0, y0, x1, y1))."""
    found = []
    for label in range(10):
        numbered, n = ndimage.label(labels == label)
        areas = np.bincount(numbered.ravel(), minlength=n + 1)[1:]
        found += [(label, int(area), (columns.start, rows.start, columns.stop, rows.stop))
                  for area, (rows, columns) in zip(areas, ndimage.find_objects(numbered), strict=True)]
    return found


def scene_graph(labels):
    """The paper's rules in exact fractions: nodes [(word, box)] and edges, a set of pairs of places in that list."""
    H, W = labels.shape
    x_scale, y_scale = Fraction(512, W), Fraction(512, H)
    nodes = []
    for label, area, (x0, y0, x1, y1) in regions(labels):
        if area * x_scale * y_scale < 5000:
            continue
        box = x0 * x_scale, y0 * y_scale, x1 * x_scale, y1 * y_scale
        nodes.append((word(label, *box), box))
    edges = {(i, j) for j in range(len(nodes)) for i in range(j) if squared_gap(nodes[i][1], nodes[j][1]) <= 20 ** 2}
    return nodes, edges


def word(label, x0, y0, x1, y1):
    area, unit = (x1 - x0) * (y1 - y0), 512 * 512 // 16
    size = 0 if area < unit else 1 if area < 6 * unit else 2
    column, row = (x0 + x1) / 2 // Fraction(512, 3), (y0 + y1) / 2 // Fraction(512, 3)
    return int((label * 3 + size) * 9 + row * 3 + column)


def squared_gap(a, b):
    """Square of the distance between the boxes (x0, y0, x1, y1): 0 if they touch or overlap."""
    across = max(a[0] - b[2], b[0] - a[2], 0)
    down = max(a[1] - b[3], b[1] - a[3], 0)
    return across ** 2 + down ** 2


def normalise_adjacency(edges, n_nodes):
    """D^-1/2 (A + I) D^-1/2 as a full matrix."""
    A = np.eye(n_nodes)
    for i, j in edges:
        A[i, j] = A[j, i] = 1
    D = np.diag(A.sum(1) ** -0.5)
    return D @ A @ D


def gcn_scores(params, words, edges):
    """Scores of one graph, its words spelled out as one-hot rows."""
    p, n_words = params, len(params["W1"])
    if not len(words):
        return p["b3"]
    X, A = np.eye(n_words)[words], normalise_adjacency(edges, len(words))
    H1 = np.maximum(A @ X @ p["W1"] + p["b1"], 0)
    H2 = np.maximum(A @ H1 @ p["W2"] + p["b2"], 0)
    return H2.mean(0) @ p["W3"] + p["b3"]


def belief(places, weights, n_places, pooling):
    """Particles of one filter pooled by place: the sum or the greatest of their weights."""
    pooled = [0.0] * n_places
    for place, weight in zip(places.tolist(), weights.tolist(), strict=True):
        pooled[place] = pooled[place] + weight if pooling == "sum" else max(pooled[place], weight)
    return np.array(pooled)


class ExactBayes:
    """The belief that a particle filter approaches with ever more particles, as masses of small cells (x, y, theta).

    grid : a PlaceGrid from (0, 0);  reach (x, y) m: its far corner;  std : of the motion noise [m], [rad]
    """

    def __init__(self, grid, reach, start_places, std_m, std_rad, step_m=0.1, n_bearings=72, margin_m=2.0):
        x, y = (np.arange(-margin_m + step_m / 2, most + margin_m, step_m) for most in reach)
        theta = (np.arange(n_bearings) + 0.5) * (2 * np.pi / n_bearings)
        self.x, self.y, self.theta, self.step_m, self.std_m, self.std_rad = x, y, theta, step_m, std_m, std_rad
        self.place = grid.place_of(np.stack(np.meshgrid(x, y, theta, indexing="ij"), -1))
        within = ((x > 0) & (x < reach[0]))[:, None] & ((y > 0) & (y < reach[1]))
        mass = np.isin(self.place, start_places) & within[:, :, None]
        self.mass = mass / mass.sum()

    def weigh(self, likelihood):
        self.mass = self.mass * likelihood[self.place]
        self.mass /= self.mass.sum()

    def predict(self, forward, turn):
        for t, theta in enumerate(self.theta):
            along_x = self._spread(self.x, forward * np.cos(theta), self.step_m, self.std_m)
            along_y = self._spread(self.y, forward * np.sin(theta), self.step_m, self.std_m)
            self.mass[:, :, t] = along_x @ self.mass[:, :, t] @ along_y.T
        step = self.theta[1] - self.theta[0]
        round_ = sum(self._spread(self.theta, turn + n * 2 * np.pi, step, self.std_rad) for n in (-1, 0, 1))
        self.mass = self.mass @ round_.T

    @staticmethod
    def _spread(cells, shift, step, std):
        """Share of what is in the middle of cell j that goes to cell i."""
        distance = cells[:, None] - cells[None] - shift
        return norm.cdf(distance + step / 2, scale=std) - norm.cdf(distance - step / 2, scale=std)

    def belief(self, n_places):
        return np.bincount(self.place.ravel(), self.mass.ravel(), n_places)


class NNQL:
    """A dictionary of values for each action; each query looks at all its states."""

    def __init__(self, n_actions, k, alpha, gamma):
        self.pairs = [{} for _ in range(n_actions)]  # state as a tuple -> value, oldest first
        self.k, self.alpha, self.gamma = k, alpha, gamma

    def q(self, state, action):
        pairs = self.pairs[action]
        if not pairs:
            return 0.0
        if tuple(state) in pairs:
            return pairs[tuple(state)]
        nearest = sorted((np.linalg.norm(np.subtract(other, state)), age) for age, other in enumerate(pairs))[:self.k]
        values = list(pairs.values())
        return sum(values[age] for _, age in nearest) / len(nearest)

    def learn(self, states, actions, rewards, next_states, done):
        """All targets and all first values come from the Q before the step; then one update after the other."""
        best = [max(self.q(state, a) for a in range(len(self.pairs))) for state in next_states]
        before = [self.q(state, action) for state, action in zip(states, actions, strict=True)]
        for i, (state, action) in enumerate(zip(states, actions, strict=True)):
            target = rewards[i] + (0 if done[i] else self.gamma * best[i])
            q = self.pairs[action].get(tuple(state), before[i])
            self.pairs[action][tuple(state)] = q + self.alpha * (target - q)


def value_iteration(next_state, reward, ends, gamma, sweeps=200):
    """Q (S, A) of a deterministic world: next_state, reward and ends are (S, A)."""
    Q = np.zeros(reward.shape)
    for _ in range(sweeps):
        Q = reward + gamma * np.where(ends, 0, Q.max(1)[next_state])
    return Q
