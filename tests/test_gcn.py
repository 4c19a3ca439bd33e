"""The GCN is its dense algebra, has the right gradient, does not see the order of nodes, and learns."""

from dataclasses import replace

import naive_learning
import numpy as np
import pytest
from scipy.linalg import eigvalsh

from gnl import gcn, nn
from gnl.files import save_arrays
from gnl.scene_graph import SceneGraphs

N_WORDS, HIDDEN, K = 11, 6, 5
SIZES = (5, 1, 0, 3, 7, 0)  # nodes of each graph


def graphs_of(parts):
    """SceneGraphs of a list of (words, edges)."""
    starts = np.cumsum([0, *(len(words) for words, _ in parts)])
    edge_starts = np.cumsum([0, *(len(edges) for _, edges in parts)])
    words = np.concatenate([np.array(words, int) for words, _ in parts])
    edges = np.concatenate([np.reshape(edges, (-1, 2)).astype(int) + start
                            for (_, edges), start in zip(parts, starts, strict=False)])
    return SceneGraphs(words, np.zeros((len(words), 4)), edges, starts, edge_starts)


def random_parts(seed, sizes=SIZES, n_words=N_WORDS):
    """Graphs of these sizes as (words, edges): about half of all pairs are neighbours."""
    rng = np.random.default_rng(seed)
    pairs = [[(i, j) for i in range(n) for j in range(i + 1, n) if rng.random() < 0.5] for n in sizes]
    return [(rng.integers(n_words, size=n), edges) for n, edges in zip(sizes, pairs, strict=True)]


def net(seed=0, n_places=K, n_words=N_WORDS, hidden=HIDDEN):
    """A GCN in float64 in which no parameter is zero."""
    rng = np.random.default_rng(seed)
    made = gcn.GCN(n_places, rng, n_words, hidden, np.float64)
    for p in made.params.values():
        p += 0.1 * rng.standard_normal(p.shape)
    return made


@pytest.mark.parametrize("n_nodes", [1, 2, 3, 8, 20])
def test_normalised_adjacency_is_that_of_dense_algebra(n_nodes):
    edges = random_parts(0, (n_nodes,))[0][1]
    A = gcn.normalise_adjacency(np.reshape(edges, (-1, 2)).astype(int), n_nodes, np.float64).toarray()
    np.testing.assert_allclose(A, naive_learning.normalise_adjacency(edges, n_nodes))
    np.testing.assert_array_equal(A, A.T)
    np.testing.assert_allclose(eigvalsh(A)[-1], 1)


def test_graphs_of_a_batch_are_blocks_of_the_adjacency():
    parts = random_parts(1)
    graphs = graphs_of(parts)
    A = gcn.normalise_adjacency(graphs.edges, len(graphs.words), np.float64).toarray()
    for (words, edges), start in zip(parts, graphs.starts, strict=False):
        block = slice(start, start + len(words))
        np.testing.assert_allclose(A[block, block], naive_learning.normalise_adjacency(edges, len(words)))
        A[block, block] = 0
    assert not A.any()


def test_gradient_of_a_graph_convolution_is_that_of_central_differences():
    rng = np.random.default_rng(0)
    H, W, b = rng.standard_normal((7, 4)), rng.standard_normal((4, 3)), rng.standard_normal(3)
    A = gcn.normalise_adjacency(np.array(random_parts(2, (7,))[0][1]), 7, np.float64)
    out, cache = gcn.graph_convolution_forward(H, A, W, b)
    dout = rng.standard_normal(out.shape)

    def loss():
        return (gcn.graph_convolution_forward(H, A, W, b)[0] * dout).sum()

    for x, dx in zip((H, W, b), gcn.graph_convolution_backward(dout, cache), strict=True):
        assert nn.gradient_error(loss, x, dx, rng) < 1e-6


