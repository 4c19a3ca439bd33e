"""Each planner chooses as its name says; among equals chance decides, and evenly."""

import itertools

import numpy as np
import pytest

from gnl import planners
from gnl.robot import FORWARD, LEFT, N_ACTIONS, RIGHT

N = 6000
STATES = np.zeros((N, 4))


class Values:
    """An NNQL of fixed Q-values."""

    def __init__(self, *q):
        self.q = np.array(q, float)

    def q_values(self, states):
        return np.tile(self.q, (len(states), 1))


def shares(actions):
    assert actions.shape == (N,)
    return np.bincount(actions, minlength=N_ACTIONS) / N


def rng():
    return np.random.default_rng(0)


def close(*wanted):
    """Within 4 standard errors of any share of N draws."""
    return pytest.approx(wanted, abs=4 * 0.5 / np.sqrt(N))


def test_who_stays_ends_the_episode():
    assert planners.stay(0, STATES, rng()) is None


def test_chance_takes_each_action_equally_often():
    assert shares(planners.chance(0, STATES, rng())) == close(1 / 3, 1 / 3, 1 / 3)


def test_a_scan_is_its_sequence_whatever_there_is_to_see():
    plan = planners.scan([LEFT, FORWARD, RIGHT])
    for step, action in enumerate((LEFT, FORWARD, RIGHT)):
        assert plan(step, STATES[:5], rng()).tolist() == [action] * 5


def test_a_scan_shorter_than_the_episode_is_refused_when_it_ends():
    plan = planners.scan([LEFT, RIGHT])
    with pytest.raises(ValueError, match="scan: expected an action for every step, found 2"):
        plan(2, STATES[:5], rng())


def test_who_goes_on_chooses_at_the_first_view_and_anew_in_a_new_episode():
    plan = planners.go_on(lambda step, states, _rng: states + step)
    for states in np.array([0, 1]), np.array([2, 0]):
        for step in range(3):
            np.testing.assert_array_equal(plan(step, states if step == 0 else states + 1, None), states)


def test_each_robot_may_have_a_scan_of_its_own():
    plan = planners.scan(np.array([[LEFT, RIGHT], [FORWARD, LEFT]]))
    assert plan(0, STATES[:2], rng()).tolist() == [LEFT, FORWARD]
    assert plan(1, STATES[:2], rng()).tolist() == [RIGHT, LEFT]
    with pytest.raises(ValueError, match="scan: expected a sequence for each of 3 robots, found 2"):
        plan(0, STATES[:3], rng())


@pytest.mark.parametrize(("q", "wanted"), [
    ((1, 2, 3), (0, 0, 1)), ((-1, -3, -2), (1, 0, 0)), ((0, 5, 5), (0, 1 / 2, 1 / 2)),
    ((7, 7, 1e-9), (1 / 2, 1 / 2, 0)), ((0, 0, 0), (1 / 3, 1 / 3, 1 / 3)), ((-2, -2, -2), (1 / 3, 1 / 3, 1 / 3))])
def test_greedy_takes_the_greatest_value_and_draws_among_equals(q, wanted):
    assert shares(planners.greedy(Values(*q))(0, STATES, rng())) == close(*wanted)


def test_best_actions_are_those_of_each_row():
    q = np.array([[1.0, 2, 3], [30, 20, 10], [-3, -1, -2]])
    assert planners.best_actions(q, rng()).tolist() == [2, 0, 1]


@pytest.mark.parametrize("epsilon", [0, 0.3, 1])
def test_exploring_is_by_chance_in_a_share_epsilon(epsilon):
    plan = planners.explore(Values(0, 1, 0), np.full(N, epsilon))
    assert shares(plan(0, STATES, rng())) == close(epsilon / 3, 1 - epsilon * 2 / 3, epsilon / 3)


def test_exploring_tries_as_many_actions_as_have_a_value():
    actions = planners.explore(Values(0, 1, 0, 0, 0), np.ones(N))(0, STATES, rng())
    np.testing.assert_allclose(np.bincount(actions) / N, 1 / 5, atol=0.02)


def test_each_episode_explores_by_its_own_epsilon():
    actions = planners.explore(Values(0, 1, 0), np.arange(N) % 2)(0, STATES, rng())
    assert (actions[::2] == 1).all()
    assert np.mean(actions[1::2] == 1) == pytest.approx(1 / 3, abs=0.04)


@pytest.mark.parametrize("length", [1, 2, 4])
def test_sequences_are_all_that_undo_no_turn_and_each_once(length):
    sequences = [tuple(row) for row in planners.sequences(length).tolist()]
    wanted = [s for s in itertools.product(range(N_ACTIONS), repeat=length)
              if (LEFT, RIGHT) not in zip(s, s[1:], strict=False) and (RIGHT, LEFT) not in zip(s, s[1:], strict=False)]
    assert sequences == wanted
    assert len(sequences) == {1: 3, 2: 7, 4: 41}[length]


def test_one_seed_gives_one_choice():
    for plan in (planners.chance, planners.greedy(Values(1, 1, 1)), planners.explore(Values(0, 1, 0), 0.5)):
        np.testing.assert_array_equal(plan(0, STATES, rng()), plan(0, STATES, rng()))
