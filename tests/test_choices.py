"""Other choices than ours: each does what its name says, by hand and beside the parts that it stands in for."""

import numpy as np
import pytest
from conftest import drawn

from gnl import ablate, choices, episode
from gnl.camera import render, true_labels
from gnl.choices import CHOICES
from gnl.nn import softmax
from gnl.particles import ParticleFilter
from gnl.places import PlaceGrid
from gnl.ranks import reciprocal_ranks
from gnl.scene_graph import regions

SCORES = np.array([[0.0, 3, 1], [2, 0, 0]])


def test_states_are_what_their_names_say():
    first = reciprocal_ranks(SCORES)
    np.testing.assert_allclose(choices.probabilities(SCORES, None, 0, None), softmax(SCORES), rtol=1e-6)
    assert choices.best_place(SCORES, None, 0, None).tolist() == [[0, 1, 0], [1, 0, 0]]
    assert choices.with_last_action(SCORES, None, 0, None)[:, 3:].tolist() == [[1, 0, 0, 0]] * 2
    after = choices.with_last_action(SCORES, None, 1, np.array([0, 2]))
    np.testing.assert_array_equal(after[:, :3], first)
    assert after[:, 3:].tolist() == [[0, 1, 0, 0], [0, 0, 0, 1]]


def test_the_filter_ranks_places_by_all_their_particles_or_by_the_heaviest():
    grid = PlaceGrid(drawn(1))
    particles = ParticleFilter(grid, np.ones((1, grid.n_places)), np.random.default_rng(0), n_particles=4)
    particles.place, particles.weight = np.array([[0, 0, 1, 2]]), np.array([[0.3, 0.3, 0.4, 0.0]])
    by_sum, by_greatest = (next(c for c in CHOICES if c.other == f"the filter's ranks{kind}").rules.state
                           for kind in ("", ", max"))
    nothing = np.zeros(grid.n_places - 2)
    for state, belief in (by_sum, [0.6, 0.4]), (by_greatest, [0.3, 0.4]):
        np.testing.assert_array_equal(state(None, particles, 0, None), reciprocal_ranks([[*belief, *nothing]]))


def test_finest_labels_are_those_of_the_whole_view_and_draw_the_same_luck():
    home, rng, again = drawn(1), np.random.default_rng(1), np.random.default_rng(1)
    poses, wanted = home.free_poses(3, np.random.default_rng(0)), np.array([True, False, True])
    rgb, labels = choices.finest(home, poses, rng, 64, 0.5, wanted)
    np.testing.assert_array_equal(labels, true_labels(home, poses[wanted], 512))
    np.testing.assert_array_equal(rgb, render(home, poses, again, 64, 0.5, wanted)[0])
    assert rng.random() == again.random()
    assert choices.finest(home, poses, rng, 64, 1.0)[1].shape == (3, 512, 512)


def test_far_or_turned_is_beyond_the_gap_from_each_test_in_one_way_or_the_other():
    tests = np.array([[0.0, 0, 1], [1, 0, np.pi]])
    poses = np.array([[0.1, 0, 1.1], [0.1, 0, 2], [0.3, 0, 1], [1, 0.1, -3], [1, 0.1, 0], [0.25, 0, 1], [0, 0, 1.5]])
    assert choices.far_or_turned(poses, tests, 0.25, 0.5).tolist() == [False, True, True, False, True, False, False]


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


def test_a_context_is_the_number_of_actions_done_and_the_last_of_them():
    steps = (0, None), (1, np.array([0, 2])), (2, np.array([1, 1]))
    seen = [choices.with_context(SCORES, None, *step) for step in steps]
    assert [s[:, -1].tolist() for s in seen] == [[0, 0], [5, 7], [10, 10]]
    of_none = [choices.without_context(SCORES, None, *step) for step in steps]
    assert [s[:, -1].tolist() for s in of_none] == [[0, 0]] * 3
    for s in seen + of_none:
        np.testing.assert_array_equal(s[:, :-1], reciprocal_ranks(SCORES))


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


def test_the_floor_of_a_choice_is_the_likelihood_of_what_is_ruled_out():
    for choice in CHOICES:
        if choice.point == "floor of the likelihood":
            with ablate.in_place(choice.constants):
                assert episode.probability(np.array([[0.0, 500]]))[0, 0] == pytest.approx(float(choice.other))
