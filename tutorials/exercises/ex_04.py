"""Exercises of chapter 04. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main

from gnl import nn


def gradient_error(f, x, dx, eps=1e-6):
    """Exercise 4.1: largest relative difference between dx and central differences of f, over all entries of x.

        numeric = (f(x + eps e_i) - f(x - eps e_i)) / (2 eps)
        error   = |numeric - analytic| / max(1e-6, |numeric| + |analytic|)

    f : function of no argument that reads the array x;  dx : of the shape of x
    """
    raise NotImplementedError("exercise 4.1")


def linear_backward(dout, x, w):
    """Exercise 4.2: gradients of x @ w + b: dout (N, F), x (N, C), w (C, F) -> dx (N, C), dw (C, F), db (F,)."""
    raise NotImplementedError("exercise 4.2")


def loss_gradient(scores, labels):
    """Exercise 4.3: gradient of the mean cross-entropy with respect to the scores: (n, K), labels (n,) -> (n, K)."""
    raise NotImplementedError("exercise 4.3")


def row_backward(dout, x, w):
    """Exercise 4.4: dx (N,), dw (3,) of z[i] = sum over u of x[i + u - 1] w[u], zeros beyond x. Find the bug."""
    N = len(x)
    x_padded, dout_padded = np.pad(x, 1), np.pad(dout, 1)
    dx, dw = np.zeros(N), np.zeros(3)
    for u in range(3):
        dx += dout_padded[u:u + N] * w[u]
        dw[u] = (x_padded[u:u + N] * dout).sum()
    return dx, dw


def predict():
    """Exercise 4.5: (pixels that one output pixel depends on, numbers that one convolution 16 -> 16 learns)."""
    raise NotImplementedError("exercise 4.5")


def grade_4_1(gradient_error):
    x = np.array([[1., 2, 3], [-1, 0.5, -2]])
    kept, right = x.copy(), 3 * x ** 2
    expect("a right gradient", gradient_error(lambda: (x ** 3).sum(), x, right), 0, 1e-6)
    expect("x after the check", x, kept, 0)
    expect("dx one per cent too large", gradient_error(lambda: (x ** 3).sum(), x, 1.01 * right), 0.01 / 2.01)
    expect("dx twice the right one", gradient_error(lambda: (x ** 3).sum(), x, 2 * right), 1 / 3)
    for i in range(x.size):
        wrong = right.copy()
        wrong.flat[i] *= -1
        expect(f"a wrong sign at entry {i} alone", gradient_error(lambda: (x ** 3).sum(), x, wrong), 1)
    expect("a gradient of zero", gradient_error(lambda: 0.0, x, 0 * x), 0)
    expect("5e-7 for a gradient of zero", gradient_error(lambda: 0.0, x, 0 * x + 5e-7), 0.5)
    for what, y in ("three dimensions", np.arange(1.0, 9).reshape(2, 2, 2)), ("an array on its side", x.T):
        expect(what, gradient_error(lambda y=y: (y ** 3).sum(), y, 3 * y ** 2), 0, 1e-6)
    expect("a nudge of 1: 3 x^2 + 1", gradient_error(lambda: (x ** 3).sum(), x, right + 1, eps=1.0), 0, 1e-9)


def grade_4_2(linear_backward):
    rng = np.random.default_rng(0)
    x, w, b, dout = (rng.standard_normal(shape) for shape in ((5, 4), (4, 3), 3, (5, 3)))
    grads = linear_backward(dout.copy(), x.copy(), w.copy())
    expect("number of gradients", len(grads), 3)
    for name, array, grad in zip(("dx", "dw", "db"), (x, w, b), grads, strict=True):
        expect(f"shape of {name}", str(np.shape(grad)), str(array.shape))
        error = nn.gradient_error(lambda: ((x @ w + b) * dout).sum(), array, np.asarray(grad), rng)
        expect(f"{name}: relative error against central differences", error, 0, 1e-5)


def grade_4_3(loss_gradient):
    expect("one row", loss_gradient(np.array([[2., 1, 0]]), np.array([1])), [[.665241, -.755272, .090031]], 1e-5)
    rng = np.random.default_rng(0)
    scores, labels = rng.standard_normal((6, 5)), rng.integers(5, size=6)
    expect("six rows", loss_gradient(scores.copy(), labels), nn.softmax_cross_entropy(scores, labels)[1])
    expect("a score of 1000", loss_gradient(np.array([[1000., 0]]), np.array([0])), [[0, 0]])
    high = np.array([[1000., 999, -1000, -1000], [0, 0, 0, 0]])
    kept = high.copy()
    expect("scores of 1000 in one row alone", loss_gradient(high, np.array([0, 0])),
           [[-.134471, .134471, 0, 0], [-.375, .125, .125, .125]], 1e-5)
    expect("the scores after that", high, kept)


def grade_4_4(row_backward):
    rng = np.random.default_rng(0)
    x, w, dout = rng.standard_normal(6), rng.standard_normal(3), rng.standard_normal(6)

    def loss():
        return sum(np.pad(x, 1)[u:u + 6] @ dout * w[u] for u in range(3))

    dx, dw = row_backward(dout.copy(), x.copy(), w.copy())
    for name, array, grad in (("dx", x, dx), ("dw", w, dw)):
        expect(f"shape of {name}", str(np.shape(grad)), str(array.shape))
        error = nn.gradient_error(loss, array, np.asarray(grad), rng)
        expect(f"{name}: relative error against central differences", error, 0, 1e-5)


def grade_4_5(predict):
    pixels, numbers = predict()
    expect("pixels", pixels, 25)
    expect("numbers", numbers, 2320)


TASKS = {
    "4.1": (gradient_error, grade_4_1),
    "4.2": (linear_backward, grade_4_2),
    "4.3": (loss_gradient, grade_4_3),
    "4.4": (row_backward, grade_4_4),
    "4.5": (predict, grade_4_5),
}

if __name__ == "__main__":
    main(TASKS)
