"""Other stores than ours: each does what its name says, by hand and beside the KD-tree."""

import numpy as np

from gnl.kdtree import KDTree
from gnl.nn import softmax
from gnl.other_stores import BruteForce, Endless, OfAnyAction, Shrunk
from gnl.ranks import reciprocal_ranks


def test_without_an_end_q_goes_on_after_the_last_step():
    s, t, no_end = np.float32([[1, 0.5]]), np.float32([[0.5, 1]]), Endless(2, 1)
    no_end.learn(t, np.array([0]), np.array([10.0]), s, np.array([True]))  # 0.1 of 10
    no_end.learn(s, np.array([0]), np.array([0.0]), t, np.array([True]))  # 1, as its neighbour, and on to 0.9
    np.testing.assert_allclose(no_end.q_values(np.append(s, t, 0))[:, 0], [0.99, 1.0])


def test_neighbours_of_any_action_are_the_nearest_in_state_and_action():
    """By hand: k = 4, states at right angles; another action is as far as another state."""
    states, store = np.eye(4, dtype=np.float32), OfAnyAction(4, 2)
    told = (0, 0, 1.0), (0, 1, 2.0), (1, 0, 3.0), (2, 1, 4.0), (3, 1, 5.0)
    for state, action, reward in told:
        store.learn(states[[state]], np.array([action]), np.array([reward]), states[:1], np.array([True]))
    one = 0.1
    two = one + 0.1 * (2 - one)  # each begins at the mean of its four nearest, the nearer and then the older first
    three = (one + two) / 2 + 0.1 * (3 - (one + two) / 2)
    four = (one + two + three) / 3 + 0.1 * (4 - (one + two + three) / 3)
    five = (one + two + three + four) / 4 + 0.1 * (5 - (one + two + three + four) / 4)
    np.testing.assert_allclose(store.q_values(states[:1]), [[one, two]])  # met before
    np.testing.assert_allclose(store.q_values(states[1:2]), [[three, (two + three + four + five) / 4]])
    assert store.q_values(states).shape == (4, 2)
    store.learn(states[:1], np.array([0]), np.array([0.0]), states[1:2], np.array([False]))  # and it looks ahead
    ahead = max(three, (two + three + four + five) / 4)
    np.testing.assert_allclose(store.q_values(states[:1])[0, 0], one + 0.1 * (0.9 * ahead - one))


def test_neighbours_are_drawn_towards_pairs_of_the_same_context_and_action():
    """By hand: a pull of 12 beside k = 3; three rankings, contexts 0 and 2, two actions; alpha is 0.1, gamma 0.9."""
    ranks = reciprocal_ranks(np.eye(4)[:3])
    first, second, third = (np.append(r, 0)[None].astype(np.float32) for r in ranks)
    late = np.append(ranks[2], 2)[None].astype(np.float32)
    store, done = Shrunk(4, 2, pull=12), np.array([True])
    store.k = 3
    for state, action, reward in ((first, 0, 10.0), (second, 0, 0.0), (late, 0, 5.0), (first, 1, -10.0)):
        store.learn(state, np.array([action]), np.array([reward]), state, done)
    # 1, then 1 less a tenth of it, then their mean 0.95 a tenth of the way to 5; and of action 1 a pair of its own
    one, two, three, other = 1.0, 0.9, 0.95 + 0.1 * (5 - 0.95), -1.0
    all_three, early = np.concatenate([first, second, late]), (one + two) / 2
    q = (3 * np.array([one, two, three]) + 12 * np.array([early, early, three])) / 15
    np.testing.assert_allclose(store.q_values(all_three)[:, 0], q)
    np.testing.assert_allclose(store.q_values(all_three)[:, 1], [other, other, 3 * other / 15])  # never in context 2
    store.learn(first, np.array([0]), np.array([0.0]), late, ~done)  # the best of what comes after is drawn, too
    one += 0.1 * (0.9 * three - one)
    np.testing.assert_allclose(store.q_values(first)[:, 0], (3 * one + 12 * (one + two) / 2) / 15)
    store.learn(third, np.array([0]), np.array([three]), third, done)  # met in another context: now it is of that
    np.testing.assert_allclose(store.q_values(late)[:, 0], 3 * three / 15)
    np.testing.assert_allclose(store.q_values(second)[:, 0], (3 * two + 12 * (one + two + three) / 3) / 15)


def test_a_pair_is_of_the_context_in_which_it_was_met_last():
    """By hand: a pair alone is drawn to itself in its context, and to nothing in others; pull 12 beside k = 4."""
    ranks, store, value = reciprocal_ranks(np.eye(4)[:1]), Shrunk(4, 1, pull=12), 0.0
    in_contexts = np.append(np.tile(ranks, (3, 1)), np.arange(3)[:, None], 1).astype(np.float32)
    for last in (0, 2, 1, 1, 2, 0):
        state = in_contexts[[last]]
        store.learn(state, np.array([0]), np.array([10.0]), state, np.array([True]))
        value += 0.1 * (10 - value)
        np.testing.assert_allclose(store.q_values(in_contexts)[:, 0], np.where(np.arange(3) == last, value, value / 4))


def test_brute_force_finds_the_oldest_that_is_the_same_and_nothing_that_is_only_near():
    brute = BruteForce(3)
    brute.add(np.float32([[0, 0, 1], [1, 0, 0], [1, 0, 0]]))
    assert brute.find(np.float32([[1, 0, 0], [0, 0, 1], [0, 1, 0], [0, 0.01, 1]])).tolist() == [1, 0, -1, -1]


def test_brute_force_finds_states_of_all_kinds_again():
    rng, brute = np.random.default_rng(0), BruteForce(300)
    states = softmax(3 * rng.standard_normal((100, 300))).astype(np.float32)
    brute.add(states)
    assert brute.find(states).tolist() == list(range(100))
    assert [brute.find(state[None])[0] for state in states] == list(range(100))


def test_brute_force_finds_states_of_large_numbers_again():
    states = np.random.default_rng(0).uniform(0, 30, (700, 300)).astype(np.float32)
    index = BruteForce(300)
    index.add(states)
    np.testing.assert_array_equal(index.find(states), np.arange(700))
    np.testing.assert_array_equal(index.query(states, 1)[0], 0)


def test_brute_force_answers_like_the_tree():
    rng, brute, tree = np.random.default_rng(0), BruteForce(5), KDTree(5)
    points = rng.random((40, 5), np.float32)
    points[7] = points[3]
    for part in np.array_split(points, 3):
        np.testing.assert_array_equal(brute.add(part), tree.add(part))
    queries = np.concatenate([rng.random((6, 5), np.float32), points[:4]])
    for k, n_first in ((1, 40), (4, 40), (4, 10), (4, 2), (4, None)):
        mine, trees = brute.query(queries, k, n_first), tree.query(queries, k, n_first)
        np.testing.assert_allclose(mine[0], trees[0], atol=1e-6)
        np.testing.assert_array_equal(mine[1], trees[1])
