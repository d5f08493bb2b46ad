"""Exact signs of the forms U, V, W of a patch at a normal, on integers of fixed length.

Exact ties are broken by Simulation of Simplicity (Edelsbrunner and Mücke,
https://doi.org/10.1145/77635.77639): the normal is displaced by an infinitesimal vector, the same
for all patches.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ....generated.patch import eliminated_forms, linear_forms, polar_forms
from ....generated.spline import NEIGHBOURS, triangle
from ....generated.vectors import Patch, Vector
from ...directions.kernels.vectors import row_vector
from ...domain.kernels.patch_numbers import place_of
from ...machine_code.jit import inline, jit, loop
from ...spline.kernels.patch import EAST, NORTH, SOUTH, SOUTHEAST, SOUTHWEST, WEST, vector_at
from .wide_integers import MANTISSA, rounded, wide

# The numbers of limbs (64 bits) of coefficients and of normals, as lengths of tuples. Normals need
# more: near a coordinate axis, their components may be rounding errors of rounding errors.
PATCH_LIMBS, NORMAL_LIMBS = (0, 0), (0, 0, 0)
# The number of spare bits, which weights and sums need.
SPARE = 6


class Decided(NamedTuple):
    """Output arrays: U/D and V/D (k, 2), |D| (k,), the signs of U, V, W (k, 3), and a mask (k,).

    The mask `known` is True for pairs that were decided.
    """

    local: Any
    size: Any
    signs: Any
    known: Any


# --- integers -------------------------------------------------------------------------------------


@loop
def widened(least, largest, x):
    """Update the least and the largest modulus of nonzero numbers by one more number x."""
    size = abs(x)
    if 0.0 < size < least:
        least = size
    if size > largest:
        largest = size
    return least, largest


@loop
def unit_of(least, largest, limbs):
    """Return the exponent of a unit in which given numbers are integers, and whether they fit.

    The nonzero moduli of the numbers are between `least` and `largest`. The integers fit if they
    have at most as many limbs as the tuple `limbs` has entries, with SPARE bits left.
    """
    unit = math.frexp(least)[1] - MANTISSA
    return unit, largest == 0.0 or math.frexp(largest)[1] - unit <= 64 * len(limbs) - SPARE


@loop
def unit_around(mu, i, j):
    """Return the result of `unit_of` for the coefficient (i, j) and its eight neighbours."""
    least, largest = np.inf, 0.0
    for p in range(i - 1, i + 2):
        for q in range(j - 1, j + 2):
            for x in range(3):
                least, largest = widened(least, largest, mu[p, q, x])
    return unit_of(least, largest, PATCH_LIMBS)


@loop
def unit_of_normal(n):
    """Return the result of `unit_of` for the components of a normal."""
    least, largest = widened(np.inf, 0.0, n.x)
    least, largest = widened(least, largest, n.y)
    least, largest = widened(least, largest, n.z)
    return unit_of(least, largest, NORMAL_LIMBS)


@loop
def wide_coefficient(mu, i, j, unit):
    """Return the coefficient (i, j) as integers, in the given unit."""
    x, y, z = vector_at(mu, i, j)
    return Vector(
        wide(x, unit, PATCH_LIMBS), wide(y, unit, PATCH_LIMBS), wide(z, unit, PATCH_LIMBS)
    )


@loop
def neighbour(mu, i, j, turn, k, centre, unit):
    """Return the k-th neighbour of the coefficient (i, j) minus `centre`, as integers."""
    x, y, z = wide_coefficient(mu, i + NEIGHBOURS[turn, k, 0], j + NEIGHBOURS[turn, k, 1], unit)
    return Vector(x - centre.x, y - centre.y, z - centre.z)


@inline
def wide_patch(mu, i, j, turn, unit) -> Patch:
    """Return the vectors of patch `turn` of the cell with the coefficient (i, j), as integers."""
    centre = wide_coefficient(mu, i, j, unit)
    return triangle(
        neighbour(mu, i, j, turn, SOUTHWEST, centre, unit),
        neighbour(mu, i, j, turn, SOUTH, centre, unit),
        neighbour(mu, i, j, turn, SOUTHEAST, centre, unit),
        neighbour(mu, i, j, turn, WEST, centre, unit),
        neighbour(mu, i, j, turn, EAST, centre, unit),
        neighbour(mu, i, j, turn, NORTH, centre, unit),
    )


@loop
def wide_normal(n, unit):
    """Return n or −n as integers: the one whose first nonzero component is positive.

    The forms are even in n. But n and −n must be displaced to opposite normals: where a surface is
    joined to its own mirror image, one patch has the normal and its neighbour the opposite one.
    """
    side = math.copysign(1.0, n.x if n.x != 0.0 else n.y if n.y != 0.0 else n.z)
    return Vector(
        wide(side * n.x, unit, NORMAL_LIMBS),
        wide(side * n.y, unit, NORMAL_LIMBS),
        wide(side * n.z, unit, NORMAL_LIMBS),
    )


# --- signs ----------------------------------------------------------------------------------------


@loop
def note(D, U, V, W, forms, signs):
    """Set each sign that is still 0 to the sign of the coefficient U, V or W of one monomial.

    If forms[0] is still 0, write the coefficients D, U, V to `forms`. Return whether all signs are
    different from 0.
    """
    if forms[0] == 0.0:
        forms[0], forms[1], forms[2] = D, U, V
    for k, value in enumerate((U, V, W)):
        if signs[k] == 0:
            signs[k] = int(value > 0.0) - int(value < 0.0)
    return signs[0] * signs[1] * signs[2] != 0


@inline
def exact_forms(patch, n, forms, signs):
    """Write D, U, V to `forms` (3,) and the signs of U, V, W to `signs` (3,), both 0 at first.

    If a zero among U, V, W leaves undecided whether the patch has the normal, the normal is
    displaced to n + (ε₁, ε₂, ε₃), with n ≫ ε₁ ≫ ε₂ ≫ ε₃ ≫ ε₁². A form is then a sum of ten
    monomials, each infinitesimal relative to the one before, and its sign is that of the first
    nonzero coefficient. D, U, V are then the coefficients of the leading monomial of D.
    """
    A, B, C, P, Q = linear_forms(patch, n)
    D, U, V, W = eliminated_forms(A, B, C, P, Q)
    known = note(rounded(D), rounded(U), rounded(V), rounded(W), forms, signs)
    known |= min(signs[0], signs[1], signs[2]) < 0 < max(signs[0], signs[1], signs[2])
    one = wide(1.0, 0, NORMAL_LIMBS)
    for s in range(-1, 3):
        if s >= 0:
            A, B, C = patch.a[s] * one, patch.b[s] * one, patch.c[s] * one
            P, Q = patch.d[s] * one, patch.e[s] * one
        for t in range(max(s, 0), 3):
            if known:
                break
            D, U, V, W = polar_forms(
                A, B, C, P, Q, patch.a[t], patch.b[t], patch.c[t], patch.d[t], patch.e[t]
            )
            # The polar form of a vector with itself is twice the quadratic form.
            share = 0.5 if s == t else 1.0
            known = note(
                share * rounded(D), share * rounded(U), share * rounded(V), rounded(W), forms, signs
            )


@jit
def decide_exactly(mu, scale, patches, normals, first, last, forms, decided):
    """Find the signs of U, V, W exactly for pairs (patches[k], normals[k]), k in [first, last).

    Write the results to `decided`. If the integers for a pair would be too long, the pair remains
    undecided. `forms` (3,) is a work array.
    """
    columns = mu.shape[1] - 2
    exponent = math.frexp(scale)[1] - 1
    k = first
    while k < last:
        number = patches[k]
        i, j, turn = place_of(number, columns)
        unit, fits = unit_around(mu, i + 1, j + 1)
        patch = wide_patch(mu, i + 1, j + 1, turn, unit)
        while k < last and patches[k] == number:
            n = row_vector(normals, k)
            unit_n, fits_n = unit_of_normal(n)
            decided.known[k] = fits and fits_n
            if decided.known[k]:
                signs = decided.signs[k]
                for x in range(3):
                    forms[x], signs[x] = 0.0, 0
                exact_forms(patch, wide_normal(n, unit_n), forms, signs)
                decided.local[k, 0] = forms[1] / forms[0]
                decided.local[k, 1] = forms[2] / forms[0]
                decided.size[k] = math.ldexp(abs(forms[0]), 2 * (unit + unit_n + exponent))
            k += 1
