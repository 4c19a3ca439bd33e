"""Nearest-neighbour Q-learning: Q-values of remembered state-action pairs (section IV-D, equations 1 and 2).

Only pairs that were lived through are stored. The value of any other pair is the mean over its k nearest stored
ones; a pair that was met before has its own value.

    Q(s, a) = |N(s, a)|^-1 sum over (s', a') in N(s, a) of Q(s', a')                         (1)
    Q(s, a) <- Q(s, a) + alpha [r + gamma max_a' Q(s', a') - Q(s, a)]                        (2)

    B states side by side   K numbers a state   A actions   n pairs of one action, in order of birth
"""

import numpy as np

from .files import load_arrays, save_arrays
from .rank_index import RankIndex

K_NEIGHBOURS, ALPHA, GAMMA = 4, 0.1, 0.9
SAME = 1e-6  # distance within which a state counts as met before


def epsilon(episode):
    """Share of random actions in the n-th training episode: 1 / (0.1 (n + 1) + 1)."""
    return 1 / (0.1 * (np.asarray(episode) + 1) + 1)


class NNQL:
    """The store: an index of states and an array of values for each action; and its past.

    `index` makes an empty nearest-neighbour index for states of n_places numbers (rank_index.py, kdtree.py).
    """

    def __init__(self, n_places, n_actions, k=K_NEIGHBOURS, alpha=ALPHA, gamma=GAMMA, index=RankIndex):
        self.k, self.alpha, self.gamma = k, alpha, gamma
        self.index = [index(n_places) for _ in range(n_actions)]
        self.values = [np.empty(0) for _ in range(n_actions)]
        self.log = []  # a checkpoint is, for each action, how many pairs there were and which values had changed
        self._logged = [np.empty(0) for _ in range(n_actions)]

    def q_values(self, states):
        """Equation 1: states (B, K) -> (B, A). An action that was never tried has value 0."""
        return np.stack([self._recall(states, a)[0] for a in range(len(self.index))], 1)

    def learn(self, states, actions, rewards, next_states, done):
        """Equation 2 for B transitions; states, next_states (B, K), actions (B,), rewards (B,).

        done : (B,) bool, nothing comes after
        """
        # DIFFERS: what robots side by side live through in one step is learned at once, from one and the same Q.
        ahead = np.where(done, 0.0, self.q_values(next_states).max(1))
        target = rewards + self.gamma * ahead
        for a in range(len(self.index)):
            rows = np.flatnonzero(actions == a)
            if len(rows):
                self._learn(states[rows], a, target[rows])

    def _learn(self, states, a, target):
        q, known = self._recall(states, a)
        values, born, births = self.values[a], {}, []  # births: values of the pairs that this step adds
        for i, state in enumerate(states):
            if known[i] >= 0:
                values[known[i]] += self.alpha * (target[i] - values[known[i]])
                continue
            # CHOICE: a new pair is stored with Q + alpha (target - Q), Q the mean of its neighbours, 0 without any.
            pair = born.setdefault(state.tobytes(), len(births))  # the second robot to meet it finds it there
            if pair == len(births):
                births.append(q[i])
            births[pair] += self.alpha * (target[i] - births[pair])
        if births:
            self.values[a] = np.append(values, births)
            self.index[a].add(np.stack([np.frombuffer(key, states.dtype) for key in born]))

    def _recall(self, states, a):
        """Q of (state, a) for each state (B,), and the stored pair that it is, or -1 (B,)."""
        values = self.values[a]
        if not len(values):
            return np.zeros(len(states)), np.full(len(states), -1)
        distance, pair = self.index[a].query(states, self.k, n_first=len(values))
        there = pair >= 0
        mean = np.where(there, values[pair], 0.0).sum(1) / there.sum(1)
        met = distance[:, 0] <= SAME
        return np.where(met, values[pair[:, 0]], mean), np.where(met, pair[:, 0], -1)

    def checkpoint(self):
        """Remember today's Q: for each action the number of pairs, and the values that changed since the last time."""
        entry = []
        for a, values in enumerate(self.values):
            before = np.full(len(values), np.nan)
            before[:len(self._logged[a])] = self._logged[a]
            changed = np.flatnonzero(before != values)
            entry.append((len(values), changed.astype(np.int32), values[changed]))
            self._logged[a] = values.copy()
        self.log.append(entry)

    def at(self, checkpoint):
        """The store as it was at a checkpoint (0, 1, ...); shares the states with this one and cannot learn.

        Pairs are only ever added, so those of the past are the first ones; a later pair is not available (N/A).
        """
        if not 0 <= checkpoint < len(self.log):
            there = f"0..{len(self.log) - 1}" if self.log else "one to be there"
            raise ValueError(f"checkpoint: expected {there}, found {checkpoint}")
        past = object.__new__(NNQL)
        past.__dict__ = {**self.__dict__, "values": [], "learn": _past_is_past, "checkpoint": _past_is_past}
        for a in range(len(self.index)):
            values = np.empty(self.log[checkpoint][a][0])
            for entry in self.log[:checkpoint + 1]:
                _, changed, value = entry[a]
                values[changed] = value
            past.values.append(values)
        return past

    def save(self, path, made_by):
        """Write states, values and checkpoints, and what made them."""
        arrays = {}
        for a, index in enumerate(self.index):
            entries = [entry[a] for entry in self.log]
            arrays |= {f"states{a}": index.points, f"values{a}": self.values[a],
                       f"born{a}": np.array([born for born, _, _ in entries], int),
                       f"n_changed{a}": np.array([len(changed) for _, changed, _ in entries], int),
                       f"changed{a}": np.concatenate([np.empty(0, np.int32), *(c for _, c, _ in entries)]),
                       f"changed_to{a}": np.concatenate([np.empty(0), *(v for _, _, v in entries)])}
        save_arrays(path, made_by, **arrays)

    @classmethod
    def load(cls, path, **settings):
        """The store of a file of `save`, and what made it."""
        arrays, made_by = load_arrays(path)
        kinds = ("states", "values", "born", "n_changed", "changed", "changed_to")
        n_actions = len(arrays) // len(kinds)
        if not n_actions or set(arrays) != {f"{kind}{a}" for kind in kinds for a in range(n_actions)}:
            raise ValueError(f"{path}: expected a store of state-action pairs, found {', '.join(sorted(arrays))}")
        store = cls(arrays["states0"].shape[1], n_actions, **settings)
        entries = []
        for a in range(n_actions):
            if len(arrays[f"states{a}"]):
                store.index[a].add(arrays[f"states{a}"])
            store.values[a] = arrays[f"values{a}"]
            cuts = np.cumsum(arrays[f"n_changed{a}"])[:-1]
            entries.append(zip(arrays[f"born{a}"].tolist(), np.split(arrays[f"changed{a}"], cuts),
                               np.split(arrays[f"changed_to{a}"], cuts), strict=False))
        store.log = [list(entry) for entry in zip(*entries, strict=False)] if len(arrays["born0"]) else []
        store._logged = [past.copy() for past in store.at(len(store.log) - 1).values] if store.log else store._logged
        return store, made_by


def _past_is_past(*_):
    raise ValueError("learn: expected the present store, found one at a past checkpoint")
