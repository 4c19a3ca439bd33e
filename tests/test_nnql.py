"""The store is a dictionary with brute force behind it, learns what value iteration finds, and forgets nothing."""

import copy
import pickle

import naive_learning
import numpy as np
import pytest

from gnl.kdtree import KDTree
from gnl.nnql import ALPHA, GAMMA, NNQL, epsilon
from gnl.rank_index import RankIndex
from gnl.ranks import reciprocal_ranks

K, A = 12, 3
INDEXES = pytest.mark.parametrize("index", [RankIndex, KDTree], ids=["RankIndex", "KDTree"])


def random_states(rng, n, n_places=K):
    return reciprocal_ranks(rng.standard_normal((n, n_places)))


def transitions(seed, n_steps, B=6, n_different=40):
    """Random experience of B robots in which states come back, also within one step."""
    rng = np.random.default_rng(seed)
    known = random_states(rng, n_different)
    for _ in range(n_steps):
        which, then = rng.integers(n_different, size=(2, B))
        actions, rewards = rng.integers(A, size=B), rng.choice([-1.0, 1.0], size=B)
        yield known[which], actions, rewards, known[then], rng.random(B) < 0.3


def lived(n_steps, seed=0, **options):
    store = NNQL(K, A, **options)
    for step in transitions(seed, n_steps):
        store.learn(*step)
    return store


def learn_one(store, state, action, reward, next_state=None):
    """One transition of one robot; without a next state it is the last one."""
    after = state if next_state is None else next_state
    store.learn(state[None], np.array([action]), np.array([reward]), after[None], np.array([next_state is None]))


def test_an_empty_store_knows_nothing():
    np.testing.assert_array_equal(NNQL(K, A).q_values(random_states(np.random.default_rng(0), 5)), np.zeros((5, A)))


@INDEXES
def test_the_first_stored_pair_is_found_again(index):
    rng, store = np.random.default_rng(0), NNQL(K, A, index=index)
    first, *others = random_states(rng, 200)
    learn_one(store, first, 1, 1.0)
    assert store.q_values(first[None]).tolist() == [[0, ALPHA, 0]]  # 0 + alpha (1 - 0)
    for state in others:
        learn_one(store, state, 1, -1.0)
    assert store.q_values(first[None])[0, 1] == ALPHA


def test_a_state_met_before_has_its_own_value_and_not_the_mean():
    rng, store = np.random.default_rng(0), NNQL(K, A)
    near = random_states(rng, 1)[0]
    states = np.stack([near, *(np.roll(near, n) for n in (1, 2, 3))])
    store.learn(states, np.zeros(4, int), np.array([1.0, -1, -1, -1]), states, np.ones(4, bool))
    np.testing.assert_allclose(store.q_values(states)[:, 0], [ALPHA, -ALPHA, -ALPHA, -ALPHA])


def test_any_other_state_has_the_mean_of_its_k_nearest():
    store = NNQL(4, 1, k=2)
    states = reciprocal_ranks([[4.0, 3, 2, 1], [4, 3, 1, 2], [1, 2, 3, 4], [1, 2, 4, 3]])
    store.learn(states, np.zeros(4, int), np.array([1.0, 2, 30, 40]), states, np.ones(4, bool))
    asked = reciprocal_ranks([[3.0, 4, 2, 1], [2, 1, 4, 3]])  # beside the first two, and beside the last two
    np.testing.assert_allclose(store.q_values(asked)[:, 0], [ALPHA * 1.5, ALPHA * 35])


def test_of_fewer_than_k_pairs_all_count():
    rng, store = np.random.default_rng(0), NNQL(K, A, k=4)
    states = random_states(rng, 4)
    learn_one(store, states[0], 2, 1.0)
    learn_one(store, states[1], 2, -3.0)
    values = store.values[2]
    np.testing.assert_allclose(store.q_values(states[2:])[:, 2], values.mean())
    assert not store.q_values(states)[:, :2].any()  # actions that were never tried


