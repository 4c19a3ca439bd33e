"""Learning in episodes: each step is told to the store, less and less is left to chance, and sequences race fairly."""

from collections import Counter

import numpy as np
import pytest

from gnl import episode, planners
from gnl.episode import Rules, race, side_by_side, train_nnql
from gnl.ranks import reciprocal_ranks
from gnl.robot import FORWARD, LEFT, N_ACTIONS, RIGHT
from tests.test_episode import GRID, Glide, Sense, knows, mistakes, starts


class Diary:
    """A store that only writes down what it is told."""

    def __init__(self):
        self.steps, self.log = [], []

    def q_values(self, states):
        return np.tile([1.0, 0.0, 0.0], (len(states), 1))

    def learn(self, *step):
        self.steps.append(step)

    def checkpoint(self):
        self.log.append(len(self.steps))


@pytest.mark.parametrize(("score", "reward"), [(knows, 1.0), (mistakes, -1.0)])
def test_the_store_is_told_each_step_with_the_right_reward(score, reward):
    diary, told = Diary(), []

    def state(scores, particles, step, actions):
        assert step == len(told)
        told.append((scores, actions))
        return reciprocal_ranks(scores)

    train_nnql(Sense(score), Glide(), GRID, starts(6), 0, Rules(length=3, state=state), store=diary)
    assert len(diary.steps) == 3
    for step, (states, actions, rewards, next_states, done) in enumerate(diary.steps):
        np.testing.assert_array_equal(states, reciprocal_ranks(told[step][0]))
        np.testing.assert_array_equal(next_states, reciprocal_ranks(told[step + 1][0]))
        np.testing.assert_array_equal(actions, told[step + 1][1])
        assert rewards.tolist() == [reward] * 6
        assert done.tolist() == [step == 2] * 6


def test_the_reward_is_that_of_the_rules_and_who_watches_sees_what_the_store_is_told():
    diary, looks = Diary(), []
    rules = Rules(length=3, reward=lambda right, belief, actions, done, **_: (
        belief + 10 * right + 100 * done + 1000 * actions))
    train_nnql(Sense(lambda poses: 0.3 * knows(poses)), Glide(), GRID, starts(6), 0, rules, store=diary,
               watch=lambda step, **what: looks.append(what))
    assert len(looks) == 4
    for step, (told, seen) in enumerate(zip(diary.steps, looks[1:], strict=True), 1):
        states, actions, rewards, next_states, _ = told
        for name, value in (("before", states), ("actions", actions), ("states", next_states)):
            np.testing.assert_array_equal(seen[name], value)
        np.testing.assert_array_equal(rewards, seen["belief"] + 10 * seen["right"] + 100 * (step == 3)
                                      + 1000 * seen["actions"])
    np.testing.assert_array_equal(looks[0]["states"], diary.steps[0][0])


def test_each_group_has_luck_of_its_own(monkeypatch):
    monkeypatch.setattr(episode, "SIDE_BY_SIDE", 4)
    firsts = []

    def watch(step, **what):
        if step == 0:
            firsts.append(what["filter"].x.copy())

    train_nnql(Sense(knows), Glide(), GRID, np.tile(starts(4), (2, 1)), 0, store=Diary(), watch=watch)
    assert (firsts[0] != firsts[1]).any()


@pytest.mark.parametrize("n", [1, 63, 64, 65, 200])
def test_groups_side_by_side_are_as_equal_as_can_be(n):
    groups = side_by_side(starts(n))
    np.testing.assert_array_equal(np.concatenate(groups), starts(n))
    sizes = [len(group) for group in groups]
    assert max(sizes) - min(sizes) <= 1
    assert max(sizes) <= episode.SIDE_BY_SIDE < sum(sizes[:2]) + episode.SIDE_BY_SIDE * (len(sizes) == 1)


def test_training_explores_first_then_keeps_checkpoints_and_says_how_far_it_is():
    told = []
    learner = train_nnql(Sense(knows), Glide(), GRID, starts(100), 0, checkpoint_every=40,
                         progress=lambda share, right: told.append((share, right)))
    assert len(learner.checkpoints) == 2  # after 40 and 80 episodes
    assert [share for share, _ in told] == [0.4, 0.8, 1.0]
    assert {right for _, right in told} == {1.0}
    stored = sum(len(values) for values in learner.values)
    assert 0 < stored <= 100 * episode.LENGTH
    assert all((values > 0).all() for values in learner.values)  # each answer was right, so each step was worth +1


def test_an_episode_is_the_less_left_to_chance_the_more_came_before_it():
    diary = Diary()  # it finds turning left the best
    train_nnql(Sense(knows), Glide(), GRID, starts(192), 0, store=diary)
    other = [sum((step[1] != LEFT).sum() for step in diary.steps[4 * i:4 * i + 4]) for i in range(3)]
    for i, count in enumerate(other):
        n = np.arange(64 * i, 64 * (i + 1))
        expected = 4 * 2 / 3 * (1 / (0.1 * (n + 1) + 1)).sum()
        assert count == pytest.approx(expected, abs=4 * np.sqrt(expected))


