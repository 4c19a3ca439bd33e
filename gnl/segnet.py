"""The segmentation net: from colours to labels (section IV-A: ResNet with a pyramid pooling module, in miniature).

The paper's net sees 512 x 512 pixels and predicts, as such nets do, at stride 8; ours sees the view at stride 8 and
predicts each of its 64 x 64 pixels.

    stem    64 x 64 pixels as 32 x 32 quads of 2 x 2, each 12 colours and a height -> 16    linear, ReLU
    down    each square of 2 x 2 quads, 4 x 16 -> 16: 16 x 16 x 16    linear, ReLU
    block   16 x 16 x 16, a residual: x + conv(ReLU(conv(x))), ReLU               (He et al. 2016)
    pyramid every square hears the means of the 1 x 1, 2 x 2 and 4 x 4 cells it lies in   (Zhao et al. 2017)
    up      16 x 16 x 16 -> 16 x 16 x 64, the four quads of the square; added to a map of the stem, ReLU
    head    each quad, 16 -> 10 scores for each of its 4 pixels

Maps lie in memory square by square, and each square quad by quad, so neither down nor up moves anything. Scores and
labels have class and pixel as their first axes (`to_quads`).
"""

from itertools import pairwise

import numpy as np

from .checks import check_count
from .classes import N_CLASSES
from .files import check_params, load_arrays, save_arrays
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

SIZE_PX = 64  # DIFFERS: the net sees the view at 64 x 64 pixels, the stride at which nets like the paper's predict
MEAN, SPREAD = 128, 50  # roughly those of the colours of training views
QUAD = 4  # pixels in a quad, quads in a square: 2 x 2, in reading order
WIDTH, BLOCKS, GRIDS = 16, 1, (1, 2, 4)  # each grid divides the cells of the one before


def new_params(rng, dtype=np.float32):
    """Random weights (He et al. 2015), zero biases; the last map of a residual block starts at zero."""
    params = {}

    def layer(name, *shape, gain=2.0, bias=True):
        params[f"{name}.w"] = (np.sqrt(gain / np.prod(shape[:-1])) * rng.standard_normal(shape)).astype(dtype)
        if bias:
            params[f"{name}.b"] = np.zeros(shape[-1], dtype)

    # Of several maps that are summed, one has the bias.
    layer("stem", QUAD * 3, WIDTH, bias=False)
    layer("height", 1, WIDTH, gain=0.5)
    layer("down", QUAD * WIDTH, WIDTH)
    for i in range(BLOCKS):
        layer(f"block{i}.first", 3, 3, WIDTH, WIDTH)
        layer(f"block{i}.second", 3, 3, WIDTH, WIDTH, gain=0.0)
    layer("pyramid", WIDTH, WIDTH)
    for grid in GRIDS:
        layer(f"pyramid{grid}", WIDTH, WIDTH, gain=0.5, bias=False)
    layer("fine", WIDTH, WIDTH, bias=False)
    layer("up", WIDTH, QUAD * WIDTH, gain=1.0)
    layer("head", WIDTH, N_CLASSES * QUAD, gain=1.0)
    return params