def test_a_life_worked_by_hand():
    s, t, u = random_states(np.random.default_rng(0), 3)
    store = NNQL(K, 2, k=4, alpha=0.5, gamma=0.9)
    learn_one(store, s, 0, 1.0, t)  # Q 0, nothing known of t: 0 + .5 (1 + 0 - 0)
    assert store.q_values(np.stack([s, t]))[:, 0].tolist() == [0.5, 0.5]
    learn_one(store, t, 1, -1.0)  # the end: 0 + .5 (-1 - 0)
    assert store.q_values(t[None]).tolist() == [[0.5, -0.5]]
    learn_one(store, s, 0, 1.0, t)  # .5 + .5 (1 + .9 * .5 - .5)
    np.testing.assert_allclose(store.q_values(s[None]), [[0.975, -0.5]])
    learn_one(store, u, 0, 0.0, s)  # new: its mean .975, and on: .975 + .5 (0 + .9 * .975 - .975)
    np.testing.assert_allclose(store.q_values(u[None]), [[0.92625, -0.5]])
    assert [len(values) for values in store.values] == [2, 1]


def test_two_robots_in_one_new_state_store_it_once_and_both_teach_it():
    s = random_states(np.random.default_rng(0), 1)
    store = NNQL(K, A, alpha=0.5)
    store.learn(s[[0, 0]], np.array([1, 1]), np.array([1.0, -1.0]), s[[0, 0]], np.ones(2, bool))
    assert store.values[1].tolist() == [-0.25]  # .5, then .5 + .5 (-1 - .5)
    assert len(store.index[1]) == 1


@INDEXES
@pytest.mark.parametrize(("seed", "k"), [(0, 1), (1, 4), (2, 9)])
def test_a_store_is_a_dictionary_with_brute_force(index, seed, k):
    store, plain = NNQL(K, A, k, 0.3, GAMMA, index), naive_learning.NNQL(A, k, 0.3, GAMMA)
    asked = random_states(np.random.default_rng(99), 3)
    for states, actions, rewards, next_states, done in transitions(seed, 30):
        store.learn(states, actions, rewards, next_states, done)
        plain.learn(states.tolist(), actions, rewards, next_states.tolist(), done)
        for state, q in zip(asked, store.q_values(asked), strict=True):
            np.testing.assert_allclose(q, [plain.q(state.tolist(), a) for a in range(A)], atol=1e-12)
    assert [len(values) for values in store.values] == [len(pairs) for pairs in plain.pairs]
    for values, pairs in zip(store.values, plain.pairs, strict=True):
        np.testing.assert_allclose(values, list(pairs.values()), atol=1e-12)


def test_what_was_lived_often_becomes_what_value_iteration_finds():
    """A corridor of five states; to the left is -1 a step, the right end is worth 1, staying costs nothing."""
    n, rng = 5, np.random.default_rng(0)
    next_state = np.stack([np.arange(n) - 1, np.arange(n) + 1, np.arange(n)], 1).clip(0, n - 1)
    reward = np.tile([-1.0, 0.0, 0.0], (n, 1))
    reward[n - 2, 1] = 1
    ends = next_state == n - 1
    states, store = random_states(rng, n), NNQL(K, A, alpha=0.5)
    for _ in range(150):
        s, a = rng.integers(n - 1, size=8), rng.integers(A, size=8)
        store.learn(states[s], a, reward[s, a], states[next_state[s, a]], ends[s, a])
    Q = naive_learning.value_iteration(next_state, reward, ends, GAMMA)
    np.testing.assert_allclose(store.q_values(states[:n - 1]), Q[:n - 1], atol=1e-3)
    assert (Q[:n - 1].argmax(1) == 1).all()


def snapshots(store, n=5):
    """Five checkpoints of a life, and a full copy of the store at each."""
    kept = []
    for part in range(n):
        if part != 3:  # once nothing happens between two checkpoints
            for step in transitions(part, 8, n_different=40 * (part + 1)):
                store.learn(*step)
        store.checkpoint()
        kept.append(copy.deepcopy(store))
    return kept


