"""Wrong answers to the exercises of chapter 06, each of which its grader must reject."""

import numpy as np


def star(own, middle):
    A = np.diag([own, *middle]).astype(float)
    A[0, 1:] = A[1:, 0] = 1 / np.sqrt(own * np.array(middle))
    A[np.diag_indices(4)] = 1 / np.diag(A)
    return A


def without_self_loops():
    return star(3, (1, 1, 1))


def means_of_neighbours():
    A = np.eye(4)
    A[0] = A[:, 0] = 1
    return A / A.sum(1, keepdims=True)


def adjacency(edges, n_nodes, loops=True, both=True):
    A = np.eye(n_nodes) if loops else np.zeros((n_nodes, n_nodes))
    i, j = edges.T
    A[i, j] = 1
    if both:
        A[j, i] = 1
    return A


def one_direction(edges, n_nodes):
    A = adjacency(edges, n_nodes, both=False)
    d = A.sum(1)
    return A / np.sqrt(np.outer(d, d))


def by_rows(edges, n_nodes):
    A = adjacency(edges, n_nodes)
    return A / A.sum(1, keepdims=True)


def without_the_root(edges, n_nodes):
    A = adjacency(edges, n_nodes)
    return A / np.outer(A.sum(1), A.sum(1))


def loops_added_after_counting(edges, n_nodes):
    A = adjacency(edges, n_nodes, loops=False)
    d = A.sum(1).clip(1)
    return (A + np.eye(n_nodes)) / np.sqrt(np.outer(d, d))


def as_if_symmetric(dout, H, A, W):
    return A @ dout @ W.T, (A @ H).T @ dout, dout.sum(0)


def neighbours_forgotten(dout, H, A, W):
    return A.T @ dout @ W.T, H.T @ dout, dout.sum(0)


def mean_for_sum(dout, H, A, W):
    return A.T @ dout @ W.T, (A @ H).T @ dout, dout.mean(0)


def written_once(dout, words, n_words):
    dW = np.zeros((n_words, dout.shape[1]))
    dW[words] += dout
    return dW


def one_row_too_few(dout, words, n_words):
    return np.eye(max(words, default=0) + 1)[words].T @ dout


def mean_of_equal_words(dout, words, n_words):
    X = np.eye(n_words)[words]
    return X.T @ dout / X.sum(0).clip(1)[:, None]


def mean_over_all(H, starts):
    return np.stack([H[begin:end].sum(0) / len(H) for begin, end in zip(starts, starts[1:], strict=False)])


def last_node_left_out(H, starts):
    return np.stack([H[begin:max(begin + 1, end - 1)].mean(0) for begin, end in zip(starts, starts[1:], strict=False)])


def sums(H, starts):
    return np.stack([H[begin:end].sum(0) for begin, end in zip(starts, starts[1:], strict=False)])


def one_for_nothing(H, starts):
    return np.stack([H[begin:end].mean(0) if end > begin else np.ones(H.shape[1])
                     for begin, end in zip(starts, starts[1:], strict=False)])


def one_empty_graph_at_the_end_alone(H, starts):
    begin = starts[:-1] if starts[-2] < len(H) else starts[:-2]
    sums = np.add.reduceat(H, begin)
    sums = np.concatenate([sums, np.zeros((len(starts) - 1 - len(sums), H.shape[1]))])
    count = np.diff(starts)
    return np.where(count[:, None] > 0, sums, 0) / count.clip(1)[:, None]


WRONG = {
    "6.1": [without_self_loops, means_of_neighbours],
    "6.2": [one_direction, by_rows, without_the_root, loops_added_after_counting],
    "6.3": [as_if_symmetric, neighbours_forgotten, mean_for_sum],
    "6.4": [written_once, one_row_too_few, mean_of_equal_words],
    "6.5": [mean_over_all, last_node_left_out, sums, one_for_nothing, one_empty_graph_at_the_end_alone],
}
