"""Exact decisions: the signs of the forms U, V, W of a patch and a normal.

They are computed with 106 bits first, and on integers if a sign is still undecided. Exact ties are
broken by Simulation of Simplicity (Edelsbrunner and Mücke, https://doi.org/10.1145/77635.77639):
the normal is displaced by an infinitesimal vector, the same for all patches.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ...generated.patch import forms
from ...generated.spline import NEIGHBOURS, triangle
from ...generated.vectors import Patch, Vector
from .double_double import DoubleDouble
from .jit import inline, jit, loop
from .modular import (
    HIGHEST,
    MANTISSA,
    exponents_around,
    exponents_of,
    mixed_radix_value,
    residue,
    residues_of_forms,
    residues_of_patch,
)
from .patch import EAST, NORTH, SOUTH, SOUTHEAST, SOUTHWEST, WEST, place_of, vector_at
from .vectors import row_vector

__all__ = ["Decided", "Pairs", "PrimeTables", "Workspace", "decide_exactly", "decide_precisely"]

# The error of double-doubles relative to that of floating-point numbers: 2⁻⁵¹, with a safety factor
# of 64.
PRECISE = math.ldexp(1.0, -45)
# The bits that each prime contributes to the product of primes.
BITS = 28.99
# Bits that the formulas add: by weights, by sums of products, and by a second normal.
WEIGHT_BITS, SUM_BITS, FORM_BITS = 6, 2, 6


class Pairs(NamedTuple):
    """Pairs of patches (k,) and normals (k, 3), with the errors of their forms.

    `bounds` (k,) are the rounding errors of the forms in floating point; `forgiven` (k,) is the
    tolerance of W, positive at the open border of the domain and 0 elsewhere.
    """

    patches: Any
    normals: Any
    bounds: Any
    forgiven: Any


class PrimeTables(NamedTuple):
    """Primes (m,), powers of two (m, …) modulo each, inverses (m, m) of primes modulo others."""

    primes: Any
    powers: Any
    inverses: Any


class Workspace(NamedTuple):
    """Work arrays for m primes: patches (m, 5, 3), normals (m, 3), residues (4, m), digits (m,).

    forms (4,) are D, U, V, W, in a unit of their own.
    """

    patches: Any
    normals: Any
    residues: Any
    digits: Any
    forms: Any


class Decided(NamedTuple):
    """The output: U/D and V/D (k, 2), |D| (k,), signs of U, V, W (k, 3), and if known (k,)."""

    local: Any
    size: Any
    signs: Any
    known: Any


# --- with 106 bits --------------------------------------------------------------------------------


@inline
def precise(x) -> Any:
    """Return a number as a double-double."""
    return DoubleDouble(x, 0.0)


@loop
def precise_difference(x, y, scale):
    """Return (x − y) times a power of two."""
    return scale * (precise(x) - precise(y))


@loop
def precise_neighbour(mu, i, j, turn, k, scale):
    """Return neighbour k minus the coefficient (i, j), times a power of two."""
    p = i + NEIGHBOURS[turn, k, 0]
    q = j + NEIGHBOURS[turn, k, 1]
    return Vector(
        precise_difference(mu[p, q, 0], mu[i, j, 0], scale),
        precise_difference(mu[p, q, 1], mu[i, j, 1], scale),
        precise_difference(mu[p, q, 2], mu[i, j, 2], scale),
    )


@loop
def precise_forms(mu, i, j, turn, scale, n):
    """Return D, U, V, W of a patch, times `scale`, and a normal as double-doubles."""
    patch = triangle(
        precise_neighbour(mu, i, j, turn, SOUTHWEST, scale),
        precise_neighbour(mu, i, j, turn, SOUTH, scale),
        precise_neighbour(mu, i, j, turn, SOUTHEAST, scale),
        precise_neighbour(mu, i, j, turn, WEST, scale),
        precise_neighbour(mu, i, j, turn, EAST, scale),
        precise_neighbour(mu, i, j, turn, NORTH, scale),
    )
    return forms(patch, Vector(precise(n.x), precise(n.y), precise(n.z)))


# --- on integers ----------------------------------------------------------------------------------


@inline
def patch_at(patches, k):
    """Return the patch a, b, c, d, e in row k of an array (m, 5, 3); p is arbitrary."""
    a = vector_at(patches, k, 0)
    return Patch(
        a,
        vector_at(patches, k, 1),
        vector_at(patches, k, 2),
        vector_at(patches, k, 3),
        vector_at(patches, k, 4),
        a,
    )


@loop
def load_residues(mu, i, j, turn, n, lowest, lowest_n, count, tables, work):
    """Write the residues of a patch and of a normal modulo the first `count` primes.

    The forms are even in n, but a normal and its opposite must be displaced to opposite normals:
    where a surface is joined to its own mirror image, one patch has the one and its neighbour the
    other. So n is taken with its first component positive.
    """
    first = n.x if n.x != 0.0 else n.y if n.y != 0.0 else n.z
    side = math.copysign(1.0, first)
    for k in range(count):
        prime = tables.primes[k]
        powers = tables.powers[k]
        patch = residues_of_patch(mu, i, j, turn, lowest, prime, powers)
        for form in range(5):
            work.patches[k, form, 0] = patch[form].x % prime
            work.patches[k, form, 1] = patch[form].y % prime
            work.patches[k, form, 2] = patch[form].z % prime
        work.normals[k, 0] = residue(side * n.x, lowest_n, prime, powers)
        work.normals[k, 1] = residue(side * n.y, lowest_n, prime, powers)
        work.normals[k, 2] = residue(side * n.z, lowest_n, prime, powers)


@loop
def residues_of_monomial(s, t, count, tables, work):
    """Write the residues of the coefficients of a monomial in D, U, V, W.

    At the displaced normal n + (ε₁, ε₂, ε₃) each form is a sum of the ten monomials of n, ε₁, ε₂,
    ε₃ (0, 1, 2, 3); this one is that of s and t. It follows from F(x + y) − F(x) − F(y).
    """
    for k in range(count):
        prime = tables.primes[k]
        patch = patch_at(work.patches, k)
        parts = ((1, 1), (1, 0), (0, 1)) if s != t else ((1, 0), (0, 0), (0, 0))
        for which, (with_s, with_t) in enumerate(parts):
            if with_s + with_t == 0:
                continue
            x, y, z = 0, 0, 0
            for axis, taken in ((s, with_s), (t, with_t)):
                if taken:
                    x += work.normals[k, 0] if axis == 0 else int(axis == 1)
                    y += work.normals[k, 1] if axis == 0 else int(axis == 2)
                    z += work.normals[k, 2] if axis == 0 else int(axis == 3)
            values = residues_of_forms(patch, Vector(x % prime, y % prime, z % prime), prime)
            for form in range(4):
                value = values[form] if which == 0 else prime - values[form]
                before = work.residues[form, k] if which else 0
                work.residues[form, k] = (value + before) % prime


@inline
def any_residue(residues, form, count):
    """Return whether a number has a nonzero residue."""
    found = False
    for k in range(count):
        found = found or residues[form, k] != 0
    return found


@loop
def exact_forms(mu, i, j, turn, n, tables, work, signs):
    """Write D, U, V, W to work.forms, and the signs of U, V, W to signs (3,).

    Returns the exponent of the unit of the forms, or HIGHEST if the numbers are too long.

    Where a zero among U, V, W leaves undecided whether the patch has the normal, the normal is
    displaced to n + (ε₁, ε₂, ε₃), with n ≫ ε₁ ≫ ε₂ ≫ ε₃ ≫ ε₁²: a form is then a sum of ten
    monomials, each infinitesimal relative to the one before, and the first nonzero one gives
    its sign. For quotients by D, the coefficients of the leading monomial of D are written.
    """
    lowest, highest = exponents_around(mu, i, j)
    lowest_n, highest_n = exponents_of(n)
    unit = 2 * (lowest + lowest_n - 2 * MANTISSA)
    bits = highest - lowest + highest_n - lowest_n + 2 * MANTISSA
    count = int((2 * (bits + WEIGHT_BITS + SUM_BITS) + FORM_BITS) / BITS) + 2
    longest = max(highest - lowest, highest_n - lowest_n)
    if count > tables.primes.size or longest >= tables.powers.shape[1]:
        return HIGHEST
    load_residues(mu, i, j, turn, n, lowest, lowest_n, count, tables, work)
    for form in range(4):
        work.forms[form] = 0.0
    for form in range(3):
        signs[form] = 0
    for s in range(4):
        for t in range(s, 4):
            residues_of_monomial(s, t, count, tables, work)
            leads_in_d = work.forms[0] == 0.0
            for form in range(4):
                known = not leads_in_d and (form == 0 or signs[form - 1] != 0)
                if known or not any_residue(work.residues, form, count):
                    continue
                value = mixed_radix_value(
                    work.residues[form, :count], tables.primes, tables.inverses, work.digits
                )
                if leads_in_d:
                    work.forms[form] = value
                if form > 0 and signs[form - 1] == 0:
                    signs[form - 1] = int(value > 0.0) - int(value < 0.0)
            opposite = min(signs[0], signs[1], signs[2]) < 0 < max(signs[0], signs[1], signs[2])
            if (opposite and s + t == 0) or signs[0] * signs[1] * signs[2] != 0:
                return unit
    return unit


# --- pairs of patches and normals -----------------------------------------------------------------


@jit
def decide_precisely(mu, scale, pairs, first, last, decided):
    """Decide the pairs first, …, last − 1, which are undecided in floating point, with 106 bits.

    If `forgiven` is positive, the parameters are needed outside the patch, too. Signs that are
    still undecided stay unknown.
    """
    columns = mu.shape[1] - 2
    for k in range(first, last):
        i, j, turn = place_of(pairs.patches[k], columns)
        n = row_vector(pairs.normals, k)
        D, U, V, W = precise_forms(mu, i + 1, j + 1, turn, scale, n)
        bound = pairs.bounds[k]
        least = PRECISE * bound
        low = min(U.high, V.high, W.high)
        high = max(U.high, V.high, W.high)
        nearest = min(abs(U.high), abs(V.high), abs(W.high))
        decided.known[k] = (nearest > least and abs(D.high) > bound) or (
            low < -least and high > least and pairs.forgiven[k] == 0.0
        )
        if decided.known[k]:
            for form, value in enumerate((U.high, V.high, W.high)):
                decided.signs[k, form] = int(value > least) - int(value < -least)
            decided.local[k, 0] = U.high / D.high
            decided.local[k, 1] = V.high / D.high
            decided.size[k] = abs(D.high)


@jit
def decide_exactly(mu, scale, pairs, tables, first, last, work, decided):
    """Decide those of the pairs first, …, last − 1 whose signs are unknown, on integers.

    The signs stay unknown if the numbers are too long for the primes.
    """
    columns = mu.shape[1] - 2
    exponent = math.frexp(scale)[1] - 1
    for k in range(first, last):
        if decided.known[k]:
            continue
        i, j, turn = place_of(pairs.patches[k], columns)
        n = row_vector(pairs.normals, k)
        unit = exact_forms(mu, i + 1, j + 1, turn, n, tables, work, decided.signs[k])
        decided.known[k] = unit < HIGHEST
        decided.local[k, 0] = work.forms[1] / work.forms[0]
        decided.local[k, 1] = work.forms[2] / work.forms[0]
        decided.size[k] = math.ldexp(abs(work.forms[0]), unit + 2 * exponent)
