"""The graph convolution network: from a scene graph to scores of the places (section IV-B).

Two graph convolutions, the mean over nodes, a linear map. (The paper takes its network from the group's earlier
work; ours follows the group's code of 2021, but normalises sums over neighbours as in Kipf and Welling 2017.)

    H1 = ReLU(A_hat X W1 + b1)    X one-hot words, so X W1 is a lookup of rows of W1
    H2 = ReLU(A_hat H1 W2 + b2)   A_hat = D^-1/2 (A + I) D^-1/2
    g  = mean over nodes of H2,   scores = g W3 + b3

    B graphs   N nodes of all graphs, one after the other   F, G features   K places
"""

import numpy as np

from .checks import check_count
from .files import check_params, load_arrays, save_arrays
from .nn import Adam, linear_backward, linear_forward, relu_backward, relu_forward, softmax_cross_entropy
from .scene_graph import N_WORDS, sparse

HIDDEN = 128  # CHOICE: 256 in the group's code of 2021; no better here and twice the time
BATCH, RATE = 32, 0.001  # the paper's
EPOCHS = 100  # CHOICE: the paper says "training iterations"; a hundred batches of 32 views would teach next to nothing


def normalise_adjacency(edges, n_nodes, dtype=np.float32):
    """Symmetric normalisation of a graph with self-loops (Kipf and Welling 2017, eq. 2), sparse.

        A_hat = D^-1/2 (A + I) D^-1/2,   D = diag(row sums of A + I)

    edges (E, 2) int, each pair once -> (N, N), symmetric, largest eigenvalue 1; graphs of a batch are its blocks
    """
    _check_integers(edges)
    i, j = ends = edges.astype(int).T
    if ends.size and not 0 <= ends.min() <= ends.max() < n_nodes:
        raise ValueError(f"edges: expected nodes 0..{n_nodes - 1}, found {ends.min()}..{ends.max()}")
    # CHOICE: sums over neighbours are normalised; the group's code of 2021 sums plainly.
    loops = np.arange(n_nodes)
    rows, columns = np.concatenate([i, j, loops]), np.concatenate([j, i, loops])
    entries = np.sort(rows * n_nodes + columns, kind="stable")  # row by row
    if (entries[1:] == entries[:-1]).any():
        raise ValueError("edges: expected pairs of different nodes, each once, found one twice, or of a node alone")
    rows, columns = np.divmod(entries, n_nodes)
    degree = np.bincount(rows, minlength=n_nodes)
    scale = (1 / np.sqrt(degree)).astype(dtype)
    return sparse(scale[rows] * scale[columns], columns, np.append(0, degree.cumsum()), n_nodes)


def graph_convolution_forward(node_features, adjacency, weight, bias):
    """A_hat H W + b: each node mixes its own and its neighbours' features, then all nodes are mapped alike.

    node_features (N, F), adjacency (N, N), weight (F, G), bias (G,) -> (N, G); cache: A_hat H, A_hat, W
    """
    H, A, W = node_features, adjacency, weight
    AH = A @ H
    out = AH @ W
    out += bias
    return out, (AH, A, W)


def graph_convolution_backward(dout, cache):
    """dout (N, G) -> dH (N, F), dW (F, G), db (G,):  dH = A_hat dout W^T,  dW = (A_hat H)^T dout."""
    AH, A, W = cache
    return A @ (dout @ W.T), AH.T @ dout, dout.sum(0)  # A_hat is symmetric


def mean_forward(node_features, starts):
    """Mean over the nodes of each graph: (N, F), starts (B + 1,) -> (B, F); a graph without nodes gives zero.

    cache : nodes of each graph (B,)
    """
    H, count = node_features, np.diff(starts)  # CHOICE: a graph is the mean of its nodes; the paper names no readout.
    nodes_of = sparse(np.ones(len(H), H.dtype), np.arange(len(H)), starts, len(H))
    return nodes_of @ H / count.clip(1)[:, None].astype(H.dtype), (count,)


def mean_backward(dout, cache):
    """Every node of a graph gets the same share: (B, F) -> (N, F)."""
    count, = cache
    return np.repeat(dout / count.clip(1)[:, None].astype(dout.dtype), count, axis=0)


def lookup_backward(dout, words, n_words):
    """X^T dout for one-hot X: each word gathers the gradients of its nodes, (N, F) -> (n_words, F)."""
    nodes, count = np.argsort(words, kind="stable"), np.bincount(words, minlength=n_words)
    return sparse(np.ones(len(words), dout.dtype), nodes, np.append(0, count.cumsum()), len(words)) @ dout


def _check_words(words, n_words):
    """ValueError for words that are not whole numbers 0 .. n_words - 1."""
    if not np.issubdtype(words.dtype, np.integer):
        raise ValueError(f"words: expected integers, found {words.dtype}")
    if words.min(initial=0) < 0 or words.max(initial=0) >= n_words:
        raise ValueError(f"words: expected 0..{n_words - 1}, found {words.min()}..{words.max()}")


def _check_integers(edges):
    """ValueError unless edges are an array (E, 2) of integers."""
    if edges.ndim != 2 or edges.shape[1] != 2 or not np.issubdtype(edges.dtype, np.integer):
        raise ValueError(f"edges: expected integers of shape (E, 2), found {edges.dtype} {edges.shape}")


