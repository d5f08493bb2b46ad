"""Exact decisions whether a patch has a normal, for the pairs that rounding leaves undecided.

The coefficients of a spline and the components of normals are binary fractions, and the formulas of
the forms U, V, W, D need only +, − and ×: evaluated on integers, they give exact signs. Exact zeros
(a normal on the common boundary of two Gaussian images, or of a parabolic line) are decided by
Simulation of Simplicity (Edelsbrunner and Mücke, https://doi.org/10.1145/77635.77639): the normal
is displaced by an infinitesimal vector, the same for all patches. The displaced normal lies on no
boundary, so that exactly one of the patches has it. A pole is one point: if several patches around
it have the displaced normal, pairs of hits with opposite signs of K cancel. Integers of fixed
length decide nearly all pairs: with integers of any length alone, a search for symmetric normals
takes 2 to 15 times as long (26 November 2026, five surfaces of the catalogue, one thread). The only
tolerance is at the open boundary of the domain: a normal whose point lies outside the domain by at
most the error of the data is a hit.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...generated.spline import CORNERS
from ..base.threads import over_ranges
from ..spline.spline import Spline
from .kernels.decide import Decided, decide_exactly
from .long_integers import forms_of_pairs

PAIRS_AT_A_TIME = 1 << 10
# The number of pairs that are decided together on Python integers. It bounds the memory: a pair has
# many such integers, each of about a hundred bytes.
LONG_PAIRS_AT_A_TIME = 1 << 14
# A distance in the parameter plane, in cells (in nets, in parameters of a patch). Hits of one
# normal at the open boundary that are closer to each other count as one point. A hit that is closer
# to a pole, or to a corner of a net, counts as a hit at the pole or corner. The distance is far
# more than rounding errors, which are below 1e-14, and far less than a cell.
SAME_PLACE = 1e-6


@dataclass(frozen=True)
class Decision:
    """The pairs of a patch and a normal that are hits.

    `which` (k,) are the indices of the hits among all pairs. The columns of `local` (k, 6) are the
    parameters u, v of the point in its patch, the sign of K, the parameters at which curvatures are
    evaluated (u, v again, or those of a nearby point if the point is singular), and the kind of the
    component, which is REGULAR.
    """

    which: NDArray[np.int64]
    local: NDArray[np.float64]


def decide(
    spline: Spline,
    patches: NDArray[np.int64],
    normals: NDArray[np.float64],
    numbers: NDArray[np.int64],
    forgiven: NDArray[np.float64],
    threads: int | None = None,
) -> Decision:
    """Decide which of the pairs (patches[k], normals[k]) are hits.

    `numbers[k]` is the index of the normal; equal normals with different indices each have their
    own hits. At the open boundary of the domain, W may have the wrong sign if |W| is at most
    `forgiven[k]`, for the scaled spline; this is 0 for a patch that does not touch the boundary.
    """
    local, size, signs = decided_forms(spline, patches, normals, threads)
    inside = (signs[:, 0] != 0) & (signs[:, 0] == signs[:, 1]) & (signs[:, 1] == signs[:, 2])
    with np.errstate(divide="ignore", invalid="ignore"):
        tolerance = np.where(size > 1024 * forgiven, forgiven / size, 0.0)
        near = (signs[:, 0] != 0) & (signs[:, 0] == signs[:, 1]) & (tolerance > 0.0) & ~inside
        total = local.sum(axis=1)
        near &= total <= 1.0 + tolerance
        local[near] /= total[near, None]
    which = np.flatnonzero(inside | near)
    _, regular, directions = spline._regular_places(patches[which], local[which])
    towards = np.einsum("kx,kx->k", directions, normals[which]) > 0.0
    which, regular = which[towards], regular[towards]
    number, sign = numbers[which], signs[which, 0]
    place = _in_cells(spline, patches[which], local[which])
    periods = np.where([x[0] == "periodic" for x in spline.boundary], spline.cells, np.inf)
    keep = first_of_each_place(number, place, near[which], periods)
    keep[keep] = uncancelled(number[keep], _poles_at(spline, place[keep]), sign[keep])
    at = np.column_stack([local[which], sign.astype(np.float64), regular, 0.0 * sign])
    return Decision(which[keep], at[keep])


def decided_forms(
    spline: Spline, patches: NDArray[np.int64], normals: NDArray[np.float64], threads: int | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int8]]:
    """Return U/D and V/D (k, 2), |D| (k,), and exact signs of U, V, W (k, 3), for k pairs.

    Where zeros would leave undecided whether the patch has the normal, the signs are those at the
    displaced normal.
    """
    count = len(patches)
    local, size = np.empty((count, 2)), np.empty(count)
    signs, known = np.empty((count, 3), dtype=np.int8), np.empty(count, dtype=np.bool_)
    decided = Decided(local, size, signs, known)

    def work(first: int, last: int) -> None:
        mu, scale = spline.coefficients, spline.scale
        decide_exactly(mu, scale, patches, normals, first, last, np.empty(3), decided)

    list(over_ranges(work, count, PAIRS_AT_A_TIME, threads))
    for first in range(0, count, LONG_PAIRS_AT_A_TIME):
        chunk = first + np.flatnonzero(~known[first : first + LONG_PAIRS_AT_A_TIME])
        if len(chunk) > 0:
            local[chunk], size[chunk], signs[chunk] = forms_of_pairs(
                spline, patches[chunk], normals[chunk]
            )
    return local, size, signs


def _in_cells(
    spline: Spline, patches: NDArray[np.int64], local: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the positions (k, 2) of hits in the domain, in cells from its lower left corner."""
    cell, turn = np.divmod(patches, 4)
    centre = np.stack(np.divmod(cell, spline.cells[1]), axis=1) + 0.5
    return centre + np.einsum("kc,kcx->kx", local, CORNERS[turn])


