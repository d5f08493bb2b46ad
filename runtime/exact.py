"""Deciding exactly what rounding leaves open: whether a patch has a normal.

Coefficients and normals are binary fractions, and the formulas need only +, − and ×: run on Python
integers they give the exact sign of every form. What is exactly zero (a normal on the boundary of
two patches, or at a parabolic line) is decided as if the normal were moved by an infinitesimal
generic vector, the same for all patches: the moved normal lies on no boundary at all, so that
exactly one of the patches that meet there claims it. Only at the open border of the domain is
rounding forgiven: a normal that leaves the domain by no more than the error of the data belongs to
it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..generated import sampler as kernels
from .integers import Integers, integers, integers_by_row, ratio, sign
from .plain import plain
from .spline import Spline

__all__ = ["Decision", "decide"]

# Python integers take memory: some hundred bytes for each of the many that a pair needs.
PAIRS_AT_A_TIME = 1 << 14
# Two samples of one normal at the open border that are closer than this (in cells) are one.
SAME_PLACE = 1e-6
# A point is singular where the normal is this short, beside that at the centre of its patch.
SINGULAR = 2.0**-20


@dataclass(frozen=True)
class Decision:
    """The pairs that are samples.

    `which` are their numbers among those asked. `local` (k, 5) holds u, v, the sign of K, and where
    the curvatures are to be taken: at u, v themselves, or a little inside if that is singular.
    """

    which: NDArray[np.int64]
    local: NDArray[np.float64]


def decide(
    spline: Spline,
    patches: NDArray[np.int64],
    normals: NDArray[np.float64],
    forgiven: NDArray[np.float64],
) -> Decision:
    """Decide which of the pairs (patches[k], normals[k]) are samples.

    `forgiven[k]` is the error of W that is forgiven at the open border of the domain, in units of
    the scaled spline; 0 for a patch that does not touch the border.
    """
    chunks = [slice(k, k + PAIRS_AT_A_TIME) for k in range(0, len(patches), PAIRS_AT_A_TIME)]
    parts = [_decide(spline, patches[x], normals[x], forgiven[x]) for x in chunks]
    which = np.concatenate([x.start + part[0] for x, part in zip(chunks, parts, strict=True)])
    local = np.concatenate([part[1] for part in parts])
    near = np.concatenate([part[2] for part in parts])
    keep = _first_of_each_place(spline, patches[which], normals[which], local[:, :2], near)
    return Decision(which[keep], local[keep])


def _decide(
    spline: Spline,
    patches: NDArray[np.int64],
    normals: NDArray[np.float64],
    forgiven: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_]]:
    """Return which pairs are samples, what `Decision` holds of them, and which are forgiven."""
    vectors, exponent = _patch_vectors(spline, patches)
    n, exponents = integers_by_row(normals)
    n = n * _leading_sign(n)
    forms = _forms(vectors, n)
    magnitude = _scaled(np.abs(forms[0]), 2 * (exponent + exponents))
    signs = sign(forms[1:])
    tied = (signs == 0).any(axis=0) & ((signs.min(axis=0) >= 0) | (signs.max(axis=0) <= 0))
    if tied.any():
        forms[:, tied], signs[:, tied] = _moved_forms(vectors[:, tied], n[:, tied])
    inside = (signs[0] != 0) & (signs[0] == signs[1]) & (signs[1] == signs[2])
    with np.errstate(divide="ignore", invalid="ignore"):
        tolerance = np.where(magnitude > 1024 * forgiven, forgiven / magnitude, 0.0)
    near = (signs[0] != 0) & (signs[0] == signs[1]) & (tolerance > 0.0) & ~inside
    u, v = np.zeros(len(patches)), np.zeros(len(patches))
    here = inside | near
    u[here], v[here] = (
        ratio(forms[1, here], forms[0, here]),
        ratio(forms[2, here], forms[0, here]),
    )
    near &= u + v <= 1.0 + tolerance
    u[near], v[near] = (x[near] / (u + v)[near] for x in (u, v))
    which = np.flatnonzero(inside | near)
    regular = np.column_stack([u, v])
    regular[which], directions = _regular_places(spline, patches[which], regular[which])
    which = which[np.einsum("kx,kx->k", directions, normals[which]) > 0.0]
    return which, np.column_stack([u, v, signs[0], regular])[which], near[which]


# --- integers -------------------------------------------------------------------------------------


def _patch_vectors(spline: Spline, patches: NDArray[np.int64]) -> tuple[Integers, int]:
    """Return a, b, c, d, e (15, k) of each patch as integers, and the exponent of their unit."""
    cell, turn = np.divmod(patches, 4)
    i, j = np.divmod(cell, spline.cells[1])
    steps = kernels.NEIGHBOURS[turn]
    around = spline.coefficients[i[:, None] + 1 + steps[..., 0], j[:, None] + 1 + steps[..., 1]]
    values, exponent = integers(around)
    differences = values - values[:, 4:5]
    read = differences[:, kernels.TRIANGLE_NEIGHBOURS].reshape(len(patches), -1)
    vectors = plain(kernels.triangle)(*read.T)
    return np.array(vectors[:15], dtype=object), exponent + int(np.log2(spline.scale))


def _forms(vectors: Integers, n: Integers) -> Integers:
    """Return D, U, V, W (4, k), exactly."""
    return np.array(plain(kernels.forms)(*vectors, *n), dtype=object)


def _moved_forms(vectors: Integers, n: Integers) -> tuple[Integers, NDArray[np.int8]]:
    """Return D, U, V, W and the signs of U, V, W at n + (ε₁, ε₂, ε₃), with n ≫ ε₁ ≫ ε₂ ≫ ε₃ ≫ ε₁².

    A quadratic form F is there a sum of ten monomials in n, ε₁, ε₂, ε₃, each infinitesimal beside
    the one before; its coefficients follow from F(x + y) − F(x) − F(y). The first that is not zero
    gives the sign. Quotients by D need the monomial that leads in D alone: that one is returned.
    """
    axes = [
        n,
        *(np.array([[x], [y], [z]], dtype=object) for x, y, z in np.eye(3, dtype=int).tolist()),
    ]
    alone = [_forms(vectors, x + 0 * n) for x in axes]
    monomials = [
        alone[i] if i == j else _forms(vectors, axes[i] + axes[j] + 0 * n) - alone[i] - alone[j]
        for i in range(4)
        for j in range(i, 4)
    ]
    coefficients = np.stack(monomials)
    leading = np.argmax(np.asarray(coefficients != 0, dtype=bool), axis=0)
    first = np.take_along_axis(coefficients, leading[None], axis=0)[0]
    in_d = np.take_along_axis(coefficients, leading[None, :1].repeat(4, axis=1), axis=0)[0]
    return in_d, sign(first[1:])


def _regular_places(
    spline: Spline, patches: NDArray[np.int64], local: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places (k, 2) where the patches have a normal, and these normals (not of unit length).

    A singular point, where p_u × p_v is nothing beside that at the centre, has none: the place is
    moved a little towards the centre.
    """

    def normals(places: NDArray[np.float64]) -> NDArray[np.float64]:
        result = np.empty((len(patches), 3))
        kernels.normals_at(spline.coefficients, spline.scale, patches, places, result)
        return result

    centre = np.full_like(local, 1 / 3)
    lengths = (np.linalg.norm(normals(x), axis=1) for x in (local, centre))
    singular = np.less_equal(next(lengths), SINGULAR * next(lengths))
    places = np.where(singular[:, None], local + SINGULAR * (centre - local), local)
    return places, normals(places)


