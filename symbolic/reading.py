"""Users' mathematical texts as SymPy expressions; no part of a text is run as Python.

The text is parsed by `ast`, and the expression is built from the tree: literals, arithmetic, the
declared symbols, and the constants and functions listed here. A value is a number or a truth value;
each function declares which of the two it takes. The work of SymPy is bounded in advance: long
constants become floating-point numbers, and operations and queries of signs are counted.
"""

import ast
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from decimal import Decimal
from itertools import islice
from typing import Any, NamedTuple, NoReturn

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import Boolean, BooleanAtom, BooleanFunction

LONGEST_TEXT = 20_000  # characters
DEEPEST_TREE = 200
MOST_STEPS = 10_000  # literals, names, operations and calls; those in sums count for each term
MOST_BITS = 2048  # twice the largest binary exponent of a float64
MOST_PLAIN_BITS = 32  # bits of numbers whose roots and functions SymPy may evaluate exactly
MOST_EXACT = 30  # numbers and operations in a constant that is not a float

# A function costs SymPy about a microsecond times the square of the number of steps of its
# arguments. A query of the sign of an argument costs as much as ASKING additional steps.
MOST_WORK = 1_000_000
ASKING = 80
MOST_DERIVED = 100_000  # numbers and operations in second derivatives


class ReadingError(ValueError):
    """A text or an expression cannot be used; the message is the reason, without a full stop."""


# --- what may stand in a text ---------------------------------------------------------------------


class Function(NamedTuple):
    """A function of SymPy that texts may use; it takes numbers or truth values.

    `counts` are the possible numbers of arguments. If it `asks`, SymPy queries the signs of
    arguments.
    """

    of: Callable[..., Any]
    takes: type
    counts: range
    asks: bool


def _functions(
    names: str, takes: type = sp.Expr, counts: range = range(1, 2), asks: bool = False
) -> dict[str, Function]:
    return {name: Function(getattr(sp, name), takes, counts, asks) for name in names.split()}