def test_at_a_checkpoint_so_many_episodes_have_ended_and_the_next_have_not_begun(monkeypatch):
    monkeypatch.setattr(episode, "SIDE_BY_SIDE", 4)
    for every, sizes, groups in ((2, [2] * 4, [1, 2, 3, 4]), (3, [3, 3, 2], [1, 2]), (4, [4, 4], [1, 2]),
                                 (5, [3, 2, 3], [2]), (8, [4, 4], [2]), (9, [4, 4], []), (None, [4, 4], [])):
        diary = Diary()
        train_nnql(Sense(knows), Glide(), GRID, starts(8), 0, checkpoint_every=every, store=diary)
        assert [len(actions) for _, actions, *_ in diary.steps[::episode.LENGTH]] == sizes
        assert diary.log == [episode.LENGTH * n for n in groups]  # steps learned by then


@pytest.mark.parametrize("every", [0, -1, 2.5, "2"])
def test_checkpoints_come_after_whole_numbers_of_episodes(every):
    with pytest.raises(ValueError, match=rf"checkpoint_every: expected a whole number from 1 .*, found {every!r}"):
        train_nnql(Sense(knows), Glide(), GRID, starts(8), 0, checkpoint_every=every, store=Diary())


def test_the_share_of_right_answers_that_is_told_is_that_after_the_last_look_of_the_last_ten_groups(monkeypatch):
    monkeypatch.setattr(episode, "SIDE_BY_SIDE", 1)
    told, looks = [], []

    def right_in_the_end_of_the_first(poses):
        looks.append(poses)
        return 1.1 * mistakes(poses) * (len(looks) in (1, *range(6, 99))) + knows(poses) * (len(looks) < 6)

    train_nnql(Sense(right_in_the_end_of_the_first), Glide(), GRID, starts(12), 0, store=Diary(),
               progress=lambda _share, right: told.append(right))
    assert told == pytest.approx([1 / n for n in range(1, 11)] + [0, 0])


@pytest.mark.parametrize("planted", [(LEFT, FORWARD, RIGHT), (FORWARD, RIGHT, FORWARD), (RIGHT, RIGHT, FORWARD)])
def test_the_search_finds_the_sequence_after_which_one_sees_where_one_is(planted):
    """All views look alike but the one at the end of the planted way; all starts lie in the first three places."""
    rng = np.random.default_rng(0)
    first = rng.uniform((0.7, 0.7, 0.2), (1.3, 1.3, 0.8), (5, 3))
    goals = first
    for action in planted:
        goals, _, _ = Glide().step(goals, np.full(len(goals), action), rng)

    def score(poses):
        there = np.isclose(poses[:, None], goals[None], atol=1e-6).all(2).any(1)
        return np.where(there[:, None], knows(poses), 0.0)

    sequences, worth = race(Sense(score), Glide(), GRID, first, 0, Rules(length=3))
    assert sorted(map(tuple, sequences.tolist())) == sorted(map(tuple, planners.sequences(3).tolist()))
    assert worth[0] > 0.9
    assert (worth[1:] < 0.5).all()
    found = sequences[0]
    reached = first
    for action in found:
        reached, _, _ = Glide().step(reached, np.full(len(reached), action), rng)
    np.testing.assert_allclose(reached, goals, atol=1e-9)
    assert tuple(found) == planted


def race_of_forty(strength):
    """Sequences, worth, how often each of 40 starts was tried: views tell the more, the greater strength(look)."""
    looks = []

    def score(poses):
        looks.append(poses)
        return strength(len(looks) - 1, len(poses))[:, None] * knows(poses)

    sequences, worth = race(Sense(score), Glide(), GRID, starts(40), 0)
    tried = Counter(tuple(pose) for first in looks[::1 + episode.LENGTH] for pose in first.tolist())
    return sequences, worth, [tried[tuple(pose)] for pose in starts(40).tolist()]


def test_in_a_race_every_round_has_three_times_as_many_new_starts_the_same_for_all():
    sequences, worth, tried = race_of_forty(lambda _look, n: np.ones(n))
    running = [tried[i] for i in (0, 1, 4, 13)]  # sequences in each round, of 1, 3, 9 and 27 starts
    assert tried == np.repeat(running, [1, 3, 9, 27]).tolist()
    for before, now in zip(running, [*running[1:], 3], strict=True):
        assert -(-before // 3) <= now <= -(-before // 3) + N_ACTIONS  # the best third, and who repeats one action
    assert running[0] == len(np.unique(sequences, axis=0)) == 41
    assert (worth > 0.9).all()  # who always knows ends with nearly all belief in the true place
    assert (worth <= 1 + 1e-6).all()


def test_finalists_come_first_by_their_worth_even_if_luck_made_others_look_better():
    rng = np.random.default_rng(1)
    sequences, worth, tried = race_of_forty(lambda look, n: rng.random(n) * (0.5 if look < 5 else 0.1))
    n = tried[-1]
    assert 3 <= n <= 8
    assert worth[n:].max() > worth[0]  # the first start was easy
    assert (np.diff(worth[:n]) <= 0).all()
    assert (np.diff(worth[n:]) <= 0).all()
    assert sum(len(set(sequence)) == 1 for sequence in sequences[:n].tolist()) == N_ACTIONS


def test_starts_that_are_fewer_than_a_race_needs_are_used_again():
    sequences, worth = race(Sense(knows), Glide(), GRID, starts(1), 0, Rules(length=2))
    assert (sequences.shape, worth.shape) == ((7, 2), (7,))
