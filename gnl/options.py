"""Options: an action that is gone on with, chosen once from the first view (Ours+, not in the paper).

NNQL chooses anew after every look, from the latest view alone. It cannot know what it did last and often undoes it.
An option (Sutton, Precup and Singh 1999) cannot: it is one action, done again and again. What options are worth is
learned from the very steps that NNQL lived through, by the mean of neighbours, as there:

    V_d(s, a) = mean over the k nearest (s', a) of [ r + V_{d-1}(s'', a) ],     V_0 = 0

    s, s'  a state (B, K), a remembered one     a   the action that is gone on with
    s''    what was seen after a was done in s' r   1 / rank of the true place in s'', the dense kin of right or wrong
    d      steps to go                          k   many, since one value differs little from another
"""

import numpy as np

from .robot import N_ACTIONS

K_NEIGHBOURS = 100
AT_ONCE = 512  # queries whose distances to all that is remembered are held in memory


class Experience:
    """Every step of some episodes: states, actions and rewards, episode by episode."""

    def __init__(self):
        self.seen, self.actions, self.states, self.rewards = [], [], [], []

    def watch(self, step, seen, actions, states, places, **_):
        """Remember a look of robots side by side; for `episode.run`."""
        if step:
            self.seen.append(seen)
            self.actions.append(actions)
            self.states.append(states)
            self.rewards.append(states[np.arange(len(states)), places])  # a state holds 1 / rank of every place


class Options:
    """What going on with each action is worth, from an Experience."""

    def __init__(self, experience, length, k=K_NEIGHBOURS):
        self.k = k
        seen, actions, states, rewards = (np.concatenate(part) for part in vars(experience).values())
        self.seen, self.worth = [], []
        for a in range(N_ACTIONS):
            rows = np.flatnonzero(actions == a)
            near = nearest(states[rows], seen[rows], k)
            ahead = np.zeros(len(rows))  # V of the states after the steps, with ever more steps to go
            for _ in range(length - 1):
                ahead = (rewards[rows] + ahead)[near].mean(1)
            self.seen.append(seen[rows])
            self.worth.append(rewards[rows] + ahead)

    def values(self, states):
        """V of each action at the start of an episode: (B, K) -> (B, A); 0 for one that was never tried."""
        return np.stack([worth[nearest(states, seen, self.k)].mean(1) if len(seen) else np.zeros(len(states))
                         for seen, worth in zip(self.seen, self.worth, strict=True)], 1)


def nearest(states, seen, k):
    """The k nearest of `seen` (n, K) to each state (B, K), or all if they are fewer: (B, min(k, n)) int.

    All states have one length, so the nearest have the greatest dot product.
    """
    k, found = min(k, len(seen)), []
    for i in range(0, len(states), AT_ONCE):
        dots = states[i:i + AT_ONCE] @ seen.T
        found.append(np.argpartition(-dots, k - 1, axis=1)[:, :k])
    return np.concatenate(found) if found else np.empty((0, k), int)
