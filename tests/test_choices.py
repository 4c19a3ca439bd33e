"""Other choices than ours: each does what its name says, by hand and beside the parts that it stands in for."""

import numpy as np
import pytest
from conftest import drawn

from gnl import ablate, choices, episode
from gnl.choices import CHOICES, BruteForce
from gnl.kdtree import KDTree
from gnl.nn import softmax
from gnl.particles import ParticleFilter
from gnl.places import PlaceGrid
from gnl.ranks import reciprocal_ranks
from gnl.scene_graph import regions

SCORES = np.array([[0.0, 3, 1], [2, 0, 0]])


def test_states_are_what_their_names_say():
    first = reciprocal_ranks(SCORES)
    np.testing.assert_allclose(choices.probabilities(SCORES, None, None), softmax(SCORES), rtol=1e-6)
    assert choices.best_place(SCORES, None, None).tolist() == [[0, 1, 0], [1, 0, 0]]
    assert choices.with_last_action(SCORES, None, None)[:, 3:].tolist() == [[1, 0, 0, 0]] * 2
    after = choices.with_last_action(SCORES, None, np.array([0, 2]))
    np.testing.assert_array_equal(after[:, :3], first)
    assert after[:, 3:].tolist() == [[0, 1, 0, 0], [0, 0, 0, 1]]


def test_the_filter_ranks_places_by_all_their_particles_or_by_the_heaviest():
    grid = PlaceGrid(drawn(1))
    particles = ParticleFilter(grid, np.ones((1, grid.n_places)), np.random.default_rng(0), n_particles=4)
    particles.place, particles.weight = np.array([[0, 0, 1, 2]]), np.array([[0.3, 0.3, 0.4, 0.0]])
    by_sum, by_greatest = (next(c for c in CHOICES if c.other == f"the filter's ranks{kind}").rules.state
                           for kind in ("", ", max"))
    np.testing.assert_array_equal(by_sum(SCORES[:1], particles, None), reciprocal_ranks([[0.6, 0.4, 0]]))
    np.testing.assert_array_equal(by_greatest(SCORES[:1], particles, None), reciprocal_ranks([[0.3, 0.4, 0]]))


def test_corners_join_regions_that_sides_do_not():
    labels = np.kron(np.array([[[3, 0, 0], [0, 3, 4]]]), np.ones((1, 8, 8), int))
    view, label, area, boxes = choices.touching_at_corners(labels)
    assert sorted(zip(label.tolist(), area.tolist(), boxes.tolist(), strict=True)) == [
        (0, 192, [0, 0, 24, 16]), (3, 128, [0, 0, 16, 16]), (4, 64, [16, 8, 24, 16])]
    assert view.tolist() == [0, 0, 0]
    several = choices.touching_at_corners(np.concatenate([labels, labels[:, ::-1]]))
    assert several[0].tolist() == [0, 0, 0, 1, 1, 1]
    np.testing.assert_array_equal(several[2][:3], area)
    assert len(regions(labels)[0]) == 5  # two beds, and the wall is in two parts


def test_the_sparse_reward_comes_at_the_end():
    right = np.array([True, False, True, False])
    assert choices.at_the_end(right, np.array([False, False, True, True])).tolist() == [0, 0, 1, -1]


def test_a_view_is_rewarded_for_its_own_first_place_whatever_the_filter_says():
    assert choices.of_the_view(SCORES, np.array([1, 2]), right=np.array([False, True])).tolist() == [1, -1]


def test_particles_that_are_not_resampled_keep_their_poses_and_weights():
    grid, likelihood = PlaceGrid(drawn(1)), np.random.default_rng(0).dirichlet(np.ones(PlaceGrid(drawn(1)).n_places), 2)
    particles = choices.Unresampled(grid, likelihood, np.random.default_rng(1), n_particles=50)
    before = particles.x.copy(), particles.weight.copy()
    particles.resample()
    np.testing.assert_array_equal((particles.x, particles.weight), before)
    assert particles.weight.std() > 0


def test_a_robot_of_two_actions_turns_left_and_goes_forward(two_rooms):
    robot, pose = choices.LeftOrForward(two_rooms), [[2.0, 2.0, 0.0]] * 2
    _, odometry, _ = robot.step(pose, [0, 1], np.random.default_rng(0))
    np.testing.assert_allclose(odometry, [[0, np.pi / 6], [0.5, 0]], atol=0.15)


def test_without_an_end_q_goes_on_after_the_last_step():
    s, t, no_end = np.float32([[1, 0.5]]), np.float32([[0.5, 1]]), choices.Endless(2, 1)
    no_end.learn(t, np.array([0]), np.array([10.0]), s, np.array([True]))  # 0.1 of 10
    no_end.learn(s, np.array([0]), np.array([0.0]), t, np.array([True]))  # 1, as its neighbour, and on to 0.9
    np.testing.assert_allclose(no_end.q_values(np.append(s, t, 0))[:, 0], [0.99, 1.0])


def test_neighbours_of_any_action_are_the_nearest_in_state_and_action():
    """By hand: k = 4, states at right angles; another action is as far as another state."""
    states, store = np.eye(4, dtype=np.float32), choices.OfAnyAction(4, 2)
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


def test_a_likelihood_by_rank_is_the_reciprocal_rank_and_a_floor_below_it():
    np.testing.assert_allclose(choices.by_rank(SCORES), reciprocal_ranks(SCORES) + 1e-3, rtol=1e-6)
    assert choices.by_rank(SCORES)[0].argmax() == 1


def test_of_equal_actions_the_first_is_taken_and_of_others_the_best():
    assert choices.first_of_equals(np.array([[1.0, 2, 2], [3, 3, 3], [0, -1, 5]]), None).tolist() == [1, 0, 2]


def test_plain_sums_and_a_sum_over_nodes_are_those_of_dense_algebra_and_their_backward_fits():
    rng, edges, starts = np.random.default_rng(0), np.array([[0, 1], [1, 2], [3, 4]]), np.array([0, 3, 5, 5])
    dense = np.eye(5)
    dense[edges[:, 0], edges[:, 1]] = dense[edges[:, 1], edges[:, 0]] = 1
    np.testing.assert_array_equal(choices.plain_sums(edges, 5).toarray(), dense)
    H, dout = rng.standard_normal((5, 4)), rng.standard_normal((3, 4))
    total, cache = choices.sum_forward(H, starts)
    np.testing.assert_allclose(total, [H[:3].sum(0), H[3:].sum(0), np.zeros(4)], atol=1e-12)
    np.testing.assert_allclose((total * dout).sum(), (H * choices.sum_backward(dout, cache)).sum())  # it is linear


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


def test_the_floor_of_a_choice_is_the_likelihood_of_what_is_ruled_out():
    for choice in CHOICES:
        if choice.point == "floor of the likelihood":
            with ablate.in_place(choice.constants):
                assert episode.probability(np.array([[0.0, 500]]))[0, 0] == pytest.approx(float(choice.other))
