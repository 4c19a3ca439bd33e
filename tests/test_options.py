"""Options: what going on with an action is worth, by hand and in a world where it can be known."""

import numpy as np
import pytest

from gnl import options, planners
from gnl.options import Experience, Options, nearest
from gnl.ranks import reciprocal_ranks
from gnl.robot import N_ACTIONS

K = 30


def ranking(*first, n=K):
    """A state whose best places are `first`, in order."""
    return reciprocal_ranks(-np.array([[first.index(p) if p in first else n + p for p in range(n)]], float))[0]


def lived(*steps):
    """An Experience of steps (before, action, after, place), one robot each."""
    experience = Experience()
    for before, action, after, place in steps:
        experience.watch(1, before=before[None], actions=np.array([action]), states=after[None],
                         places=np.array([place]))
    return experience


def options_of(experience, length, k, worth=(0, 0, 0)):
    """Options of an Experience, the three sequences of one action being worth so much, those of several far more."""
    sequences = planners.sequences(length)[::-1]
    worths = [worth[s[0]] if len(set(s.tolist())) == 1 else 9.0 for s in sequences]
    return Options(experience, sequences, np.array(worths), k)


def test_an_experience_is_the_steps_and_how_well_the_true_place_ranked_after_each():
    a, b = ranking(3, 1), ranking(1, 3)
    experience = lived((a, 0, b, 3), (b, 2, a, 3))
    experience.watch(0, before=None, actions=None, states=a[None], places=np.array([0]))  # the first look is no step
    steps, before, actions, after, rewards = experience.arrays()
    assert (steps.tolist(), actions.tolist(), rewards.tolist()) == ([1, 1], [0, 2], [0.5, 1.0])
    np.testing.assert_array_equal(before, [a, b])
    np.testing.assert_array_equal(after, [b, a])


def test_what_is_enough_is_enough(monkeypatch):
    monkeypatch.setattr(options, "MOST_STEPS", 5)
    a = ranking(3, 1)
    steps, before, *_ = lived(*[(a, 0, a, 3)] * 9).arrays()
    assert len(steps) == len(before) == 5
    experience, four = Experience(), np.tile(a, (4, 1))
    for step in range(9):
        experience.watch(step, four, np.zeros(4, int), four, np.zeros(4, int))
    assert len(next(experience.arrays())) == 8  # four robots side by side


def test_a_small_case_by_hand():
    # Left leads from a to b (true place second, 1/2) and from b to c (first, 1); from c back to a (third, 1/3).
    a, b, c = ranking(1, 2, 3), ranking(11, 12, 13), ranking(21, 22, 23)
    experience = lived((a, 0, b, 12), (b, 0, c, 21), (c, 0, a, 3), (a, 1, a, 1))
    one_step, two, three = (options_of(experience, length, 1).values(np.stack([a, b, c])) for length in (1, 2, 3))
    assert one_step[:, 0] == pytest.approx([1 / 2, 1, 1 / 3])
    assert two[:, 0] == pytest.approx([(1 / 2 + 1) / 2, (1 + 1 / 3) / 2, (1 / 3 + 1 / 2) / 2])
    assert three[:, 0] == pytest.approx([(1 / 2 + 1 + 1 / 3) / 3] * 3)
    assert three[:, 1] == pytest.approx([1, 1, 1])  # the one step that there is, again and again
    assert three[:, 2].tolist() == [0, 0, 0]  # never tried


def test_over_all_first_views_an_option_is_worth_what_it_was_in_the_race():
    rng = np.random.default_rng(0)
    first, after = reciprocal_ranks(rng.random((60, K))), reciprocal_ranks(rng.random((60, K)))
    experience = lived(*zip(first, rng.integers(3, size=60), after, rng.integers(K, size=60), strict=True))
    made = options_of(experience, 4, 5, worth=(0.3, 0.5, 0.1))
    assert made.q_values(first).mean(0) == pytest.approx([0.3, 0.5, 0.1])
    assert made.q_values(first).std(0).min() > 0


def test_only_first_views_are_compared_with_the_race_and_later_steps_teach_nonetheless():
    a, b, c = ranking(1, 2, 3), ranking(11, 12, 13), ranking(11, 12, 21)  # c is nearest to b
    experience = lived((a, 0, b, 12))
    experience.watch(2, before=b[None], actions=np.array([0]), states=c[None], places=np.array([11]))
    made = options_of(experience, 2, 1, worth=(0.3, 0, 0))
    assert made.values(a[None])[0, 0] == pytest.approx((1 / 2 + 1) / 2)
    assert made.q_values(a[None])[0, 0] == pytest.approx(0.3)
    assert made.q_values(b[None])[0, 0] == pytest.approx(0.3 + 1 - 0.75)


