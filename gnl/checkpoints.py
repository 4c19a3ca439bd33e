"""Checkpoints: what the values of a store of state-action pairs were at moments of its past (section IV-D).

Pairs are only ever added, so those that were there at a checkpoint are the first ones: their count says which. A
later pair is what the paper calls "not available" (N/A), and it takes no room at all. Of the values we keep only those
that changed since the checkpoint before: 12 bytes each, where a state of 360 places has 1440. The states themselves
are stored once.
"""

import numpy as np


class Checkpoints:
    """For each checkpoint and action: how many pairs there were, which values had changed, and to what."""

    NAMES = "born", "n_changed", "changed", "changed_to"  # of arrays in a file, each followed by an action's number

    def __init__(self, n_actions):
        self.entries = []
        self._latest = [np.empty(0)] * n_actions  # values at the last checkpoint

    def __len__(self):
        return len(self.entries)

    def add(self, values):
        """Add a checkpoint: values (n,) of each action."""
        entry = []
        for now, before in zip(values, self._latest, strict=True):
            padded = np.append(before, np.full(len(now) - len(before), np.nan))  # a new value differs from NaN
            changed = np.flatnonzero(padded != now)
            entry.append((len(now), changed.astype(np.int32), now[changed]))
        self.entries.append(entry)
        self._latest = [now.copy() for now in values]

    def values_at(self, checkpoint):
        """The values of each action as they were at a checkpoint (0, 1, ...)."""
        if not isinstance(checkpoint, int | np.integer) or not 0 <= checkpoint < len(self):
            there = f"0..{len(self) - 1}" if self.entries else "one to be there"
            raise ValueError(f"checkpoint: expected {there}, found {checkpoint}")
        values = [np.full(n, np.nan) for n, _, _ in self.entries[checkpoint]]
        for entry in self.entries[:checkpoint + 1]:
            for of_action, (_, changed, to) in zip(values, entry, strict=True):
                of_action[changed] = to
        return values

    def to_arrays(self):
        """All checkpoints as named arrays, for a file."""
        arrays = {}
        for a in range(len(self._latest)):
            entries = [entry[a] for entry in self.entries]
            arrays |= {f"born{a}": np.array([born for born, _, _ in entries], int),
                       f"n_changed{a}": np.array([len(changed) for _, changed, _ in entries], int),
                       f"changed{a}": np.concatenate([np.empty(0, np.int32), *(c for _, c, _ in entries)]),
                       f"changed_to{a}": np.concatenate([np.empty(0), *(to for _, _, to in entries)])}
        return arrays

    @classmethod
    def from_arrays(cls, arrays, n_actions):
        """The checkpoints of `to_arrays`; ValueError if they do not hold a value of every pair."""
        self, by_action = cls(n_actions), []
        for a in range(n_actions):
            born, n_changed, changed, to = (arrays[f"{name}{a}"] for name in cls.NAMES)
            if not n_changed.sum() == len(changed) == len(to):
                raise ValueError(f"{n_changed.sum()} changes counted, {len(changed)} and {len(to)} there")
            changed, to = (np.split(part, np.cumsum(n_changed)[:-1]) for part in (changed, to))
            # From no checkpoints at all np.split makes one empty piece.
            by_action.append(list(zip(born.tolist(), changed, to, strict=False)))
        self.entries = list(map(list, zip(*by_action, strict=True)))
        for checkpoint in range(len(self)):
            self._latest = self.values_at(checkpoint)
            if not all(np.isfinite(values).all() for values in self._latest):
                raise ValueError(f"checkpoint {checkpoint} lacks values")
        return self