# --- poles ----------------------------------------------------------------------------------------


def uncancelled(
    numbers: NDArray[np.int64], poles: NDArray[np.int64], signs: NDArray[np.int8]
) -> NDArray[np.bool_]:
    """Return a mask (k,) of the hits to keep: at a pole, pairs of hits with opposite signs cancel.

    `poles` (k,) has the index of the pole at which a hit is, or −1. Around a pole the Gaussian
    image of a spline may be folded, by rounding, or because the principal curvatures of the surface
    at the pole are different. The number of hits that remain is the winding number of the image
    around the normal, which is 1 at a regular point of the surface. If no hit would remain, all
    hits are kept.
    """
    keep = np.ones(len(numbers), dtype=bool)
    at = np.flatnonzero(poles >= 0)
    if len(at) == 0:
        return keep
    keys = np.stack([numbers[at], poles[at]], axis=1)
    found, group = np.unique(keys, axis=0, return_inverse=True)
    group, sign = group.ravel(), signs[at].astype(np.int64)
    total = np.zeros(len(found), np.int64)
    np.add.at(total, group, sign)
    order = np.lexsort((sign != np.sign(total[group]), group))
    rank = np.arange(len(at)) - np.searchsorted(group[order], group[order])
    keep[at[order]] = (rank < np.abs(total[group[order]])) | (total[group[order]] == 0)
    return keep


def _poles_at(spline: Spline, places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the index of the pole at each position (k, 2), given in cells, or −1."""
    poles = np.full(len(places), -1)
    for axis, end in np.ndindex(2, 2):
        if spline.boundary[axis][end] == "pole":
            away = np.abs(places[:, axis] - end * spline.cells[axis])
            poles[away < SAME_PLACE] = 2 * axis + end
    return poles


# --- the open boundary ----------------------------------------------------------------------------


def first_of_each_place(
    numbers: NDArray[np.int64],
    place: NDArray[np.float64],
    near: NDArray[np.bool_],
    periods: NDArray[np.float64] | float = np.inf,
) -> NDArray[np.bool_]:
    """Return a mask of the hits to keep.

    A hit `near` the open boundary is left out if it coincides with another hit that is kept: both
    have the same normal, and positions `place` (k, d) that differ by less than SAME_PLACE, modulo
    the `periods` (d,).
    """
    keep = np.ones(len(place), dtype=bool)
    if not near.any():
        return keep
    order = np.argsort(numbers, kind="stable")
    first, last = (np.searchsorted(numbers[order], numbers, side) for side in ("left", "right"))
    for k in np.flatnonzero(near):
        others = order[first[k] : last[k]]
        apart = np.abs(place[others] - place[k])
        apart = np.minimum(apart, np.abs(periods - apart))
        same = (apart.max(axis=1) < SAME_PLACE) & keep[others] & (others != k)
        keep[k] = not same.any()
    return keep