def test_mean_is_over_the_nodes_of_each_graph_and_its_gradient_that_of_central_differences():
    rng = np.random.default_rng(0)
    starts, H = np.cumsum([0, *SIZES]), rng.standard_normal((sum(SIZES), 4))
    out, cache = gcn.mean_forward(H, starts)
    for b, size in enumerate(SIZES):
        np.testing.assert_allclose(out[b], H[starts[b]:starts[b] + size].mean(0) if size else 0)
    dout = rng.standard_normal(out.shape)
    dH = gcn.mean_backward(dout, cache)
    assert nn.gradient_error(lambda: (gcn.mean_forward(H, starts)[0] * dout).sum(), H, dH, rng) < 1e-6


def test_gradient_of_the_lookup_is_the_product_with_one_hot_rows():
    words, dout = np.array([4, 1, 4, 4, 0]), np.random.default_rng(0).standard_normal((5, 3))
    np.testing.assert_allclose(gcn.lookup_backward(dout, words, 7), np.eye(7)[words].T @ dout)
    assert not gcn.lookup_backward(dout[:0], words[:0], 7).any()


def test_every_gradient_is_that_of_central_differences():
    rng, model, graphs = np.random.default_rng(0), net(), graphs_of(random_parts(3))
    places = rng.integers(K, size=len(SIZES))
    scores, cache = model.forward(graphs)
    grads = model.backward(nn.softmax_cross_entropy(scores, places)[1], cache)
    assert grads.keys() == model.params.keys()
    for name, p in model.params.items():
        assert grads[name].shape == p.shape
        error = nn.gradient_error(lambda: nn.softmax_cross_entropy(model.scores(graphs), places)[0], p, grads[name],
                                  rng, probes=60)
        assert error < 1e-6, name


