"""The scene graph: from labels to a graph of semantic words, exactly by the paper's rules (section IV-A).

A node is a part region: connected pixels of one class, at least 5000 of the 512 x 512. Its word joins what it is,
how large its box is and where in the image the box's centre lies. Boxes that overlap or are at most 20 px apart
make an edge.

    word = (class * 3 + size) * 9 + location,  0..269        location = row * 3 + column of a 3 x 3 grid
    size: S < S_o small 0, S_o <= S < 6 S_o medium 1, else large 2;  S area of the box, S_o a 16th of the image's

    B graphs   N nodes of all graphs, one graph after the other   E edges
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from .classes import N_CLASSES

VIEW_PX = 512  # all thresholds are stated in pixels of this view
SMALLEST_REGION_PX = 5000
FARTHEST_EDGE_PX = 20.0
SIZE_UNIT = 16  # S_o is a 16th of the image's area
N_SIZES, GRID = 3, 3
N_WORDS = N_CLASSES * N_SIZES * GRID * GRID


@dataclass(frozen=True)
class SceneGraphs:
    """The graphs of B views, one after the other; a batch of one is a graph.

    By hand, three nodes in a row: SceneGraphs(words, boxes, np.array([[0, 1], [1, 2]]), np.array([0, 3]),
    np.array([0, 2])); boxes may hold anything, (N, 4): a GCN does not look at them.
    """

    words: np.ndarray  # (N,) int
    boxes: np.ndarray  # (N, 4) px, half-open (x0, y0, x1, y1)
    edges: np.ndarray  # (E, 2) int, nodes i < j, sorted
    starts: np.ndarray  # (B + 1,) int: graph b holds the nodes starts[b]:starts[b + 1]
    edge_starts: np.ndarray  # (B + 1,) int: and the edges edge_starts[b]:edge_starts[b + 1]

    def __len__(self):
        return len(self.starts) - 1

    def __getitem__(self, chosen):
        """Graphs chosen as in an array: one by its number, several by slice, mask (B,) or numbers (n,) in order."""
        chosen = np.atleast_1d(np.arange(len(self))[chosen])
        starts, nodes = _spread(self.starts[chosen], self.starts[chosen + 1])
        edge_starts, edges = _spread(self.edge_starts[chosen], self.edge_starts[chosen + 1])
        shift = np.repeat(starts[:-1] - self.starts[chosen], np.diff(edge_starts))
        return SceneGraphs(self.words[nodes], self.boxes[nodes], self.edges[edges] + shift[:, None], starts,
                           edge_starts)


def _spread(begin, end):
    """Ranges [begin, end) one after the other: where each starts in the result (n + 1,), and the result."""
    count = end - begin
    starts = np.append(0, np.cumsum(count))
    return starts, np.arange(starts[-1]) + np.repeat(begin - starts[:-1], count)


def join(parts):
    """Several batches joined into one."""
    def starts(name):
        return np.append(0, np.concatenate([np.diff(getattr(part, name)) for part in parts]).cumsum())

    nodes_before = np.cumsum([0, *(len(part.words) for part in parts[:-1])])
    edges = np.concatenate([part.edges + n for part, n in zip(parts, nodes_before, strict=True)])
    return SceneGraphs(np.concatenate([part.words for part in parts]), np.concatenate([part.boxes for part in parts]),
                       edges, starts("starts"), starts("edge_starts"))


def scene_graph(labels):
    """Scene graphs of label images: (H, W) or (B, H, W) ints in 0..9, of any size -> SceneGraphs.

    Images of other sizes are measured in pixels of the 512 x 512 view: x * 512 / W, y * 512 / H.
    """
    labels = np.asarray(labels)
    if labels.ndim not in (2, 3) or not np.issubdtype(labels.dtype, np.integer) or 0 in labels.shape[-2:]:
        raise ValueError(f"labels: expected integers (H, W) or (B, H, W), found {labels.dtype} {labels.shape}")
    if labels.size and (labels.min() < 0 or labels.max() >= N_CLASSES):
        raise ValueError(f"labels: expected 0..{N_CLASSES - 1}, found {labels.min()}..{labels.max()}")
    labels = labels if labels.ndim == 3 else labels[None]
    view, label, area, boxes = regions(labels)
    H, W = labels.shape[1:]
    kept = area * VIEW_PX ** 2 >= SMALLEST_REGION_PX * H * W
    starts = np.searchsorted(view[kept], np.arange(len(labels) + 1))
    words = word_of(label[kept], boxes[kept], (W, H))
    boxes = boxes[kept] * VIEW_PX / [W, H, W, H]
    edges = edges_of(boxes, starts)
    return SceneGraphs(words, boxes, edges, starts, np.searchsorted(edges[:, 0], starts))


def regions(labels):
    """Part regions, connected pixels of one class: labels (B, H, W) -> view, class, area, boxes in pixels.

    Columns are cut into runs of one class; two runs of neighbouring columns that share a row and a class belong
    together. Regions come ordered by view, then by their first pixel, column by column.
    """
    B, H, W = labels.shape
    columns = np.ascontiguousarray(labels.transpose(0, 2, 1)).ravel()  # one column after the other
    begins = np.ones(len(columns) + H + 1, bool)  # whether a run begins at a pixel; past the last column, too
    np.not_equal(columns[1:], columns[:-1], out=begins[1:len(columns)])
    begins[::H] = True
    cuts = np.flatnonzero(begins[:len(columns) + 1])
    begin, end = cuts[:-1], cuts[1:]
    label, column, y0 = columns[begin], begin // H, begin % H

    # CHOICE: pixels are connected by their sides (4-connected); the paper says only "part region".

    # A run touches the runs of the next column from the one beside its first pixel to the one beside its last. The
    # latter is also beside the pixel just below the run, unless it ends there: then the run beside that is one too far.
    beside = np.searchsorted(cuts, cuts + H, side="right") - 1
    first, last = beside[:-1], beside[1:] - begins[end + H]
    count = np.where(column % W < W - 1, last - first + 1, 0)
    left = np.repeat(np.arange(len(begin)), count)
    _, right = _spread(first, first + count)
    same = np.flatnonzero(label[left] == label[right])
    n = len(begin)
    ends = np.append(0, np.bincount(left[same], minlength=n).cumsum())
    links = sparse(np.ones(len(same)), right[same], ends, n)
    region = connected_components(links, directed=False)[1]  # numbered in the order of their first runs

    order = region.argsort(kind="stable")  # region by region
    cut = np.flatnonzero(np.diff(region[order], prepend=-1))
    x, y0, y1 = (column % W)[order], y0[order], (y0 + end - begin)[order]
    low, high, total = np.minimum.reduceat, np.maximum.reduceat, np.add.reduceat
    boxes = np.stack([x[cut], low(y0, cut), high(x, cut) + 1, high(y1, cut)], 1)
    return column[order[cut]] // W, label[order[cut]].astype(int), total(y1 - y0, cut), boxes


def sparse(values, columns, starts, n_columns):
    """A sparse matrix row by row: row i holds values[starts[i]:starts[i + 1]], in the same slice of columns (CSR)."""
    # As int32: scipy would scan longer integers every time, to see whether these would do.
    return csr_matrix((values, columns.astype(np.int32), starts.astype(np.int32)), (len(starts) - 1, n_columns))


def word_of(label, boxes, size=(VIEW_PX, VIEW_PX)):
    """Word of each region: class (N,), boxes (N, 4) px of an image of that size -> (N,) in 0..269.

    In the image's own pixels all is in whole numbers, so a box or a centre just on a boundary is found to be there.
    """
    (x0, y0, x1, y1), (W, H) = boxes.T, size
    share = (x1 - x0) * (y1 - y0) * SIZE_UNIT  # S / S_o, times W H
    size_word = (share >= W * H).astype(int) + (share >= 6 * W * H)
    column, row = (x0 + x1) * GRID // (2 * W), (y0 + y1) * GRID // (2 * H)
    return (label * N_SIZES + size_word) * GRID * GRID + (row * GRID + column).astype(int)


def edges_of(boxes, starts):
    """Pairs of nodes of one graph whose boxes overlap or lie at most 20 px apart: (E, 2), i < j, sorted."""
    size = np.diff(starts)
    # Each node with those that follow it in its graph.
    following = np.repeat(starts[1:], size) - 1 - np.arange(len(boxes))
    i = np.repeat(np.arange(len(boxes)), following)
    _, j = _spread(np.arange(1, len(boxes) + 1), np.arange(1, len(boxes) + 1) + following)
    a, b = boxes[i], boxes[j]
    gap = np.maximum(a[:, :2] - b[:, 2:], b[:, :2] - a[:, 2:]).clip(0)  # (x, y), 0 where they overlap
    near = np.hypot(*gap.T) <= FARTHEST_EDGE_PX + 1e-9  # allow for rounding at just 20
    return np.stack([i[near], j[near]], 1)


def unpack_words(words):
    """The parts of each word, the inverse of `word_of`: (N,) -> list of (class, size, location), each from 0 on."""
    rest, location = np.divmod(words, GRID * GRID)
    label, size = np.divmod(rest, N_SIZES)
    return list(zip(label.tolist(), size.tolist(), location.tolist(), strict=True))
