"""Solid angles of Gaussian images: line integrals along the arcs of their boundaries."""

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...generated.gaussian_image import boundary_arc
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.directions.unit import unit_or_zero
from .kernels.solid_angle import integrate_arcs

Array = NDArray[np.float64]
# The least cosine between the normals of one triangle and their mean; wider triangles are
# subdivided.
NARROW = 0.5
# A sum of unit normals shorter than this counts as having no direction.
SMALL = 1e-9
# Around a singular point inside a triangle, wide triangles remain at any depth. Triangles that are
# wide after DEPTH subdivisions are omitted, which loses a solid angle of about 2^-26; after more
# subdivisions, rounding errors would be larger than this loss. Along a curve of singular points,
# the number of wide triangles soon exceeds MOST_WIDE, and about 2^-12 is omitted. The integral
# along the boundary restores a solid angle of at most LEFT_OUT.
DEPTH = 26
MOST_WIDE = 20_000
LEFT_OUT = 2.0**-6
# Gauss-Legendre quadrature on an arc and on its halves must agree to AGREEMENT, or the halves are
# cut again. They are also cut if the control normal at an end of the arc is shorter than the
# longest one by the factor SHORT: its direction may turn too fast there for both quadratures.
SHORT = 1.0 / 16.0
NODES = 16
AGREEMENT = 1e-15
ARC_DEPTH = 40
MOST_PARTS = 1_000_000
# The candidates for poles, and the number of normals on each arc whose distance from the opposite
# pole is tested.
POLES = np.array([x for x in product((-1.0, 0.0, 1.0), repeat=3) if any(x)])
POLES /= np.linalg.norm(POLES, axis=1, keepdims=True)
SAMPLES = 9
# The edges of a triangle, counter-clockwise in (u, v): both corners, and the opposite corner.
EDGES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def solid_angles(normals: Array) -> Array:
    """Return the solid angles (k,) of triangles, given the polar forms of their normal fields.

    For the full accuracy, singular points must be corners of triangles, at which N is exactly zero.

    `normals` (k, 3, 3, 3) are the polar forms: a control normal for each pair of corners. The
    result is the integral of the Gaussian curvature over the surface: negative where it is
    hyperbolic, with overlaps counted by their multiplicity. It is exact up to rounding, about 1e-15
    for each triangle.
    """
    result = np.zeros(len(normals))
    owners, poles, narrow = _narrow(normals)
    arcs = boundary_of(narrow)
    integrals = integrate(np.concatenate(arcs), np.tile(poles, (len(arcs), 1)))
    np.add.at(result, np.tile(owners, len(arcs)), integrals)
    return result


def by_boundary(normals: Array, about: float) -> float:
    """Return the solid angle of one triangle (3, 3, 3) by the integral along its boundary alone.

    The integral is known up to multiples of 4π, which the approximate value `about` decides. It is
    also accurate at a singular corner, where subdivision has to omit a part of the triangle. Return
    `about` if the integral differs from `about` by more than LEFT_OUT, as for a boundary that is
    not closed.
    """
    arcs = np.concatenate(boundary_of(normals[None]))
    columns = map(vector, np.moveaxis(arcs[..., None, :], 1, 0))
    arc, _ = python_function(boundary_arc)(*columns, np.linspace(0.0, 1.0, SAMPLES))
    curve = unit_or_zero(np.stack(arc, axis=-1)).reshape(-1, 3)
    pole = POLES[int((POLES @ curve.T).min(axis=1).argmax())]
    whole = float(integrate(arcs, np.tile(pole, (len(arcs), 1))).sum())
    better = math.remainder(whole - about, 4.0 * math.pi)
    return about + better if abs(better) < LEFT_OUT else about


def is_wide(normals: Array) -> NDArray[np.bool_]:
    """Return a mask of the triangles (k,) that have normals far from their mean."""
    return ~_near_mean(normals)[1] & normals.any(axis=(1, 2, 3))


def triangle_of(normals: Array, corners: Array) -> Array:
    """Return the polar forms (k, 3, 3, 3) on parts of triangles.

    `corners` (k, 3, 3) are the barycentric coordinates of the corners of each part.
    """
    return np.einsum("kia,kjb,kabx->kijx", corners, corners, normals, optimize=True)


def boundary_of(normals: Array) -> list[Array]:
    """Return the arcs (k, 3, 3) that bound the images of k triangles, counter-clockwise.

    Three arcs belong to the edges, from u = 1 on. An edge without normals has the arc of the limits
    of normals, a part of a great circle. Three more arcs close the boundary at singular corners:
    the limits of the normals there, which lie on a great circle. At regular corners, these arcs are
    single points.
    """
    edges = []
    for i, j, k in EDGES:
        arc = np.stack([normals[:, i, i], normals[:, i, j], normals[:, j, j]], axis=1)
        ends = normals[:, i, k], normals[:, j, k]
        limit = np.stack([ends[0], 0.5 * (ends[0] + ends[1]), ends[1]], axis=1)
        edges.append(np.where(np.any(arc, axis=(1, 2), keepdims=True), arc, limit))
    corners = []
    for before, after in ((edges[2], edges[0]), (edges[0], edges[1]), (edges[1], edges[2])):
        start, end = first_directions(before[:, ::-1]), first_directions(after)
        corners.append(np.stack([start, 0.5 * (start + end), end], axis=1))
    return edges + corners


