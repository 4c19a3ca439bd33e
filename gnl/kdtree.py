"""A KD-tree: exact nearest neighbours among any vectors, growing one point or many at a time (Bentley 1975).

Nearest-neighbour Q-learning asks of every view: which of my memories are most like this? A KD-tree answers
without looking at all of them. It cuts space in two, each half again, and so on, and never opens a box that
lies farther away than what it has found already. In 2-D that skips nearly everything. In 300-D, if points are
spread out, no box is far from a query. Rankings of views are kinder, but a box costs as much to measure as a point,
and one matrix product with all points is faster; `RankIndex` shows what it takes to do better there.

symbol     shape      meaning
points     (n, dim)   all stored vectors in order of birth, float32; a point's id is its row
queries    (B, dim)   vectors whose neighbours are wanted
low, high  (dim,)     corners of the smallest box around the points of a node
k          int        neighbours wanted
n_first    int        look at the first n_first points only: the store as it was when it held that many
"""

from heapq import heappop, heappush
from itertools import count

import numpy as np

from .checks import check_count

LEAF_SIZE = 32  # points; to look at this few at once costs hardly more than to choose between two boxes


class KDTree:
    """Exact nearest neighbours. Points may arrive in any order; if sorted, the tree grows deep and slow."""

    def __init__(self, dim):
        dim = check_count("dim", dim, 1)
        self._points = np.empty((LEAF_SIZE, dim), np.float32)  # doubled when full: the first n rows count
        self._n = 0
        self._root = _Node(dim)

    def __len__(self):
        return self._n

    @property
    def points(self):
        """All stored vectors, (n, dim) float32, in order of birth; a copy."""
        return self._points[:self._n].copy()

    def add(self, points):
        """Store points (n, dim); returns their ids (n,), continuing those of the points already there."""
        points = check_points(points, self._points.shape[1])
        ids = np.arange(self._n, self._n + len(points))
        self._n += len(points)
        while self._n > len(self._points):
            self._points = np.concatenate([self._points, np.empty_like(self._points)])
        self._points[ids] = points

        arrivals = [(self._root, ids)] if len(ids) else []
        while arrivals:  # a list, not recursion: the tree may be deeper than Python's stack
            node, new = arrivals.pop()
            node.enclose(self._points[new])
            if node.is_leaf:
                node.ids = np.concatenate([node.ids, new])
                if len(node.ids) <= LEAF_SIZE or (node.low == node.high).all():  # equal points: no way to cut
                    continue
                new = node.split(self._points)
            on_left = self._points[new, node.axis] <= node.cut
            halves = (node.left, new[on_left]), (node.right, new[~on_left])
            arrivals += [(child, half) for child, half in halves if len(half)]
        return ids

    def find(self, points):
        """The oldest stored point that equals each of points (B, dim), or -1: (B,). Only one leaf can hold it."""
        points, found = check_points(points, self._points.shape[1]), []
        for point in points:
            node = self._root
            while not node.is_leaf:
                node = node.left if point[node.axis] <= node.cut else node.right
            equal = node.ids[(self._points[node.ids] == point).all(axis=1)]
            found.append(equal.min() if len(equal) else -1)
        return np.array(found, int)

    def query(self, points, k, n_first=None):
        """The k nearest stored points of each query, nearest first, ties to the older point.

        points  : (B, dim) queries
        returns : distances (B, k) float64, ids (B, k); inf and -1 where there are fewer than k points
        """
        queries = check_points(points, self._points.shape[1]).astype(float)
        k = check_count("k", k, 1)
        n_first = self._n if n_first is None else check_count("n_first", n_first, 0, self._n)
        distances, ids = np.full((len(queries), k), np.inf), np.full((len(queries), k), -1)
        for i, query in enumerate(queries):
            for j, answer in enumerate(self._nearest(query, k, n_first)):
                distances[i, j], ids[i, j] = answer
        return distances, ids

    def _nearest(self, query, k, n_first):
        """Best-first search for one query (dim,): open the nearest box, until it is beyond the k-th best."""
        best = []  # the k nearest so far, ascending: (distance, id)
        births = count()  # settles ties in the heap, which cannot compare nodes
        boxes = [(0.0, next(births), self._root)]
        while boxes:
            distance, _, node = heappop(boxes)
            if len(best) == k and distance > best[-1][0]:  # at equal distance there may be an older point
                break
            if node.is_leaf:
                ids = node.ids[node.ids < n_first]
                distances = lengths(self._points[ids] - query)
                best = sorted(best + list(zip(distances.tolist(), ids.tolist(), strict=True)))[:k]
            else:
                for child in (node.left, node.right):
                    heappush(boxes, (child.distance_to(query), next(births), child))
        return best


class _Node:
    """A box of space: a leaf, which holds ids, or a cut into `left` (x[axis] <= cut) and `right`."""

    def __init__(self, dim):
        self.low = np.full(dim, np.inf, np.float32)
        self.high = np.full(dim, -np.inf, np.float32)
        self.ids = np.empty(0, int)
        self.axis = self.cut = self.left = self.right = None

    @property
    def is_leaf(self):
        return self.axis is None

    def enclose(self, points):
        """Widen the box to hold points (n, dim) too."""
        self.low = np.minimum(self.low, points.min(axis=0))
        self.high = np.maximum(self.high, points.max(axis=0))

    def distance_to(self, query):
        """Distance from query (dim,) to the box: to the query clipped to the box, which is its nearest point.

        Never above the distance to a point in the box, not even by rounding: no coordinate differs by more,
        and `lengths` rounds both in the same order, monotonically.
        """
        return lengths((query.clip(self.low, self.high) - query)[None])[0]

    def split(self, points):
        """Cut a leaf across its widest side at the median; returns its ids, which now belong to the children.

        The cut is the greatest value below the median, or the least of all if none is below: no half is ever empty.
        """
        self.axis = int(np.argmax(self.high.astype(float) - self.low))
        values = points[self.ids, self.axis]
        median = np.sort(values)[len(values) // 2]
        self.cut = values[values < median].max(initial=self.low[self.axis])
        self.left, self.right = _Node(len(self.low)), _Node(len(self.low))
        ids, self.ids = self.ids, None
        return ids


# Shared by all indexes.

def lengths(differences):
    """Euclidean lengths of the rows of (n, dim) -> (n,)."""
    return np.sqrt((differences ** 2).sum(axis=1))


def check_points(points, dim):
    """The points as float32 (n, dim), or a ValueError that says what is wrong with them."""
    points = as_points(points, dim)
    if not np.isfinite(points).all():
        raise ValueError(f"points: expected finite float32 values, found {points[~np.isfinite(points)][0]}")
    return points


def as_points(points, dim):
    """The points as float32 (n, dim), or a ValueError; what is too great for float32 becomes inf."""
    points = np.asarray(points)
    if points.dtype != np.float32:
        with np.errstate(over="ignore"):
            points = points.astype(np.float32)
    if points.ndim != 2 or points.shape[1] != dim:
        raise ValueError(f"points: expected shape (n, {dim}), found {points.shape}")
    return points