@INDEXES
def test_the_store_at_a_checkpoint_is_a_snapshot_taken_then(index):
    store = NNQL(K, A, index=index)
    store.checkpoint()  # the first one has nothing to remember
    kept = [copy.deepcopy(store), *snapshots(store)]
    for step in transitions(77, 10):
        store.learn(*step)
    asked = np.concatenate([random_states(np.random.default_rng(5), 20), *(step[0] for step in transitions(2, 3))])
    now = store.q_values(asked)
    for i, snapshot in enumerate(kept):
        past = store.at(i)
        for ours, theirs in zip(past.values, snapshot.values, strict=True):
            np.testing.assert_array_equal(ours, theirs)
        np.testing.assert_array_equal(past.q_values(asked), snapshot.q_values(asked))
    assert abs(past.q_values(asked) - now).max() > 0
    np.testing.assert_array_equal(store.q_values(asked), now)


def test_the_past_cannot_learn():
    store = lived(3)
    store.checkpoint()
    before = pickle.dumps(store.values)
    with pytest.raises(ValueError, match="learn: expected the present store, found one at a past checkpoint"):
        store.at(0).learn(*next(transitions(1, 1)))
    assert pickle.dumps(store.values) == before


@pytest.mark.parametrize("checkpoint", [-1, 2])
def test_a_checkpoint_that_is_none_is_refused(checkpoint):
    store = lived(1)
    store.checkpoint()
    store.checkpoint()
    with pytest.raises(ValueError, match=rf"checkpoint: expected 0\.\.1, found {checkpoint}"):
        store.at(checkpoint)


def test_checkpoints_cost_little_beside_the_states():
    """A checkpoint logs a birth count and the values that changed: 12 bytes each, a state of 360 places has 1440."""
    rng, store = np.random.default_rng(0), NNQL(360, A)
    known = random_states(rng, 600, 360)
    for step in range(100):
        which = rng.integers(len(known), size=32)
        store.learn(known[which], rng.integers(A, size=32), np.ones(32), known[which], np.ones(32, bool))
        if step % 10 == 9:
            store.checkpoint()
    log = sum(changed.nbytes + values.nbytes for entry in store.log for _, changed, values in entry)
    states = sum(len(values) for values in store.values) * 360 * 4
    changes = sum(len(changed) for entry in store.log for _, changed, _ in entry)
    assert log == 12 * changes
    assert log < 0.05 * states  # measured: 0.014


def test_a_checkpoint_without_news_logs_nothing():
    store = lived(5)
    store.checkpoint()
    store.checkpoint()
    assert all(len(changed) == len(values) == 0 for _, changed, values in store.log[1])


def test_both_indexes_give_the_same_values():
    asked = random_states(np.random.default_rng(5), 40)
    np.testing.assert_array_equal(lived(40).q_values(asked), lived(40, index=KDTree).q_values(asked))


@pytest.mark.parametrize("n_checkpoints", [0, 3])
def test_a_saved_store_is_read_back_with_its_past_and_goes_on_as_the_other(tmp_path, n_checkpoints):
    store = NNQL(K, A, k=3, alpha=0.2)
    snapshots(store, n_checkpoints)
    for step in transitions(9, 3):
        store.learn(*step)
    store.save(tmp_path / "nnql.npz", {"home": 800})
    again, made_by = NNQL.load(tmp_path / "nnql.npz", k=3, alpha=0.2)
    assert made_by == {"home": 800}
    for both in (store, again):
        for step in transitions(10, 3):
            both.learn(*step)
        both.checkpoint()
    assert [len(changed) for _, changed, _ in again.log[-1]] == [len(changed) for _, changed, _ in store.log[-1]]
    asked = random_states(np.random.default_rng(5), 40)
    assert len(again.log) == n_checkpoints + 1
    for i in range(n_checkpoints + 1):
        np.testing.assert_array_equal(again.at(i).q_values(asked), store.at(i).q_values(asked))
    np.testing.assert_array_equal(again.q_values(asked), store.q_values(asked))


def test_epsilon_is_that_of_the_paper():
    np.testing.assert_allclose(epsilon(np.array([0, 9, 99, 9999])), [1 / 1.1, 1 / 2, 1 / 11, 1 / 1001])