def _power(base: Any, exponent: Any) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return a power; ReadingError if SymPy may compute huge numbers, as for 2**(10**9) + 1."""
    bits = max((_bits(x) for x in base.atoms(sp.Number)), default=1)
    for term in sp.Add.make_args(exponent):
        if term.is_number and abs(_float(term)) * max(bits, 1) > MOST_BITS:
            _refuse_size()
    return sp.Pow(base, exponent)


ONE, TWO, SOME = range(1, 2), range(2, 3), range(1, MOST_STEPS)

FUNCTIONS = {
    **_functions("sin cos tan cot sec csc asin acos atan acot asec acsc"),
    **_functions("sinh cosh tanh coth sech csch asinh acosh atanh acoth asech acsch"),
    **_functions("erf erfc sinc"),
    **_functions("log", counts=range(1, 3)),
    **_functions("Abs sign floor ceiling", asks=True),
    **_functions("atan2 Lt Le Gt Ge Eq Ne", counts=TWO, asks=True),
    **_functions("Min Max", counts=SOME, asks=True),
    **_functions("And Or Xor", takes=Boolean, counts=SOME),
    **_functions("Not", takes=Boolean),
    **_functions("ITE", takes=Boolean, counts=range(3, 4)),
    "exp": Function(lambda x: _power(sp.E, x), sp.Expr, ONE, False),
    "sqrt": Function(lambda x: _power(x, sp.S.Half), sp.Expr, ONE, True),
    "cbrt": Function(lambda x: _power(x, sp.Rational(1, 3)), sp.Expr, ONE, True),
    "root": Function(lambda x, n: _power(x, _power(n, sp.S.NegativeOne)), sp.Expr, TWO, True),
    "Pow": Function(_power, sp.Expr, TWO, True),
    "Heaviside": Function(lambda x: (1 + sp.sign(x)) / 2, sp.Expr, ONE, True),
}
FUNCTIONS |= {"abs": FUNCTIONS["Abs"], "ln": FUNCTIONS["log"]}
PARTED = ("Piecewise", "Sum", "Product")  # functions whose arguments are not values

CONSTANTS = {
    name: getattr(sp, name)
    for name in (
        "pi", "E", "GoldenRatio", "TribonacciConstant", "EulerGamma", "Catalan", "true", "false",
    )
}  # fmt: skip

UNREAL = ("I", "oo", "zoo", "nan")  # names of SymPy

OPERATORS = {
    ast.Lt: "Lt", ast.LtE: "Le", ast.Gt: "Gt", ast.GtE: "Ge", ast.Eq: "Eq", ast.NotEq: "Ne",
    ast.BitAnd: "And", ast.BitOr: "Or", ast.Invert: "Not", ast.Not: "Not", ast.Pow: "Pow",
}  # fmt: skip

# The classes that an expression may contain; each compiler checks whether it supports them.
USABLE = (
    sp.Symbol, sp.Number, sp.NumberSymbol, type(sp.I), sp.Add, sp.Mul, sp.Pow, sp.exp,
    sp.Piecewise, ExprCondPair, sp.Tuple, sp.UnevaluatedExpr, sp.Sum, sp.Product,
    Relational, BooleanAtom, BooleanFunction, sp.MatrixBase,
    sp.Mod, sp.frac, sp.Heaviside, sp.re, sp.im, sp.arg, sp.conjugate,
    *(x.of for x in FUNCTIONS.values() if isinstance(x.of, type)),
)  # fmt: skip


# --- checks ---------------------------------------------------------------------------------------


def read(text: str, symbols: Mapping[str, Any] | None = None, exact: bool = False) -> sp.Basic:
    """Return the expression or condition of a text.

    Names are first looked up in `symbols`; unknown names become symbols. `^` is a power. With
    `exact`, decimal numbers are fractions, and no number is rounded. Raises ReadingError, with the
    reason, for anything but real mathematics, for functions that are neither in `FUNCTIONS` nor in
    `PARTED`, and for expressions that are too large.
    """
    try:
        expression = _Reader(text, symbols or {}, exact).read()
    except ReadingError:
        raise
    except (RecursionError, MemoryError):
        raise ReadingError("it is nested too deeply") from None
    except Exception as error:  # SymPy may raise anything for unusable arguments
        raise ReadingError("SymPy cannot make sense of it") from error
    refuse_unusable(expression)
    return expression


def refuse_unusable(expression: sp.Basic) -> None:
    """Raise ReadingError if an expression is too deep, or has parts that kernels cannot compute."""
    if _depth(expression) > DEEPEST_TREE:
        raise ReadingError("it is nested too deeply")
    for part in parts(expression):
        if part in (sp.nan, sp.zoo, sp.oo, -sp.oo):
            raise ReadingError("it is not finite")
        if not isinstance(part, USABLE):
            _refuse_function(part.func.__name__)
        exponent = part.exp if isinstance(part, sp.Pow) else sp.S.Zero
        if _bits(part) > MOST_BITS or (exponent.is_Rational and abs(exponent) > MOST_BITS):
            _refuse_size()


def is_long(expressions: Iterable[sp.Basic]) -> bool:
    """Return whether expressions, written out, have more parts than texts may have (MOST_STEPS).

    Shared parts count each time that they occur, since SymPy's functions visit them each time.
    """
    known: dict[sp.Basic, tuple[int, int, int]] = {}
    return sum(_sizes(x, known)[0] for x in expressions) > MOST_STEPS


def is_differentiable(expressions: Iterable[sp.Basic]) -> bool:
    """Return whether SymPy can derive second derivatives of expressions within a few seconds."""
    known: dict[sp.Basic, tuple[int, int, int]] = {}
    return sum(_sizes(x, known)[2] for x in expressions) <= MOST_DERIVED


def _sizes(x: sp.Basic, known: dict[sp.Basic, tuple[int, int, int]]) -> tuple[int, int, int]:
    """Return the approximate sizes of an expression and of its first and second derivatives."""
    if x not in known:
        parts = [_sizes(y, known) for y in x.args if isinstance(y, sp.Basic)]
        size, first, second = (sum(y[k] for y in parts) for k in range(3))
        size += 1
        if isinstance(x, sp.Symbol):
            first = 1
        elif isinstance(x, Boolean):  # conditions are not differentiated
            first = second = 0
        elif not isinstance(x, sp.Add | sp.Piecewise | ExprCondPair):  # rules of product and chain
            count = sum(y[1] > 0 for y in parts)
            if isinstance(x, sp.Min | sp.Max):  # each argument is compared with all others
                count **= 2
            first, second = first + count * size, second + 2 * count * first + count**2 * size
        known[x] = size, first, second
    return known[x]


def _depth(expression: sp.Basic) -> int:
    """Return the largest depth of nested operations and functions."""
    levels, part = -1, {expression}
    while part and levels <= DEEPEST_TREE:
        part = {x for y in part for x in y.args if isinstance(x, sp.Basic)}
        levels += 1
    return levels


def parts(expression: sp.Basic) -> Iterator[sp.Basic]:
    """Yield every distinct subexpression once, at any depth.

    SymPy's own traversals visit a shared part once for each path to it.
    """
    seen, waiting = {expression}, [expression]
    while waiting:
        part = waiting.pop()
        yield part
        new = {x for x in part.args if isinstance(x, sp.Basic)} - seen
        seen |= new
        waiting.extend(new)


def free_symbols(expression: sp.Basic) -> set[sp.Basic]:
    """Return the symbols that an expression depends on."""
    found = list(parts(expression))
    if any(isinstance(x, sp.Sum | sp.Product) for x in found):  # these bind symbols
        return set(expression.free_symbols)
    return {x for x in found if isinstance(x, sp.Symbol)}


def replaced(expression: Any, rules: Mapping[Any, Any]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return an expression with parts replaced, as `xreplace` does, but visit shared parts once."""
    known: dict[Any, Any] = dict(rules)
    plain = {"evaluate": False} if rules and is_long([expression]) else {}

    def of(x: Any) -> Any:  # noqa: ANN401
        if x not in known:
            args = [of(y) if isinstance(y, sp.Basic) else y for y in x.args]
            same = all(y is z for y, z in zip(args, x.args, strict=True))
            options = plain if isinstance(x, sp.Add | sp.Mul | sp.Pow) else {}
            known[x] = x if same else x.func(*args, **options)
        return known[x]

    return of(expression) if rules else expression


