"""Layers as pairs of pure functions, the loss, Adam, and the check that every gradient must pass.

    forward(x, ...) -> out, cache        cache: the tuple that backward needs, never written into
    backward(dout, cache) -> dx, ...     d<name>: gradient of the loss with respect to <name>, same shape

    B batch   H x W image, row 0 on top   C channels in   F channels out   K classes
"""

import math

import numpy as np


def conv_forward(x, w, b):
    """3 x 3 convolution with a border of zeros: every output pixel is a linear map of nine input pixels.

        out[i, j] = b + sum over u, v in 0..2 of x[i + u - 1, j + v - 1] w[u, v]

    x (B, H, W, C), w (3, 3, C, F), b (F,) -> out (B, H, W, F); cache: patches (B H W, 9 C), w
    """
    B, H, W, C = x.shape
    padded = np.zeros((B, H + 2, W + 2, C), x.dtype)
    padded[:, 1:-1, 1:-1] = x
    # The three pixels of a patch's row lie side by side: copied as one piece, an item of 3 C numbers.
    s0, s1, s2, s3 = padded.strides
    rows = np.ndarray((B, H, W, 3), f"V{3 * C * s3}", padded, strides=(s0, s1, s2, s1))
    patches = rows.copy().view(x.dtype).reshape(B, H * W, 9 * C)
    out = patches @ w.reshape(9 * C, -1)  # a product for each image: a small one fits in the cache
    out += b
    return out.reshape(B, H, W, w.shape[3]), (patches.reshape(B * H * W, 9 * C), w)


def conv_backward(dout, cache):
    """dout (B, H, W, F) -> dx (B, H, W, C), dw, db: what went out at [u, v] comes back at [2 - u, 2 - v]."""
    patches, w = cache
    dx, _ = conv_forward(dout, w[::-1, ::-1].swapaxes(2, 3), np.zeros(w.shape[2], w.dtype))
    dflat = dout.reshape(-1, w.shape[3])
    return dx, (patches.T @ dflat).reshape(w.shape), dflat.sum(0)


def linear_forward(x, w, b=None):
    """The same linear map at every pixel (1 x 1 convolution).

    x (..., C), w (C, F), b (F,) or None -> (..., F); cache: x, w
    """
    out = (x.reshape(len(x), -1, len(w)) if x.ndim > 2 else x) @ w  # a product for each image, not for each of its rows
    if b is not None:
        out += b
    return out.reshape(*x.shape[:-1], w.shape[1]), (x, w)


def linear_backward(dout, cache):
    """dout (..., F) -> dx (..., C), dw (C, F), db (F,)."""
    x, w = cache
    dflat = dout.reshape(-1, w.shape[1])
    return (dflat @ w.T).reshape(x.shape), x.reshape(-1, w.shape[0]).T @ dflat, dflat.sum(0)


def relu_forward(x, out=None):
    """max(x, 0), in a new array or in `out`; cache: the output, which is positive just where the input was."""
    out = np.maximum(x, 0, out=out)
    return out, (out,)


def relu_backward(dout, cache):
    """The gradient passes where the input was positive."""
    out, = cache
    return dout * (out > 0)


