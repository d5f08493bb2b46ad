"""The parabolic curves of a spline: lines inside patches, and edges where K changes sign."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...generated import spline as grid
from ...runtime.spline.spline import Spline
from .chains import joined
from .classes import PatchClass
from .parabolic_lines import cubic_bernstein, lines_of
from .patches import Patches

__all__ = ["polylines_of"]

Array = NDArray[np.float64]
# The corners of the triangle by their parameters.
CORNERS = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
# A point of an edge within this distance of a corner, relative to the edge, is the corner.
AT_CORNER = 1e-9
# The distance from a segment, in cells, at which the sign of K is taken on both sides.
ASIDE = 1e-7


def polylines_of(spline: Spline, classes: NDArray[np.int8]) -> list[Array]:
    """Return the polylines (k, 2) where the Gaussian curvature vanishes or changes sign.

    They are exact: in each patch and along its edges these curves are straight in the parameters.
    """
    patches = Patches.of_spline(spline)
    lines = [
        (int(k), line.segment)
        for k in np.flatnonzero(classes == PatchClass.MIXED)
        for line in lines_of(patches[k : k + 1])
        if line.segment is not None
    ]
    inner = [_places(spline, np.array([k]), segment)[0] for k, segment in lines]
    segments = np.array([*inner, *_edges(spline, lines)]).reshape(-1, 2, 2)
    across = np.diff(segments, axis=1)[:, 0, ::-1] * [1.0, -1.0]
    across *= ASIDE / np.linalg.norm(across, axis=1, keepdims=True)
    middle = segments.mean(axis=1)
    left, right = (_signs(spline, patches, classes, middle + x) for x in (across, -across))
    period = [
        count if ends[0] == "periodic" else np.inf
        for count, ends in zip(spline.cells, spline.boundary, strict=True)
    ]

    def node(place: Array) -> Hashable:
        return tuple(np.round(np.mod(place + 0.1 * AT_CORNER, period) / AT_CORNER).tolist())

    pieces = [(node(x[0]), node(x[1]), x) for x in segments[left * right < 0]]
    return [spline.frame[:2] + x * spline.frame[2:] for x, _ in joined(pieces)]


def _places(spline: Spline, patch: NDArray[np.int64], local: Array) -> Array:
    """Return points (k, n, 2), in cells, from parameters (n, 2) relative to patches (k,)."""
    cell = np.stack(np.divmod(patch // 4, spline.cells[1]), axis=-1)
    return cell[:, None] + 0.5 + local @ grid.CORNERS[patch % 4]


def _edges(spline: Spline, lines: list[tuple[int, Array]]) -> Array:
    """Return the edges of patches (k, 2, 2), each once and cut where it meets parabolic lines."""
    corners = _places(spline, np.arange(spline.patches), CORNERS)
    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2, 2)
    names = np.round(4.0 * ends.mean(axis=1)).astype(np.int64)
    for axis, (count, kind) in enumerate(zip(spline.cells, spline.boundary, strict=True)):
        if kind[0] == "periodic":
            names[:, axis] %= 4 * count
    keys = names @ np.array([4 * spline.cells[1] + 1, 1])
    _, first, number = np.unique(keys, return_index=True, return_inverse=True)
    cuts: dict[int, set[float]] = defaultdict(lambda: {0.0, 1.0})
    for patch, segment in lines:
        for place in segment:
            weights = np.append(place, 1.0 - place.sum())
            for edge in range(3):
                share = float(weights[(edge + 1) % 3])
                if abs(weights[edge - 1]) <= AT_CORNER and AT_CORNER < share < 1.0 - AT_CORNER:
                    own = 3 * patch + edge
                    # The patch on the other side runs along the edge in reverse.
                    cuts[int(number[own])].add(share if first[number[own]] == own else 1.0 - share)
    whole = np.ones(len(first), dtype=bool)
    whole[list(cuts)] = False
    parts = [
        (1.0 - x) * ends[first[k], 0] + x * ends[first[k], 1]
        for k, shares in cuts.items()
        for pair in pairwise(sorted(shares))
        if pair[1] - pair[0] > AT_CORNER
        for x in [np.array(pair)[:, None]]
    ]
    return np.concatenate([ends[first[whole]], np.reshape(parts, (-1, 2, 2))])


def _signs(
    spline: Spline, patches: Patches, classes: NDArray[np.int8], places: Array
) -> NDArray[np.int64]:
    """Return the signs of K (k,) at points (k, 2), in cells; 0 outside, and where K is zero."""
    inside = np.ones(len(places), dtype=bool)
    for axis, (count, kind) in enumerate(zip(spline.cells, spline.boundary, strict=True)):
        if kind[0] == "periodic":
            places[:, axis] %= count
        inside &= (places[:, axis] >= 0.0) & (places[:, axis] < count)
    cell = np.where(inside[:, None], np.floor(places), 0.0).astype(np.int64)
    local = places - cell - 0.5
    # The triangles of a cell: south, east, north, west.
    steep = np.abs(local[:, 1]) > np.abs(local[:, 0])
    turn = np.where(steep, np.where(local[:, 1] < 0.0, 0, 2), np.where(local[:, 0] > 0.0, 1, 3))
    patch = 4 * (cell[:, 0] * spline.cells[1] + cell[:, 1]) + turn
    uv = np.einsum("kx,kxy->ky", local, np.linalg.inv(grid.CORNERS)[turn])
    D = np.einsum("kd,kd->k", cubic_bernstein(uv), patches.cubic[patch])
    of_patch = classes[patch]
    signs = np.where(of_patch == PatchClass.MIXED, np.sign(D), 0.0)
    signs[of_patch == PatchClass.ELLIPTIC], signs[of_patch == PatchClass.HYPERBOLIC] = 1.0, -1.0
    return np.where(inside, signs, 0.0).astype(np.int64)