def with_shared_parts(expressions: Iterable[Any]) -> tuple[list[tuple[sp.Symbol, Any]], list[Any]]:
    """Return definitions of symbols for parts that are used several times, and the expressions.

    Symbols replace these parts in the expressions, and in the definitions.
    """
    expressions = list(expressions)
    uses = Counter(y for x in {y for e in expressions for y in parts(e)} for y in x.args)
    uses.update(expressions)
    known: dict[Any, Any] = {}
    shared: list[tuple[sp.Symbol, Any]] = []

    def of(x: Any) -> Any:  # noqa: ANN401 - SymPy has no types
        if x not in known:
            args = [of(y) if isinstance(y, sp.Basic) else y for y in x.args]
            value = x.func(*args) if args else x
            if args and uses[x] > 1 and isinstance(x, sp.Expr):
                shared.append((sp.Dummy(real=True), value))
                value = shared[-1][0]
            known[x] = value
        return known[x]

    outputs = [of(e) for e in expressions]
    return shared, outputs


def _refuse_function(name: str) -> NoReturn:
    raise ReadingError(f"it uses {name}, which kernels cannot compute")


def _refuse_size() -> NoReturn:
    raise ReadingError("it holds a number or a power that is too large to compute with")


def _refuse_syntax() -> NoReturn:
    raise ReadingError("it is not arithmetic with functions, as in 'sin(2*u)**2 + 1/3'")


# --- the reader -----------------------------------------------------------------------------------


