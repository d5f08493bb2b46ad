"""Expressions and conditions of users: their checks, and NumPy functions that compute them.

`symbolic.reading` defines the language of texts. SymPy is imported at first use. Functions are
pickled as their expressions. Derivatives are computed from a tape if the expressions have one.
Otherwise, as for Max(u, v), SymPy differentiates the expressions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from numbers import Number
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..base import bridge
from ..base.checks import listed
from ..base.errors import InputError, clipped, shown
from ..tape.kernels.points import Tape
from ..tape.tapes import jets_of, tape_of_steps
from .derivatives import NAMES, Differentiable

if TYPE_CHECKING:
    import sympy

PROBES = np.array([0.25, 0.75])  # parameters for a trial of the derivatives; any values do


def as_position(position: Sequence[Any], symbols: Sequence[sympy.Symbol]) -> tuple[Any, ...]:
    """Return the coordinates: three expressions in two symbols, or two expressions in one symbol.

    A symbol in the expressions that has the name of one of `symbols` is replaced by this one, even
    if the assumptions of the two differ. Raises InputError if the expressions are unusable.
    """
    by_name = {symbol.name: symbol for symbol in symbols}
    expressions = [as_expression(entry, by_name) for entry in _coordinates(position, len(symbols))]
    reading, found = bridge.reading(), []
    unknown: set[Any] = set()
    for e in expressions:
        free: set[Any] = reading.free_symbols(e)
        own = {s: by_name[s.name] for s in free if s.name in by_name}
        found.append(reading.replaced(e, {s: x for s, x in own.items() if s != x}))
        unknown |= free - set(own)
    if unknown:
        names = clipped(", ".join(sorted(map(str, unknown))))
        raise InputError(f"position holds symbols that are neither parameter nor number: {names}.")
    return tuple(found)


def numbers(domain: Sequence[Any], form: str) -> Any:  # noqa: ANN401
    """Return a domain or an interval with bounds as floats; the given bounds may be expressions.

    Raises InputError, which states the required form, if the domain is invalid.
    """

    def number(end: object) -> Any:  # noqa: ANN401
        ends = listed(end)
        return float(as_expression(end, {})) if ends is None else [number(x) for x in ends]

    try:
        return number(domain)
    except (TypeError, ValueError, OverflowError, RecursionError):  # lists that contain themselves
        raise InputError(f"domain must be {form} in numbers, not {shown(domain)}.") from None


def _coordinates(position: Sequence[Any], parameters: int) -> tuple[Any, ...]:
    """Return the coordinates in a position; InputError unless there are `parameters` + 1."""
    names = "(x, y, z)" if parameters == 2 else "(x, y)"
    coordinates = tuple(listed(position) or ())
    if len(coordinates) != parameters + 1:
        number = "three" if parameters == 2 else "two"
        raise InputError(
            f"position must be {number} SymPy expressions {names}, not {shown(position)}."
        )
    return coordinates


def two_symbols(parameters: Sequence[Any]) -> list[sympy.Symbol]:
    """Return real symbols for two parameters, given as symbols or names; otherwise InputError."""
    try:
        u, v = (_symbol(x) for x in parameters)
    except Exception:  # iteration may raise anything
        u = v = None
    if u is None or v is None or u.name == v.name:
        raise InputError(f"parameters must be two SymPy symbols (u, v), not {shown(parameters)}.")
    return [u, v]


def one_symbol(parameter: sympy.Symbol | str) -> list[sympy.Symbol]:
    """Return a real symbol for a parameter, given as symbol or name; otherwise InputError."""
    symbol = _symbol(parameter)
    if symbol is None:
        raise InputError(f"the parameter must be a SymPy symbol such as t, not {shown(parameter)}.")
    return [symbol]


def _symbol(entry: object) -> sympy.Symbol | None:
    import sympy as sp

    if isinstance(entry, sp.Symbol):
        entry = entry.name
    elif not isinstance(entry, str) or not entry.isidentifier():
        return None
    return sp.Symbol(entry, real=True)


def as_expression(entry: Any, symbols: dict[str, Any]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return a SymPy expression, or read one from a text, in which `symbols` are known by name.

    Raises InputError, which states the reason, if the expression is invalid or cannot be compiled.
    """
    import sympy as sp

    expression = _read(entry, symbols)
    if not isinstance(expression, sp.Expr) or expression.is_Matrix:
        raise InputError(f"{shown(entry)} is not a SymPy expression.")
    return expression