def _leading_sign(n: Integers) -> Integers:
    """Return the sign of the first component that is not zero, for each column.

    The forms are even in n. A normal and its opposite must be moved to opposite normals: where a
    surface is joined to its own mirror image, one patch has the one and its neighbour the other.
    """
    signs = sign(n)
    first = np.argmax(signs != 0, axis=0)
    return np.take_along_axis(signs, first[None], axis=0).astype(object)


def _scaled(values: Integers, exponents: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return values × 2^exponents as floats."""
    pairs = zip(values, exponents.tolist(), strict=True)
    return np.array([x << e if e >= 0 else x / (1 << -e) for x, e in pairs], dtype=np.float64)


# --- the open border ------------------------------------------------------------------------------


def _first_of_each_place(
    spline: Spline,
    patches: NDArray[np.int64],
    normals: NDArray[np.float64],
    local: NDArray[np.float64],
    near: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Drop what was let in at the border and is, for its normal, in the place of another sample."""
    keep = np.ones(len(patches), dtype=bool)
    if not near.any():
        return keep
    cell, turn = np.divmod(patches, 4)
    corners = kernels.CORNERS[turn]
    place = np.stack(np.divmod(cell, spline.cells[1]), axis=1) + np.einsum(
        "kc,kcx->kx", local, corners
    )
    for k in np.flatnonzero(near):
        same = (normals == normals[k]).all(axis=1)
        close = np.abs(place - place[k]).max(axis=1) < SAME_PLACE
        others = same & close & keep
        others[k] = False
        keep[k] = not others.any()
    return keep