def integrate(arcs: Array, poles: Array) -> Array:
    """Return the integrals (k,) of the solid-angle form along arcs (k, 3, 3), up to rounding."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    nodes, weights = 0.5 + 0.5 * nodes, 0.5 * weights

    def once(arcs: Array, poles: Array) -> Array:
        integrals = np.empty(len(arcs))
        integrate_arcs(arcs, poles, nodes, weights, integrals)
        return integrals

    result = np.zeros(len(arcs))
    curved = np.any(arcs[:, 0] != arcs[:, 2], axis=1) | np.any(arcs[:, 0] != arcs[:, 1], axis=1)
    owners = np.flatnonzero(curved)
    arcs, poles = np.ascontiguousarray(arcs[owners]), np.ascontiguousarray(poles[owners])
    whole = once(arcs, poles)
    for _ in range(ARC_DEPTH):
        if not 0 < len(owners) < MOST_PARTS:
            break
        parts = _halves(arcs)
        twice = np.repeat(poles, 2, axis=0)
        integrals = once(parts, twice).reshape(-1, 2)
        rough = np.abs(integrals.sum(axis=1) - whole) > AGREEMENT + 8.0 * np.spacing(np.abs(whole))
        rough |= _has_short_end(arcs)
        np.add.at(result, owners[~rough], integrals[~rough].sum(axis=1))
        owners = np.repeat(owners[rough], 2)
        arcs, poles = parts[np.repeat(rough, 2)], twice[np.repeat(rough, 2)]
        whole = integrals[rough].ravel()
    np.add.at(result, owners, whole)
    return result


def _halves(arcs: Array) -> Array:
    """Return the two halves (2 k, 3, 3) of quadratic Bézier curves, one after the other."""
    left, right = (0.5 * (arcs[:, k] + arcs[:, k + 1]) for k in (0, 1))
    middle = 0.5 * (left + right)
    parts = np.stack([arcs[:, 0], left, middle, middle, right, arcs[:, 2]], axis=1)
    return parts.reshape(-1, 3, 3)


# --- triangles that are narrow enough -------------------------------------------------------------

QUARTERS = 0.5 * np.array(
    [
        [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
        [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
        [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
        [[0, 1, 1], [1, 0, 1], [1, 1, 0]],
    ],
    dtype=float,
)


def _narrow(normals: Array) -> tuple[NDArray[np.intp], Array, Array]:
    """Subdivide triangles until all normals of each triangle are near a direction, its pole.

    Returns the index of the original triangle of each part, the poles (m, 3) and the polar forms
    (m, 3, 3, 3). Parts without normals are omitted.
    """
    owners: NDArray[np.intp] = np.arange(len(normals))
    found = []
    for depth in range(DEPTH):
        means, ready = _near_mean(normals)
        found.append((owners[ready], means[ready], normals[ready]))
        wide = ~ready & normals.any(axis=(1, 2, 3))
        if not wide.any() or (depth > 8 and np.count_nonzero(wide) > MOST_WIDE):
            break
        normals, which = _cut(normals[wide])
        owners = owners[wide][which]
    owner, pole, part = (np.concatenate(x) for x in zip(*found, strict=True))
    return owner, pole, part


def _near_mean(normals: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the mean directions (k, 3) of the control normals of triangles, and a mask (k,).

    The mask says whether all control normals of a triangle are near their mean.
    """
    net = normals.reshape(-1, 9, 3)
    directions = unit_or_zero(net)
    means = directions.sum(axis=1)
    sizes = np.linalg.norm(means, axis=1, keepdims=True)
    means = np.divide(means, sizes, out=np.zeros_like(means), where=sizes > SMALL)
    cosines = np.einsum("kix,kx->ki", directions, means)
    cosines[~directions.any(axis=2)] = 1.0
    return means, (cosines.min(axis=1) > NARROW) & (sizes[:, 0] > SMALL)


def _cut(normals: Array) -> tuple[Array, NDArray[np.intp]]:
    """Cut triangles into smaller ones; also return the index of the original of each.

    A triangle is cut into four. If the normals turn by more than 60 degrees at a singular corner,
    the triangle is cut into two from that corner, since the normals of smaller triangles at the
    corner would turn as much.
    """
    whole = np.ones(len(normals), dtype=bool)
    parts, which = [], []
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        left, right = normals[:, i, j], normals[:, i, k]
        lengths = np.linalg.norm(left, axis=1) * np.linalg.norm(right, axis=1)
        turning = np.einsum("kx,kx->k", left, right) < NARROW * lengths
        here = np.flatnonzero(whole & turning & ~normals[:, i, i].any(axis=1))
        whole[here] = False
        for end in (j, k):
            corners = np.eye(3)
            corners[end] = 0.5 * (np.eye(3)[j] + np.eye(3)[k])
            parts.append(triangle_of(normals[here], np.broadcast_to(corners, (len(here), 3, 3))))
            which.append(here)
    here = np.flatnonzero(whole)
    for corners in QUARTERS:
        parts.append(triangle_of(normals[here], np.broadcast_to(corners, (len(here), 3, 3))))
        which.append(here)
    return np.concatenate(parts), np.concatenate(which)


def _has_short_end(arcs: Array) -> NDArray[np.bool_]:
    """Return a mask of the arcs that begin or end near a singular point, but not at it."""
    lengths = np.linalg.norm(arcs, axis=2)
    ends = np.where(lengths[:, ::2] > 0.0, lengths[:, ::2], np.inf)
    return ends.min(axis=1) < SHORT * lengths.max(axis=1)


def first_directions(arcs: Array) -> Array:
    """Return the first nonzero control normal (k, 3) of each arc, scaled to unit length."""
    nonzero = arcs.any(axis=2)
    first = np.take_along_axis(arcs, nonzero.argmax(axis=1)[:, None, None], axis=1)[:, 0]
    return unit_or_zero(first)
