"""The store at a checkpoint is a snapshot taken then, costs almost nothing, and comes back from its file."""

import copy

import numpy as np
import pytest
from test_nnql import INDEXES, A, K, lived, random_states, transitions

from gnl.files import load_arrays, save_arrays
from gnl.nnql import NNQL


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
    np.testing.assert_array_equal(past.q_values(asked.tolist()), past.q_values(asked))
    np.testing.assert_array_equal(store.q_values(asked), now)


@INDEXES
def test_values_that_change_while_no_pair_is_born_are_in_the_next_checkpoint(index):
    store, step = NNQL(K, A, index=index), next(transitions(0, 1))
    kept = []
    for _ in range(3):
        store.learn(*step)
        store.checkpoint()
        kept.append([values.copy() for values in store.values])
    for i, snapshot in enumerate(kept):
        assert [len(values) for values in snapshot] == [len(values) for values in kept[0]]
        for ours, then in zip(store.at(i).values, snapshot, strict=True):
            np.testing.assert_array_equal(ours, then)
    assert np.concatenate(kept[0]).tolist() != np.concatenate(kept[1]).tolist()


def test_the_past_does_not_change_as_the_present_learns():
    store = lived(3)
    store.checkpoint()
    past, asked = store.at(0), random_states(np.random.default_rng(5), 20)
    before = past.q_values(asked)
    for step in transitions(1, 10):
        store.learn(*step)
    np.testing.assert_array_equal(past.q_values(asked), before)
    assert abs(store.q_values(asked) - before).max() > 0
    assert not hasattr(past, "learn")
    assert not hasattr(past, "checkpoint")


@pytest.mark.parametrize("checkpoint", [-1, 2, 1.0])
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
    log = sum(changed.nbytes + values.nbytes for entry in store.checkpoints.entries for _, changed, values in entry)
    states = sum(len(values) for values in store.values) * 360 * 4
    changes = sum(len(changed) for entry in store.checkpoints.entries for _, changed, _ in entry)
    assert log == 12 * changes
    assert log < 0.05 * states  # measured: 0.014


@pytest.mark.parametrize(("damage", "words"), [
    ({"changed0": -2, "changed_to0": -2}, "changes counted"), ({"changed_to1": -2}, "changes counted"),
    ({"changed0": 1, "changed_to0": 1}, "changes counted"),
    ({"changed0": -2, "changed_to0": -2, "n_changed0": 0}, "checkpoint 0 lacks values")], ids=str)
def test_a_file_whose_checkpoints_hold_more_or_less_than_they_count_is_refused(tmp_path, damage, words):
    """Entries are removed from the end of an array, or added; or 2 is subtracted from its numbers."""
    store = lived(5)
    store.checkpoint()
    store.save(tmp_path / "nnql.npz", "a test")
    arrays, made_by = load_arrays(tmp_path / "nnql.npz")
    for name, n in damage.items():
        whole = arrays[name]
        arrays[name] = whole - 2 if n == 0 else whole[:n] if n < 0 else np.append(whole, whole[:n])
    save_arrays(tmp_path / "nnql.npz", made_by, **arrays)
    with pytest.raises(ValueError, match=f"expected a store of state-action pairs, found another one .*{words}"):
        NNQL.load(tmp_path / "nnql.npz")


def test_a_checkpoint_without_news_logs_nothing():
    store = lived(5)
    store.checkpoint()
    store.checkpoint()
    assert all(len(changed) == len(values) == 0 for _, changed, values in store.checkpoints.entries[1])


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
    sizes = [[len(changed) for _, changed, _ in both.checkpoints.entries[-1]] for both in (again, store)]
    assert sizes[0] == sizes[1]
    asked = random_states(np.random.default_rng(5), 40)
    assert len(again.checkpoints) == n_checkpoints + 1
    for i in range(n_checkpoints + 1):
        np.testing.assert_array_equal(again.at(i).q_values(asked), store.at(i).q_values(asked))
    np.testing.assert_array_equal(again.q_values(asked), store.q_values(asked))
