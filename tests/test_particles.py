"""The filter approaches exact Bayes, resamples without bias, and survives views that explain nothing."""

from types import SimpleNamespace

import naive_learning
import numpy as np
import pytest

from gnl.particles import AT_ONCE, ParticleFilter
from gnl.places import PlaceGrid

GRID = PlaceGrid(SimpleNamespace(bounds=(-1, 2, 5, 6)))  # 3 x 2 x 12 = 72 places; not square, not from 0
K = GRID.n_places


def random_likelihood(seed, B=1):
    return np.random.default_rng(seed).random((B, K)) ** 4


def new_filter(likelihood=None, seed=0, n_particles=400, **options):
    likelihood = np.ones((1, K)) if likelihood is None else likelihood
    return ParticleFilter(GRID, likelihood, np.random.default_rng(seed), n_particles, **options)


def state(belief):
    return {name: value.copy() for name, value in vars(belief).items() if isinstance(value, np.ndarray)}


@pytest.mark.parametrize("k", [3, 8])
def test_the_filter_approaches_exact_bayes(k):
    """Total variation over 8 places with 100,000 particles: measured 0.003, at most 0.011 over 12 seeds."""
    grid = PlaceGrid(SimpleNamespace(bounds=(0, 0, 4, 2)), n_bearings=4)
    rng = np.random.default_rng(0)
    views = (0.02 + rng.random((5, 8)) ** 2) / 2
    best = np.argsort(-views[0])[:k]
    belief = ParticleFilter(grid, views[:1], np.random.default_rng(1), 100_000, k, std=(0.2, 0.2))
    exact = naive_learning.ExactBayes(grid, (4, 2), best, 0.2, 0.2)
    exact.weigh(views[0])
    for view, (forward, turn) in zip(views[1:], [(0.5, 0.0), (0.0, 0.6), (0.7, 0.0), (0.3, -0.4)], strict=True):
        belief.resample()
        belief.predict(np.array([[forward, turn]]))
        belief.weigh(view[None])
        exact.predict(forward, turn)
        exact.weigh(view)
        difference = belief.belief()[0] - exact.belief(8)
        assert abs(difference).sum() / 2 < 0.015
    assert exact.belief(8).max() < 0.9  # it was no foregone conclusion


def test_odometry_moves_each_particle_along_its_own_bearing():
    belief = new_filter(np.ones((2, K)), std=(0, 0))
    before = state(belief)
    belief.predict(np.array([[0.5, 0.0], [-0.2, 0.3]]))
    forward, turn = np.array([[0.5], [-0.2]]), np.array([[0.0], [0.3]])
    np.testing.assert_allclose(belief.x, before["x"] + forward * np.cos(before["theta"]), atol=1e-6)
    np.testing.assert_allclose(belief.y, before["y"] + forward * np.sin(before["theta"]), atol=1e-6)
    np.testing.assert_allclose(belief.theta, before["theta"] + turn, atol=1e-6)


def test_the_noise_of_motion_has_the_stated_spread_in_each_direction_by_itself():
    belief = new_filter(n_particles=40_000, std=(0.1, 0.02))
    before = state(belief)
    belief.predict(np.zeros((1, 2)))
    steps = [(getattr(belief, name) - before[name])[0] for name in ("x", "y", "theta")]
    for step, std in zip(steps, (0.1, 0.1, 0.02), strict=True):
        assert step.std() == pytest.approx(std, rel=0.02)
        assert abs(step.mean()) < 4 * std / 200
    assert np.corrcoef(steps) == pytest.approx(np.eye(3), abs=4 / 200)


def test_each_of_many_robots_moves_by_its_own_odometry():
    B = 2 * AT_ONCE + 3  # more than go at once
    belief = new_filter(np.ones((B, K)), std=(0, 0))
    before, odometry = state(belief), np.random.default_rng(1).uniform(-1, 1, (B, 2))
    belief.predict(odometry)
    forward, turn = odometry.T[..., None]
    np.testing.assert_allclose(belief.x, before["x"] + forward * np.cos(before["theta"]), atol=1e-6)
    np.testing.assert_allclose(belief.y, before["y"] + forward * np.sin(before["theta"]), atol=1e-6)
    np.testing.assert_allclose(belief.theta, before["theta"] + turn, atol=1e-6)


@pytest.mark.parametrize("likelihood", [np.ones((1, 3)), np.ones(K), np.ones((2, K)), np.full((1, K), np.nan),
                                        np.eye(K)[:1] - 0.1, np.full((1, K), np.inf)])
def test_a_likelihood_that_cannot_be_is_refused_and_changes_nothing(likelihood):
    belief = new_filter()
    before = state(belief)
    with pytest.raises(ValueError, match=f"likelihood: expected 1 x {K} finite numbers from 0 on, found "):
        belief.weigh(likelihood)
    for name, value in before.items():
        np.testing.assert_array_equal(getattr(belief, name), value)