def test_all_neighbours_count_alike():
    a, near, far = ranking(1, 2, 3), ranking(1, 3, 2), ranking(21, 22)
    experience = lived((a, 0, far, 22), (near, 0, far, 21), (far, 0, far, 23))
    assert options_of(experience, 1, 2).values(a[None])[0, 0] == pytest.approx((1 / 2 + 1) / 2)
    assert options_of(experience, 2, 3).values(a[None])[0, 0] == pytest.approx((1 / 2 + 1 + far[23]) / 3)  # later, too


@pytest.mark.parametrize("k", [1, 7, 40, 200])
def test_the_nearest_are_those_of_brute_force(k, monkeypatch):
    monkeypatch.setattr(options, "AT_ONCE", 16)
    rng = np.random.default_rng(0)
    seen, states = reciprocal_ranks(rng.random((90, K))), reciprocal_ranks(rng.random((50, K)))
    found = nearest(states, seen, k)
    assert found.shape == (50, min(k, 90))
    distance = np.linalg.norm(states[:, None].astype(float) - seen[None], axis=2)
    for row, chosen in zip(distance, found, strict=True):
        assert len(set(chosen.tolist())) == min(k, 90)
        np.testing.assert_allclose(np.sort(row[chosen]), np.sort(row)[:min(k, 90)], atol=1e-6)


def test_a_hundred_neighbours_count_unless_told_otherwise():
    """The nearest 50 steps ended in the true place's rank 1, the next 50 in rank 2, all others in rank 5."""
    seen, state = (ranking(1, 2, 3), ranking(1, 3, 2), ranking(21, 22)), ranking(1, 2, 3, 4, 5)
    steps = [(one, 0, state, place) for one, place in zip(seen, (1, 2, 5), strict=True) for _ in range(50)]
    made = Options(lived(*steps), np.arange(3)[:, None], np.zeros(3))
    assert made.values(seen[0][None])[0, 0] == pytest.approx((1 + 1 / 2) / 2)


def test_over_the_first_of_many_first_views_a_mean_is_taken(monkeypatch):
    monkeypatch.setattr(options, "FIRST_VIEWS", 2)
    a, b = ranking(1, 2, 3), ranking(11, 12, 13)
    experience = lived((a, 0, a, 1), (a, 0, a, 1), (b, 0, a, 2), (b, 0, a, 2))  # worth 1 from a and 1/2 from b
    made = options_of(experience, 1, 1, worth=(0.3, 0, 0))
    assert made.q_values(np.stack([a, b]))[:, 0] == pytest.approx([0.3, 0.3 - 1 / 2])


def test_the_better_direction_is_found_where_it_depends_on_the_first_view():
    """Two kinds of views: in the one it pays to turn left on and on, in the other right; all else is noise."""
    rng, kinds = np.random.default_rng(0), (ranking(0, 1, 2), ranking(15, 16, 17))

    def view(kind):
        scores = 4 * kinds[kind].astype(float) + 0.3 * rng.random(K)
        return reciprocal_ranks(scores[None])[0]

    experience = Experience()
    for _ in range(2000):
        kind, action = rng.integers(2), rng.integers(N_ACTIONS)
        state, good = view(kind), action == kind
        place = np.argsort(-state)[0 if rng.random() < (0.6 if good else 0.4) else 3]
        experience.watch(1, before=view(kind)[None], actions=np.array([action]), states=state[None],
                         places=np.array([place]))
    plan = planners.go_on(planners.greedy(options_of(experience, 4, 100)))
    kind = np.arange(60) % 2
    first = plan(0, np.stack([view(one) for one in kind]), rng)
    assert (first == kind).mean() > 0.9
    assert (plan(1, None, rng) == first).all()  # and it goes on, whatever it sees


class Worth:
    """Options whose values are the states themselves."""

    def q_values(self, states):
        return np.asarray(states)


def test_each_episode_chooses_anew_from_its_first_view_and_among_equals_by_chance():
    plan, rng = planners.go_on(planners.greedy(Worth())), np.random.default_rng(0)
    for first in ([[1, 3, 2], [5, 0, 0]], [[0, 0, 1], [0, 1, 0], [1, 0, 0]]):
        chosen = np.argmax(first, 1).tolist()
        assert [plan(step, np.roll(first, step, 1), rng).tolist() for step in range(3)] == [chosen] * 3
    of_equals = plan(0, np.tile([1, 1, 0], (600, 1)), rng)
    assert np.bincount(of_equals, minlength=3) / 600 == pytest.approx([0.5, 0.5, 0], abs=0.08)


def test_the_race_decides_between_options_that_experience_finds_alike():
    a, b = ranking(1, 2), ranking(11, 12)
    experience = lived(*[(a, action, b, 11) for action in range(N_ACTIONS)])
    plan = planners.go_on(planners.greedy(options_of(experience, 4, 1, worth=(0.2, 0.1, 0.3))))
    assert plan(0, np.stack([a, b]), np.random.default_rng(0)).tolist() == [2, 2]


def test_no_experience_is_named():
    with pytest.raises(ValueError, match="experience: expected at least one step, found none"):
        Options(Experience(), np.zeros((3, 4), int), np.zeros(3))
