"""Exact nearest neighbours among reciprocal-rank vectors, many times faster than looking at every vector.

The state of nearest-neighbour Q-learning is a ranking of K places, written as 1/rank: every vector is a
permutation of (1, 1/2, ..., 1/K). So all have one length, the nearest is the one with the greatest dot
product, and two are near only if their first places agree, or nearly so. The index keeps a bucket of vectors
for each first place and opens only those that can hold a neighbour (`reach_of`). A robot that faces one more
bare wall ranks the places as it did at the last one: equal vectors share one row.

symbol     shape     meaning
points     (n, K)    all stored vectors in order of birth, float32; a point's id is its row
queries    (B, K)    vectors whose neighbours are wanted
depth      int       open the buckets of a query's first `depth` places
k          int       neighbours wanted
n_first    int       look at the first n_first points only: the store as it was when it held so many
"""

from bisect import bisect_left
from functools import cache

import numpy as np

from .kdtree import check_count, check_points, lengths, pack_answers

SMALL = 2000  # points; up to here one bucket for all is faster than one per first place
DEPTHS = (1, 4, 16)  # tried in turn before all buckets are opened; any choice gives the same answers


class RankIndex:
    """The answers of a `KDTree`, for reciprocal-rank vectors only."""

    def __init__(self, n_places):
        n_places = check_count("n_places", n_places, 1)
        self._values = (1 / np.arange(1, n_places + 1)).astype(np.float32)  # of every vector, in some order
        self._buckets = {None: _Bucket(n_places)}  # by first place; a small store has this one for all
        self._homes = []  # of each point, its bucket and row
        self._copies = {}  # oldest of several equal points -> all of them, ascending
        # Summed in any order, a float32 dot product of K positive terms is off by at most K * 2^-24 of
        # itself, and it is at most pi^2 / 6. Twice that, since it is compared with another one.
        self._tolerance = 2 * n_places * 2 ** -24 * np.pi ** 2 / 6

    def __len__(self):
        return len(self._homes)

    @property
    def points(self):
        """All stored vectors, (n, K) float32, in order of birth; put together anew at each call."""
        points = np.empty((len(self), len(self._values)), np.float32)
        for i, (bucket, row) in enumerate(self._homes):
            points[i] = bucket.rows[row]
        return points

    def add(self, points):
        """Store points (n, K); returns their ids (n,), counted on from the points already there."""
        points = self._check_ranks(points)
        ids = np.arange(len(self), len(self) + len(points))
        for new, vector in zip(ids.tolist(), points, strict=True):
            if new == SMALL:
                self._deal_out()
            self._store(new, vector)
        return ids

    def _store(self, new, vector):
        first = None if None in self._buckets else int(vector.argmax())
        if first not in self._buckets:
            self._buckets[first] = _Bucket(len(vector))
        bucket = self._buckets[first]
        row = bucket.add(vector, new)
        oldest = bucket.ids[row]
        if oldest != new:
            self._copies.setdefault(oldest, [oldest]).append(new)
        self._homes.append((bucket, row))

    def _deal_out(self):
        """From one bucket for all to one per first place."""
        points = self.points
        self._buckets, self._homes, self._copies = {}, [], {}
        for i, vector in enumerate(points):
            self._store(i, vector)

    def query(self, points, k, n_first=None):
        """The k nearest stored points of each query, nearest first, ties to the older point.

        points  : (B, K) queries
        returns : distances (B, k) float64, ids (B, k); inf and -1 where there are fewer than k points

        Equals brute force: a query looks deeper until its k-th best is nearer than all it has not looked at.
        """
        queries = self._check_ranks(points)
        k = check_count("k", k, 1)
        n_first = len(self) if n_first is None else check_count("n_first", n_first, 0, len(self))
        distances, ids = np.empty((len(queries), k)), np.empty((len(queries), k), int)
        unsure = np.arange(len(queries))
        everything = len(self._values)
        for depth in (everything,) if None in self._buckets else (*DEPTHS, everything):
            distances[unsure], ids[unsure] = self._look(queries[unsure], depth, k, n_first)
            unsure = unsure[distances[unsure, -1] >= reach_of(depth)]  # equal: there may be an older point
            if not len(unsure):
                break
        return distances, ids

    def _look(self, queries, depth, k, n_first):
        """The k nearest points in the buckets of each query's first `depth` places."""
        who, ids = [], []  # pairs of a query and a point that may be among its k nearest
        for group, buckets in self._groups(queries, depth):
            Q = queries[group].T
            dots, owners = [], []
            for bucket in buckets:
                n = bisect_left(bucket.ids, n_first)
                dots.append(bucket.rows[:n] @ Q)
                owners += bucket.ids[:n]
            dots = np.concatenate(dots).T  # (queries in the group, rows in the buckets)
            n = len(owners)
            floor = np.partition(dots, n - k, axis=1)[:, n - k, None] - self._tolerance if n > k else 0
            rows, columns = (dots >= floor).nonzero()
            who += group[rows].tolist()
            ids += [owners[column] for column in columns.tolist()]
        return self._settle(queries, who, ids, k, n_first)

    def _groups(self, queries, depth):
        """Who opens which buckets: queries with one first place share the work, and at full depth all do."""
        if depth == len(self._values):
            return [(np.arange(len(queries)), self._buckets.values())]
        ranking = np.argsort(-queries, axis=1)[:, :depth] if depth > 1 else queries.argmax(axis=1)[:, None]
        groups = []
        for first in set(ranking[:, 0].tolist()):
            group = (ranking[:, 0] == first).nonzero()[0]
            places = self._buckets.keys() & set(ranking[group].ravel().tolist())
            if places:
                groups.append((group, [self._buckets[place] for place in places]))
        return groups

    def _settle(self, queries, who, ids, k, n_first):
        """Of the pairs (query, point) and the point's copies, the k best of each query by exact distance."""
        answers = [[] for _ in queries]
        if ids:
            vectors = np.stack([bucket.rows[row] for bucket, row in map(self._homes.__getitem__, ids)])
            exact = lengths(vectors - queries[who].astype(float))
            for query, distance, i in zip(who, exact.tolist(), ids, strict=True):
                copies = self._copies.get(i, [i])[:k]
                answers[query] += [(distance, copy) for copy in copies if copy < n_first]
        return pack_answers([sorted(pairs)[:k] for pairs in answers], k)

    def _check_ranks(self, points):
        """The points as float32 (n, K), or a ValueError if they are not reciprocal ranks."""
        points = check_points(points, len(self._values))
        wrong = (np.sort(points, axis=1)[:, ::-1] != self._values).any(axis=1)
        if wrong.any():
            raise ValueError("points: expected reciprocal ranks, in each row a permutation of 1, 1/2, ..., "
                             f"1/{len(self._values)} in float32, found {points[wrong][0]}")
        return points


