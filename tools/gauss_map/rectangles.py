"""Rectangles (k, 2, 2) of the parameter plane: the lower and the upper corner of each."""

from collections.abc import Sequence

import numpy as np

from ...runtime.base.aliases import Array, Flags


def merged(cells: Flags, lines: Sequence[Array]) -> Array:
    """Return rectangles that consist of the True cells of a grid, merged along v, then along u.

    `lines` are the parameters u and v of the nodes.
    """
    changes = np.argwhere(np.diff(cells, axis=1, prepend=False, append=False)).reshape(-1, 2, 2)
    i, j, k = changes[:, 0, 0], changes[:, 0, 1], changes[:, 1, 1]
    order = np.lexsort((i, k, j))
    i, j, k = i[order], j[order], k[order]
    new = np.append(True, (np.diff(i) != 1) | (np.diff(j) != 0) | (np.diff(k) != 0))[: len(i)]
    first, last = np.flatnonzero(new), np.flatnonzero(np.append(new[1:], True)[: len(i)])
    u, v = lines
    low, high = [u[i[first]], v[j[first]]], [u[i[last] + 1], v[k[first]]]
    return np.array([low, high]).transpose(2, 0, 1)
