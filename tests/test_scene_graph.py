"""Scene graphs obey the paper's rules at every boundary, whatever the image's size, and equal scipy's regions."""

from collections import Counter

import naive_learning
import numpy as np
import pytest

from data_gen.rooms import make_home
from gnl.camera import true_labels
from gnl.classes import BED, DOOR, FLOOR, OTHER, TABLE, WALL
from gnl.scene_graph import edges_of, regions, scene_graph, word_of, words_in_words

SMALL, MEDIUM, LARGE = range(3)


def image(*things, size=(512, 512)):
    """Labels of a wall before which things hang: (class, x0, y0, x1, y1) each, in pixels of the image."""
    labels = np.full(size, WALL, np.uint8)
    for label, x0, y0, x1, y1 in things:
        labels[y0:y1, x0:x1] = label
    return labels


def without_wall(labels):
    """The words of the image as triples (class, size, location), those of the wall left out."""
    return [word for word in words_in_words(scene_graph(labels).words) if word[0] != WALL]


def blobs(rng, height, width, n_classes=10):
    """Random labels in patches of a few pixels."""
    coarse = rng.integers(n_classes, size=(height // 4 + 1, width // 3 + 1), dtype=np.uint8)
    return coarse.repeat(4, 0).repeat(3, 1)[:height, :width]


def spiral(n):
    """One class that winds through another."""
    labels = np.zeros((n, n), np.uint8)
    for ring in range(0, n // 2, 2):
        low, high = ring, n - 1 - ring
        labels[low, max(low - 2, 0):high + 1] = labels[low:high + 1, high] = labels[high, low:high + 1] = 1
        labels[low + 2:high + 1, low] = 1
    return labels


IMAGES = {
    "noise": np.random.default_rng(0).integers(10, size=(64, 64)),
    "two classes": np.random.default_rng(1).integers(2, size=(512, 512)),
    "blobs": blobs(np.random.default_rng(2), 512, 512),
    "oblong": blobs(np.random.default_rng(3), 37, 101),
    "3 x 7": np.random.default_rng(4).integers(3, size=(3, 7)),
    "1 x 1": np.array([[4]]),
    "one row": np.array([[1, 1, 2, 1, 1, 1]]),
    "one column": np.array([[1, 1, 2, 1, 1, 1]]).T,
    "rows": np.arange(64)[:, None] // 3 % 10 + np.zeros((1, 64), int),
    "columns": np.arange(64)[None] // 3 % 10 + np.zeros((64, 1), int),
    "checkerboard": np.indices((64, 64)).sum(0) % 2,
    "spiral": spiral(64),
    "one class": np.full((64, 64), 7),
}


@pytest.mark.parametrize("name", IMAGES)
def test_regions_are_those_of_scipy(name):
    labels = IMAGES[name].astype(np.uint8)
    view, label, area, boxes = regions(labels[None])
    found = Counter(zip(label.tolist(), area.tolist(), map(tuple, boxes.tolist()), strict=True))
    assert found == Counter(naive_learning.regions(labels))
    assert not view.any()


def test_the_spiral_is_one_region_within_another():
    assert len(naive_learning.regions(spiral(64))) == 2


@pytest.mark.parametrize("size", [(512, 512), (64, 64), (96, 128), (384, 384), (100, 70), (7, 3)])
def test_graphs_are_those_of_the_rules_in_exact_fractions(size):
    rng = np.random.default_rng(0)
    for _ in range(20):
        corners = rng.integers(0, [size[1], size[0]] * 2, (6, 4))
        corners[:, 2:] = np.maximum(corners[:, 2:], corners[:, :2]) + 1
        labels = image(*((rng.integers(10), *box) for box in corners.tolist()), size=size)
        graph = scene_graph(labels)
        nodes, edges = naive_learning.scene_graph(labels)
        ours = list(zip(graph.words.tolist(), np.round(graph.boxes, 6).map if False else map(tuple, graph.boxes.round(6).tolist()), strict=True))
        plain = [(word, tuple(round(float(x), 6) for x in box)) for word, box in nodes]
        assert Counter(ours) == Counter(plain)
        assert ({frozenset((ours[i], ours[j])) for i, j in graph.edges}
                == {frozenset((plain[i], plain[j])) for i, j in edges})
