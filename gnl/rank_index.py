"""Exact nearest neighbours among reciprocal-rank vectors; where there are many, faster than looking at every one.

The state of nearest-neighbour Q-learning is a ranking of K places, written as 1/rank: every vector is a
permutation of (1, 1/2, ..., 1/K). So all have the same length, the nearest is the one with the greatest dot
product, and two are near only if their first places agree, or nearly so. The index keeps vectors on shelves,
one for each first place, and looks only at those that can hold a neighbour (`most_beyond`). New vectors lie on
a pile until there are enough to put on the shelves. A robot that faces one more bare wall ranks the places as
it did at the last one: equal vectors share one row.

symbol     shape     meaning
points     (n, K)    all stored vectors in order of birth, float32; a point's id is its number
rows       (m, K)    the different ones: shelf after shelf, each by age, then the pile by age
queries    (B, K)    vectors whose neighbours are wanted
k          int       neighbours wanted
n_first    int       look at the first n_first points only: the store as it was when it held that many
"""

from bisect import bisect_left

import numpy as np

from .checks import check_count
from .kdtree import as_points, check_points, lengths

# Whatever these are, the answers are the same.
SMALL = 2000  # rows; up to this many stay on the pile, where it is fastest to look at every one
PILE = 500  # rows; this many go to the shelves together
DEEP = 8  # shelves; a query still unsure after these looks at every row


