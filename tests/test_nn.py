"""Every gradient is that of central differences; the layers, the loss and Adam equal their plain forms."""

import naive_learning
import numpy as np
import pytest
from scipy.signal import correlate

from gnl import nn

CLOSE = 1e-6  # largest relative difference from central differences in float64


def normal(seed, *shape):
    return np.random.default_rng(seed).standard_normal(shape)


def linear_data(seed=0):
    return normal(seed, 2, 3, 5, 4), normal(seed + 1, 4, 6), normal(seed + 2, 6)


def conv_data(seed=0):
    return normal(seed, 2, 6, 8, 4), normal(seed + 1, 3, 3, 4, 5), normal(seed + 2, 5)


LAYERS = {  # name: inputs, forward, backward; all sizes differ, so that a transpose fails
    "conv": (conv_data(), nn.conv_forward, nn.conv_backward),
    "linear": (linear_data(), nn.linear_forward, nn.linear_backward),
    "relu": ((normal(0, 3, 5, 4),), nn.relu_forward, nn.relu_backward),
    "pool": ((normal(0, 2, 6, 12, 5),), lambda x: nn.pool_forward(x, 3), nn.pool_backward),
    "upsample": ((normal(0, 2, 4, 3, 5),), lambda x: nn.upsample_forward(x, 3), nn.upsample_backward),
}


@pytest.fixture(params=LAYERS, ids=str)
def layer(request):
    return LAYERS[request.param]


def gradients_of(backward, dout, cache):
    gradients = backward(dout, cache)
    return gradients if isinstance(gradients, tuple) else (gradients,)


def test_every_gradient_is_that_of_central_differences(layer):
    inputs, forward, backward = layer
    out, cache = forward(*inputs)
    dout = normal(9, *out.shape)
    gradients = gradients_of(backward, dout, cache)
    assert len(gradients) == len(inputs)
    for x, dx in zip(inputs, gradients, strict=True):
        assert dx.shape == x.shape
        # (out * dout).sum() is a loss whose gradient by `out` is dout.
        error = nn.gradient_error(lambda: (forward(*inputs)[0] * dout).sum(), x, dx, np.random.default_rng(0), 60)
        assert error < CLOSE


def test_backward_writes_neither_into_the_cache_nor_into_what_it_is_given(layer):
    inputs, forward, backward = layer
    out, cache = forward(*inputs)
    dout = normal(9, *out.shape)
    arrays = [dout, *inputs, *(item for item in cache if isinstance(item, np.ndarray))]
    before = [array.copy() for array in arrays]
    for gradient in gradients_of(backward, dout, cache):
        gradient += 1  # nor does it hand out a view of them
    for array, kept in zip(arrays, before, strict=True):
        np.testing.assert_array_equal(array, kept)


def test_layers_keep_float32(layer):
    inputs, forward, backward = layer
    out, cache = forward(*(x.astype(np.float32) for x in inputs))
    gradients = gradients_of(backward, out, cache)
    assert {array.dtype for array in (out, *gradients)} == {np.dtype(np.float32)}


def test_convolution_is_that_of_the_plain_loops():
    x, w, b = conv_data()
    np.testing.assert_allclose(nn.conv_forward(x, w, b)[0], naive_learning.conv(x, w, b))


def test_convolution_is_that_of_scipy():
    x, w, b = conv_data()
    out, _ = nn.conv_forward(x, w, b)
    for image, f in np.ndindex(len(x), len(b)):
        sums = sum(correlate(x[image, :, :, c], w[:, :, c, f], mode="same") for c in range(x.shape[3]))
        np.testing.assert_allclose(out[image, :, :, f], sums + b[f])


def test_linear_is_one_map_at_every_pixel():
    x, w, b = linear_data()
    out, _ = nn.linear_forward(x, w, b)
    for pixel in np.ndindex(x.shape[:-1]):
        np.testing.assert_allclose(out[pixel], x[pixel] @ w + b)
    np.testing.assert_array_equal(nn.linear_forward(x, w)[0], nn.linear_forward(x, w, 0 * b)[0])


def test_pooling_takes_the_mean_of_each_cell_and_upsampling_repeats_it():
    x = normal(0, 2, 6, 9, 4)
    pooled, _ = nn.pool_forward(x, 3)
    for i, j in np.ndindex(3, 3):
        np.testing.assert_allclose(pooled[:, i, j], x[:, 2 * i:2 * i + 2, 3 * j:3 * j + 3].mean((1, 2)))
    np.testing.assert_array_equal(nn.upsample_forward(x, 3)[0], x.repeat(3, 1).repeat(3, 2))