def test_resampling_is_unbiased_and_copies_floor_or_ceil_times():
    n, M = 4000, 60
    weight = np.random.default_rng(0).random(M) ** 6
    weight[7] = 0
    belief = new_filter(np.ones((n, K)), n_particles=M)
    belief.weight = np.broadcast_to(weight / weight.sum(), (n, M))
    belief.x = np.tile(np.arange(M, dtype=np.float32), (n, 1))
    belief.resample()
    copies = np.stack([np.bincount(row.astype(int), minlength=M) for row in belief.x])
    deserved = M * weight / weight.sum()
    assert (copies >= np.floor(deserved)).all()
    assert (copies <= np.ceil(deserved)).all()
    standard_error = np.sqrt(deserved % 1 * (1 - deserved % 1) / n)
    assert (abs(copies.mean(0) - deserved) <= 4 * standard_error + 1e-12).all()
    np.testing.assert_array_equal(belief.weight, np.float32(1 / M))


def test_the_light_survive_as_often_as_they_deserve():
    belief = new_filter(np.ones((9000, K)), n_particles=3)
    belief.weight = np.tile(np.float32([0.1, 0.2, 0.7]), (9000, 1))
    belief.x = np.tile(np.float32([0, 1, 2]), (9000, 1))
    belief.resample()
    share = [(belief.x == i).mean() for i in range(3)]
    np.testing.assert_allclose(share, [0.1, 0.2, 0.7], atol=0.01)


def test_resampling_leaves_the_belief_after_the_first_view_as_it_was():
    """Copies are dealt out at equal steps along the particles, so places must not take turns along them."""
    belief = new_filter(random_likelihood(0, 20), n_particles=5000)
    before = belief.belief()
    belief.resample()
    np.testing.assert_allclose(belief.belief(), before, atol=2 / 5000)


def test_a_particle_of_all_the_weight_takes_every_place():
    belief = new_filter(n_particles=50)
    x, place = belief.x[0, 31], belief.place[0, 31]
    belief.weight = np.float32(np.arange(50) == 31)[None]
    belief.resample()
    assert (belief.x == x).all()
    assert (belief.place == place).all()


def test_resampling_keeps_a_particle_in_one_piece():
    belief = new_filter(random_likelihood(0, 3))
    particles_before = np.stack([belief.x, belief.y, belief.theta, belief.place], -1)
    belief.resample()
    particles_after = np.stack([belief.x, belief.y, belief.theta, belief.place], -1)
    for before, after in zip(particles_before.tolist(), particles_after.tolist(), strict=True):
        assert set(map(tuple, after)) <= set(map(tuple, before))


def test_a_view_that_explains_no_particle_changes_no_weight():
    likelihood = random_likelihood(0, 2)
    belief = new_filter(likelihood)
    before = belief.weight.copy()
    nothing = random_likelihood(1, 2)
    nothing[0] = 0
    belief.weigh(nothing)
    np.testing.assert_array_equal(belief.weight[0], before[0])
    assert abs(belief.weight[1] - before[1]).max() > 0
    np.testing.assert_allclose(belief.weight.sum(1), 1, rtol=1e-5)


def test_likelihoods_of_zero_from_the_first_view_on_never_give_nan():
    belief = new_filter(np.zeros((2, K)))
    for _ in range(3):
        belief.resample()
        belief.predict(np.ones((2, 2)))
        belief.weigh(np.zeros((2, K)))
        assert np.isfinite(belief.x).all()
        np.testing.assert_allclose(belief.belief().sum(1), 1, rtol=1e-5)


@pytest.mark.parametrize("k", [1, 3, 5])
def test_the_start_is_in_the_k_best_places_alone(k):
    likelihood = random_likelihood(0, 4)
    belief = new_filter(likelihood, n_start_places=k)
    places = GRID.place_of(np.stack([belief.x, belief.y, belief.theta], -1))
    np.testing.assert_array_equal(places, belief.place)
    for b in range(4):
        best = np.argsort(-likelihood[b])[:k]
        assert set(places[b]) == set(best)
        assert np.ptp(np.bincount(places[b], minlength=K)[best]) <= 1  # they share the particles evenly
        deserved = likelihood[b, best] / likelihood[b, best].sum()
        np.testing.assert_allclose(belief.belief()[b, best], deserved, rtol=0.02)


def test_the_start_is_uniform_within_a_place():
    place = 40
    belief = new_filter(np.eye(K)[[place]], n_particles=6000, n_start_places=1)
    low = GRID.corner_of(place)
    for values, start, width in zip((belief.x, belief.y, belief.theta), low, (2, 2, np.pi / 6), strict=True):
        counts, _ = np.histogram(values, 10, (start, start + width))
        assert counts.sum() == 6000
        assert abs(counts - 600).max() < 4 * np.sqrt(600)


