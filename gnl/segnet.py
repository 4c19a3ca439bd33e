"""The segmentation net: from colours to labels (section IV-A: ResNet with a pyramid pooling module, in miniature).

The paper's net sees 512 x 512 pixels and predicts at stride 8; ours sees the view at stride 8 and predicts each of
its 64 x 64 pixels.

    stem    64 x 64 pixels as 32 x 32 quads of 2 x 2 -> 32 x 32 x 24    linear, ReLU
    down    32 x 32 x 24 -> 16 x 16 x 32    conv / 2, ReLU
    block   16 x 16 x 32, a residual: x + conv(ReLU(conv(x))), ReLU               (He et al. 2016)
    pyramid every pixel hears the means of the 1 x 1, 2 x 2 and 4 x 4 cells it lies in   (Zhao et al. 2017)
    head    upsampled to 32 x 32 and joined with the stem -> 10 scores for each of the 4 pixels of a quad
"""

import numpy as np

from .classes import N_CLASSES
from .files import load_arrays, save_arrays
from .nn import (
    Adam,
    conv_backward,
    conv_forward,
    linear_backward,
    linear_forward,
    pool_backward,
    pool_forward,
    relu_backward,
    relu_forward,
    softmax_cross_entropy,
    upsample_backward,
    upsample_forward,
)

SIZE_PX = 64
QUAD = 4  # pixels in a quad, 2 x 2
STEM, WIDTH, BLOCKS, GRIDS = 24, 32, 1, (1, 2, 4)


def new_params(rng, dtype=np.float32):
    """Random weights (He et al. 2015), zero biases; the last map of a residual block starts at zero."""
    params = {}

    def layer(name, *shape, gain=2.0):
        params[f"{name}.w"] = (np.sqrt(gain / np.prod(shape[:-1])) * rng.standard_normal(shape)).astype(dtype)
        params[f"{name}.b"] = np.zeros(shape[-1], dtype)

    layer("stem", QUAD * 4, STEM)
    layer("down", 3, 3, STEM, WIDTH)
    for i in range(BLOCKS):
        layer(f"block{i}.first", 3, 3, WIDTH, WIDTH)
        layer(f"block{i}.second", 3, 3, WIDTH, WIDTH, gain=0.0)
    layer("pyramid", WIDTH, WIDTH)
    for grid in GRIDS:
        layer(f"pyramid{grid}", WIDTH, WIDTH, gain=0.5)
    layer("fine", STEM, WIDTH)
    layer("coarse", WIDTH, WIDTH, gain=1.0)
    layer("head", WIDTH, N_CLASSES * QUAD, gain=1.0)
    return params


