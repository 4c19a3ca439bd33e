"""Exercises of chapter 06. Fill in each function, then run this file."""

import numpy as np
from grader import expect, main

from gnl.nn import gradient_error


def predict():
    """Exercise 6.1: A_hat (4, 4) of the star: node 0 is a neighbour of 1, 2 and 3."""
    raise NotImplementedError("exercise 6.1")


def normalise(edges, n_nodes):
    """Exercise 6.2: A_hat = D^-1/2 (A + I) D^-1/2 as a full array: edges (E, 2), each pair once -> (N, N)."""
    raise NotImplementedError("exercise 6.2")


def backward(dout, H, A, W):
    """Exercise 6.3: gradients of A @ H @ W + b for any square A: dout (N, G) -> dH (N, F), dW (F, G), db (G,)."""
    raise NotImplementedError("exercise 6.3")


def lookup_backward(dout, words, n_words):
    """Exercise 6.4: gradient for W1 from dout (N, F), the one for W1[words]: words (N,) -> (n_words, F)."""
    raise NotImplementedError("exercise 6.4")


def mean_readout(H, starts):
    """Exercise 6.5: mean over the nodes of each graph: (N, F), starts (B + 1,) -> (B, F). Find the bug."""
    count = np.diff(starts)
    inner = starts[:-1].clip(0, len(H) - 1)
    return np.add.reduceat(H, inner) / count.clip(1)[:, None]


def grade_6_1(predict):
    r = 1 / np.sqrt(8)
    expect("A_hat", predict(), [[1 / 4, r, r, r], [r, 1 / 2, 0, 0], [r, 0, 1 / 2, 0], [r, 0, 0, 1 / 2]], 1e-3)


def grade_6_2(normalise):
    r = 1 / np.sqrt(6)
    chain = np.array([[0, 1], [1, 2]])
    expect("door, wall, sofa", normalise(chain, 3), [[1 / 2, r, 0], [r, 1 / 3, r], [0, r, 1 / 2]])
    expect("a node without neighbours", normalise(chain[:1], 3), [[.5, .5, 0], [.5, .5, 0], [0, 0, 1]])
    expect("no edges at all", normalise(np.zeros((0, 2), int), 2), np.eye(2))
    expect("its argument is left as it was", chain, [[0, 1], [1, 2]])


def grade_6_3(backward):
    rng = np.random.default_rng(0)
    A, H, W, b, dout = (rng.standard_normal(shape) for shape in ((6, 6), (6, 4), (4, 3), 3, (6, 3)))
    grads = backward(dout, H.copy(), A.copy(), W.copy())
    expect("number of gradients", len(grads), 3)
    for name, x, dx in zip(("dH", "dW", "db"), (H, W, b), grads, strict=True):
        expect(f"shape of {name}", str(np.shape(dx)), str(x.shape))
        error = gradient_error(lambda: ((A @ H @ W + b) * dout).sum(), x, np.asarray(dx), rng, 60)
        expect(f"{name}: relative error against central differences", error, 0, 1e-5)


def grade_6_4(lookup_backward):
    dout = np.array([[1., 2], [3, 4], [5, 6]])
    expect("words that differ", lookup_backward(dout, np.array([2, 0, 3]), 5), [[3, 4], [0, 0], [1, 2], [5, 6], [0, 0]])
    expect("a word that occurs twice", lookup_backward(dout, np.array([1, 0, 1]), 3), [[3, 4], [6, 8], [0, 0]])
    expect("no nodes", lookup_backward(dout[:0], np.zeros(0, int), 2), np.zeros((2, 2)))


def grade_6_5(mean_readout):
    H = np.array([[1., 2], [3, 4], [8, 6]])
    expect("two graphs", mean_readout(H, np.array([0, 2, 3])), [[2, 3], [8, 6]])
    expect("a graph without nodes between them", mean_readout(H, np.array([0, 2, 2, 3])), [[2, 3], [0, 0], [8, 6]])
    expect("one at the end", mean_readout(H, np.array([0, 3, 3])), [[4, 4], [0, 0]])
    expect("two at the end", mean_readout(H, np.array([0, 3, 3, 3])), [[4, 4], [0, 0], [0, 0]])
    expect("one at the beginning", mean_readout(H, np.array([0, 0, 3])), [[0, 0], [4, 4]])


TASKS = {
    "6.1": (predict, grade_6_1),
    "6.2": (normalise, grade_6_2),
    "6.3": (backward, grade_6_3),
    "6.4": (lookup_backward, grade_6_4),
    "6.5": (mean_readout, grade_6_5),
}

if __name__ == "__main__":
    main(TASKS)
