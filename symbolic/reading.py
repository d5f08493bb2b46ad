"""Mathematical text of users as SymPy expressions: nothing in a text is ever run as Python.

The text is parsed by `ast`, and the expression built from the tree: numbers, arithmetic, the
declared symbols, and the functions and constants that stand here. Numbers are bounded before they
are computed, so that a short text cannot ask for a long computation.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NoReturn, cast

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import Boolean, BooleanAtom, BooleanFunction

__all__ = ["ReadingError", "depth", "read", "refuse_unusable"]

LONGEST_TEXT = 20_000  # characters
DEEPEST_BRACKETS = 90  # Python's own parser takes 200
DEEPEST_TREE = 200
MOST_STEPS = 10_000  # operations and calls, those of sums counted for each term
MOST_BITS = 2048  # twice what a float64 can hold
MOST_TERMS = 1000  # of a Sum or a Product
MOST_COMPARED = 12  # values in Min and Max, which SymPy compares in pairs, at 5 ms each
LARGEST_ARGUMENT = 100  # of functions that SymPy computes exactly, such as factorial

CONSTANTS = {
    name: getattr(sp, name)
    for name in (
        "pi", "E", "I", "oo", "zoo", "nan", "GoldenRatio", "TribonacciConstant", "EulerGamma",
        "Catalan", "true", "false",
    )
}  # fmt: skip

FUNCTIONS = {
    name: getattr(sp, name)
    for name in (
        "Abs", "Heaviside", "Max", "Min", "acos", "acosh", "acot", "acoth", "acsc", "acsch", "arg",
        "asec", "asech", "asin", "asinh", "atan", "atan2", "atanh", "ceiling", "conjugate", "cos",
        "cosh", "cot", "coth", "csc", "csch", "erf", "erfc", "floor", "frac", "im", "log", "re",
        "sec", "sech", "sign", "sin", "sinc", "sinh", "tan", "tanh", "Mod", "Add", "Mul",
        "And", "Or", "Not", "Xor", "ITE", "Eq", "Ne", "Lt", "Le", "Gt", "Ge",
        "Integer", "Rational",
    )
} | {"abs": sp.Abs, "ln": sp.log}  # fmt: skip

# SymPy computes these exactly where their arguments are numbers; some are polynomials then.
EXACT = {
    name: getattr(sp, name)
    for name in (
        "factorial", "factorial2", "binomial", "gamma", "RisingFactorial", "FallingFactorial",
        "fibonacci", "lucas", "bernoulli", "harmonic", "catalan", "zeta", "KroneckerDelta",
        "legendre", "assoc_legendre", "chebyshevt", "chebyshevu", "hermite", "laguerre",
    )
}  # fmt: skip

# What may be left in an expression: whether its own kernel has it, each compiler says itself.
USABLE = (
    sp.Symbol, sp.Number, sp.NumberSymbol, type(sp.I), type(sp.zoo), sp.Add, sp.Mul, sp.Pow,
    sp.exp, sp.Piecewise, ExprCondPair, sp.Tuple, sp.UnevaluatedExpr, sp.Sum, sp.Product,
    Relational, BooleanAtom, BooleanFunction, sp.MatrixBase,
    *(x for x in FUNCTIONS.values() if isinstance(x, type)),
)  # fmt: skip

COMPARISONS = {
    ast.Lt: sp.Lt, ast.LtE: sp.Le, ast.Gt: sp.Gt, ast.GtE: sp.Ge, ast.Eq: sp.Eq, ast.NotEq: sp.Ne,
}  # fmt: skip


class ReadingError(ValueError):
    """A text or an expression cannot be used; the message is the reason, without a full stop."""


def read(text: str, symbols: Mapping[str, Any] | None = None, exact: bool = False) -> sp.Basic:
    """Return the expression or condition that a text stands for.

    Names are first looked up in `symbols`; those that are unknown become symbols. `^` is a power.
    With `exact`, decimal numbers are fractions. Raises ReadingError, with the reason, for anything
    but mathematics, for functions that kernels do not have, and for what is too large.
    """
    try:
        expression = _Reader(_source(text), symbols or {}, exact).read()
    except ReadingError:
        raise
    except (RecursionError, MemoryError):
        raise ReadingError("it is nested too deeply") from None
    except Exception as error:  # SymPy raises anything on arguments that it cannot use
        raise ReadingError("SymPy cannot make sense of it") from error
    refuse_unusable(expression)
    return expression


def refuse_unusable(expression: sp.Basic) -> None:
    """Raise ReadingError if an expression has parts that no kernel can have, or huge numbers."""
    if depth(expression) > DEEPEST_TREE:
        raise ReadingError("it is nested too deeply")
    for part in _parts(expression):
        if not isinstance(part, USABLE):
            _refuse_function(part.func.__name__)
        if isinstance(part, sp.Number) and _bits(part) > MOST_BITS:
            _refuse_size()
        if (
            isinstance(part, sp.Pow)
            and part.exp.is_Rational
            and abs(cast(Any, part.exp).p) > MOST_BITS
        ):
            _refuse_size()


def depth(expression: sp.Basic) -> int:
    """Return how many operations and functions stand in one another, at most."""
    levels, part = -1, {expression}
    while part and levels <= DEEPEST_TREE:
        part = {x for y in part for x in y.args if isinstance(x, sp.Basic)}
        levels += 1
    return levels


def _parts(expression: sp.Basic) -> Iterator[sp.Basic]:
    """Yield every different part of an expression once, however deep it is."""
    seen, waiting = {expression}, [expression]
    while waiting:
        part = waiting.pop()
        yield part
        new = {x for x in part.args if isinstance(x, sp.Basic)} - seen
        seen |= new
        waiting.extend(new)


def _refuse_function(name: str) -> NoReturn:
    raise ReadingError(f"it uses {name}, which kernels cannot compute")


def _refuse_size() -> NoReturn:
    raise ReadingError("it holds a number or a power that is too large to compute with")


def _refuse_syntax() -> NoReturn:
    raise ReadingError("it is not arithmetic with functions, as in 'sin(2*u)**2 + 1/3'")


def _source(text: str) -> str:
    """Return a text as `ast` reads it; ReadingError if it is too long or too deep for that."""
    if len(text) > LONGEST_TEXT:
        raise ReadingError(f"it is longer than {LONGEST_TEXT:,} characters")
    depth = 0
    for character in text:
        depth += (character in "([{") - (character in ")]}")
        if depth > DEEPEST_BRACKETS:
            raise ReadingError("it is nested too deeply")
    try:
        return text.encode().decode().strip().replace("^", "**")
    except UnicodeEncodeError:  # of lone surrogates
        _refuse_syntax()


class _Reader:
    """Builds one expression from the syntax tree of a text."""

    def __init__(self, source: str, symbols: Mapping[str, Any], exact: bool) -> None:
        self.source, self.symbols, self.exact = source, dict(symbols), exact
        self.depth = self.steps = self.pairs = 0
        self.operations: dict[type, Callable[[Any], Any]] = {
            ast.Constant: self._number,
            ast.Name: self._name,
            ast.BinOp: self._operation,
            ast.UnaryOp: self._signed,
            ast.Compare: self._comparison,
            ast.Call: self._call,
        }

    def read(self) -> sp.Basic:
        try:
            tree = ast.parse(self.source, mode="eval")
        except (SyntaxError, ValueError):
            _refuse_syntax()
        return self._of(tree.body)

    def _of(self, node: ast.AST) -> Any:  # noqa: ANN401 - SymPy has no types
        self.steps += 1
        if self.depth > DEEPEST_TREE:
            raise ReadingError("it is nested too deeply")
        if self.steps > MOST_STEPS:
            raise ReadingError(f"it has more than {MOST_STEPS:,} operations")
        operation = self.operations.get(type(node))
        if operation is None:
            _refuse_syntax()
        self.depth += 1
        value = operation(node)
        self.depth -= 1
        return _bounded(value)

    def _number(self, node: ast.Constant) -> Any:  # noqa: ANN401
        value = node.value
        if isinstance(value, bool):
            return sp.true if value else sp.false
        if isinstance(value, complex):
            return sp.Float(value.imag) * sp.I
        if isinstance(value, int):
            return sp.Integer(value)
        if not isinstance(value, float):
            _refuse_syntax()
        text = ast.get_source_segment(self.source, node) or ""
        if not abs(value) < float("inf") or (
            value == 0.0 and text.lower().split("e")[0].strip("0._")
        ):
            _refuse_size()
        return sp.Rational(text.replace("_", "")) if self.exact else sp.Float(value)

    def _name(self, node: ast.Name) -> Any:  # noqa: ANN401
        if node.id in self.symbols:
            return self.symbols[node.id]
        if node.id in CONSTANTS:
            return CONSTANTS[node.id]
        if node.id in FUNCTIONS | EXACT | SPECIAL:
            raise ReadingError(f"it uses the function {node.id} without arguments")
        return sp.Symbol(node.id)

    def _operation(self, node: ast.BinOp) -> Any:  # noqa: ANN401
        if isinstance(node.op, ast.Add | ast.Sub):
            first, rest = _chain(node, (ast.Add, ast.Sub))
            terms = [self._of(first)]
            for operator, operand in rest:
                term = self._of(operand)
                terms.append(-term if isinstance(operator, ast.Sub) else term)
            return sp.Add(*terms)
        if isinstance(node.op, ast.Mult | ast.Div | ast.Mod | ast.FloorDiv):
            return self._product(node)
        left, right = self._of(node.left), self._of(node.right)
        if isinstance(node.op, ast.Pow):
            return _power(left, right)
        if isinstance(node.op, ast.BitAnd):
            return sp.And(left, right)
        if isinstance(node.op, ast.BitOr):
            return sp.Or(left, right)
        _refuse_syntax()

    def _product(self, node: ast.BinOp) -> Any:  # noqa: ANN401
        first, rest = _chain(node, (ast.Mult, ast.Div, ast.Mod, ast.FloorDiv))
        factors = [self._of(first)]
        for operator, operand in rest:
            factor = self._of(operand)
            if isinstance(operator, ast.Mult):
                factors.append(factor)
            elif isinstance(operator, ast.Div):
                factors.append(_power(factor, sp.S.NegativeOne))
            elif isinstance(operator, ast.Mod):
                factors = [sp.Mod(_bounded(sp.Mul(*factors)), factor)]
            else:
                factors = [sp.floor(_bounded(sp.Mul(*factors)) / factor)]
        return sp.Mul(*factors)

    def _signed(self, node: ast.UnaryOp) -> Any:  # noqa: ANN401
        value = self._of(node.operand)
        if isinstance(node.op, ast.USub):
            return -value
        return sp.Not(value) if isinstance(node.op, ast.Invert | ast.Not) else value

    def _comparison(self, node: ast.Compare) -> Any:  # noqa: ANN401
        relation = COMPARISONS.get(type(node.ops[0]))
        if relation is None or len(node.ops) > 1:
            _refuse_syntax()
        return cast(Any, relation)(self._of(node.left), self._of(node.comparators[0]))

    def _call(self, node: ast.Call) -> Any:  # noqa: ANN401
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if not name or node.keywords:
            _refuse_syntax()
        if name == "Piecewise":
            return sp.Piecewise(*(self._pair(x) for x in node.args))
        if name in ("Sum", "Product"):
            return self._finite(node, sp.Add if name == "Sum" else sp.Mul)
        if name not in FUNCTIONS | EXACT | SPECIAL:
            _refuse_function(name)
        arguments = [self._of(x) for x in node.args]
        if name in ("Min", "Max"):
            self._count_compared(arguments)
        if name in EXACT and any(
            x.is_number and not abs(_value(x)) <= LARGEST_ARGUMENT for x in arguments
        ):
            _refuse_size()
        return (FUNCTIONS | EXACT | SPECIAL)[name](*arguments)

    def _count_compared(self, arguments: list[Any]) -> None:
        """Refuse more pairs in all Min and Max than there are of MOST_COMPARED values."""
        values = sum(len(x.args) if isinstance(x, sp.Min | sp.Max) else 1 for x in arguments)
        self.pairs += values * values
        if self.pairs > MOST_COMPARED**2:
            raise ReadingError(f"its Min and Max compare more than {MOST_COMPARED} values")

    def _pair(self, node: ast.AST) -> tuple[Any, Any]:
        """Return a value and its condition, in Piecewise."""
        if not isinstance(node, ast.Tuple) or len(node.elts) != 2:
            _refuse_syntax()
        return self._of(node.elts[0]), self._of(node.elts[1])

    def _finite(self, node: ast.Call, joined: Callable[..., Any]) -> Any:  # noqa: ANN401
        """Return a sum or product over whole numbers, as in Sum(u**k, (k, 0, 3)), term by term."""
        if len(node.args) != 2 or not isinstance(limits := node.args[1], ast.Tuple):
            _refuse_syntax()
        if len(limits.elts) != 3 or not isinstance(index := limits.elts[0], ast.Name):
            _refuse_syntax()
        low, high = (self._of(x) for x in limits.elts[1:])
        if not (low.is_Integer and high.is_Integer and high - low < MOST_TERMS):
            raise ReadingError(f"a sum or product has no whole limits at most {MOST_TERMS} apart")
        outside, terms = self.symbols, []
        for k in range(int(low), int(high) + 1):
            self.symbols = {**outside, index.id: sp.Integer(k)}
            terms.append(self._of(node.args[0]))
        self.symbols = outside
        return joined(*terms)


def _chain(node: ast.AST, kinds: tuple[type, ...]) -> tuple[ast.AST, list[tuple[ast.AST, ast.AST]]]:
    """Return the first operand of a - b + c, and the others with the operators before them."""
    rest: list[tuple[ast.AST, ast.AST]] = []
    while isinstance(node, ast.BinOp) and isinstance(node.op, kinds):
        rest.append((node.op, node.right))
        node = node.left
    return node, rest[::-1]


def _power(base: Any, exponent: Any) -> Any:  # noqa: ANN401
    """Return a power, if its numbers cannot become too large: SymPy computes 2**(10**9) + 1."""
    bits = max((_bits(x) for x in base.atoms(sp.Number)), default=1)
    for term in sp.Add.make_args(exponent):
        if term.is_number and abs(_value(term)) * max(bits, 1) > MOST_BITS:
            _refuse_size()
    return sp.Pow(base, exponent)


def _root(base: Any, degree: Any) -> Any:  # noqa: ANN401
    return _power(base, _power(degree, sp.S.NegativeOne))


# Powers under other names.
SPECIAL: dict[str, Callable[..., Any]] = {
    "Pow": _power,
    "exp": lambda x: _power(sp.E, x),
    "sqrt": lambda x: _power(x, sp.S.Half),
    "cbrt": lambda x: _root(x, sp.Integer(3)),
    "root": _root,
    "Float": lambda x: sp.Float(x),  # without its other argument, a number of digits
}


def _bounded(value: Any) -> Any:  # noqa: ANN401
    """Return a value; ReadingError if it is a constant far outside the range of float64."""
    if (
        isinstance(value, Boolean)
        or not value.is_number
        or value.has(sp.oo, -sp.oo, sp.zoo, sp.nan)
    ):
        return value
    parts = [value] if value.is_Number else value.evalf(8, maxn=60).as_real_imag()
    if any(x.is_Number and _bits(x) > MOST_BITS for x in parts):
        _refuse_size()
    return value


def _bits(number: Any) -> int:  # noqa: ANN401
    """Return the length of a number: of numerator or denominator, or the exponent of a float."""
    if number.is_Rational and number.is_finite:
        return max(int(number.p).bit_length(), int(number.q).bit_length())
    if number.is_Float:
        _, mantissa, exponent, length = number._mpf_
        return abs(exponent + length) if mantissa else 0
    return 0


def _value(constant: Any) -> complex:  # noqa: ANN401
    """Return about what a constant is; infinity if that is not known."""
    try:
        return complex(constant.evalf(8, maxn=60))
    except (TypeError, ValueError, OverflowError):
        return complex("inf")