def _check_edges(graphs):
    """ValueError unless edges are pairs of nodes i < j of one graph, each once."""
    _check_integers(graphs.edges)
    i, j = graphs.edges.astype(int).T
    n = len(graphs.words)
    good = (i >= 0) & (i < j) & (j < n)
    good[good] = np.equal(*(np.searchsorted(graphs.starts, ends[good], side="right") for ends in (i, j)))
    if not good.all():
        raise ValueError(f"edges: expected nodes i < j of one graph, found {graphs.edges[~good][0]}")
    if len(np.unique(i * n + j)) < len(i):
        raise ValueError("edges: expected each pair once, found one twice")


class GCN:
    """Parameters and passes of the network; any `n_words` and `hidden` will do."""

    def __init__(self, n_places, rng=None, n_words=N_WORDS, hidden=HIDDEN, dtype=np.float32):
        rng = rng or np.random.default_rng(0)

        def glorot(n_in, n_out):
            bound = np.sqrt(6 / (n_in + n_out))
            return rng.uniform(-bound, bound, (n_in, n_out)).astype(dtype)

        self.params = {"W1": glorot(n_words, hidden), "b1": np.zeros(hidden, dtype),
                       "W2": glorot(hidden, hidden), "b2": np.zeros(hidden, dtype),
                       "W3": glorot(hidden, n_places), "b3": np.zeros(n_places, dtype)}

    @property
    def n_places(self):
        """K, the number of scores."""
        return len(self.params["b3"])

    def scores(self, graphs):
        """Scores of all places for each graph: SceneGraphs -> (B, K)."""
        _check_words(graphs.words, len(self.params["W1"]))
        return self.forward(graphs)[0]

    def forward(self, graphs):
        """Scores (B, K) and the cache that `backward` needs."""
        p = self.params
        A = normalise_adjacency(graphs.edges, len(graphs.words), p["W1"].dtype)
        # The words are one-hot: X W1 picks rows, and A_hat (X W1) costs less than (A_hat X) W1.
        Z1 = A @ p["W1"].take(graphs.words, 0)
        Z1 += p["b1"]
        H1, relu1 = relu_forward(Z1, out=Z1)
        Z2, conv2 = graph_convolution_forward(H1, A, p["W2"], p["b2"])
        H2, relu2 = relu_forward(Z2, out=Z2)
        g, mean = mean_forward(H2, graphs.starts)
        scores, last = linear_forward(g, p["W3"], p["b3"])
        return scores, (graphs.words, A, relu1, conv2, relu2, mean, last)

    def backward(self, dscores, cache):
        """Gradients of all parameters from dscores (B, K)."""
        words, A, relu1, conv2, relu2, mean, last = cache
        grads = {}
        dg, grads["W3"], grads["b3"] = linear_backward(dscores, last)
        dZ2 = relu_backward(mean_backward(dg, mean), relu2)
        dH1, grads["W2"], grads["b2"] = graph_convolution_backward(dZ2, conv2)
        dZ1 = relu_backward(dH1, relu1)
        grads["b1"] = dZ1.sum(0)
        grads["W1"] = lookup_backward(A @ dZ1, words, len(self.params["W1"]))
        return grads

    def save(self, path, made_by):
        """Write the weights and what made them."""
        save_arrays(path, made_by, **self.params)

    @classmethod
    def load(cls, path):
        """The network in a file written by `save`, and what made it."""
        params, made_by = load_arrays(path)
        n_words, hidden = params["W1"].shape if np.ndim(params.get("W1")) == 2 else (1, 1)
        gcn = cls(np.size(params.get("b3")), n_words=n_words, hidden=hidden)
        check_params(path, params, gcn.params)
        gcn.params = params
        return gcn, made_by


def train(gcn, graphs, places, rng, epochs=EPOCHS, batch=BATCH, rate=RATE, progress=None):
    """Fit `gcn` in place to graphs of known place by softmax cross-entropy and Adam.

    graphs : SceneGraphs of n views; places (n,) int; progress(share done, loss) is called after each epoch
    """
    places = np.asarray(places)
    _check_words(graphs.words, len(gcn.params["W1"]))
    _check_edges(graphs)
    if places.shape != (len(graphs),) or not len(places) or not np.issubdtype(places.dtype, np.integer):
        raise ValueError(f"places: expected an integer for each of the {len(graphs)} graphs, "
                         f"found {places.dtype} of shape {places.shape}")
    if not 0 <= places.min() <= places.max() < gcn.n_places:
        raise ValueError(f"places: expected 0..{gcn.n_places - 1}, found {places.min()}..{places.max()}")
    batch, epochs = check_count("batch", batch, 1), check_count("epochs", epochs, 0)
    if not 0 <= rate < np.inf:
        raise ValueError(f"rate: expected a finite number from 0 on, found {rate}")
    adam = Adam(gcn.params, rate)
    for epoch in range(epochs):
        order, losses = rng.permutation(len(places)), []
        for i in range(0, len(order), batch):
            picked = order[i:i + batch]
            scores, cache = gcn.forward(graphs[picked])
            loss, dscores = softmax_cross_entropy(scores, places[picked])
            adam.step(gcn.backward(dscores, cache))
            losses.append(loss)
        if progress:
            progress((epoch + 1) / epochs, np.mean(losses))