def pool_forward(x, grid):
    """Mean over each cell of a grid x grid partition: x (B, H, W, C) -> (B, grid, grid, C); cache: shape of x, grid."""
    B, H, W, C = x.shape
    rows = x.reshape(B, grid, H // grid, W * C).sum(2)  # whole rows first: their numbers lie side by side
    cells = rows.reshape(B, grid, grid, W // grid, C).sum(3)
    cells /= H // grid * (W // grid)
    return cells, (x.shape, grid)


def pool_backward(dout, cache):
    """Every pixel of a cell gets the same share."""
    (B, H, W, C), grid = cache
    dx = np.empty((B, grid, H // grid, grid, W // grid, C), dout.dtype)
    dx[:] = (dout / (H // grid * (W // grid)))[:, :, None, :, None]
    return dx.reshape(B, H, W, C)


def upsample_forward(x, factor):
    """Each pixel becomes factor x factor equal pixels: (B, H, W, C) -> (B, factor H, factor W, C); cache: factor."""
    B, H, W, C = x.shape
    wide = np.empty((B, H, factor, W, factor, C), x.dtype)
    wide[:] = x[:, :, None, :, None]
    return wide.reshape(B, factor * H, factor * W, C), (factor,)


def upsample_backward(dout, cache):
    """A pixel gets the sum of what its copies get."""
    factor, = cache
    B, H, W, C = dout.shape
    return dout.reshape(B, H // factor, factor, W // factor, factor, C).sum((2, 4))


def softmax(scores):
    """Probabilities from scores, along the last axis; shifted by the greatest so that nothing overflows."""
    e = np.exp(scores - scores.max(-1, keepdims=True))
    return e / e.sum(-1, keepdims=True)


def softmax_cross_entropy(scores, labels, axis=-1):
    """Mean of -log p[label] and its gradient.

        p = softmax(scores),   dscores = (p - onehot(labels)) / n

    scores (..., K), or with the classes along another `axis`; labels (...) int, n in all -> loss, dscores like scores
    """
    moved = np.moveaxis(scores, axis, 0)
    z = moved.reshape(len(moved), -1)
    n = z.shape[1]
    right, top = (labels.ravel(), np.arange(n)), z.max(0)
    p = np.exp(z - top)
    total = p.sum(0)
    loss = (np.log(total) + top - z[right]).mean()  # and not -log p: p may be too small for its digits
    p /= total
    p[right] -= 1
    p /= n
    return loss, np.moveaxis(p.reshape(moved.shape), 0, axis)


class Adam:
    """Adam (Kingma and Ba 2015, in the form at the end of section 2): running means of gradients and their squares.

        m <- beta1 m + (1 - beta1) g,   v <- beta2 v + (1 - beta2) g^2
        p <- p - rate sqrt(1 - beta2^t) / (1 - beta1^t) m / (sqrt(v) + eps)
    """

    def __init__(self, params, rate=0.001, beta1=0.9, beta2=0.999, eps=1e-8):
        self.params, self.rate, self.beta1, self.beta2, self.eps, self.t = params, rate, beta1, beta2, eps, 0
        self.m = {name: np.zeros_like(p) for name, p in params.items()}
        self.v = {name: np.zeros_like(p) for name, p in params.items()}

    def step(self, grads, rate=None):
        """Move `params` in place against `grads`, a dict of the same names, at `rate` if given."""
        self.t += 1
        rate = (self.rate if rate is None else rate) * math.sqrt(1 - self.beta2 ** self.t) / (1 - self.beta1 ** self.t)
        rate = float(rate)  # a NumPy float64 would have the product below computed in 64 bits
        for name, g in grads.items():
            m, v = self.m[name], self.v[name]
            m *= self.beta1
            m += (1 - self.beta1) * g
            v *= self.beta2
            v += (1 - self.beta2) * g ** 2
            step = np.sqrt(v)
            step += self.eps
            np.divide(m, step, out=step)
            step *= rate
            self.params[name] -= step


def gradient_error(f, x, dx, rng, probes=20, eps=1e-6):
    """Largest relative difference between dx and central differences of the scalar f at random entries of x, or NaN.

        df/dx_i = (f(x + eps e_i) - f(x - eps e_i)) / (2 eps),   a to b differs by |a - b| / max(1e-6, |a| + |b|)

    f : function of no argument that reads x, a float64 array which is nudged in place and restored
    """
    errors = [0.0]
    for i in rng.choice(x.size, min(probes, x.size), replace=False):
        kept = x.flat[i]
        x.flat[i] = kept + eps
        up = f()
        x.flat[i] = kept - eps
        down = f()
        x.flat[i] = kept
        numeric, analytic = (up - down) / (2 * eps), dx.flat[i]
        errors.append(abs(numeric - analytic) / max(1e-6, abs(numeric) + abs(analytic)))
    return np.max(errors)  # NaN if any is, unlike Python's max
