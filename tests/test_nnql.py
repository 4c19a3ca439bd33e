"""The store is a dictionary with brute force behind it and learns what value iteration finds."""

import copy
import itertools

import naive_learning
import numpy as np
import pytest

from gnl.checkpoints import Checkpoints
from gnl.files import load_arrays, save_arrays
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


@INDEXES
@pytest.mark.parametrize("n_places", [4, K])
def test_what_was_looked_up_is_right_after_pairs_were_born(index, n_places):
    rng, store = np.random.default_rng(0), NNQL(n_places, A, index=index)
    states = random_states(rng, 8, n_places)
    for step in range(60):
        next_states = random_states(rng, 8, n_places)  # of four places there are few states: many come back
        next_states[:4] = states[[1, 2, 3, 3]]  # pairs of these are born in this very step
        done = np.full(8, step % 5 == 4)
        store.learn(states, rng.integers(A, size=8), rng.choice([-1.0, 1.0], 8), next_states, done)
        anew = copy.deepcopy(store)
        anew._states = None
        np.testing.assert_array_equal(store.q_values(next_states), anew.q_values(next_states))
        states = next_states


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


def test_both_indexes_give_the_same_values():
    asked = random_states(np.random.default_rng(5), 40)
    np.testing.assert_array_equal(lived(40).q_values(asked), lived(40, index=KDTree).q_values(asked))


def test_what_robots_do_in_lockstep_is_searched_for_once(monkeypatch):
    store, searched = lived(20), []
    for index in store.index:
        query = index.query
        monkeypatch.setattr(index, "query", lambda *args, query=query: searched.append(len(args[0])) or query(*args))
    rng = np.random.default_rng(3)
    looks = [random_states(rng, 8) for _ in range(5)]
    for step, (states, next_states) in enumerate(itertools.pairwise(looks)):
        store.q_values(states)  # planning
        store.learn(states, rng.integers(A, size=8), np.ones(8), next_states, np.full(8, step == 3))
    assert searched == [8] * 4 * A  # the last of five looks needs no value


def test_lists_teach_as_arrays_do():
    (lists, arrays), states = (NNQL(K, A) for _ in range(2)), random_states(np.random.default_rng(0), 2)
    step = states, [2, 0], [1, -1], states[::-1], [True, False]
    lists.learn(*(part if part is states else list(part) for part in step))
    arrays.learn(*map(np.array, step))
    for one, other in zip(lists.values, arrays.values, strict=True):
        np.testing.assert_array_equal(one, other)
    assert [len(values) for values in lists.values] == [1, 0, 1]


def test_epsilon_is_that_of_the_paper():
    np.testing.assert_allclose(epsilon(np.array([0, 9, 99, 9999])), [1 / 1.1, 1 / 2, 1 / 11, 1 / 1001])


@pytest.mark.parametrize(("actions", "rewards", "words"), [
    ([0, A], [1.0, 1.0], r"actions: expected 2 whole numbers 0\.\.2, found \[0 3\]"),
    ([0, -1], [1.0, 1.0], "actions: "), ([0.5, 1.0], [1.0, 1.0], "actions: "), ([0], [1.0, 1.0], "actions: "),
    ([0, 1, 1], [1.0, 1.0], "actions: "),
    ([], [], "actions: "), ([0, 1], [1.0, np.nan], "rewards: expected finite numbers, found nan"),
    ([0, 1], 1.0, r"step: expected one of each for 2 states, found .* rewards \(\)")], ids=str)
def test_steps_that_cannot_be_are_refused_and_change_nothing(actions, rewards, words):
    store, states = lived(5), random_states(np.random.default_rng(0), 2)
    before = [values.copy() for values in store.values]
    with pytest.raises(ValueError, match=words):
        store.learn(states, np.array(actions), np.array(rewards), states, np.zeros(2, bool))
    for next_states, done in ((states[:1], np.zeros(2, bool)), (states, np.zeros(3, bool))):
        with pytest.raises(ValueError, match="step: expected one of each for 2 states, found next states "):
            store.learn(states, np.array([0, 1]), np.ones(2), next_states, done)
    for values, then in zip(store.values, before, strict=True):
        np.testing.assert_array_equal(values, then)


@pytest.mark.parametrize("change", [{"values1": np.zeros(2)}, {"values0": "nan"}, {"values2": "text"},
                                    {"states2": np.zeros(K, np.float32)}],
                         ids=lambda change: next(iter(change)))
def test_a_file_that_is_no_store_is_refused(tmp_path, change):
    path, store = tmp_path / "store.npz", lived(5)
    store.save(path, "a test")
    arrays, _ = load_arrays(path)
    of = {"nan": lambda a: np.full_like(a, np.nan), "text": lambda a: a.astype(str)}
    change = {name: of[a](arrays[name]) if isinstance(a, str) else a for name, a in change.items()}
    save_arrays(path, "a test", **arrays | change)
    with pytest.raises(ValueError, match=r"store\.npz: expected states \(n, K\) and n finite values of action \d"):
        NNQL.load(path)


@pytest.mark.parametrize("change", [{"states0": np.ones((9, K), np.float32)}, {"changed1": np.zeros(1, int)},
                                    {"born2": np.zeros(0, int)}, {"n_changed0": np.full(2, 0.5)}, {"born0": 3}],
                         ids=lambda change: next(iter(change)))
def test_a_store_that_does_not_fit_together_is_refused_by_name(tmp_path, change):
    path, store = tmp_path / "store.npz", lived(5)
    store.checkpoints = Checkpoints(A)
    for _ in range(2):
        store.checkpoint()
    store.save(path, "a test")
    arrays, _ = load_arrays(path)
    if "states0" in change:
        change |= {"values0": np.zeros(9)}
    save_arrays(path, "a test", **arrays | change)
    with pytest.raises(ValueError, match=r"store\.npz: expected a store of state-action pairs, found another one \("):
        NNQL.load(path)


def test_no_neighbours_are_refused():
    with pytest.raises(ValueError, match="k: expected a whole number from 1 on, found 0"):
        NNQL(K, A, k=0)


@pytest.mark.parametrize("n_actions", [0, -1, 2.0])
def test_a_store_of_no_actions_is_refused(n_actions):
    with pytest.raises(ValueError, match="n_actions: expected a whole number from 1 "):
        NNQL(K, n_actions)


@pytest.mark.parametrize("how", [{"alpha": np.nan}, {"alpha": -3}, {"gamma": 7}, {"gamma": np.nan}], ids=str)
def test_rates_that_cannot_be_are_refused(how):
    with pytest.raises(ValueError, match="alpha, gamma: expected numbers from 0 to 1, found "):
        NNQL(K, A, **how)
