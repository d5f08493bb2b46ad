"""Exact decisions whether a patch has a normal, where rounding leaves that open.

Coefficients and normals are binary fractions, and the formulas need only +, − and ×: computed with
more bits, and finally on integers, they give the exact sign of every form. Exact zeros (a normal on
the common boundary of two Gaussian images, or of a parabolic line) are decided by simulation of
simplicity, as if the normal were moved by an infinitesimal generic vector, the same for all
patches: the moved normal lies on no boundary, so that exactly one of the patches has it. Only at
the open border of the domain there is a tolerance: a normal whose point lies outside of the domain
by no more than the error of the data belongs to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..generated.primes import PRIMES
from ..generated.spline import CORNERS
from .kernels import decide as kernels
from .kernels.patch import normals_at
from .long_integers import forms_of_pairs
from .spline import Spline
from .threads import over_ranges
from .tolerances import SINGULAR_POINT

__all__ = ["Decision", "decide"]

PAIRS_AT_A_TIME = 1 << 8
# Python integers take memory: about a hundred bytes for each of the many of a pair.
LONG_PAIRS_AT_A_TIME = 1 << 14
# The exponents in one pair may differ by this before integers of any length are needed.
MOST_SHIFTED = 512
# Two samples of one normal at the open border that are closer than this (in cells) are one.
SAME_PLACE = 1e-6


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
    numbers: NDArray[np.int64],
    bounds: NDArray[np.float64],
    forgiven: NDArray[np.float64],
    threads: int | None = None,
) -> Decision:
    """Decide which of the pairs (patches[k], normals[k]) are samples.

    `numbers[k]` is that of the normal: equal normals with different numbers all count. `bounds[k]`
    is the error of the forms as floating-point numbers; `forgiven[k]` that of W that is forgiven at
    the open border of the domain, 0 for a patch that does not touch the border. Both are in units
    of the scaled spline.
    """
    local, size, signs = _forms(spline, patches, normals, bounds, forgiven, threads)
    inside = (signs[:, 0] != 0) & (signs[:, 0] == signs[:, 1]) & (signs[:, 1] == signs[:, 2])
    with np.errstate(divide="ignore", invalid="ignore"):
        tolerance = np.where(size > 1024 * forgiven, forgiven / size, 0.0)
        near = (signs[:, 0] != 0) & (signs[:, 0] == signs[:, 1]) & (tolerance > 0.0) & ~inside
        total = local.sum(axis=1)
        near &= total <= 1.0 + tolerance
        local[near] /= total[near, None]
    which = np.flatnonzero(inside | near)
    regular, directions = _regular_places(spline, patches[which], local[which])
    towards = np.einsum("kx,kx->k", directions, normals[which]) > 0.0
    which, regular = which[towards], regular[towards]
    place, number = local[which], numbers[which]
    keep = _first_of_each_place(spline, patches[which], number, place, near[which])
    at = np.column_stack([place, signs[which, :1].astype(np.float64), regular])
    return Decision(which[keep], at[keep])


def _forms(
    spline: Spline,
    patches: NDArray[np.int64],
    normals: NDArray[np.float64],
    bounds: NDArray[np.float64],
    forgiven: NDArray[np.float64],
    threads: int | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int8]]:
    """Return U/D, V/D (k, 2), the modulus of D (k,), and the signs of U, V, W (k, 3)."""
    count = len(patches)
    local, size = np.empty((count, 2)), np.empty(count)
    signs, known = np.empty((count, 3), dtype=np.int8), np.empty(count, dtype=np.bool_)
    pairs = kernels.Pairs(patches, normals, bounds, forgiven)
    decided = kernels.Decided(local, size, signs, known)

    # Kernels for integers take long to compile, and few surfaces need them.
    def work(first: int, last: int) -> None:
        mu, scale = spline.coefficients, spline.scale
        kernels.decide_precisely(mu, scale, pairs, first, last, decided)
        if not known[first:last].all():
            tables, memory = prime_tables(), _workspace()
            kernels.decide_exactly(mu, scale, pairs, tables, first, last, memory, decided)

    for _ in over_ranges(work, count, PAIRS_AT_A_TIME, threads):
        pass
    for first in range(0, count, LONG_PAIRS_AT_A_TIME):
        chunk = first + np.flatnonzero(~known[first : first + LONG_PAIRS_AT_A_TIME])
        if len(chunk) > 0:
            local[chunk], size[chunk], signs[chunk] = forms_of_pairs(
                spline, patches[chunk], normals[chunk]
            )
    return local, size, signs


@cache
def prime_tables() -> kernels.PrimeTables:
    """Return the primes, and what computing modulo them needs."""
    primes = PRIMES.tolist()
    powers = np.array([[pow(2, k, p) for k in range(MOST_SHIFTED)] for p in primes])
    inverses = np.array([[pow(p, -1, q) if p != q else 0 for q in primes] for p in primes])
    return kernels.PrimeTables(PRIMES, powers, inverses)


def _workspace() -> kernels.Workspace:
    """Return room for the residues of one pair."""
    count = len(PRIMES)
    shapes = (count, 5, 3), (count, 3), (4, count), (count,)
    patches, directions, residues, digits = (np.empty(x, dtype=np.int64) for x in shapes)
    return kernels.Workspace(patches, directions, residues, digits, np.empty(4))


def _regular_places(
    spline: Spline, patches: NDArray[np.int64], local: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places (k, 2) where the patches have a normal, and these normals (not of unit length).

    A singular point, where p_u × p_v is nothing beside that at the centre, has none: the place is
    moved a little towards the centre.
    """

    def normals(places: NDArray[np.float64]) -> NDArray[np.float64]:
        result = np.empty((len(patches), 3))
        normals_at(spline.coefficients, spline.scale, patches, places, result)
        return result

    centre = np.full_like(local, 1 / 3)
    lengths = (np.linalg.norm(normals(x), axis=1) for x in (local, centre))
    singular = np.less_equal(next(lengths), SINGULAR_POINT * next(lengths))
    places = np.where(singular[:, None], local + SINGULAR_POINT * (centre - local), local)
    return places, normals(places)


# --- the open border ------------------------------------------------------------------------------


def _first_of_each_place(
    spline: Spline,
    patches: NDArray[np.int64],
    numbers: NDArray[np.int64],
    local: NDArray[np.float64],
    near: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Drop what was let in at the border and is, for its normal, in the place of another sample."""
    keep = np.ones(len(patches), dtype=bool)
    if not near.any():
        return keep
    cell, turn = np.divmod(patches, 4)
    corners = CORNERS[turn]
    place = np.stack(np.divmod(cell, spline.cells[1]), axis=1) + np.einsum(
        "kc,kcx->kx", local, corners
    )
    for k in np.flatnonzero(near):
        apart = place - place[k]
        for axis, (ends, cells) in enumerate(zip(spline.boundary, spline.cells, strict=True)):
            if ends[0] == "periodic":
                apart[:, axis] -= cells * np.round(apart[:, axis] / cells)
        others = (numbers == numbers[k]) & (np.abs(apart).max(axis=1) < SAME_PLACE) & keep
        others[k] = False
        keep[k] = not others.any()
    return keep
