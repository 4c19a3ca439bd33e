"""Planners: who chooses the next action.

A planner is a function plan(step, states, rng) -> actions (B,): states (B, K) are the reciprocal ranks of the
latest views, unless the episode's rules say otherwise; `rng` is the exploration stream. A plan that returns None ends
the episode of all robots. A planner that needs more, such as the particles, gets it from a function that
is given to `episode.run` as `watch` and called before the plan.
"""

import itertools

import numpy as np

from .robot import LEFT, N_ACTIONS, RIGHT


def stay(_step, _states, _rng):
    """Nobody: the first view is all there is (the paper's single-view method, SV)."""
    return


def chance(_step, states, rng):
    """Each action with the same probability (the paper's passive multi-view method, MV)."""
    return rng.integers(N_ACTIONS, size=len(states))


def scan(sequence):
    """The same actions in every episode, whatever there is to see: (L,), or (B, L) one for each robot."""
    sequence = np.asarray(sequence)

    def plan(step, states, _rng):
        if step >= sequence.shape[-1]:
            raise ValueError(f"scan: expected an action for every step, found {sequence.shape[-1]} at step {step + 1}")
        if sequence.ndim > 1 and len(sequence) != len(states):
            raise ValueError(f"scan: expected a sequence for each of {len(states)} robots, found {len(sequence)}")
        return np.broadcast_to(sequence[..., step], len(states))
    return plan


def greedy(nnql):
    """The action of the greatest Q-value (Ours); ties are broken at random."""
    def plan(_step, states, rng):
        return best_actions(nnql.q_values(states), rng)
    return plan


def go_on(plan):
    """What a planner chooses at the first view, again and again (greedy by the values of options.py: Ours+)."""
    first = None

    def plan_once(step, states, rng):
        nonlocal first
        if step == 0:
            first = plan(step, states, rng)
        return first
    return plan_once


def explore(nnql, epsilon):
    """Greedy, but at random with probability epsilon (B,): how NNQL gathers experience."""
    def plan(_step, states, rng):
        q = nnql.q_values(states)
        best = best_actions(q, rng)
        by_chance, coin = rng.integers(q.shape[1], size=len(q)), rng.random(len(q))
        return np.where(coin < epsilon, by_chance, best)
    return plan


def best_actions(q, rng):
    """Arg max over actions: q (B, A) -> (B,)."""
    # CHOICE: equal values are drawn among; always taking the first would make a scan of turning left.
    return np.where(q == q.max(1, keepdims=True), rng.random(q.shape), -1).argmax(1)


def sequences(length):
    """Every sequence of `length` actions that never undoes a turn at once: (n, length), n = 3, 7, 17, 41, ...

    To turn back is to see again what one has just seen.
    """
    undone = {LEFT, RIGHT}
    return np.array([s for s in itertools.product(range(N_ACTIONS), repeat=length)
                     if undone not in map(set, itertools.pairwise(s))])
