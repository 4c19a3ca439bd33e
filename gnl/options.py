"""Options: an action chosen once, from the first view, and repeated to the end (Ours+, not in the paper).

NNQL chooses anew after every look, from the latest view alone. It cannot know what it did last and often undoes it.
An option (Sutton, Precup and Singh 1999) never does: it is one action, done again and again. What options are worth is
learned from the very steps that NNQL lived through, by a mean over neighbours, as there, and from the race of the
fixed sequences, three of which are the options:

    V_d(s, a) = mean over the k nearest (s', a) of [ r / L + V_{d-1}(s'', a) ],     V_0 = 0
    Q(s, a)   = V_L(s, a) - mean of V_L(., a) over first views + worth of a in the race

    s, s'  a state (B, K), a remembered one          a   the action that is repeated
    s''    what was seen after a was done in s'      d   steps to go, of L
    r      1 / rank of the true place in s'': dense and less noisy than right or wrong, which is mostly luck
    k      many, for values differ little from view to view, and what each of them says is noisy

Where there is little experience the race decides alone, and Ours+ is a scan.
"""

import numpy as np

from .robot import N_ACTIONS

K_NEIGHBOURS = 100
MOST_STEPS = 20_000  # twice as many take four times as long
FIRST_VIEWS = 2000  # over which a mean is taken
AT_ONCE = 64  # queries whose dot products with all that is remembered are held in memory


class Experience:
    """All steps lived through until there are MOST_STEPS: states, actions and rewards, one after the other."""

    def __init__(self):
        self.steps, self.before, self.actions, self.after, self.rewards = [], [], [], [], []

    def watch(self, step, before, actions, states, places, **_):
        """Remember a look of robots side by side; for `episode.run`."""
        if step and sum(map(len, self.actions)) < MOST_STEPS:
            self.steps.append(np.full(len(actions), step))
            self.before.append(before)
            self.actions.append(actions)
            self.after.append(states)
            self.rewards.append(states[np.arange(len(states)), places])  # a state holds 1 / rank of every place

    def arrays(self):
        """Steps (1 after the first view), states before, actions, states after, rewards; ValueError if none."""
        if not self.steps:
            raise ValueError("experience: expected at least one step, found none")
        return (np.concatenate(part) for part in (self.steps, self.before, self.actions, self.after, self.rewards))


class Options:
    """What going on with each action is worth, from an Experience and a race.

    sequences, worth : fixed sequences of actions (n, L), each action repeated among them, and what they were worth (n,)
    """

    def __init__(self, experience, sequences, worth, k=K_NEIGHBOURS):
        steps, before, actions, after, rewards = experience.arrays()
        first, length = before[steps == 1][:FIRST_VIEWS], sequences.shape[1]
        self.k, self.before, self.ahead = k, [], []
        for a in range(N_ACTIONS):
            rows = np.flatnonzero(actions == a)
            near, reward = nearest(after[rows], before[rows], k), rewards[rows] / length
            ahead = reward  # of each remembered step: its reward and V of the state after it, with more and more to go
            for _ in range(length - 1 if len(rows) else 0):
                ahead = reward + ahead[near].mean(1)
            self.before.append(before[rows])
            self.ahead.append(ahead)
        in_race = np.array([worth[(sequences == a).all(1)][0] for a in range(N_ACTIONS)])
        self.offset = in_race - self.values(first).mean(0)

    def values(self, states):
        """V_L of each action: (B, K) -> (B, A); 0 for one that was never tried."""
        return np.stack([ahead[nearest(states, before, self.k)].mean(1) if len(before) else np.zeros(len(states))
                         for before, ahead in zip(self.before, self.ahead, strict=True)], 1)

    def q_values(self, states):
        """Worth of each action in the race, plus how much more than on average lies ahead here: (B, K) -> (B, A)."""
        return self.values(states) + self.offset


def nearest(states, remembered, k):
    """The k nearest of `remembered` (n, K) to each state (B, K), or all if they are fewer: (B, min(k, n)), unordered.

    All states have the same length, so the nearest have the greatest dot product.
    """
    n, k = len(remembered), min(k, len(remembered))
    found = np.empty((len(states), k), np.int32)
    for i in range(0, len(states), AT_ONCE):
        dots = states[i:i + AT_ONCE] @ remembered.T
        found[i:i + AT_ONCE] = np.argpartition(dots, n - k, axis=1)[:, n - k:]
    return found