def test_a_home_of_fewer_places_than_k_starts_in_all_of_them():
    grid = PlaceGrid(SimpleNamespace(bounds=(0, 0, 2, 2)), n_bearings=2)
    belief = ParticleFilter(grid, np.ones((1, 2)), np.random.default_rng(0), 100, 3)
    np.testing.assert_allclose(belief.belief(), [[0.5, 0.5]], rtol=1e-5)


@pytest.mark.parametrize("pooling", ["sum", "max"])
def test_pooling_is_that_of_the_plain_loop(pooling):
    belief = new_filter(random_likelihood(0, 3))
    belief.predict(np.array([[0.5, 0.2]] * 3))
    belief.weigh(random_likelihood(1, 3))
    pooled = belief.belief(pooling)
    assert pooled.shape == (3, K)
    for b in range(3):
        plain = naive_learning.belief(belief.place[b], belief.weight[b], K, pooling)
        np.testing.assert_allclose(pooled[b], plain, rtol=1e-6)


@pytest.mark.parametrize("kind", [bool, np.uint8, np.int8, int])
def test_likelihoods_of_any_kind_of_numbers_start_the_filter_alike(kind):
    likelihood = np.zeros((1, K), kind)
    likelihood[0, [5, 1]] = 100, 50
    one, other = (new_filter(likelihood.astype(kind)) for kind in (kind, float))
    for name, value in state(one).items():
        np.testing.assert_array_equal(value, getattr(other, name))


@pytest.mark.parametrize("size", [{"n_particles": 0}, {"n_start_places": 0}, {"n_start_places": -1},
                                  {"n_particles": 1e3}], ids=str)
def test_a_filter_of_nothing_is_refused(size):
    (name, found), = size.items()
    with pytest.raises(ValueError, match=f"{name}: expected a whole number from 1 on, found {found}"):
        ParticleFilter(GRID, np.ones((1, K)), np.random.default_rng(0), **size)
    with pytest.raises(ValueError, match=r"likelihood: expected shape \(B, K\), found \(7,\)"):
        ParticleFilter(GRID, np.ones(7), np.random.default_rng(0))


@pytest.mark.parametrize("odometry", [[0.5, 0], [[0.5, 0]] * 2, [[np.nan, 0]], [[0.5]]], ids=str)
def test_an_odometry_that_cannot_be_is_refused_and_moves_nothing(odometry):
    belief = new_filter()
    before = state(belief)
    with pytest.raises(ValueError, match="odometry: expected 1 x 2 finite numbers, found "):
        belief.predict(odometry)
    for name, value in before.items():
        np.testing.assert_array_equal(getattr(belief, name), value)


def test_a_belief_about_what_comes_next_is_pooled_after_weighing_by_ones():
    belief = new_filter()
    before = belief.belief()
    belief.predict(np.array([[0.0, np.pi]]))
    np.testing.assert_array_equal(belief.belief(), before)
    belief.weigh(np.ones((1, K)))
    places = belief.grid.place_of(np.stack([belief.x, belief.y, belief.theta], -1)[0])
    np.testing.assert_allclose(belief.belief()[0], np.bincount(places, belief.weight[0], K), atol=1e-6)
    assert abs(belief.belief() - before).sum() > 1


def test_a_pooling_that_is_none_is_refused():
    with pytest.raises(ValueError, match='pooling: expected "sum" or "max", found \'mean\''):
        new_filter().belief("mean")


def test_the_belief_sums_to_one_all_along():
    belief = new_filter(random_likelihood(0, 3), n_particles=5000)
    for step in range(6):
        belief.resample()
        belief.predict(np.array([[0.5, 0.2]] * 3))
        belief.weigh(random_likelihood(step, 3))
        np.testing.assert_allclose(belief.belief().sum(1), 1, rtol=1e-5)


def life(likelihood, seed, resample):
    B, belief = len(likelihood), new_filter(likelihood, seed)
    for step in range(3):
        if resample:
            belief.resample()
        belief.predict(np.array([[0.5, 0.2]] * B))
        belief.weigh(random_likelihood(step).repeat(B, 0))
    return state(belief)


@pytest.mark.parametrize("std", [(np.nan, 0.03), (0.03, np.inf), (-0.1, 0), (0.1, 0.1, 0.1), (0.1,), 0.1],
                         ids=str)
def test_motion_noise_that_cannot_be_is_refused(std):
    with pytest.raises(ValueError, match="std: expected two finite numbers from 0 on, found "):
        new_filter(std=std)


def test_one_seed_gives_one_filter():
    one, again, other = (life(random_likelihood(0, 2), seed, True) for seed in (0, 0, 1))
    for name, value in one.items():
        np.testing.assert_array_equal(value, again[name])
    assert (one["x"] != other["x"]).any()


def test_filters_side_by_side_are_each_what_one_would_be_alone():
    """Bit by bit, until they resample: there each draws a number of its own."""
    alone = life(random_likelihood(0), 0, False)
    for name, value in life(random_likelihood(0).repeat(AT_ONCE + 3, 0), 0, False).items():
        np.testing.assert_array_equal(value, alone[name].repeat(AT_ONCE + 3, 0))
