"""Alternatives to the store of nnql.py, for choices.py: each is one way to read equations 1 and 2.

    B states side by side   K numbers in a state   n pairs stored   k neighbours   A actions
"""

import numpy as np

from .nnql import NNQL, SAME


class Endless(NNQL):
    """Equation 2 as it is written, even at the last step: what comes after that is worth what Q says."""

    def learn(self, states, actions, rewards, next_states, done):
        super().learn(states, actions, rewards, next_states, np.zeros_like(done))


class OfAnyAction(NNQL):
    """Neighbours may be of another action: a pair is a state and its action, one-hot, as in `with_last_action`."""

    def __init__(self, n_places, n_actions):
        super().__init__(n_places + n_actions, 1, index=BruteForce)
        self.one_hot = np.eye(n_actions, dtype=np.float32)

    def q_values(self, states):
        of_pairs, n = super().q_values, len(states)
        return np.concatenate([of_pairs(np.append(states, np.tile(a, (n, 1)), 1)) for a in self.one_hot], 1)

    def learn(self, states, actions, rewards, next_states, done):
        pairs, none = np.append(states, self.one_hot[actions], 1), np.zeros(len(states), int)
        target = rewards + self.gamma * np.where(done, 0.0, self.q_values(next_states).max(1))
        super().learn(pairs, none, target, pairs, np.ones_like(done))


class Shrunk(NNQL):
    """The mean of the neighbours is shrunk towards that of all pairs of the same context and action.

        Q(s, a) <- [k Q(s, a) + pull Q(c, a)] / (k + pull)     c   how many actions were done, and the last one

    The last number of a state is its context (choices.with_context); a pair has that in which it was met last. Q(c, a)
    is 0 where nothing was met; a new pair starts at the plain mean of its neighbours. For one run only: what is saved,
    or asked of a checkpoint, knows no contexts.
    """

    def __init__(self, n_places, n_actions, pull):
        super().__init__(n_places, n_actions)
        self.pull, self.context = pull, [np.empty(0, int)] * n_actions

    def q_values(self, states):
        ranks, context = states[:, :-1], states[:, -1].astype(int)
        q, n = super().q_values(ranks), context.max(initial=0) + 1
        for a, (values, met_in) in enumerate(zip(self.values, self.context, strict=True)):
            mean = np.bincount(met_in, values, n) / np.bincount(met_in, minlength=n).clip(1)
            q[:, a] = (self.k * q[:, a] + self.pull * mean[context]) / (self.k + self.pull)
        return q

    def learn(self, states, actions, rewards, next_states, done):
        target = rewards + self.gamma * np.where(done, 0.0, self.q_values(next_states).max(1))
        ranks, context = np.ascontiguousarray(states[:, :-1]), states[:, -1].astype(int)
        super().learn(ranks, actions, target, ranks, np.ones_like(done))
        for a, index in enumerate(self.index):
            here, born = actions == a, len(self.values[a]) - len(self.context[a])
            self.context[a] = np.append(self.context[a], np.zeros(born, int))
            self.context[a][index.find(ranks[here])] = context[here]


class BruteForce:
    """Nearest neighbours for any vectors, all distances at once: an index for a few thousand of them.

    Exact but where rounding cannot tell two neighbours apart. In 64 bits: in 32, rounding alone would put a state
    farther from itself than nnql.SAME.
    """

    def __init__(self, dim):
        self.points = np.empty((0, dim))

    def add(self, points):
        ids = np.arange(len(self.points), len(self.points) + len(points))
        self.points = np.concatenate([self.points, points])
        return ids

    def find(self, points):
        """The oldest equal point of each query, or -1."""
        distance, found = self.query(points, 1)
        return np.where(distance[:, 0] <= SAME, found[:, 0], -1)

    def query(self, points, k, n_first=None):
        points, there = points.astype(float), self.points[:n_first]
        squares = (points ** 2).sum(1)[:, None] + (there ** 2).sum(1) - 2 * points @ there.T
        order = np.argsort(squares.clip(0), 1, kind="stable")[:, :k]
        # With large numbers the squares alone would put a point at a distance from itself.
        distances = np.linalg.norm(there[order] - points[:, None], axis=2)
        lacking = ((0, 0), (0, k - order.shape[1]))
        return np.pad(distances, lacking, constant_values=np.inf), np.pad(order, lacking, constant_values=-1)