class RankIndex:
    """The answers of a `KDTree`, for reciprocal-rank vectors only."""

    def __init__(self, n_places):
        n_places = check_count("n_places", n_places, 1)
        self._values = (1 / np.arange(n_places, 0, -1)).astype(np.float32)  # of every vector, sorted
        self._most_beyond = most_beyond(n_places).tolist()
        # Summed in any order, a float32 dot product of K positive terms is off by at most K * 2^-24 of itself, and it
        # is at most pi^2 / 6. Twice that, since two are compared, and twice again, for the bound is rounded too.
        self._tolerance = 4 * n_places * 2 ** -24 * np.pi ** 2 / 6
        self._rows = np.empty((2, n_places), np.float32)  # doubled when full: the first m count
        self._shelves = [0] * (n_places + 1)  # vectors of first place p: rows shelves[p] to shelves[p + 1]
        self._oldest = []  # of each row, the oldest point that is this vector
        self._row_of = []  # of each point, its row
        self._copies = {}  # oldest of several equal points -> all of them, ascending
        self._known = {}  # hash of a vector -> oldest points of vectors with this hash: nearly always one

    def __len__(self):
        return len(self._row_of)

    @property
    def points(self):
        """All stored vectors, (n, K) float32, in order of birth; a copy."""
        return self._rows[self._row_of]

    def add(self, points):
        """Store points (n, K); returns their ids (n,), continuing those of the points already there."""
        points = self._check_ranks(points)
        ids = np.arange(len(self), len(self) + len(points))
        for new, vector in zip(ids.tolist(), points, strict=True):
            oldest = self._find(vector)
            if oldest >= 0:
                self._copies.setdefault(oldest, [oldest]).append(new)
                self._row_of.append(self._row_of[oldest])
            else:
                self._put_on_pile(vector, new)
        if len(self._oldest) > SMALL and len(self._oldest) - self._shelves[-1] >= PILE:
            self._tidy_up()
        return ids

    def find(self, points):
        """The oldest stored point that equals each of points (B, K), or -1: (B,)."""
        points = check_points(points, len(self._values))
        return np.array([self._find(vector) for vector in points], int)

    def query(self, points, k, n_first=None):
        """The k nearest stored points of each query, nearest first, ties to the older point.

        points  : (B, K) queries
        returns : distances (B, k) float64, ids (B, k); inf and -1 where there are fewer than k points

        Equals brute force: a query looks on until its k-th best is nearer than all it has not looked at.
        """
        queries = self._check_ranks(points)
        k = check_count("k", k, 1)
        n_first = len(self) if n_first is None else check_count("n_first", n_first, 0, len(self))
        if self._shelves[-1]:
            who, rows, unsure = self._look_on_shelves(queries, k, n_first)
        else:
            who, rows, unsure = [], [], list(range(len(queries)))
        if unsure:
            others, their_rows = self._look_at_all(queries[unsure], k, n_first)
            who, rows = who + [unsure[i] for i in others.tolist()], rows + their_rows.tolist()
        return self._settle(queries, who, rows, k, n_first)

    def _look_on_shelves(self, queries, k, n_first):
        """Pairs of a query and a row that may be among its k nearest; and the queries that need to see more."""
        start, end = self._shelves[-1], bisect_left(self._oldest, n_first, self._shelves[-1])
        on_pile = [()] * len(queries)
        if start < end:
            on_pile = products(queries, self._rows[start:end])  # of all together: much faster than one by one
        who, rows, unsure = [], [], []
        for i, (query, dots) in enumerate(zip(queries, on_pile, strict=True)):
            near = self._look(k, self._pieces(query, dots, n_first))
            if near is None:
                unsure.append(i)
            else:
                who += [i] * len(near)
                rows += near
        return who, rows, unsure

    def _pieces(self, query, on_pile, n_first):
        """Where a query (K,) looks: first row of a piece, its dot products, the most that any row beyond can have."""
        if len(on_pile):
            yield self._shelves[-1], on_pile, self._most_beyond[0]
        for depth in range(1, min(DEEP, len(query)) + 1):
            place = (query == 1 / depth).argmax()
            start = self._shelves[place]
            end = bisect_left(self._oldest, n_first, start, self._shelves[place + 1])
            yield start, self._rows[start:end] @ query, self._most_beyond[depth]

    def _look(self, k, pieces):
        """Rows whose dot product is among the k greatest, or too close to say; None if there may be more beyond."""
        best, seen = np.full(k, -1, np.float32), []  # -1: less than any
        for start, dots, beyond in pieces:
            best = np.concatenate([best, dots])
            best.partition(-k)  # the k greatest come last, and of them the least first
            best = best[-k:]
            seen.append((start, dots))
            enough = best[0] - self._tolerance
            if enough > beyond:
                return [start + i for start, dots in seen for i in (dots >= max(enough, 0)).nonzero()[0].tolist()]
        return None

    def _look_at_all(self, queries, k, n_first):
        """Pairs of a query and a row that may be among its k nearest."""
        dots = products(queries, self._rows[:len(self._oldest)])
        if n_first < len(self):
            dots[:, np.array(self._oldest) >= n_first] = -1
        m = dots.shape[1]
        enough = np.partition(dots, m - k)[:, m - k] - self._tolerance if m > k else np.zeros(len(dots))
        return (dots >= enough.clip(0)[:, None]).nonzero()

    def _settle(self, queries, who, rows, k, n_first):
        """Of the rows found for each query, and the copies of each, the k best points by exact distance."""
        exact = lengths(self._rows.take(rows, 0) - queries.take(who, 0).astype(float)).tolist() if rows else []
        near = [[] for _ in queries]  # (distance, point), few of each query
        for i, row, distance in zip(who, rows, exact, strict=True):
            oldest = self._oldest[row]
            near[i] += [(distance, point) for point in self._copies.get(oldest, (oldest,))[:k] if point < n_first]
        # The nearest first, the older of equals first.
        best = [sorted(points)[:k] + [(np.inf, -1)] * (k - len(points)) for points in near]
        best = np.array(best).reshape(-1, k, 2)
        return best[..., 0], best[..., 1].astype(int)

    def _find(self, vector):
        key = vector.tobytes()
        for oldest in self._known.get(hash(key), ()):
            if self._rows[self._row_of[oldest]].tobytes() == key:
                return oldest
        return -1

    def _put_on_pile(self, vector, new):
        m = len(self._oldest)
        if m == len(self._rows):
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
        self._rows[m] = vector
        self._row_of.append(m)
        self._oldest.append(new)
        self._known.setdefault(hash(vector.tobytes()), []).append(new)

    def _tidy_up(self):
        """From the pile to the shelves."""
        m = len(self._oldest)
        first = self._rows[:m].argmax(axis=1)
        order = first.argsort(kind="stable")  # the older stay before the younger
        self._rows[:m] = self._rows[order]
        self._oldest = np.array(self._oldest)[order].tolist()
        self._row_of = order.argsort()[self._row_of].tolist()
        self._shelves = first[order].searchsorted(np.arange(len(self._shelves))).tolist()

    def _check_ranks(self, points):
        """The points as float32 (n, K), or a ValueError if they are no reciprocal ranks."""
        points = as_points(points, len(self._values))
        wrong = np.sort(points, axis=1) != self._values
        if wrong.any():
            check_points(points, len(self._values))
            raise ValueError("points: expected reciprocal ranks (a KDTree takes any), in each row a permutation "
                             f"of 1, 1/2, ..., 1/{len(self._values)} in float32, found {points[wrong.any(axis=1)][0]}")
        return points


def products(queries, rows):
    """Dot products of all with all: (B, m). BLAS is nearly twice as fast this way round as with queries @ rows.T."""
    return (rows @ queries.T).T.copy()


def most_beyond(n_places):
    """Greatest dot product of a query with a vector whose first place is none of the query's first d: d = 0..K.

        q.s  <=  1 + sum_{i > r} 1/i^2,   r = d + 1

    Let s have its 1 where q has 1/r. By the rearrangement inequality q.s is greatest if all the rest pairs
    off in order: 1 with 1/2, 1/2 with 1/3, ..., 1/(r-1) with 1/r, and from there on 1/i with 1/i. So q.s is
    at most 1/r + sum_{i<r} 1/(i (i+1)) + sum_{i>r} 1/i^2 = 1 + sum_{i>r} 1/i^2, as the first sum telescopes
    to 1 - 1/r. The smaller q is where s has its 1, the smaller this bound. Beyond all K places there is nothing.
    """
    squares = 1 / np.arange(1, n_places + 1) ** 2
    return np.append(1 + squares.sum() - squares.cumsum(), -np.inf)