def test_softmax_sums_to_one_even_of_huge_scores():
    scores = np.concatenate([normal(0, 4, 7), 1e300 * normal(1, 4, 7), -1e308 * np.ones((2, 7))])
    p = nn.softmax(scores)
    np.testing.assert_allclose(p.sum(1), 1)
    np.testing.assert_allclose(p[:4], np.exp(scores[:4]) / np.exp(scores[:4]).sum(1, keepdims=True))
    np.testing.assert_allclose(p[-2:], 1 / 7)


@pytest.mark.parametrize("shape", [(6,), (3, 2), (2, 3, 4)])
def test_loss_is_minus_log_of_the_right_probability_and_its_gradient_that_of_central_differences(shape):
    scores, labels = normal(0, *shape, 5), np.random.default_rng(1).integers(5, size=shape)
    loss, dscores = nn.softmax_cross_entropy(scores, labels)
    np.testing.assert_allclose(loss, -np.log(np.take_along_axis(nn.softmax(scores), labels[..., None], -1)).mean())
    assert dscores.shape == scores.shape
    error = nn.gradient_error(lambda: nn.softmax_cross_entropy(scores, labels)[0], scores, dscores,
                              np.random.default_rng(2), scores.size)
    assert error < CLOSE


@pytest.mark.parametrize("axis", [0, 1, -1])
def test_classes_may_lie_along_any_axis(axis):
    scores, labels = normal(0, 2, 3, 4, 5), np.random.default_rng(1).integers(5, size=(2, 3, 4))
    loss, dscores = nn.softmax_cross_entropy(scores, labels)
    moved_loss, moved_dscores = nn.softmax_cross_entropy(np.moveaxis(scores, -1, axis), labels, axis)
    assert moved_loss == pytest.approx(loss)
    np.testing.assert_allclose(np.moveaxis(moved_dscores, axis, -1), dscores)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_loss_is_right_where_the_probability_is_too_small_for_its_digits(dtype):
    loss, dscores = nn.softmax_cross_entropy(np.array([[0, 5000, 0]], dtype), np.array([2]))
    assert loss == 5000
    np.testing.assert_array_equal(dscores, [[0, 1, -1]])
    assert dscores.dtype == dtype


def test_first_step_of_adam_is_the_rate_against_the_sign_of_the_gradient():
    g = np.array([3.0, -1e-3, 200.0, 0.0])
    params = {"x": np.ones(4)}
    nn.Adam(params, rate=0.01).step({"x": g})
    np.testing.assert_allclose(params["x"], 1 - 0.01 * np.sign(g), atol=1e-5)


def test_adam_is_that_of_the_plain_loops_over_many_steps():
    x, gradients = normal(0, 4), normal(1, 60, 4) * [1e-3, 1, 10, 1000]
    params = {"x": x.copy(), "still": np.ones(2)}
    adam = nn.Adam(params, rate=0.02)
    for g in gradients:
        adam.step({"x": g})
    np.testing.assert_allclose(params["x"], naive_learning.adam(x, gradients, 0.02), rtol=1e-10)
    np.testing.assert_array_equal(params["still"], 1)


def test_a_rate_given_to_one_step_holds_for_that_step():
    params = {"x": np.zeros(1)}
    nn.Adam(params, rate=0.01).step({"x": np.ones(1)}, rate=0.5)
    np.testing.assert_allclose(params["x"], -0.5, rtol=1e-6)


def test_adam_finds_the_minimum_of_a_quadratic():
    params, minimum, steepness = {"x": np.zeros(3)}, np.array([1.0, -2.0, 0.5]), np.array([1.0, 10.0, 100.0])
    adam = nn.Adam(params, rate=0.05)
    for _ in range(800):
        adam.step({"x": steepness * (params["x"] - minimum)})
    np.testing.assert_allclose(params["x"], minimum, atol=1e-3)


def test_the_gradient_check_sees_a_wrong_gradient_and_leaves_its_argument_as_it_was():
    x = normal(0, 7)
    kept, rng = x.copy(), np.random.default_rng(0)
    assert nn.gradient_error(lambda: (x ** 3).sum(), x, 3 * x ** 2, rng) < CLOSE
    assert nn.gradient_error(lambda: (x ** 3).sum(), x, 3.01 * x ** 2, rng) > 1e-3
    np.testing.assert_array_equal(x, kept)


def test_the_gradient_check_sees_that_a_small_gradient_is_off_by_half():
    x, rng = normal(0, 7), np.random.default_rng(0)
    assert nn.gradient_error(lambda: 1e-4 * x.sum(), x, np.full(7, 1e-4), rng) < 1e-3
    assert nn.gradient_error(lambda: 1e-4 * x.sum(), x, np.full(7, 0.5e-4), rng) > 0.1


def test_the_gradient_check_sees_what_is_no_number():
    x, rng = normal(0, 7), np.random.default_rng(0)
    assert not nn.gradient_error(lambda: (x ** 2).sum(), x, np.full(7, np.nan), rng) < CLOSE
    assert not nn.gradient_error(lambda: np.nan, x, 2 * x, rng) < CLOSE
