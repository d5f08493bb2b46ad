"""Tapes of callables that are made of NumPy functions: they are called once with symbols."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..domain.domain import Domain
from ..kernels.tape import Tape
from .tapes import TapeWriter, values_of

__all__ = ["traced_tape"]

Array = NDArray[np.float64]
Function = Callable[[Array, Array], Any]

# The callable and the tape are compared at points (i/√2, i/√3) modulo 1 of the domain. Both have
# rounding errors, of which that of the tape is bounded, and that of the callable may be larger.
PLACES = 48
ROUNDING = 64.0


def traced_tape(function: Function, domain: Domain) -> Tape | None:
    """Return the tape of a callable f(u, v) → (..., 3); None if it does what is not traced.

    What depends on comparisons, on single precision or on anything but u and v has none.
    """
    try:
        tape = _tape_of(function)
        return tape if tape is not None and _agree(function, tape, domain) else None
    except Exception:  # what a user's callable raises for arrays of objects
        return None


def _tape_of(function: Function) -> Tape | None:
    writer = TapeWriter()
    u, v = np.empty(1, dtype=object), np.empty(1, dtype=object)
    u[0], v[0] = (Traced(writer, writer.write(x)) for x in "uv")
    position = np.asarray(function(u, v), dtype=object)
    if position.shape != (1, 3):
        return None
    return writer.tape([row_of(writer, x) for x in position[0]])


def _agree(function: Function, tape: Tape, domain: Domain) -> bool:
    """Return whether the callable has the values of a tape, but for rounding."""
    steps = np.arange(1, PLACES + 1)
    u, v = (
        low + (high - low) * (np.sqrt(x) * steps % 1.0)
        for x, (low, high) in zip((0.5, 1 / 3), domain, strict=True)
    )
    values, errors = values_of(tape, u, v)
    with np.errstate(all="ignore"):
        own = np.asarray(function(u, v))
    known = np.isfinite(errors)
    return bool(
        own.dtype == np.float64
        and own.shape == values.shape
        and known.any(axis=0).all()
        and (np.abs(own - values) <= ROUNDING * errors)[known].all()
    )


def row_of(writer: TapeWriter, value: object) -> int:
    """Return the row of a traced number, or of a constant; TypeError for anything else."""
    if isinstance(value, Traced) and value.writer is writer:
        return value.row
    if isinstance(value, Real) and float(value) == value:
        return writer.constant(float(value))
    raise TypeError(f"{type(value).__name__} is not traced")


def applied(name: str) -> Callable[[Traced], Traced]:
    """Return the method that writes a function of the generated formulas."""

    def method(self: Traced) -> Traced:
        return self.written(name, self)

    return method


@dataclass(frozen=True, eq=False)
class Traced:
    """A number that depends on u and v: what is done to it is written to a tape.

    NumPy's functions call the methods of their names for arrays of objects. There are none for
    comparisons, absolute values and integers, which raise TypeError.
    """

    writer: TapeWriter
    row: int

    def written(self, name: str, *values: object) -> Traced:
        """Return an operation on numbers."""
        rows = (row_of(self.writer, x) for x in values)
        return Traced(self.writer, self.writer.write(name, *rows))

    def __eq__(self, other: object) -> NoReturn:
        raise TypeError("branches are not traced")

    def __ne__(self, other: object) -> NoReturn:
        raise TypeError("branches are not traced")

    def __bool__(self) -> NoReturn:
        raise TypeError("branches are not traced")

    def __pos__(self) -> Traced:
        return self

    def __neg__(self) -> Traced:
        return self.written("negative", self)

    def __add__(self, other: object) -> Traced:
        return self.written("sum", self, other)

    __radd__ = __add__

    def __sub__(self, other: object) -> Traced:
        return self + self.written("negative", other)

    def __rsub__(self, other: object) -> Traced:
        return -self + other

    def __mul__(self, other: object) -> Traced:
        return self**2 if other is self else self.written("product", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Traced:
        return self * self.written("reciprocal", other)

    def __rtruediv__(self, other: object) -> Traced:
        return self.written("reciprocal", self) * other

    def __pow__(self, other: object) -> Traced:
        halves = 2.0 * float(other) if isinstance(other, Real) else math.nan
        if halves.is_integer() and halves != 0.0:
            return Traced(self.writer, self.writer.power(self.row, int(halves)))
        return self.written("exp", self.log() * other)

    def __rpow__(self, other: object) -> Traced:
        return self.written("exp", self * self.written("log", other))

    def hypot(self, other: object) -> Traced:
        """Return √(x² + y²)."""
        return self.written("sqrt", self * self + self.written("square", other))

    def arctan2(self, other: object) -> Traced:
        """Return the angle of (other, self), by half of it: it has no bounds where that is π/2."""
        size = self.written("sqrt", self.written("square", other) + self * self)
        return self.written("atan", self / (size + other)) * 2.0

    def tan(self) -> Traced:
        """Return the tangent."""
        return self.sin() / self.cos()

    def arccos(self) -> Traced:
        """Return the inverse of the cosine."""
        quarter = Traced(self.writer, self.writer.constant(math.pi / 2, 2.0**-53))
        return quarter - self.arcsin()

    sin, cos, exp, log, sqrt = map(applied, ("sin", "cos", "exp", "log", "sqrt"))
    sinh, cosh, tanh = map(applied, ("sinh", "cosh", "tanh"))
    arcsin, arctan = map(applied, ("asin", "atan"))
