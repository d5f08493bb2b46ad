"""Floating-point numbers as integers times a power of two: formulas of +, − and × are exact."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Integers", "integers", "integers_by_row", "ratio", "sign"]

Integers = NDArray[np.object_]
MANTISSA = 53


def integers(values: NDArray[np.float64]) -> tuple[Integers, int]:
    """Return integers and one exponent with values = integers × 2^exponent, exactly."""
    mantissas, exponents = np.frexp(values)
    whole = np.ldexp(mantissas, MANTISSA).astype(np.int64).astype(object)
    lowest = int(exponents[mantissas != 0].min(initial=exponents.max()))
    shifts = np.maximum(exponents - lowest, 0)
    return np.left_shift(whole, shifts.astype(object)), lowest - MANTISSA


def integers_by_row(vectors: NDArray[np.float64]) -> tuple[Integers, NDArray[np.int64]]:
    """Return vectors (k, 3) as integers (3, k), with an exponent for each vector."""
    mantissas, exponents = np.frexp(vectors)
    whole = np.ldexp(mantissas, MANTISSA).astype(np.int64).astype(object)
    lowest = np.where(mantissas != 0, exponents, 2**30).min(axis=1)
    shifts = np.maximum(exponents - lowest[:, None], 0)
    return (whole << shifts.astype(object)).T, lowest.astype(np.int64) - MANTISSA


def sign(values: Integers) -> NDArray[np.int8]:
    """Return the signs −1, 0, 1."""
    return np.asarray(values > 0, dtype=np.int8) - np.asarray(values < 0, dtype=np.int8)


def ratio(numerator: Integers, denominator: Integers) -> NDArray[np.float64]:
    """Return quotients of integers, correctly rounded."""
    return np.asarray(numerator / denominator, dtype=np.float64)