def forward(params, rgb, learning=True):
    """Scores of each pixel, classes first and pixels as in `to_quads`; cache: those of the layers by name.

    rgb (B, 64, 64, 3) uint8 -> (10 classes, 4 pixels of a quad, B, 16, 16, 4 quads of a square)
    learning : if False, nothing is kept for `backward`: it would take room in the processor's cache
    """
    if rgb.dtype != np.uint8 or rgb.shape[3:] != (3,):
        raise ValueError(f"views: expected bytes (B, H, W, 3), found {rgb.dtype} {rgb.shape}")
    (H, W), part = rgb.shape[1:3], 4 * max(GRIDS)  # squares of 4 x 4 pixels, a multiple of the finest grid per side
    if H % part or W % part:
        raise ValueError(f"views: expected a height and a width that are multiples of {part}, found {H} x {W}")
    cache = {}

    def keep(name, out_and_cache):
        out, of_layer = out_and_cache
        if learning:
            cache[name] = of_layer
        return out

    def conv(name, x):
        return keep(name, conv_forward(x, params[f"{name}.w"], params[f"{name}.b"]))

    def linear(name, x):
        return keep(name, linear_forward(x, params[f"{name}.w"], params.get(f"{name}.b")))

    def relu(name, x):
        return keep(f"{name}.relu", relu_forward(x, out=x))  # in place: no layer needs its own sums again

    colours = standardise(rgb, params["stem.w"].dtype)
    fine = linear("stem", colours)
    fine += linear("height", heights(len(fine[0]), fine.dtype))
    fine = relu("stem", fine)  # (B, 16, 16, 4, 16)

    x = relu("down", linear("down", fine.reshape(*fine.shape[:3], -1)))  # (B, 16, 16, 16)
    for i in range(BLOCKS):
        inner = relu(f"block{i}.first", conv(f"block{i}.first", x))
        added = conv(f"block{i}.second", inner)
        added += x
        x = relu(f"block{i}.second", added)

    cells, maps = x, [linear("pyramid", x)]
    for grid in reversed(GRIDS):  # the mean of a large cell is that of the small cells in it
        cells = keep(f"pool{grid}", pool_forward(cells, grid))
        maps.append(linear(f"pyramid{grid}", cells))
    for large, small in pairwise(reversed(maps)):  # and what it hears, the small ones hear, too
        small += upsample_forward(large, small.shape[1] // large.shape[1])[0]
    heard = relu("pyramid", maps[0])

    joined = linear("fine", fine)
    joined += linear("up", heard).reshape(joined.shape)
    joined = relu("head", joined)
    # Classes first: the loss and the best class then run over contiguous memory.
    scores = np.ascontiguousarray(params["head.w"].T) @ joined.reshape(-1, WIDTH).T
    scores += params["head.b"][:, None]
    scores = keep("head", (scores, (joined, params["head.w"])))
    return scores.reshape(N_CLASSES, QUAD, *joined.shape[:-1]), cache


def standardise(rgb, dtype=np.float32):
    """Colours minus MEAN, over SPREAD, quad by quad: (B, H, W, 3) uint8 -> (B, H / 4, W / 4, 4, 12)."""
    B, H, W, _ = rgb.shape
    # The two rows of each quad, each of two pixels and so of six numbers that lie side by side.
    order = np.arange(H * W // 2).reshape(H // 4, 2, 2, W // 4, 2).transpose(0, 3, 1, 4, 2).ravel()
    flat = rgb.reshape(B, -1, 6).take(order, 1).astype(dtype)
    flat -= MEAN
    flat /= SPREAD
    return flat.reshape(B, H // 4, W // 4, 4, 12)


def heights(n, dtype=np.float32):
    """Heights of the quads in n rows of squares, from 1 down to -1, (n, 1, 4, 1). The camera never tilts."""
    rows = 1 - np.arange(2 * n, dtype=dtype) / (n - 0.5)
    return rows.reshape(n, 1, 2, 1).repeat(2, 2)


def backward(params, dscores, cache):
    """Gradients of all parameters from dscores (10, 4, B, 16, 16, 4), as a dict with the names of `params`."""
    grads = {}

    def back(step, name, dout):
        dx, grads[f"{name}.w"], db = step(dout, cache[name])
        if f"{name}.b" in params:
            grads[f"{name}.b"] = db
        return dx

    dhead = np.moveaxis(dscores.reshape(-1, *dscores.shape[2:]), 0, -1)
    djoined = relu_backward(back(linear_backward, "head", dhead), cache["head.relu"])
    dfine = back(linear_backward, "fine", djoined)

    dup = djoined.reshape(*djoined.shape[:3], -1)
    dheard = relu_backward(back(linear_backward, "up", dup), cache["pyramid.relu"])
    dx, dcells = back(linear_backward, "pyramid", dheard), 0
    for grid in GRIDS:
        dout = upsample_backward(dheard, (dheard.shape[1] // grid,))
        dcells = pool_backward(dcells + back(linear_backward, f"pyramid{grid}", dout), cache[f"pool{grid}"])
    dx += dcells

    for i in reversed(range(BLOCKS)):
        dsum = relu_backward(dx, cache[f"block{i}.second.relu"])
        dinner = back(conv_backward, f"block{i}.second", dsum)
        dx = dsum + back(conv_backward, f"block{i}.first", relu_backward(dinner, cache[f"block{i}.first.relu"]))

    dfine += back(linear_backward, "down", relu_backward(dx, cache["down.relu"])).reshape(dfine.shape)
    dstem = relu_backward(dfine, cache["stem.relu"])
    back(linear_backward, "stem", dstem)
    back(linear_backward, "height", dstem.sum((0, 2))[:, None])
    return grads


def predict(params, rgb, chunk=8):
    """Labels of each pixel: rgb (B, 64, 64, 3) uint8 -> (B, 64, 64) uint8. A chunk fits in the cache."""
    labels = np.empty(rgb.shape[:3], np.uint8)
    for i in range(0, len(rgb), chunk):
        scores, _ = forward(params, rgb[i:i + chunk], learning=False)
        best, quads = scores.max(0), np.zeros(scores.shape[1:], np.uint8)
        for k in range(1, N_CLASSES):  # the best class, of equals the last; many times faster than argmax over ten
            np.maximum(quads, (scores[k] == best) * np.uint8(k), out=quads)
        labels[i:i + chunk] = from_quads(quads)
    return labels


def train(params, rgb, labels, rng, epochs, batch=4, rate=8e-3, progress=None):
    """Fit `params` in place to views and their labels; half of the batches are seen mirrored.

    The rate rises over the first 20th of the steps and falls along a cosine to nearly 0.
    rgb (n, 64, 64, 3) uint8, labels (n, 64, 64) uint8; progress(share done, loss) is called after each batch
    """
    if not len(rgb) or labels.shape != rgb.shape[:3] or not np.issubdtype(labels.dtype, np.integer):
        raise ValueError("labels: expected integers for each pixel of at least one view, found "
                         f"{labels.dtype} {labels.shape} for views {rgb.shape}")
    if not 0 <= labels.min() <= labels.max() < N_CLASSES:
        raise ValueError(f"labels: expected 0..{N_CLASSES - 1}, found {labels.min()}..{labels.max()}")
    batch, epochs = min(check_count("batch", batch, 1), len(rgb)), check_count("epochs", epochs, 0)
    adam, n_batches = Adam(params), len(rgb) // batch  # of an epoch; what is left over waits for another one
    for epoch in range(epochs):
        batches = rng.permutation(len(rgb))[:n_batches * batch].reshape(n_batches, batch)
        for step, i in enumerate(batches, epoch * n_batches):
            x, y = rgb[i], labels[i]
            if rng.random() < 0.5:
                x, y = x[:, :, ::-1], y[:, :, ::-1]
            scores, cache = forward(params, x)
            loss, dscores = softmax_cross_entropy(scores, to_quads(y), axis=0)
            share = (step + 0.5) / (epochs * n_batches)
            adam.step(backward(params, dscores, cache), rate * min(1, 20 * share) * (1 + np.cos(np.pi * share)) / 2)
            if progress:
                progress((step + 1) / (epochs * n_batches), loss)


def accuracy(predicted, true):
    """Pixel accuracy, and mean intersection over union of the classes that occur in `true`."""
    both = np.bincount(true.ravel().astype(int) * N_CLASSES + predicted.ravel(), minlength=N_CLASSES ** 2)
    both = both.reshape(N_CLASSES, N_CLASSES).astype(float)
    hit, present = both.diagonal(), both.sum(1) > 0
    iou = hit[present] / (both.sum(0) + both.sum(1) - hit)[present]
    return hit.sum() / both.sum(), iou.mean()


def to_quads(images):
    """(B, H, W) -> (4, B, H / 4, W / 4, 4): pixel in its quad, view, square, quad in its square, in reading order."""
    B, H, W = images.shape
    return images.reshape(B, H // 4, 2, 2, W // 4, 2, 2).transpose(3, 6, 0, 1, 4, 2, 5).reshape(4, B, H // 4, W // 4, 4)


def from_quads(quads):
    """The inverse: (4, B, h, w, 4) -> (B, 4 h, 4 w)."""
    _, B, h, w, _ = quads.shape
    pairs = np.stack([quads[::2], quads[1::2]], -1)  # left and right pixel of each quad's upper, then lower row
    fours = pairs.reshape(2, B, h, w, 2, 4).view(f"V{4 * quads.itemsize}")[..., 0]  # in a row of the image
    return fours.transpose(1, 2, 4, 0, 3).copy().view(quads.dtype).reshape(B, 4 * h, 4 * w)


def save(params, path, made_by):
    """Write the weights and what made them."""
    save_arrays(path, made_by, **params)


def load(path):
    """Weights in a file written by `save`, and what made them; ValueError if they do not fit this net."""
    params, made_by = load_arrays(path)
    check_params(path, params, new_params(np.random.default_rng(0)))
    return params, made_by