class _Reader:
    """Builds one expression from the syntax tree of a text."""

    def __init__(self, text: str, symbols: Mapping[str, Any], exact: bool) -> None:
        self.source = text.strip().replace("^", "**")
        self.symbols, self.exact = dict(symbols), exact
        self.depth = self.steps = self.work = 0
        self.readers: dict[type, Callable[[Any], Any]] = {
            ast.Constant: self._literal,
            ast.Name: self._name,
            ast.BinOp: self._operation,
            ast.UnaryOp: self._signed,
            ast.Compare: self._comparison,
            ast.Call: self._call,
        }

    def read(self) -> sp.Basic:
        if len(self.source) > LONGEST_TEXT:
            raise ReadingError(f"it is longer than {LONGEST_TEXT:,} characters")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # SyntaxWarnings of Python's parser, about '1or 2'
                tree = ast.parse(self.source, mode="eval")
        except (SyntaxError, ValueError):
            _refuse_syntax()
        return self._of(tree.body)

    def _of(self, node: ast.AST, takes: type = sp.Basic) -> Any:  # noqa: ANN401
        """Return the value of a node: a number (Expr) or a truth value (Boolean).

        `takes` says which of the two is required; by default, both are possible.
        """
        self._count(1)
        if self.depth > DEEPEST_TREE:
            raise ReadingError("it is nested too deeply")
        reader = self.readers.get(type(node))
        if reader is None:
            _refuse_syntax()
        self.depth += 1
        value = self._bounded(reader(node))
        self.depth -= 1
        if takes is sp.Expr and not isinstance(value, sp.Expr):
            raise ReadingError("it has a truth value where a number belongs")
        if takes is Boolean and isinstance(value, sp.Expr):
            raise ReadingError("it has a number where a truth value belongs")
        return value

    def _number(self, node: ast.AST) -> Any:  # noqa: ANN401
        return self._of(node, sp.Expr)

    def _count(self, steps: int) -> None:
        self.steps += steps
        if self.steps > MOST_STEPS:
            raise ReadingError(f"it has more than {MOST_STEPS:,} operations")

    def _spend(self, size: int, times: int = 1) -> None:
        self.work += times * size**2
        if self.work > MOST_WORK:
            raise ReadingError("its functions have more or longer arguments than SymPy can examine")

    def _literal(self, node: ast.Constant) -> Any:  # noqa: ANN401
        value = node.value
        if isinstance(value, bool):
            return sp.true if value else sp.false
        if isinstance(value, int):
            return sp.Integer(value)
        if not isinstance(value, float):
            _refuse_syntax()
        if not self.exact:
            return sp.Float(value)
        text = (ast.get_source_segment(self.source, node) or "").replace("_", "")
        if abs(Decimal(text).adjusted()) > MOST_BITS:
            _refuse_size()
        return sp.Rational(text)

    def _name(self, node: ast.Name) -> Any:  # noqa: ANN401
        if node.id in self.symbols:
            return self.symbols[node.id]
        if node.id in FUNCTIONS or node.id in PARTED:
            raise ReadingError(f"it uses the function {node.id} without arguments")
        if node.id in UNREAL:
            raise ReadingError(f"it uses {node.id}, which is not a real number")
        return CONSTANTS[node.id] if node.id in CONSTANTS else sp.Symbol(node.id)

    def _operation(self, node: ast.BinOp) -> Any:  # noqa: ANN401
        start = self.steps
        for kinds, joined in ((ast.Add | ast.Sub, sp.Add), (ast.Mult | ast.Div, sp.Mul)):
            if isinstance(node.op, kinds):
                return joined(*self._chain(node, kinds))
        if not isinstance(node.op, ast.Pow | ast.Mod | ast.FloorDiv):
            return self._function(OPERATORS.get(type(node.op), ""), [node.left, node.right])
        left, right = self._number(node.left), self._number(node.right)
        size = self.steps - start
        if isinstance(node.op, ast.Pow):
            whole = right.is_Integer
            return _power(left, right) if whole else self._value("Pow", [left, right], size)
        quotient = self._bounded(left * _power(right, sp.S.NegativeOne))
        floor = self._value("floor", [quotient], size)
        if isinstance(node.op, ast.FloorDiv):
            return floor
        self._count(size)  # for parts that are written twice
        return left - right * floor

    def _chain(self, node: Any, kinds: Any) -> list[Any]:  # noqa: ANN401
        """Return the terms of a - b + …, or the factors of a / b * …, without recursion."""
        operands = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, kinds):
            operands.append((node.op, node.right))
            node = node.left
        values = [self._number(node)]
        for operator, operand in reversed(operands):
            value = self._number(operand)
            if isinstance(operator, ast.Sub):
                value = -value
            elif isinstance(operator, ast.Div):
                value = _power(value, sp.S.NegativeOne)
            values.append(value)
        return values

    def _signed(self, node: ast.UnaryOp) -> Any:  # noqa: ANN401
        if isinstance(node.op, ast.Invert | ast.Not):
            return self._function("Not", [node.operand])
        value = self._number(node.operand)
        return -value if isinstance(node.op, ast.USub) else value

    def _comparison(self, node: ast.Compare) -> Any:  # noqa: ANN401
        if len(node.ops) > 1:
            _refuse_syntax()
        return self._function(OPERATORS.get(type(node.ops[0]), ""), [node.left, *node.comparators])

    def _call(self, node: ast.Call) -> Any:  # noqa: ANN401
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if not name or node.keywords:
            _refuse_syntax()
        if name in PARTED:
            return self._piecewise(node) if name == "Piecewise" else self._finite(node, name)
        if name not in FUNCTIONS:
            _refuse_function(name)
        return self._function(name, node.args)

    def _function(self, name: str, nodes: list[ast.expr]) -> Any:  # noqa: ANN401
        """Return the value of a function; the number and the types of its arguments are checked."""
        if name not in FUNCTIONS:
            _refuse_syntax()
        function, start = FUNCTIONS[name], self.steps
        if len(nodes) not in function.counts:
            raise ReadingError(f"it uses {name} with {len(nodes)} arguments")
        values = [self._of(x, function.takes) for x in nodes]
        return self._value(name, values, self.steps - start)

    def _value(self, name: str, values: list[Any], size: int) -> Any:  # noqa: ANN401
        """Return the value of a function at `values`, which were built in `size` steps."""
        function = FUNCTIONS[name]
        if not self.exact and all(x.is_number for x in values):
            plain = all(map(_is_plain, values))
            return function.of(*(values if plain else map(_float, values)))
        compared = sum(len(x.args) if isinstance(x, sp.Min | sp.Max) else 1 for x in values)
        if function.asks:  # for each pair
            pairs = max(compared * (compared - 1) // 2, 1)
            self._spend(ASKING + min(size, 2 * size // compared), pairs)
        else:
            self._spend(size)
        return function.of(*values)

    def _piecewise(self, node: ast.Call) -> Any:  # noqa: ANN401
        pairs = []
        for pair in node.args:
            start = self.steps
            if not isinstance(pair, ast.Tuple) or len(pair.elts) != 2:
                _refuse_syntax()
            pairs.append((self._number(pair.elts[0]), self._of(pair.elts[1], Boolean)))
            self._spend(self.steps - start + ASKING)
        return sp.Piecewise(*pairs)

    def _finite(self, node: ast.Call, name: str) -> Any:  # noqa: ANN401
        """Return a sum or product such as Sum(u**k, (k, 0, 3)), with its terms written out."""
        if len(node.args) != 2 or not isinstance(limits := node.args[1], ast.Tuple):
            _refuse_syntax()
        if len(limits.elts) != 3 or not isinstance(index := limits.elts[0], ast.Name):
            _refuse_syntax()
        low, high = (self._number(x) for x in limits.elts[1:])
        if not (low.is_Integer and high.is_Integer):
            raise ReadingError(f"the limits of its {name} are not whole numbers")
        outside, terms = self.symbols, []
        for k in range(int(low), int(high) + 1):
            self.symbols = {**outside, index.id: sp.Integer(k)}
            terms.append(self._number(node.args[0]))
        self.symbols = outside
        return (sp.Add if name == "Sum" else sp.Mul)(*terms)

    def _bounded(self, value: Any) -> Any:  # noqa: ANN401
        """Return a value, as a float if it is a long constant or a function of constants.

        With `exact`, ReadingError is raised for a long constant. It is always raised for a constant
        that is too large, not finite or not real.
        """
        if isinstance(value, Boolean) or not value.is_number:
            return value
        rounded = _float(value)
        if not (rounded.is_Number and rounded.is_finite):
            raise ReadingError("it holds a number that is not real or not finite")
        if _bits(rounded) > MOST_BITS or _bits(value) > MOST_BITS:
            _refuse_size()
        parts = list(islice(sp.preorder_traversal(value), MOST_EXACT + 1))
        if self.exact and len(parts) > MOST_EXACT:
            raise ReadingError("it holds a number that is too long to be exact")
        if len(parts) > MOST_EXACT or not (self.exact or all(map(_is_arithmetic, parts))):
            return rounded
        return value


# --- numbers --------------------------------------------------------------------------------------


def _is_arithmetic(part: sp.Basic) -> bool:
    return isinstance(part, sp.Number | sp.NumberSymbol | sp.Add | sp.Mul | sp.Pow | sp.exp)


def _is_plain(constant: Any) -> bool:  # noqa: ANN401
    """Return whether SymPy evaluates functions of this constant exactly and quickly."""
    factor, rest = constant.as_coeff_Mul()
    return _bits(factor) <= MOST_PLAIN_BITS and (rest is sp.S.One or rest.is_NumberSymbol)


def _float(constant: Any) -> Any:  # noqa: ANN401
    """Return a constant computed in float64: `evalf` takes exponential time for nested ones."""
    if constant.is_Rational:
        return sp.Float(constant) if constant.is_finite else constant
    if not constant.args:
        return constant.evalf()
    if constant.is_Pow and constant.exp.is_Rational:
        return sp.Pow(_float(constant.base), constant.exp)
    return constant.func(*map(_float, constant.args))


def _bits(number: Any) -> int:  # noqa: ANN401
    """Return the most bits of numerator and denominator, or the modulus of a float's exponent."""
    if number.is_Rational and number.is_finite:
        return max(int(number.p).bit_length(), int(number.q).bit_length())
    if number.is_Float:
        _, mantissa, exponent, length = number._mpf_
        return abs(exponent + length) if mantissa else 0
    return 0
