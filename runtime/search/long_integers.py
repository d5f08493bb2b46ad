"""The forms U, V, W, D of patches at normals, evaluated on Python integers of any length.

They decide the pairs of a patch and a normal for which the integers of fixed length in
`kernels.decide` are too short, and all undecided pairs in nets. Coefficients and normals are binary
fractions, and the formulas need only +, − and ×, so that the sign of every form is exact.
"""

import numpy as np
from numpy.typing import NDArray

from ...generated.patch import forms
from ...generated.spline import TRIANGLE_NEIGHBOURS, triangle
from ..base.formula_calls import patch, python_function, vector
from ..spline.spline import CENTRE, Spline

Integers = NDArray[np.object_]
MANTISSA = 53


def forms_of_pairs(
    spline: Spline, patches: NDArray[np.int64], normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int8]]:
    """Return U/D and V/D (k, 2), |D| (k,) and the signs of U, V, W (k, 3) for k pairs.

    If a zero among U, V, W leaves undecided whether the patch has the normal, values and signs are
    those at the normal displaced by an infinitesimal vector, see `displaced_forms`.
    """
    vectors, exponent = patch_vectors(spline, patches)
    n, exponents = integers_by_row(normals)
    n = n * leading_sign(n)
    values = exact_forms(vectors, n)
    signs = sign(values[1:])
    tied = (signs == 0).any(axis=0) & ((signs.min(axis=0) >= 0) | (signs.max(axis=0) <= 0))
    if tied.any():
        values[:, tied], signs[:, tied] = displaced_forms(vectors[..., tied], n[:, tied])
    size = _scaled(np.abs(values[0]), 2 * (exponent + exponents))
    local = np.full((len(patches), 2), np.nan)
    some = np.asarray(values[0] != 0, dtype=bool)
    for k in (0, 1):
        local[some, k] = ratio(values[k + 1, some], values[0, some])
    return local, size, signs.T


def patch_vectors(spline: Spline, patches: NDArray[np.int64]) -> tuple[Integers, int]:
    """Return the vectors a, b, c, d, e (5, 3, k) of patches as integers, in units of 2^exponent.

    The second result is the exponent.
    """
    values, exponent = integers(spline._coefficients_around(patches))
    differences = values - values[:, CENTRE, None]
    read = np.moveaxis(differences[:, TRIANGLE_NEIGHBOURS], 1, 0)
    vectors = python_function(triangle)(*map(vector, read))
    return np.array(vectors[:5], dtype=object), exponent + int(np.log2(spline.scale))


def exact_forms(vectors: Integers, n: Integers) -> Integers:
    """Return the exact values of D, U, V, W (4, k) for vectors (5, 3, k) and normals (3, k)."""
    values = python_function(forms)(patch(np.moveaxis(vectors, -1, 0)), vector(n.T))
    return np.array(values, dtype=object)


def displaced_forms(vectors: Integers, n: Integers) -> tuple[Integers, NDArray[np.int8]]:
    """Return D, U, V, W and signs of U, V, W at n + (ε₁, ε₂, ε₃), with n ≫ ε₁ ≫ ε₂ ≫ ε₃ ≫ ε₁².

    A quadratic form at this sum has ten monomials in n, ε₁, ε₂, ε₃, each infinitesimal relative to
    the one before, so that the first nonzero coefficient gives the sign. The values returned are
    the coefficients of one monomial, the first one whose coefficient in D is not 0: their
    quotients by that of D are the parameters of the point.
    """
    coefficients = monomials_of_forms(vectors, n)
    leading = np.argmax(np.asarray(coefficients != 0, dtype=bool), axis=0)
    first = np.take_along_axis(coefficients, leading[None], axis=0)[0]
    in_d = np.take_along_axis(coefficients, leading[None, :1].repeat(4, axis=1), axis=0)[0]
    return in_d, sign(first[1:])


def monomials_of_forms(vectors: Integers, n: Integers) -> Integers:
    """Return the coefficients (10, 4, k) of the ten monomials of the forms D, U, V, W.

    The variables are the normal n and the three axes. The coefficient of a mixed monomial is
    F(x + y) − F(x) − F(y), where F is the form and x, y are two of these vectors.
    """
    axes = [
        n,
        *(np.array([[x], [y], [z]], dtype=object) for x, y, z in np.eye(3, dtype=int).tolist()),
    ]
    alone = [exact_forms(vectors, x + 0 * n) for x in axes]
    monomials = [
        alone[i]
        if i == j
        else exact_forms(vectors, axes[i] + axes[j] + 0 * n) - alone[i] - alone[j]
        for i in range(4)
        for j in range(i, 4)
    ]
    return np.stack(monomials)


def leading_sign(n: Integers) -> Integers:
    """Return the sign of the first nonzero component of each column of n (3, k).

    A normal times this sign is the same for n and −n, so that both are displaced to opposite
    normals. This is needed where a surface is joined to its own mirror image (a Möbius strip): one
    patch has a normal where its neighbour has the opposite normal. The forms are even in n.
    """
    signs = sign(n)
    first = np.argmax(signs != 0, axis=0)
    return np.take_along_axis(signs, first[None], axis=0).astype(object)


def _scaled(values: Integers, exponents: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return values × 2^exponents, as floating-point numbers."""
    pairs = zip(values, exponents.tolist(), strict=True)
    return np.array([x << e if e >= 0 else x / (1 << -e) for x, e in pairs], dtype=np.float64)


# --- floating-point numbers as integers times a power of two --------------------------------------


def integers(values: NDArray[np.float64]) -> tuple[Integers, int]:
    """Return integers and one exponent with values = integers × 2^exponent, exactly."""
    mantissas, exponents = np.frexp(values)
    whole = np.ldexp(mantissas, MANTISSA).astype(np.int64).astype(object)
    lowest = int(exponents[mantissas != 0].min(initial=exponents.max()))
    shifts = np.maximum(exponents - lowest, 0)
    return np.left_shift(whole, shifts.astype(object)), lowest - MANTISSA


def integers_by_row(vectors: NDArray[np.float64]) -> tuple[Integers, NDArray[np.int64]]:
    """Return vectors (k, 3) as integers (3, k), and for each vector the exponent of their unit."""
    mantissas, exponents = np.frexp(vectors)
    whole = np.ldexp(mantissas, MANTISSA).astype(np.int64).astype(object)
    lowest = np.where(mantissas != 0, exponents, 2**30).min(axis=1)
    shifts = np.maximum(exponents - lowest[:, None], 0)
    return (whole << shifts.astype(object)).T, lowest.astype(np.int64) - MANTISSA


def sign(values: Integers) -> NDArray[np.int8]:
    """Return the sign −1, 0 or 1 of each value."""
    return np.asarray(values > 0, dtype=np.int8) - np.asarray(values < 0, dtype=np.int8)


def ratio(numerator: Integers, denominator: Integers) -> NDArray[np.float64]:
    """Return quotients of integers as the nearest floating-point numbers."""
    return np.asarray(numerator / denominator, dtype=np.float64)
