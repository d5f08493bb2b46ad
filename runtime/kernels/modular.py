"""Exact integers by their residues modulo several primes.

Coefficients and normals are binary fractions: in a common unit they are integers, and so are the
forms of patches and normals. These are computed modulo primes, which is exact if the product of the
primes is larger than the result. The number itself is found in mixed radix (Garner, The residue
number system, https://doi.org/10.1109/TEC.1959.5219515).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...generated.patch import eliminated_forms, linear_forms
from ...generated.spline import NEIGHBOURS, triangle
from ...generated.vectors import Patch, Vector
from .jit import loop
from .patch import EAST, NORTH, SOUTH, SOUTHEAST, SOUTHWEST, WEST, vector_at

__all__ = [
    "HIGHEST",
    "MANTISSA",
    "exponents_around",
    "exponents_of",
    "mixed_radix_value",
    "residue",
    "residues_of_forms",
    "residues_of_patch",
]

MANTISSA = 53
# Beyond all exponents. It has a type: a literal number is compiled for itself.
HIGHEST: Any = np.int64(1 << 30)


@loop
def widened(lowest, highest, value):
    """Return the lowest and the highest exponent, including one more number; 0 has none."""
    if value != 0.0:
        exponent = math.frexp(value)[1]
        lowest, highest = min(lowest, exponent), max(highest, exponent)
    return lowest, highest


@loop
def exponents_of(v):
    """Return the lowest and the highest exponent of the components of a vector."""
    lowest, highest = widened(HIGHEST, -HIGHEST, v.x)
    lowest, highest = widened(lowest, highest, v.y)
    return widened(lowest, highest, v.z)


@loop
def exponents_around(mu, i, j):
    """Return the lowest and the highest exponent of the coefficient (i, j) and its neighbours."""
    lowest, highest = HIGHEST, -HIGHEST
    for p in range(i - 1, i + 2):
        for q in range(j - 1, j + 2):
            for x in range(3):
                lowest, highest = widened(lowest, highest, mu[p, q, x])
    return lowest, highest


@loop
def residue(value, lowest, prime, powers):
    """Return the integer value / 2^(lowest − MANTISSA) modulo a prime; powers are those of two."""
    mantissa, exponent = math.frexp(value)
    if mantissa == 0.0:
        return 0
    return int(math.ldexp(mantissa, MANTISSA)) % prime * powers[exponent - lowest] % prime


@loop
def residues_of_vector(v, lowest, prime, powers):
    """Return the residues of the components of a vector."""
    return Vector(
        residue(v.x, lowest, prime, powers),
        residue(v.y, lowest, prime, powers),
        residue(v.z, lowest, prime, powers),
    )


@loop
def neighbour(mu, i, j, turn, k, centre, lowest, prime, powers):
    """Return neighbour k minus the coefficient, up to multiples of a prime."""
    value = vector_at(mu, i + NEIGHBOURS[turn, k, 0], j + NEIGHBOURS[turn, k, 1])
    v = residues_of_vector(value, lowest, prime, powers)
    return Vector(v.x - centre.x, v.y - centre.y, v.z - centre.z)


@loop
def residues_of_patch(mu, i, j, turn, lowest, prime, powers) -> Patch:
    """Return the vectors of the patch of the coefficient (i, j), up to multiples of a prime."""
    centre = residues_of_vector(vector_at(mu, i, j), lowest, prime, powers)
    return triangle(
        neighbour(mu, i, j, turn, SOUTHWEST, centre, lowest, prime, powers),
        neighbour(mu, i, j, turn, SOUTH, centre, lowest, prime, powers),
        neighbour(mu, i, j, turn, SOUTHEAST, centre, lowest, prime, powers),
        neighbour(mu, i, j, turn, WEST, centre, lowest, prime, powers),
        neighbour(mu, i, j, turn, EAST, centre, lowest, prime, powers),
        neighbour(mu, i, j, turn, NORTH, centre, lowest, prime, powers),
    )


@loop
def residues_of_forms(patch, n, prime):
    """Return D, U, V, W modulo a prime, from the residues of a patch and of a normal."""
    A, B, C, P, Q = linear_forms(patch, n)
    D, U, V, W = eliminated_forms(A % prime, B % prime, C % prime, P % prime, Q % prime)
    return D % prime, U % prime, V % prime, W % prime


@loop
def mixed_radix_value(residues, primes, inverses, digits):
    """Return the number (sign included) that has residues (m,) modulo the first m primes.

    It must be smaller than the product of the first m − 1. inverses[i, k] is the inverse of prime i
    modulo prime k. `digits` (m,) is a work array for the mixed-radix digits of the number or of its
    opposite: the last one is zero for the one that is positive.
    """
    count = residues.size
    negative = False
    for _ in range(2):
        for k in range(count):
            prime = primes[k]
            digit = (prime - residues[k]) % prime if negative else residues[k]
            for i in range(k):
                digit = (digit - digits[i]) % prime * inverses[i, k] % prime
            digits[k] = digit
        if digits[count - 1] == 0:
            break
        negative = True
    value = 0.0
    for k in range(count - 1, -1, -1):
        value = value * primes[k] + digits[k]
    return -value if negative else value
