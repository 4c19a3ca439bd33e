"""Wrong answers to the exercises of chapter 04, each of which its grader must reject."""

import numpy as np


def checker(up=1.0, down=1.0, over=2.0, restore=True, relative=True, combine=max, entries=None, floor=1e-6):
    """A gradient checker with one slip."""
    def gradient_error(f, x, dx, eps=1e-6):
        errors = []
        for i in range(x.size)[:entries]:
            kept = x.flat[i]
            x.flat[i] = kept + up * eps
            high = f()
            x.flat[i] = kept - down * eps
            low = f()
            if restore:
                x.flat[i] = kept
            numeric, analytic = (high - low) / (over * eps), dx.flat[i]
            scale = max(floor, abs(numeric) + abs(analytic)) if relative else 1
            errors.append(abs(numeric - analytic) / scale)
        return combine(errors)

    return gradient_error


def nudges_a_copy(f, x, dx, eps=1e-6):
    x = x.copy()
    return checker()(f, x, dx, eps)


def sign_lost(f, x, dx, eps=1e-6):
    """Compares sizes only."""
    worst = 0.0
    for i in range(x.size):
        kept = x.flat[i]
        x.flat[i] = kept + eps
        up = f()
        x.flat[i] = kept - eps
        down = f()
        x.flat[i] = kept
        a, b = abs(up - down) / (2 * eps), abs(dx.flat[i])
        worst = max(worst, abs(a - b) / max(1e-6, a + b))
    return worst


def weight_not_transposed(dout, x, w):
    return dout @ w[:, :dout.shape[1]], x.T @ dout, dout.sum(0)


def transposed_dw(dout, x, w):
    return dout @ w.T, dout.T @ x, dout.sum(0)


def mean_for_db(dout, x, w):
    return dout @ w.T, x.T @ dout, dout.mean(0)


def mean_for_dw(dout, x, w):
    return dout @ w.T, x.T @ dout / len(x), dout.sum(0)


def softmax(scores, axis=1, shift=True):
    with np.errstate(all="ignore"):
        e = np.exp(scores - shift * scores.max(axis, keepdims=True))
        return e / e.sum(axis, keepdims=True)


def onehot(scores, labels):
    return np.eye(scores.shape[1])[labels]


def sum_for_mean(scores, labels):
    return softmax(scores) - onehot(scores, labels)


def sign_turned(scores, labels):
    return (onehot(scores, labels) - softmax(scores)) / len(labels)


def wrong_axis(scores, labels):
    return (softmax(scores, 0) - onehot(scores, labels)) / len(labels)


def unshifted(scores, labels):
    return (softmax(scores, shift=False) - onehot(scores, labels)) / len(labels)


def over_all_entries(scores, labels):
    return (softmax(scores) - onehot(scores, labels)) / scores.size


def row(dout, x, w, turn_dx, turn_dw=False):
    N = len(x)
    taps = range(3)
    dx = sum(np.pad(dout, 1)[u:u + N] * w[2 - u if turn_dx else u] for u in taps)
    dw = np.array([np.pad(x, 1)[u:u + N] @ dout for u in taps])
    return dx, dw[::-1] if turn_dw else dw


def unturned(dout, x, w):
    return row(dout, x, w, False)


def both_turned(dout, x, w):
    return row(dout, x, w, True, True)


def without_border(dout, x, w):
    dx, dw = row(dout, x, w, True)
    dx[0] = dx[-1] = 0
    return dx, dw


def cyclic(dout, x, w):
    dx, dw = row(dout, x, w, True)
    return sum(np.roll(dout, u - 1) * w[u] for u in range(3)), dw


def greatest_of_all_rows(scores, labels):
    p = np.exp(scores - scores.max())
    p /= p.sum(1, keepdims=True)
    p[np.arange(len(labels)), labels] -= 1
    return p / len(labels)


def clipped(scores, labels):
    return greatest_of_all_rows(np.clip(scores, -500, 500), labels)


WRONG = {
    "4.1": [checker(down=0.0, over=1.0), checker(over=1.0), checker(restore=False), checker(relative=False),
            checker(combine=np.mean), checker(entries=1), checker(combine=min), nudges_a_copy, sign_lost,
            checker(floor=1e-300), checker(floor=1)],
    "4.2": [weight_not_transposed, transposed_dw, mean_for_db, mean_for_dw],
    "4.3": [sum_for_mean, sign_turned, wrong_axis, unshifted, over_all_entries, greatest_of_all_rows, clipped],
    "4.4": [unturned, both_turned, without_border, cyclic],
    "4.5": [lambda: (81, 2320), lambda: (25, 2304), lambda: (9, 2320), lambda: (25, 160)],
}