def as_condition(entry: Any, symbols: dict[str, Any]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return a Boolean of SymPy, or read one from a text; InputError if it is invalid."""
    from sympy.logic.boolalg import Boolean

    condition = _read(entry, symbols)
    if not isinstance(condition, Boolean) or condition.is_Symbol:
        raise InputError(f"{shown(entry)} is not a condition.")
    return condition


def _read(entry: Any, symbols: dict[str, Any]) -> Any:  # noqa: ANN401
    """Return the SymPy object for a text, a number or an expression; None for anything else.

    SymPy would run texts as Python, even those in lists, so texts are never passed to it.
    """
    import sympy as sp

    reading = bridge.reading()
    try:
        if isinstance(entry, str):
            return reading.read(entry, symbols)
        if not isinstance(entry, sp.Basic | sp.MatrixBase | Number | np.bool_):
            return None
        expression = sp.sympify(entry, strict=True)
        reading.refuse_unusable(expression)
    except reading.ReadingError as error:
        raise InputError(
            f"{shown(entry)} is not a SymPy expression that can be compiled: {error}."
        ) from None
    except (sp.SympifyError, ValueError, TypeError, RecursionError):
        return None
    return expression


# --- callables ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Expressions(Differentiable):
    """The NumPy function of a position, given by SymPy expressions.

    The position is three expressions in two symbols, or two expressions in one symbol.
    """

    has_gaps = True  # sin(u)/u

    expressions: tuple[Any, ...]
    symbols: tuple[sympy.Symbol, ...]

    @property
    def differentiable(self) -> bool:
        """Whether derivatives can be computed: from a tape, or by NumPy from SymPy's formulas."""
        return self._tape is not None or self._derivatives is not None

    def __call__(self, *values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the points (..., 3) or (..., 2) for parameters of one shape."""
        shape = values[0].shape
        return np.stack([np.broadcast_to(x, shape) for x in self._position(*values)], axis=-1)

    def jets(self, u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return positions and derivatives (k, 6, 3)."""
        if self._tape is not None:
            return jets_of(self._tape, u, v)
        assert self._derivatives is not None
        result = np.empty((u.size, 3 * len(NAMES)))
        with np.errstate(all="ignore"):
            for column, values in enumerate(self._derivatives(u, v)):
                result[:, column] = values
        return result.reshape(-1, len(NAMES), 3)

    def tape(self) -> Tape | None:
        """Return the tape of a surface; None if the expressions have operations that tapes lack."""
        return self._tape

    def __getstate__(self) -> dict[str, object]:
        """Return the pickled state: the expressions without the compiled functions."""
        return {"expressions": self.expressions, "symbols": self.symbols}

    @cached_property
    def _position(self) -> Callable[..., Any]:
        return _lambdified(self.symbols, self.expressions)

    @cached_property
    def _tape(self) -> Tape | None:
        steps = bridge.tape_steps(self.expressions, self.symbols)
        return None if steps is None else tape_of_steps(*steps, {})

    @cached_property
    def _derivatives(self) -> Callable[..., Any] | None:
        """The NumPy function of the 18 components of the 2-jet, or None if there is none."""
        expressions = _jet(self.expressions, self.symbols)
        if expressions is None:
            return None
        try:
            function = _lambdified(self.symbols, expressions)
            with np.errstate(all="ignore"):
                values = [np.asarray(x) for x in function(PROBES, PROBES)]
        except Exception:  # functions that NumPy lacks, and SymPy's output for them
            return None
        return function if all(x.dtype.kind in "fi" for x in values) else None


def compiled(position: Sequence[Any], symbols: Sequence[sympy.Symbol]) -> Expressions:
    """Return the NumPy function f(u, v) → (..., 3) of three expressions in two symbols.

    For two expressions in one symbol, return f(t) → (..., 2). Raises InputError if the expressions
    are unusable.
    """
    function = Expressions(as_position(position, symbols), tuple(symbols))
    _ = function._position  # raises InputError if the expressions are unusable
    return function


def _jet(expressions: Sequence[Any], symbols: Sequence[sympy.Symbol]) -> list[Any] | None:
    """Return the 18 expressions of the 2-jet x, x_u, x_v, x_uu, x_uv, x_vv.

    Returns None if SymPy cannot differentiate the expressions.
    """
    import sympy as sp

    if not bridge.reading().is_differentiable(expressions):
        return None
    u, v = symbols
    try:
        x = [_with_floor(e) for e in expressions]
        x_u, x_v = ([_derivative(e, by) for e in x] for by in (u, v))
        x_uu, x_uv = ([_derivative(e, by) for e in x_u] for by in (u, v))
        x_vv = [_derivative(e, v) for e in x_v]
    except Exception:  # SymPy may raise anything
        return None
    jet = [*x, *x_u, *x_v, *x_uu, *x_uv, *x_vv]
    if any(e.has(sp.Derivative, sp.Subs, sp.zoo, sp.nan) for e in jet):
        return None
    return jet


def _with_floor(expression: Any) -> Any:  # noqa: ANN401 - SymPy has no types
    """Rewrite remainders and fractional parts in terms of floor, whose derivative is known."""
    import sympy as sp

    written = expression.replace(sp.Mod, lambda x, y: x - y * sp.floor(x / y))
    return written.replace(sp.frac, lambda x: x - sp.floor(x))


def _derivative(expression: Any, by: sympy.Symbol) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return the derivative of an expression.

    Terms that come from kinks and jumps, such as Dirac deltas, are replaced by 0.
    """
    import sympy as sp

    flat = sp.sign, sp.floor, sp.ceiling, sp.Heaviside
    derivative = sp.diff(expression, by)
    jumps = {
        x: sp.S.Zero
        for x in derivative.atoms(sp.DiracDelta, sp.Derivative, sp.Subs)
        if isinstance(x, sp.DiracDelta) or isinstance(_differentiated(x), flat)
    }
    return derivative.xreplace(jumps)


def _differentiated(expression: Any) -> Any:  # noqa: ANN401
    """Return the function f of an unevaluated derivative f'(g); None if there is none."""
    return expression.args[0].args[0] if expression.args[0].args else None


def _lambdified(symbols: Sequence[sympy.Symbol], expressions: Sequence[Any]) -> Callable[..., Any]:
    """Return a NumPy function of expressions; InputError if they are nested too deeply."""
    import sympy as sp

    modules: list[Any] = ["numpy"]
    reading, found = bridge.reading(), list(expressions)
    if any(isinstance(x, sp.erf | sp.erfc) for e in found for x in reading.parts(e)):
        # NumPy has no erf and erfc.
        from scipy.special import erf, erfc

        modules.insert(0, {"erf": erf, "erfc": erfc})
    common: Any = True
    try:
        if reading.is_long(found):
            definitions, found = reading.with_shared_parts(found)
            common = partial(_defined, definitions)
        return sp.lambdify(symbols, found, modules=modules, cse=common, dummify=True)
    except (RecursionError, MemoryError, SyntaxError):  # SyntaxError: too many brackets
        raise InputError("position is nested too deeply to be compiled.") from None


def _defined(definitions: Any, expressions: Any) -> tuple[Any, Any]:  # noqa: ANN401
    """Return both arguments.

    With `definitions` fixed, this is the function that SymPy's lambdify takes as its option `cse`:
    it returns the definitions of shared parts, and the expressions that use them.
    """
    return definitions, expressions
