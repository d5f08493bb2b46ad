"""A short path through samples: the shortest links are joined first, until there is one path."""

import numpy as np

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.trees import tree_of

# Links are sought between each end of a path and this number of nearest ends.
NEIGHBOURS = 8


def path_order(points: Array) -> Indices:
    """Return the indices (N,) of points (N, 3) along a short path.

    Each point is a path at first. In each round, links between neighbouring ends of paths are
    tried, the shortest first; a link between two different paths joins them. The rounds end when
    there is one path.
    """
    count, joined = len(points), 0
    links = [list[int]() for _ in range(count)]
    other_end = list(range(count))
    while joined < count - 1:
        ends = np.array([k for k in range(count) if len(links[k]) < 2])
        for a, b in _candidates(points[ends], ends):
            if len(links[a]) < 2 and len(links[b]) < 2 and other_end[a] != b:
                links[a].append(b)
                links[b].append(a)
                first, last = other_end[a], other_end[b]
                other_end[first], other_end[last] = last, first
                joined += 1
    order, before = [k for k in range(count) if len(links[k]) < 2][:1], -1
    while len(order) < count:
        (following,) = (k for k in links[order[-1]] if k != before)
        before = order[-1]
        order.append(following)
    return np.array(order, np.int64)


def _candidates(points: Array, numbers: Indices) -> list[tuple[int, int]]:
    """Return pairs of neighbouring points (k, 3) as pairs of indices, sorted by distance.

    The indices of the points are `numbers` (k,).
    """
    near, rows = tree_of(points).query(points, min(NEIGHBOURS, len(points)), workers=-1)
    first = np.repeat(np.arange(len(points)), near.shape[1])
    a, b = np.minimum(first, rows.ravel()), np.maximum(first, rows.ravel())
    order = np.lexsort((b, a, near.ravel()))
    order = order[a[order] < b[order]]
    return list(zip(numbers[a[order]].tolist(), numbers[b[order]].tolist(), strict=True))