@pytest.mark.parametrize("seed", range(5))
def test_scores_are_those_of_dense_algebra_on_one_hot_words(seed):
    parts, model = random_parts(seed), net(seed)
    scores = model.scores(graphs_of(parts))
    assert scores.shape == (len(parts), K)
    for (words, edges), ours in zip(parts, scores, strict=True):
        np.testing.assert_allclose(ours, naive_learning.gcn_scores(model.params, words, edges), atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_nodes_and_of_edges_changes_nothing(seed):
    rng, model = np.random.default_rng(seed), net()
    words, edges = random_parts(seed, (9,))[0]
    order = rng.permutation(9)  # the node that was order[i] is now node i
    now = np.argsort(order)
    renamed = [sorted((now[i], now[j])) for i, j in edges]
    shuffled = rng.permutation(np.array(edges))
    turned = np.array(edges)[:, ::-1]
    before = model.scores(graphs_of([(words, edges)]))
    for same in ((words[order], sorted(renamed)), (words[order], renamed), (words, shuffled), (words, turned)):
        np.testing.assert_allclose(model.scores(graphs_of([same])), before, atol=1e-12)
    assert abs(model.scores(graphs_of([(words, edges[:-1])])) - before).max() > 1e-6  # but edges do matter


def test_a_batch_is_its_graphs_one_by_one():
    graphs, model = graphs_of(random_parts(4)), net()
    one_by_one = np.concatenate([model.scores(graph) for graph in graphs])
    np.testing.assert_allclose(model.scores(graphs), one_by_one, atol=1e-12)


def test_a_graph_without_nodes_gets_the_bias():
    model = net()
    empty = graphs_of([([], [])] * 3)
    scores, cache = model.forward(empty)
    np.testing.assert_array_equal(scores, np.tile(model.params["b3"], (3, 1)))
    grads = model.backward(np.ones_like(scores), cache)
    assert {name for name, g in grads.items() if g.any()} == {"b3"}


def test_scores_are_float32_unless_asked_otherwise():
    model, graphs = gcn.GCN(K, n_words=N_WORDS, hidden=HIDDEN), graphs_of(random_parts(0))
    scores, cache = model.forward(graphs)
    assert {a.dtype for a in (scores, *model.backward(scores, cache).values())} == {np.dtype(np.float32)}


def toy(n, seed):
    """Six places: which of two words there is twice, and to how many of those two the other word is a neighbour."""
    rng = np.random.default_rng(seed)
    places = rng.integers(6, size=n)
    edges = ([], [(0, 2)], [(0, 2), (1, 2)])
    return graphs_of([([p % 2, p % 2, 1 - p % 2], edges[p // 2]) for p in places]), places


@pytest.mark.parametrize(("n_places", "n_words"), [(6, 2), (9, 270)])
def test_training_tells_graphs_apart_even_if_some_places_and_words_are_never_seen(n_places, n_words):
    model, losses = gcn.GCN(n_places, np.random.default_rng(0), n_words, hidden=16), []
    gcn.train(model, *toy(200, 0), np.random.default_rng(1), epochs=40, rate=0.02,
              progress=lambda share, loss: losses.append((share, loss)))
    graphs, places = toy(60, 1)
    np.testing.assert_array_equal(model.scores(graphs).argmax(1), places)
    assert [share for share, _ in losses] == [(i + 1) / 40 for i in range(40)]
    assert losses[-1][1] < 0.2 < losses[0][1]
    assert model.n_places == n_places


@pytest.mark.parametrize(("n_places", "n_words", "hidden"), [(1, 1, 1), (3, 1000, 2), (700, 12, 4)])
def test_any_number_of_places_words_and_features_will_do(n_places, n_words, hidden):
    model = gcn.GCN(n_places, np.random.default_rng(0), n_words, hidden)
    graphs = graphs_of(random_parts(0, n_words=n_words))
    gcn.train(model, graphs, np.arange(len(graphs)) % n_places, np.random.default_rng(0), epochs=2)
    assert model.scores(graphs).shape == (len(graphs), n_places)
    assert np.isfinite(model.scores(graphs)).all()


def test_one_seed_trains_one_network():
    models = [gcn.GCN(6, np.random.default_rng(0), 2, 16) for _ in range(2)]
    for model in models:
        gcn.train(model, *toy(50, 0), np.random.default_rng(1), epochs=3)
    for name, p in models[0].params.items():
        np.testing.assert_array_equal(p, models[1].params[name])


def test_a_saved_network_is_read_back_as_it_was(tmp_path):
    model, graphs = gcn.GCN(K, np.random.default_rng(7), N_WORDS, HIDDEN), graphs_of(random_parts(0))
    model.save(tmp_path / "gcn.npz", {"home": 800})
    again, made_by = gcn.GCN.load(tmp_path / "gcn.npz")
    assert made_by == {"home": 800}
    assert again.n_places == K
    np.testing.assert_array_equal(again.scores(graphs), model.scores(graphs))
    assert again.scores(graphs).dtype == np.float32


@pytest.mark.parametrize("change", [
    {"W4": np.zeros((2, 2))}, {"W2": None}, {"W2": np.zeros((HIDDEN, HIDDEN + 1))}, {"W1": np.zeros(N_WORDS)},
    {"b1": np.zeros(HIDDEN + 1)}, {"W3": np.zeros((HIDDEN + 1, K))}, {"b3": np.zeros(())},
], ids=lambda change: next(iter(change)))
def test_a_file_that_is_no_network_is_refused(tmp_path, change):
    arrays = gcn.GCN(K, None, N_WORDS, HIDDEN).params | change
    save_arrays(tmp_path / "gcn.npz", "a test", **{name: a for name, a in arrays.items() if a is not None})
    with pytest.raises(ValueError, match=r"gcn\.npz: .*expected .*, found "):
        gcn.GCN.load(tmp_path / "gcn.npz")


@pytest.mark.parametrize(("how", "complaint"), [
    ({"batch": 0}, "batch: expected a whole number from 1 on, found 0"), ({"batch": 2.0}, "batch: .* found 2.0"),
    ({"epochs": -1}, "epochs: expected a whole number from 0 on, found -1"), ({"epochs": 1.0}, "epochs: .* found 1.0"),
    ({"rate": np.nan}, "rate: expected a finite number from 0 on, found nan")], ids=str)
def test_a_training_that_cannot_be_is_refused(how, complaint):
    with pytest.raises(ValueError, match=complaint):
        gcn.train(net(), graphs_of(random_parts(0)), np.zeros(len(SIZES), int), np.random.default_rng(0), **how)


@pytest.mark.parametrize(("words", "edges", "complaint"), [
    ([1, 2, 3], [[0, 5]], "edges: expected nodes 0..2, found 0..5"),
    ([1, 2, 3], [[-1, 0]], "edges: expected nodes 0..2, found -1..0"),
    ([1.0, 2.0, 3.0], [[0, 1]], "words: expected integers, found float64")], ids=str)
def test_graphs_made_by_hand_of_nodes_or_words_that_are_none_have_no_scores(words, edges, complaint):
    graphs = SceneGraphs(np.array(words), np.zeros((3, 4)), np.array(edges), np.array([0, 3]), np.array([0, 1]))
    with pytest.raises(ValueError, match=complaint):
        net().scores(graphs)


def test_edges_may_be_of_any_kind_of_integer():
    graphs = graphs_of(random_parts(0))
    small = replace(graphs, edges=graphs.edges.astype(np.uint64))
    np.testing.assert_array_equal(net().scores(small), net().scores(graphs))


@pytest.mark.parametrize("places", [[0, 1, 2], [], [0] * 5 + [K], [0] * 5 + [-1], [0.5] * 6, [True] * 6], ids=str)
def test_training_without_one_known_place_for_each_graph_is_refused(places):
    with pytest.raises(ValueError, match="places: expected .*, found "):
        gcn.train(net(), graphs_of(random_parts(0)), places, np.random.default_rng(0))


@pytest.mark.parametrize(("edges", "words"), [
    ([(0, 1), (0, 1)], "each once, found one twice"), ([(0, 1), (1, 0)], "each once, found one twice"),
    ([(2, 2)], "or of a node alone"), (np.empty((0, 2)), r"edges: expected integers of shape \(E, 2\), found float64"),
    ([0, 1], r"edges: expected integers of shape \(E, 2\), found int64 \(2,\)")])
def test_scores_of_edges_that_are_no_pairs_are_refused(edges, words):
    graphs = SceneGraphs(np.zeros(3, int), np.zeros((3, 4)), np.asarray(edges), np.array([0, 3]), np.array([0, 2]))
    with pytest.raises(ValueError, match=words):
        net().scores(graphs)


def test_training_on_edges_that_are_no_whole_numbers_is_refused():
    graphs = SceneGraphs(np.zeros(3, int), np.zeros((3, 4)), np.array([[0.2, 1.7]]), np.array([0, 3]), np.array([0, 1]))
    with pytest.raises(ValueError, match="edges: expected integers"):
        gcn.train(net(), graphs, [0], np.random.default_rng(0))


def test_words_that_the_network_does_not_know_are_refused():
    few = gcn.GCN(K, np.random.default_rng(0), n_words=3)
    for words in ([0, 3], [-1, 2]):
        graphs = graphs_of([(words, [(0, 1)])])
        for use in (few.scores, lambda graphs: gcn.train(few, graphs, [0], np.random.default_rng(0))):
            with pytest.raises(ValueError, match=rf"words: expected 0\.\.2, found {words[0]}\.\.{words[1]}"):
                use(graphs)


@pytest.mark.parametrize(("edges", "words"), [
    ([(0, 1), (1, 0)], r"nodes i < j of one graph, found \[1 0\]"), ([(1, 1)], r"nodes i < j .* found \[1 1\]"),
    ([(1, 2)], r"nodes i < j .* found \[1 2\]"), ([(0, 99)], r"nodes i < j .* found \[ 0 99\]"),
    ([(0, 1), (0, 1)], "each pair once, found one twice")],
    ids=["both ways", "to itself", "to another graph", "to nowhere", "twice"])
def test_training_on_edges_that_are_no_pairs_of_one_graph_is_refused(edges, words):
    with pytest.raises(ValueError, match=f"edges: expected {words}"):
        gcn.train(net(), graphs_of([([0, 1], edges), ([2], [])]), [0, 1], np.random.default_rng(0))