@cache
def reach_of(depth):
    """No vector whose first place is not among a query's first `depth` places is nearer to it than this.

        |q - s|^2 = 2 (sum_i 1/i^2 - q.s)  >=  2 (1/2^2 + 1/3^2 + ... + 1/r^2),   r = depth + 1

    Let s have its 1 where q has 1/r. By the rearrangement inequality q.s is greatest if all the rest pairs
    off in order: 1 with 1/2, 1/2 with 1/3, ..., 1/(r-1) with 1/r, and from there on 1/i with 1/i. So q.s is
    at most 1/r + sum_{i<r} 1/(i (i+1)) + sum_{i>r} 1/i^2 = 1 + sum_{i>r} 1/i^2, as the first sum telescopes
    to 1 - 1/r. The less q has where s has its 1, the farther they are apart.
    """
    return np.sqrt(2 * (1 / np.arange(2, depth + 2) ** 2).sum()) * (1 - 1e-6)  # less: float32 rounds 1/i


class _Bucket:
    """Vectors that all differ, in contiguous rows, oldest first; the array doubles when full."""

    def __init__(self, n_places):
        self.rows = np.empty((2, n_places), np.float32)
        self.ids = []  # of each row, the oldest point that is this vector
        self._row_of = {}  # hash of a vector -> its row

    def add(self, vector, new):
        """The row of the vector (K,): the one that an equal vector has, or else a new one."""
        size = len(self.ids)
        row = self._row_of.setdefault(hash(vector.tobytes()), size)
        if row < size and (self.rows[row] == vector).all():
            return row
        if size == len(self.rows):
            rows = np.empty((2 * size, len(vector)), np.float32)  # reserve takes no memory until written to
            rows[:size], self.rows = self.rows, rows
        self.rows[size] = vector
        self.ids.append(new)
        return size
