"""Tracing of callables made of NumPy functions: they are called with symbols.

Callables that return points give tapes; those that return booleans give inequalities of tapes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real
from types import FunctionType
from typing import Any, NoReturn

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.aliases import Array
from ..domain.domain import Domain, places_in
from ..tape.kernels.points import Tape
from ..tape.tapes import TapeWriter, bounds_over_boxes, values_of

Sides = NDArray[np.int8]
Function = Callable[..., Any]  # of u and v: arrays, or traced numbers

# The number of points where the callable is compared with its tape. The values of callable and tape
# may differ by ROUNDING times the error bound of the tape, since the callable may have larger
# rounding errors.
PLACES = 48
ROUNDING = 64.0


def traced_tape(function: Function, domain: Domain) -> Tape | None:
    """Return the tape of a callable f(u, v) → (..., 3); None if it cannot be traced.

    A callable cannot be traced if it depends on comparisons or single precision, or if another call
    returns other points.
    """
    for called in (function, _with_object_arrays(function)):
        try:
            tape = _tape_of(called)
            return tape if tape is not None and _agree(function, tape, domain) else None
        except Exception:  # any exception of a user's callable for arrays of objects
            continue
    return None


class ObjectArrays:
    """NumPy with other functions `empty`, `zeros` and `sinc`, for traced numbers.

    New float64 arrays are arrays of objects, which can hold traced numbers.
    """

    def __getattr__(self, name: str) -> object:
        return getattr(np, name)

    @staticmethod
    def empty(shape: Any, dtype: DTypeLike = np.float64) -> Any:  # noqa: ANN401
        """Return a new array."""
        return np.empty(shape, object if dtype in (float, np.float64) else dtype)

    @staticmethod
    def zeros(shape: Any, dtype: DTypeLike = np.float64) -> Any:  # noqa: ANN401
        """Return a new array of zeros."""
        return np.zeros(shape, object if dtype in (float, np.float64) else dtype)

    @staticmethod
    def sinc(x: Any) -> Any:  # noqa: ANN401
        """Return sin(π x) / (π x)."""

        def of(y: Any) -> Any:  # noqa: ANN401
            return y.written("sinc", y * math.pi) if isinstance(y, Traced) else np.sinc(y)

        return np.frompyfunc(of, 1, 1)(x)


def _with_object_arrays(function: Function) -> Function:
    """Return a copy of a Python function in which new arrays of NumPy can hold traced numbers.

    The copy has globals of its own, with `ObjectArrays` in place of NumPy. A call that assigns to a
    global raises TypeError. Callables of other types are returned unchanged.
    """
    if not isinstance(function, FunctionType):
        return function
    known = {x: ObjectArrays() if y is np else y for x, y in function.__globals__.items()}
    own = dict(known)
    copy = FunctionType(
        function.__code__, own, function.__name__, function.__defaults__, function.__closure__
    )
    copy.__kwdefaults__ = function.__kwdefaults__

    def called(u: Array, v: Array) -> Any:  # noqa: ANN401
        position = copy(u, v)
        if any(own.get(x) is not y for x, y in known.items()):
            raise TypeError("assignments to globals are not traced")
        return position

    return called


def traced_condition(function: Function, domain: Domain) -> Condition | None:
    """Return the condition that a callable f(u, v) → booleans computes; None if it is not traced.

    A traced condition consists of inequalities that are joined by &, | and ~. Its values are
    compared with those of the callable at some points.
    """
    writer = TapeWriter()
    try:
        found = function(*(Traced(writer, writer.write(x)) for x in "uv"))
        if not isinstance(found, Condition):
            return None
        u, v = places_in(domain, PLACES)
        own, sides = function(u, v), found.sides(np.stack([u, u, v, v], axis=1))
        return found if ((sides == 0) | (own == (sides > 0))).all() else None
    except Exception:  # any exception of a user's callable for objects
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
    """Return whether callable and tape have equal values, up to rounding, at some points."""
    u, v = places_in(domain, PLACES)
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
    """Return the row of a traced number on the tape; a constant is appended to the tape.

    Raises TypeError for any other value.
    """
    if isinstance(value, Traced) and value.writer is writer:
        return value.row
    if isinstance(value, Real) and float(value) == value:
        return writer.constant(float(value))
    raise TypeError(f"{type(value).__name__} is not traced")


def applied(name: str) -> Callable[[Traced], Traced]:
    """Return a method of `Traced` that records the operation `name` on the tape, such as "asin"."""

    def method(self: Traced) -> Traced:
        return self.written(name, self)

    return method


@dataclass(frozen=True, eq=False)
class Traced:
    """A number that depends on u and v: operations on it are written to a tape.

    For an array of objects, a function of NumPy calls the method of the same name of each object:
    np.sin calls `sin`. Comparisons give conditions, which have no truth value. Integer conversion
    and equality raise TypeError.
    """

    writer: TapeWriter
    row: int

    def written(self, name: str, *values: object) -> Traced:
        """Record an operation on numbers on the tape, and return its result."""
        rows = (row_of(self.writer, x) for x in values)
        return Traced(self.writer, self.writer.write(name, *rows))

    def __eq__(self, other: object) -> NoReturn:
        raise TypeError("branches are not traced")

    def __ne__(self, other: object) -> NoReturn:
        raise TypeError("branches are not traced")

    def __bool__(self) -> NoReturn:
        raise TypeError("branches are not traced")

    def __gt__(self, other: object) -> Condition:
        tape = self.writer.tape([(self - other).row] * 3)
        if tape is None:
            raise TypeError("numbers that are not finite are not traced")
        return Positive(tape)

    def __lt__(self, other: object) -> Condition:
        return -self > self.written("negative", other)

    __ge__, __le__ = __gt__, __lt__  # undecided on a box whose bounds contain equality

    def __abs__(self) -> AbsoluteValue:
        return AbsoluteValue(self.writer, (self * self.written("sign", self)).row, self)

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
        """Return the polar angle of the point (other, self), by the tangent of half the angle.

        At the angle π this tangent is unbounded.
        """
        size = self.written("sqrt", self.written("square", other) + self * self)
        return self.written("atan", self / (size + other)) * 2.0

    def tan(self) -> Traced:
        """Return the tangent."""
        return self.sin() / self.cos()

    def arccos(self) -> Traced:
        """Return the inverse cosine."""
        quarter = Traced(self.writer, self.writer.constant(math.pi / 2, 2.0**-53))
        return quarter - self.arcsin()

    sin, cos, exp, log, sqrt = map(applied, ("sin", "cos", "exp", "log", "sqrt"))
    sinh, cosh, tanh = map(applied, ("sinh", "cosh", "tanh"))
    arcsin, arctan = map(applied, ("asin", "atan"))


@dataclass(frozen=True, eq=False)
class AbsoluteValue(Traced):
    """The absolute value of a traced number x.

    Comparisons with |x| become comparisons with x and −x, whose tapes are smooth at x = 0.
    """

    of: Traced

    def __gt__(self, other: object) -> Condition:
        return (self.of > other) | (-self.of > other)

    def __lt__(self, other: object) -> Condition:
        return (self.of < other) & (-self.of < other)

    __ge__, __le__ = __gt__, __lt__


class Condition:
    """A condition on u and v, made of inequalities, which can be evaluated on boxes."""

    def sides(self, boxes: Array) -> Sides:
        """Return 1 for boxes (k, 4) where the condition holds, −1 where it fails, 0 if unknown."""
        raise NotImplementedError

    def __and__(self, other: Condition) -> Condition:
        return Joined(np.minimum, (self, other))

    def __or__(self, other: Condition) -> Condition:
        return Joined(np.maximum, (self, other))

    def __invert__(self) -> Condition:
        return Joined(np.negative, (self,))

    def __bool__(self) -> NoReturn:
        raise TypeError("branches are not traced")


@dataclass(frozen=True, eq=False)
class Positive(Condition):
    """The condition that the first coordinate of a tape is positive."""

    tape: Tape

    def sides(self, boxes: Array) -> Sides:
        """Return the signs (k,) of the coordinate over boxes (k, 4); 0 if its bounds contain 0."""
        low, high = boxes[:, ::2], boxes[:, 1::2]
        halves = (high - low) / 2.0 + np.spacing(np.maximum(np.abs(low), np.abs(high)))
        bounds = bounds_over_boxes(self.tape, (low + high) / 2.0, halves)
        middle, radius = bounds[:, 0, 0, 0], bounds[:, 1, 0, 0]
        return np.where(np.abs(middle) > radius, np.sign(middle), 0.0).astype(np.int8)


@dataclass(frozen=True, eq=False)
class Joined(Condition):
    """A condition made of other conditions, whose values −1, 0, 1 a function of NumPy joins.

    The function is `minimum` for &, `maximum` for | and `negative` for ~.
    """

    join: np.ufunc
    parts: tuple[Condition, ...]

    def sides(self, boxes: Array) -> Sides:
        """Return the values (k,) on boxes (k, 4), joined from the values of the parts."""
        return self.join(*(x.sides(boxes) for x in self.parts))
