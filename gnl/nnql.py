"""Nearest-neighbour Q-learning: Q-values of remembered state-action pairs (section IV-D, equations 1 and 2).

Q(s, a) is how much reward to expect from doing a where the view is s. Only pairs that were lived through are stored,
each with a value of its own. Any other pair has the mean value of its neighbours.

    Q(s, a) = |N(s, a)|^-1 sum over (s', a) in N(s, a) of Q(s', a)                           (1)
    Q(s, a) <- Q(s, a) + alpha [r + gamma max_a' Q(s', a') - Q(s, a)]                        (2)

    N(s, a)   the k stored pairs *of the same action* a whose states are nearest to s; if (s, a) itself is
              stored, it alone; nothing if a was never tried
    (s', a')  in the paper two things under one name: in (1) a neighbour, where we take a' to be a; in (2) s' is the
              state that came after s, and a' any action that could be done there; the last step has none

    B states side by side   K numbers in a state   A actions   n pairs of one action, in order of birth
    k neighbours            r reward            alpha learning rate            gamma discount
"""

from dataclasses import dataclass

import numpy as np

from .checkpoints import Checkpoints
from .checks import check_count, check_finite
from .files import load_arrays, save_arrays
from .kdtree import lengths
from .rank_index import RankIndex
from .robot import check_actions

K_NEIGHBOURS, ALPHA, GAMMA = 4, 0.1, 0.9
SAME = 1e-6  # CHOICE: distance within which a state counts as met before; "quantization error" in the paper


def epsilon(episode):
    """Share of random actions in training episode n = 0, 1, ...: 1 / (0.1 (n + 1) + 1)."""
    return 1 / (0.1 * (np.asarray(episode) + 1) + 1)


def first_value(mean):
    """Q of a pair that is not stored yet, before equation 2 changes it; from the mean of its neighbours."""
    return mean  # CHOICE: the paper does not say where a new pair starts; ours starts where equation 1 leaves it.


@dataclass(frozen=True)
class Neighbours:
    """N(s, a) of B states and one action, nearest first, ties to the older pair."""

    distance: np.ndarray  # (B, k); inf where there are fewer
    pair: np.ndarray  # (B, k) number of the pair; -1 where there are fewer

    @classmethod
    def find(cls, index, states, k, n_first):
        """Of states (B, K) among the first n_first pairs of an index; a later pair is not available (N/A)."""
        distance, pair = np.full((len(states), k), np.inf), np.full((len(states), k), -1)
        itself = index.find(states)  # much cheaper than to search for neighbours
        met = (itself >= 0) & (itself < n_first)
        distance[met, 0], pair[met, 0] = 0, itself[met]
        if not met.all():
            distance[~met], pair[~met] = index.query(states[~met], k, n_first)
        return cls._of(distance, pair)

    def joined_by(self, states, newborn, ids):
        """The same after pairs of the states `newborn` (m, K) were stored with the numbers ids (m,)."""
        k, S, born = self.pair.shape[1], states.astype(float), newborn.astype(float)
        # Few of the newborn are near: |s|^2 + |b|^2 - 2 s.b shows which, up to rounding; the rest can stay inf.
        size = (S ** 2).sum(1)[:, None]
        roughly = size + (born ** 2).sum(1) - 2 * S @ born.T
        near = (roughly <= self.distance[:, -1:] ** 2 + 1e-6 * size) & (self.itself < 0)[:, None]
        who, which = near.nonzero()
        apart = np.full(near.shape, np.inf)
        apart[who, which] = lengths(born[which] - S[who])
        distance, pair = np.append(self.distance, apart, 1), np.append(self.pair, np.tile(ids, (len(states), 1)), 1)
        nearest = distance.argsort(1, kind="stable")[:, :k]  # stable: the older come first and stay first
        return self._of(np.take_along_axis(distance, nearest, 1), np.take_along_axis(pair, nearest, 1))

    @classmethod
    def _of(cls, distance, pair):
        """If the nearest pair is (s, a) itself, it alone."""
        others = (distance[:, :1] <= SAME) & (np.arange(pair.shape[1]) > 0)
        return cls(np.where(others, np.inf, distance), np.where(others, -1, pair))

    def mean(self, values):
        """Equation 1: values (n,) of the pairs -> (B,); 0 where there is no neighbour."""
        there = self.pair >= 0
        n = there.sum(1)
        return np.where(there, values[self.pair], 0.0).sum(1) / n.clip(1) if n.any() else np.zeros(len(n))

    @property
    def itself(self):
        """Number of the pair (s, a) if it is stored, or else -1: (B,)."""
        return np.where(self.distance[:, 0] <= SAME, self.pair[:, 0], -1)