def forward(params, rgb, learning=True):
    """Scores of each pixel, classes first and pixels by quads (see `to_quads`); cache: those of the layers by name.

    rgb (B, 64, 64, 3) uint8 -> (10, 4, B, 32, 32); not `learning`: no cache, which costs room near the processor
    """
    cache = {}

    def keep(name, out_and_cache):
        out, of_layer = out_and_cache
        if learning:
            cache[name] = of_layer
        return out

    def conv(name, x, stride=1):
        return keep(name, conv_forward(x, params[f"{name}.w"], params[f"{name}.b"], stride))

    def linear(name, x):
        return keep(name, linear_forward(x, params[f"{name}.w"], params[f"{name}.b"]))

    def relu(name, x):
        return keep(f"{name}.relu", relu_forward(x, out=x))  # in place: no layer needs its own sums again

    fine = relu("stem", linear("stem", standardise(rgb, params["stem.w"].dtype)))
    x = relu("down", conv("down", fine, 2))
    for i in range(BLOCKS):
        inner = relu(f"block{i}.first", conv(f"block{i}.first", x))
        added = conv(f"block{i}.second", inner)
        added += x
        x = relu(f"block{i}.second", added)
    y = linear("pyramid", x)
    for grid in GRIDS:
        pooled = keep(f"pool{grid}", pool_forward(x, grid))
        y += upsample_forward(linear(f"pyramid{grid}", pooled), x.shape[1] // grid)[0]
    y = relu("pyramid", y)
    joined = linear("fine", fine)
    joined += upsample_forward(linear("coarse", y), 2)[0]
    joined = relu("head", joined)
    # Classes first: the loss and the best class then run along memory.
    scores = params["head.w"].T @ joined.reshape(-1, WIDTH).T
    scores += params["head.b"][:, None]
    cache["head"] = joined, params["head.w"]
    return scores.reshape(N_CLASSES, QUAD, *joined.shape[:3]), cache


def standardise(rgb, dtype=np.float32):
    """Colours less the view's mean over its spread, and how high each row is: (B, H, H, 3) uint8 -> quads of these.

    returns : (B, H / 2, H / 2, 16), the 4 channels of the 2 x 2 pixels of each quad
    """
    B, H, W, _ = rgb.shape
    flat = rgb.reshape(B, -1).astype(dtype)
    flat -= flat.mean(1, keepdims=True)
    spread = np.sqrt(np.einsum("bi,bi->b", flat, flat) / flat.shape[1])
    flat /= spread[:, None] + 1  # a view of one colour stays at zero
    pixels = np.empty((B, H, W, 4), dtype)
    for c in range(3):  # one by one: NumPy is slow along an axis of three
        pixels[..., c] = flat.reshape(rgb.shape)[..., c]
    pixels[..., 3] = np.linspace(1, -1, H, dtype=dtype)[:, None]  # the camera never tilts: floor is low
    quads = pixels.reshape(B, H // 2, 2, W // 2, 8).transpose(0, 1, 3, 2, 4)
    return quads.reshape(B, H // 2, W // 2, 16)


def backward(params, dscores, cache):
    """Gradients of all parameters from dscores (10, 4, B, 32, 32), as a dict with the names of `params`."""
    grads = {}

    def back(step, name, dout):
        dx, grads[f"{name}.w"], grads[f"{name}.b"] = step(dout, cache[name])
        return dx

    dhead = np.moveaxis(dscores.reshape(-1, *dscores.shape[2:]), 0, -1)
    djoined = relu_backward(back(linear_backward, "head", dhead), cache["head.relu"])
    dfine = back(linear_backward, "fine", djoined)
    dy = back(linear_backward, "coarse", upsample_backward(djoined, (2,)))
    dy = relu_backward(dy, cache["pyramid.relu"])
    dx = back(linear_backward, "pyramid", dy)
    for grid in GRIDS:
        dpooled = back(linear_backward, f"pyramid{grid}", upsample_backward(dy, (dy.shape[1] // grid,)))
        dx = dx + pool_backward(dpooled, cache[f"pool{grid}"])
    for i in reversed(range(BLOCKS)):
        dsum = relu_backward(dx, cache[f"block{i}.second.relu"])
        dinner = back(conv_backward, f"block{i}.second", dsum)
        dx = dsum + back(conv_backward, f"block{i}.first", relu_backward(dinner, cache[f"block{i}.first.relu"]))
    dfine = dfine + back(conv_backward, "down", relu_backward(dx, cache["down.relu"]))
    back(linear_backward, "stem", relu_backward(dfine, cache["stem.relu"]))
    return grads


def predict(params, rgb, chunk=8):
    """Labels of each pixel: rgb (B, 64, 64, 3) uint8 -> (B, 64, 64) uint8. Few views at once stay in the cache."""
    labels = np.empty(rgb.shape[:3], np.uint8)
    for i in range(0, len(rgb), chunk):
        scores, _ = forward(params, rgb[i:i + chunk], learning=False)
        best, quads = scores.max(0), np.zeros(scores.shape[1:], np.uint8)
        for k in range(1, N_CLASSES):  # arg max over classes, many times faster than along an axis of ten
            np.maximum(quads, (scores[k] == best) * np.uint8(k), out=quads)
        labels[i:i + chunk] = from_quads(quads)
    return labels


def train(params, rgb, labels, rng, epochs, batch=8, rate=4e-3, progress=None):
    """Fit `params` in place to views and their labels; each view is seen mirrored half the time.

    rgb (n, 64, 64, 3) uint8, labels (n, 64, 64) uint8; progress(share done, loss) is called after each batch
    """
    batch = min(batch, len(rgb))
    adam, n_steps = Adam(params), epochs * (len(rgb) // batch)
    for step in range(n_steps):
        if step % (len(rgb) // batch) == 0:
            order = rng.permutation(len(rgb))
        i = order[step * batch % (len(rgb) // batch * batch):][:batch]
        x, y = rgb[i], labels[i]
        if rng.random() < 0.5:
            x, y = x[:, :, ::-1], y[:, :, ::-1]
        scores, cache = forward(params, x)
        loss, dscores = softmax_cross_entropy(scores, to_quads(y), axis=0)
        share = (step + 1) / n_steps
        adam.step(backward(params, dscores, cache), rate * min(1, 20 * share) * (1 + np.cos(np.pi * share)) / 2)
        if progress:
            progress(share, loss)


def accuracy(predicted, true):
    """Pixel accuracy, and mean intersection over union of the classes that occur in `true`."""
    both = np.bincount(true.ravel() * N_CLASSES + predicted.ravel(), minlength=N_CLASSES ** 2)
    both = both.reshape(N_CLASSES, N_CLASSES).astype(float)
    hit, present = both.diagonal(), both.sum(1) > 0
    iou = hit[present] / (both.sum(0) + both.sum(1) - hit)[present]
    return hit.sum() / both.sum(), iou.mean()


def to_quads(images):
    """Pixels by quads: (B, H, W, ...) -> (4, B, H / 2, W / 2, ...), upper left and right, lower left and right."""
    return np.stack([images[:, i::2, j::2] for i in (0, 1) for j in (0, 1)])


def from_quads(quads):
    """The way back: (4, B, h, w) -> (B, 2 h, 2 w)."""
    _, B, h, w = quads.shape
    return quads.reshape(2, 2, B, h, w).transpose(2, 3, 0, 4, 1).reshape(B, 2 * h, 2 * w)


def save(params, path, made_by):
    """Write the weights and what made them."""
    save_arrays(path, made_by, **params)


def load(path):
    """Weights of a file of `save`, and what made them; ValueError if they do not fit this net."""
    params, made_by = load_arrays(path)
    wanted = {name: p.shape for name, p in new_params(np.random.default_rng(0)).items()}
    found = {name: p.shape for name, p in params.items()}
    if wanted != found:
        name = next(k for k in wanted | found if wanted.get(k) != found.get(k))
        raise ValueError(f"{path}: {name}: expected shape {wanted.get(name)}, found {found.get(name)}")
    return params, made_by
