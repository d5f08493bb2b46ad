"""Moving vertices of thin triangles inside their faces, to increase the smallest angles."""

import math

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ..meshes.mesh import cosines_of, tangents_of
from ..meshes.triangulated import LARGEST_DEVIATION
from .edges import Places, at_places
from .results import PartSpace

# Vertices of triangles with an angle below SMALL degrees move, at most ROUNDS times.
SMALL, ROUNDS = 30.0, 6
# The ratio of height and side of an equilateral triangle.
EVEN = math.sqrt(0.75)


def smoothed(
    space: PartSpace, pieces: Indices, known: Places, triangles: Indices, points: Array, free: Flags
) -> tuple[Places, Array]:
    """Move some of the `free` vertices; return the fields (C,) and points (C, 3) of all vertices.

    The smallest angle around a moved vertex grows. No triangle at a moved vertex deviates from the
    normals at its corners by more than `LARGEST_DEVIATION` degrees, unless it did so before.
    """
    known, points = Places._make(x.copy() for x in known), points.copy()
    for _ in range(ROUNDS):
        tangents, thin = tangents_of(points, triangles), np.zeros(len(points), dtype=np.bool_)
        thin[triangles[tangents < math.tan(math.radians(SMALL))]] = True
        chosen = np.flatnonzero(thin & free)
        rows, corners = np.nonzero((thin & free)[triangles])
        # The triangles at each chosen vertex, their corners permuted cyclically so that this vertex
        # comes first.
        around = triangles[rows[:, None], (corners[:, None] + np.arange(3)) % 3]
        owner = np.searchsorted(chosen, around[:, 0])
        steps = _steps(points[around], tangents[rows], owner, len(chosen))
        moved = _moved(space, pieces[chosen], known, chosen, steps)
        # At the boundary of its domain, a surface may be undefined.
        lost = ~np.isfinite(moved.vectors[:, 0]).all(axis=1)
        for mine, others in zip(moved, known, strict=True):
            mine[lost] = others[chosen[lost]]
        new = points[around], known.normals[around]
        new[0][:, 0], new[1][:, 0] = moved.vectors[owner, 0], moved.normals[owner]
        before = cosines_of(points, known.normals, around, np.ones_like(around))
        after = _tangents(*new, np.minimum(before, math.cos(math.radians(LARGEST_DEVIATION))))
        now, then = (_least(x, owner, len(chosen)) for x in (tangents[rows], after))
        better = then > now
        if not better.any():
            break
        at = _first(chosen, better, now, around, len(points))
        for mine, others in zip(known, moved, strict=True):
            mine[chosen[at]] = others[at]
        points[chosen[at]] = moved.vectors[at, 0]
    return known, points


def _steps(corners: Array, tangents: Array, owner: Indices, count: int) -> Array:
    """Return displacements (count, 3) of vertices; triangle i has vertex owner[i] as first corner.

    In each of its triangles `corners` (k, 3, 3), the side opposite to the vertex is the base of an
    equilateral triangle. The vertex moves to a weighted mean of the tips of these equilateral
    triangles; thin triangles have larger weights.
    """
    tip, one, other = corners.transpose(1, 0, 2)
    side, up = other - one, tip - (one + other) / 2.0
    lengths = np.linalg.norm(side, axis=1, keepdims=True)
    along = side / np.where(lengths > 0.0, lengths, 1.0)
    up -= np.einsum("kx,kx->k", up, along)[:, None] * along
    heights = np.linalg.norm(up, axis=1, keepdims=True)
    even = (one + other) / 2.0 + EVEN * lengths * up / np.where(heights > 0.0, heights, 1.0)
    weights = 1.0 / np.maximum(tangents, np.finfo(np.float64).eps) ** 2
    sums = [np.bincount(owner, weights * x, count) for x in (even - tip).T]
    return np.stack(sums, axis=1) / np.bincount(owner, weights, count)[:, None]


def _moved(
    space: PartSpace, pieces: Indices, known: Places, chosen: Indices, steps: Array
) -> Places:
    """Return the fields of chosen vertices after steps (k, 3) in the tangent plane."""
    x_u, x_v = known.vectors[chosen, 1:].transpose(1, 0, 2)
    E, F, G, a, b = (
        np.einsum("kx,kx->k", *x)
        for x in ((x_u, x_u), (x_u, x_v), (x_v, x_v), (x_u, steps), (x_v, steps))
    )
    square = E * G - F * F
    shares = np.stack([G * a - F * b, E * b - F * a], axis=1)
    uv = known.uv[chosen] + shares / np.where(square > 0.0, square, np.inf)[:, None]
    low, high = np.array([x.domain for x in space.pieces])[pieces].transpose(2, 0, 1)
    return at_places(space, pieces, np.clip(uv, low, high))


def _tangents(corners: Array, normals: Array, least: Array) -> Array:
    """Return tan(smallest angle) of each triangle (k, 3, 3), or −1 if it deviates from its normals.

    It deviates if the cosine of the angle between the triangle and the normal at one of its corners
    is below `least` (k,).
    """
    own = np.arange(3 * len(corners)).reshape(-1, 3)
    points, normals = corners.reshape(-1, 3), normals.reshape(-1, 3)
    cosines = cosines_of(points, normals, own, np.ones_like(own))
    return np.where(cosines < least, -1.0, tangents_of(points, own))


def _least(values: Array, owner: Indices, count: int) -> Array:
    found = np.full(count, np.inf)
    np.minimum.at(found, owner, values)
    return found


def _first(chosen: Indices, better: Flags, now: Array, around: Indices, count: int) -> Indices:
    """Return the vertices that move in this round, as indices in `chosen`.

    Only vertices that `better` flags move: their smallest angle grows. Of two such neighbours, only
    the vertex with the smaller angle moves.
    """
    rank = np.full(count, len(chosen))
    rank[chosen[better]] = np.argsort(np.argsort(now[better]))
    nearest = rank[around].min(axis=1)
    found = np.full(count, len(chosen))
    np.minimum.at(found, around[:, 0], nearest)
    return np.flatnonzero(better & (found[chosen] == rank[chosen]))