class NNQL:
    """The store: an index of states and an array of values for each action; its past as checkpoints.

    `index` makes an empty nearest-neighbour index for states of state_size numbers (rank_index.py, kdtree.py): anything
    with add, find, query and points like a KDTree's.
    """

    def __init__(self, state_size, n_actions, k=K_NEIGHBOURS, alpha=ALPHA, gamma=GAMMA, index=RankIndex):
        if not (0 <= alpha <= 1 and 0 <= gamma <= 1):  # NaN compares as false
            raise ValueError(f"alpha, gamma: expected numbers from 0 to 1, found {alpha} and {gamma}")
        self.k, self.alpha, self.gamma = check_count("k", k, 1), alpha, gamma
        n_actions = check_count("n_actions", n_actions, 1)
        # CHOICE: neighbours of a pair are pairs of the same action; the paper's N(s, a) could hold others, too.
        self.index = [index(state_size) for _ in range(n_actions)]
        self.values = [np.empty(0) for _ in range(n_actions)]
        self.checkpoints = Checkpoints(n_actions)
        self._states, self._found = None, []  # what was looked up last, and its Neighbours for each action

    def q_values(self, states):
        """Equation 1: states (B, K) -> (B, A). An action that was never tried has value 0."""
        return _means(self._neighbours(states), self.values)

    def learn(self, states, actions, rewards, next_states, done):
        """Equation 2 for B transitions; states, next_states (B, K), actions (B,), rewards (B,).

        done : (B,) bool, whether nothing comes after
        """
        # DIFFERS: robots side by side learn together: all targets come from the Q before this step, and a pair that
        # several met is changed by one after the other.
        states, next_states = np.asarray(states, np.float32), np.asarray(next_states, np.float32)
        B, rewards, done = len(states), np.asarray(rewards, float), np.asarray(done, bool)
        actions = check_actions(actions, B, len(self.index))
        if states.shape != next_states.shape or not rewards.shape == done.shape == (B,):
            raise ValueError(f"step: expected one of each for {B} states, found next states {next_states.shape}, "
                             f"rewards {rewards.shape} and done {done.shape}")
        check_finite("rewards", rewards)
        found = self._neighbours(states)
        if done.all():
            ahead, self._states = 0.0, None  # nobody will ask for what comes after
        else:
            # CHOICE: nothing is ahead of the last step; the paper's equation does not know it.
            ahead = np.where(done, 0.0, self.q_values(next_states).max(1))
        target = rewards + self.gamma * ahead
        for a in range(len(self.index)):
            rows = np.flatnonzero(actions == a)
            if len(rows):
                q, pair = found[a].mean(self.values[a])[rows], found[a].itself[rows]
                self._learn(states[rows], a, q, pair, target[rows])

    def _learn(self, states, a, q, pair, target):
        """Equation 2 for the robots that did action a: states (m, K), q, target (m,), pair (m,) -1 where it is new."""
        values, born = self.values[a], {}  # born: values of the pairs that this step adds, by state
        for i, state in enumerate(states):
            if pair[i] >= 0:
                values[pair[i]] += self.alpha * (target[i] - values[pair[i]])
            else:
                value = born.get(state.tobytes(), first_value(q[i]))  # a second robot in this state goes on from there
                born[state.tobytes()] = value + self.alpha * (target[i] - value)
        if born:
            newborn = np.stack([np.frombuffer(key, states.dtype) for key in born])
            ids = self.index[a].add(newborn)
            self.values[a] = np.append(values, list(born.values()))
            if self._states is not None:
                self._found[a] = self._found[a].joined_by(self._states, newborn, ids)

    def _neighbours(self, states):
        """The Neighbours of the states, for each action.

        Learning looks up the next states; planning then asks for the same ones, and so does the next step of
        learning. So the last answer is kept, and pairs that are born join it.
        """
        states = np.asarray(states, np.float32)
        if not np.array_equal(states, self._states):
            self._found = _find(self, states)
            self._states = states.copy()
        return self._found

    def checkpoint(self):
        """Remember Q as it is now."""
        self.checkpoints.add(self.values)

    def at(self, checkpoint):
        """Q as it was at a checkpoint (0, 1, ...), read-only; shares the states with this store."""
        return PastQ(self.index, self.checkpoints.values_at(checkpoint), self.k)

    def save(self, path, made_by):
        """Write states, values and checkpoints, and what made them."""
        states = {f"states{a}": index.points for a, index in enumerate(self.index)}
        values = {f"values{a}": values for a, values in enumerate(self.values)}
        save_arrays(path, made_by, **states, **values, **self.checkpoints.to_arrays())

    @classmethod
    def load(cls, path, **settings):
        """The store in a file written by `save`, and what made it; k, alpha, gamma and index are not in the file."""
        arrays, made_by = load_arrays(path)
        kinds = ("states", "values", *Checkpoints.NAMES)
        n_actions = len(arrays) // len(kinds)
        if not n_actions or set(arrays) != {f"{kind}{a}" for kind in kinds for a in range(n_actions)}:
            raise ValueError(f"{path}: expected a store of state-action pairs, found {', '.join(sorted(arrays))}")
        for a in range(n_actions):
            states, values = arrays[f"states{a}"], arrays[f"values{a}"]
            numbers = np.issubdtype(values.dtype, np.floating)
            if states.ndim != 2 or values.shape != (len(states),) or not (numbers and np.isfinite(values).all()):
                raise ValueError(f"{path}: expected states (n, K) and n finite values of action {a}, "
                                 f"found {states.shape} and {values.dtype} {values.shape}")
        store = cls(arrays["states0"].shape[1], n_actions, **settings)
        try:
            for a, index in enumerate(store.index):
                index.add(arrays[f"states{a}"])
            store.values = [arrays[f"values{a}"] for a in range(n_actions)]
            store.checkpoints = Checkpoints.from_arrays(arrays, n_actions)
        except (ValueError, IndexError, TypeError) as error:
            raise ValueError(f"{path}: expected a store of state-action pairs, found another one ({error})") from None
        return store, made_by


@dataclass(frozen=True)
class PastQ:
    """Q at a checkpoint: for each action the values of the pairs it had, and the index, which has later ones too."""

    index: list
    values: list
    k: int

    def q_values(self, states):
        """Equation 1: states (B, K) -> (B, A)."""
        states = np.asarray(states, np.float32)
        return _means(_find(self, states), self.values)


def _find(store, states):
    """The Neighbours of the states for each action, among its first pairs: as many as the store has values."""
    return [Neighbours.find(index, states, store.k, len(v)) for index, v in zip(store.index, store.values, strict=True)]


def _means(found, values):
    """Equation 1 for each action: (B, A)."""
    return np.stack([near.mean(v) for near, v in zip(found, values, strict=True)], 1)
