"""Double-doubles: numbers of 106 bits as unevaluated sums of two floating-point numbers.

Formulas of sums, differences and products run on them as they are: operators on pairs are compiled
to the functions below. These are two_sum (Knuth, The Art of Computer Programming, vol. 2, 4.2.2;
Møller, https://doi.org/10.1007/BF01975722), and split (Veltkamp) and two_product, both in Dekker,
https://doi.org/10.1007/BF01397083. Sums of pairs are those of Hida, Li and Bailey,
https://doi.org/10.1109/ARITH.2001.930115. They need the rounding of IEEE 754, and no fast-math.
"""

from __future__ import annotations

import operator
from typing import Any, NamedTuple

from numba import types
from numba.extending import overload

from .jit import inline, loop

__all__ = ["DoubleDouble", "split", "two_product", "two_sum"]

SPLITTER = 134217729.0  # 2²⁷ + 1


def _python(function: Any) -> Any:
    return getattr(function, "py_func", function)


class DoubleDouble(NamedTuple):
    """The number high + low, where low is at most half a unit in the last place of high."""

    high: float
    low: float

    # The operators without compilation.

    def __add__(self, other: Any) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Return the sum of two pairs."""
        return _python(add)(self, other)

    def __sub__(self, other: Any) -> Any:
        """Return the difference of two pairs."""
        return self + -other

    def __mul__(self, other: Any) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Return the product of two pairs."""
        return _python(multiply)(self, other)

    def __rmul__(self, power: Any) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Return the product with a power of two."""
        return _python(scale)(power, self)

    def __neg__(self) -> Any:
        """Return the opposite number."""
        return _python(negate)(self)


# --- exact sums and products of two numbers -------------------------------------------------------


@inline
def two_sum(x, y):
    """Return the rounded sum of two numbers and its error: together they are x + y exactly."""
    s = x + y
    part = s - x
    return s, (x - (s - part)) + (y - part)


@inline
def split(x):
    """Return two numbers of 26 bits each whose sum is x."""
    c = SPLITTER * x
    high = c - (c - x)
    return high, x - high


@inline
def two_product(x, y):
    """Return the rounded product of two numbers and its error: together they are x y exactly."""
    product = x * y
    a, b = split(x)
    c, d = split(y)
    return product, ((a * c - product) + a * d + b * c) + b * d


# --- arithmetic on pairs --------------------------------------------------------------------------


@loop
def add(x, y):
    """Return x + y."""
    high, low = two_sum(x.high, y.high)
    middle, rest = two_sum(x.low, y.low)
    high, low = two_sum(high, low + middle)
    high, low = two_sum(high, low + rest)
    return DoubleDouble(high, low)


@inline
def negate(x):
    """Return −x."""
    return DoubleDouble(-x.high, -x.low)


@loop
def subtract(x, y):
    """Return x − y."""
    return add(x, DoubleDouble(-y.high, -y.low))


@loop
def multiply(x, y):
    """Return x y."""
    product, error = two_product(x.high, y.high)
    high, low = two_sum(product, error + (x.high * y.low + x.low * y.high))
    return DoubleDouble(high, low)


@inline
def scale(power, x):
    """Return x times a power of two, exactly."""
    return DoubleDouble(x.high * power, x.low * power)


# --- operators in compiled code -------------------------------------------------------------------


def is_pair(kind: types.Type) -> bool:
    """Say whether something is a double-double, by its type in compiled code."""
    return getattr(kind, "instance_class", None) is DoubleDouble


@overload(operator.add)
def _add(x, y):
    if is_pair(x) and is_pair(y):
        return lambda x, y: add(x, y)
    return None


@overload(operator.sub)
def _subtract(x, y):
    if is_pair(x) and is_pair(y):
        return lambda x, y: subtract(x, y)
    return None


@overload(operator.mul)
def _multiply(x, y):
    if is_pair(y):
        if is_pair(x):
            return lambda x, y: multiply(x, y)
        if isinstance(x, types.Number):
            return lambda x, y: scale(x, y)
    return None


@overload(operator.neg)
def _negate(x):
    if is_pair(x):
        return lambda x: negate(x)
    return None
