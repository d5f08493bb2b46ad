"""Taylor polynomials in two variables: their products, compositions, and bounds of these.

A function of u and v near a point has the Taylor polynomial

    a_0 + a_u s + a_v t + a_uu s² + a_uv s t + a_vv t² + …,

whose coefficients are derivatives divided by factorials. Formulas with `radius` in their names
bound the errors of those results if the coefficients of the arguments have errors, with the rounding
of the computation itself. Results are sums of products with positive coefficients. The change of a
product x y …, |x| <= X, by errors |δx| <= D_x is bounded by terms that are added up,

    |(x + δx)(y + δy) … − x y …| <= D_x Y … + (X + D_x) D_y … + …
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, cast

import sympy as sp
from sympy import calculus

from .formula import Formula
from .notation import CubicTaylorSymbol, TaylorSymbol, scalar

__all__ = ["CODES", "FORMULAS", "FUNCTIONS", "constants", "derivatives"]

s, t = sp.symbols("s t")
u = scalar("u")  # the unit of rounding


def _orders(axis: str) -> tuple[int, int]:
    return axis.count("u"), axis.count("v")


def _coefficients(symbol: TaylorSymbol) -> dict[str, sp.Symbol]:
    return dict(zip(symbol.AXES, symbol.components, strict=True))


def _polynomial(symbol: TaylorSymbol) -> sp.Expr:
    terms = (x * s ** _orders(k)[0] * t ** _orders(k)[1] for k, x in _coefficients(symbol).items())
    return sum(terms, start=sp.S.Zero)


def _taken(expression: sp.Expr, axes: Sequence[str]) -> dict[str, sp.Expr]:
    """Return the coefficients of a polynomial in s and t by their names."""
    polynomial = sp.Poly(expression, s, t)
    return {k: sp.expand(polynomial.coeff_monomial((*_orders(k),))) for k in axes}


def _product(a: TaylorSymbol, b: TaylorSymbol) -> dict[str, sp.Expr]:
    return _taken(_polynomial(a) * _polynomial(b), a.AXES)


def _composition(f: Sequence[sp.Symbol], a: TaylorSymbol) -> dict[str, sp.Expr]:
    """Return the coefficients of Σ f_k p^k, k > 0, where p is a without its value."""
    p = _polynomial(a) - a.components[0]
    return _taken(sum((x * p ** (k + 1) for k, x in enumerate(f)), sp.S.Zero), a.AXES[1:])


def _radius(value: sp.Expr, radii: Mapping[sp.Symbol, sp.Symbol]) -> sp.Expr:
    """Return the bound of the change of a sum of products, and of the rounding of its value."""
    terms = [term.as_coeff_Mul() for term in sp.Add.make_args(value)]
    factors = [
        [x for y in sp.Mul.make_args(rest) for x in [y.as_base_exp()[0]] * int(y.as_base_exp()[1])]
        for _, rest in terms
    ]
    changes = [
        number * sp.Mul(*(x + radii[x] for x in row[:k]), radii[row[k]], *row[k + 1 :])
        for (number, _), row in zip(terms, factors, strict=True)
        for k in range(len(row))
    ]
    roundings = (
        len(terms) - 1 + max(len(x) - (c == 1) for (c, _), x in zip(terms, factors, strict=True))
    )
    largest = value.xreplace({x: x + r for x, r in radii.items()})
    return sp.Add(*changes) + roundings * u * largest


def _formulas(kind: type[TaylorSymbol], order: int) -> list[Formula]:
    a, b, d, e = (kind(x) for x in "abde")
    f, g = ([scalar(f"{x}{k}") for k in range(1, order + 1)] for x in "fg")
    radii = dict(
        zip((*a.components, *b.components, *f), (*d.components, *e.components, *g), strict=True)
    )
    product, composition = _product(a, b), _composition(f, a)
    known = f"up to order {order}"
    return [
        Formula.build(
            f"product_{order}",
            f"The Taylor coefficients $c$ of the product of two functions, {known}.",
            inputs=[a, b],
            outputs=[(f"c_{k}", x) for k, x in product.items()],
        ),
        Formula.build(
            f"product_radius_{order}",
            f"Bounds $r$ of the errors of `product_{order}` if coefficients of absolute values up "
            "to $a$ and $b$ have errors up to $d$ and $e$; $u$ is the unit of rounding.",
            inputs=[a, d, b, e, u],
            outputs=[(f"r_{k}", _radius(x, radii)) for k, x in product.items()],
        ),
        Formula.build(
            f"composition_{order}",
            f"The Taylor coefficients $c$ of a function of a function with coefficients $a$, {known}, "
            "without the value; $f1$, $f2$, … are those of the outer one at the value of the inner "
            "one.",
            inputs=[*f, a],
            outputs=[(f"c_{k}", x) for k, x in composition.items()],
        ),
        Formula.build(
            f"composition_radius_{order}",
            f"Bounds $r$ of the errors of `composition_{order}` if coefficients of absolute values "
            "up to $f$ and $a$ have errors up to $g$ and $d$; $u$ is the unit of rounding.",
            inputs=[*f, *g, a, d, u],
            outputs=[(f"r_{k}", _radius(x, radii)) for k, x in composition.items()],
        ),
    ]


# --- functions of one variable ------------------------------------------------------------------

x, y, w = scalar("x"), scalar("y"), scalar("w")
HIGHEST = 3
# The error of functions of the C library, in units of 2⁻⁵³: two units of the last place, which is
# more than their makers state.
LIBRARY = 4


class Function(NamedTuple):
    """A function of x, and what its derivatives are written in.

    `values` are the value y of the function and, for some, a second value w. `named` is a term that
    several derivatives share. Where the terms of derivatives cancel, the sums of their absolute
    values are at most `cancelling`.
    """

    of: sp.Expr
    values: Mapping[sp.Expr, sp.Expr] = {}
    named: Mapping[str, sp.Expr] = {}
    cancelling: sp.Rational = sp.S.Zero


FUNCTIONS = {
    "reciprocal": Function(1 / x, {x: 1 / y}),
    "square": Function(x**2),
    "cube": Function(x**3),
    "sqrt": Function(sp.sqrt(x), {x: 1 / w**2}, {"w": 1 / y}),
    "exp": Function(sp.exp(x), {sp.exp(x): y}),
    "log": Function(sp.log(x), {x: 1 / w}, {"w": 1 / x}),
    "sin": Function(sp.sin(x), {sp.sin(x): y, sp.cos(x): w}),
    "cos": Function(sp.cos(x), {sp.cos(x): y, sp.sin(x): w}),
    "sinh": Function(sp.sinh(x), {sp.sinh(x): y, sp.cosh(x): w}),
    "cosh": Function(sp.cosh(x), {sp.cosh(x): y, sp.sinh(x): w}),
    "tanh": Function(sp.tanh(x), {sp.tanh(x): y}, cancelling=sp.Rational(16, 3)),
    "asin": Function(sp.asin(x), {1 - x**2: 1 / w**2}, {"w": 1 / sp.sqrt((1 - x) * (1 + x))}),
    "atan": Function(
        sp.atan(x), {x**2 + 1: 1 / w}, {"w": 1 / (1 + x**2)}, cancelling=sp.Rational(5, 3)
    ),
}
# The operations of a tape, by the numbers that stand for them: those of all functions follow.
BASIC = ("u", "v", "constant", "sum", "negative", "shift", "scale", "product")
CODES = {name: code for code, name in enumerate((*BASIC, *FUNCTIONS))}


def derivatives(function: Function) -> list[sp.Expr]:
    """Return the function and its Taylor coefficients f1, f2, f3 at x."""
    return [sp.diff(function.of, x, k) / sp.factorial(k) for k in range(HIGHEST + 1)]


def _formula(name: str, function: Function) -> Formula:
    positive = sp.Dummy(positive=True)
    values = {k: y_.xreplace({w: positive}) for k, y_ in function.values.items()}
    outputs = [
        sp.factor(sp.powdenest(f.subs(values), force=True)).xreplace({positive: w})
        for f in derivatives(function)[1:]
    ]
    used = sp.Tuple(*outputs, *function.named.values(), *function.values.values()).free_symbols
    return Formula.build(
        f"{name}_taylor",
        f"The Taylor coefficients $f1$, $f2$, $f3$ of {name} at $x$, from $x$ and values there.",
        inputs=[z for z in (x, y, w) if z in used and z.name not in function.named],
        terms=[*function.named.items()],
        outputs=[(f"f{k + 1}", f) for k, f in enumerate(outputs)],
    )


def _critical(function: Function) -> tuple[float, list[float]]:
    """Return where Taylor coefficients may have extremes: the distance of places, and places.

    The distance is that of the zeros of sin and cos, or 0. Singularities are places, too.
    """
    if function.of.has(sp.sin, sp.cos):
        return float(sp.pi / 2), []
    domain = calculus.util.continuous_domain(function.of, x, sp.S.Reals)
    slopes = [sp.diff(f, x) for f in derivatives(function)]
    zeros = [sp.solveset(_rational(f), x, domain.interior) for f in slopes if f.free_symbols]
    places = {place for found in zeros for place in found}
    places |= set(calculus.singularities(function.of, x))
    return 0.0, sorted({float(place) for place in places})


def _roundings(expression: sp.Expr, known: Mapping[sp.Expr, int]) -> int:
    """Return how many roundings a term of an expression goes through, those of symbols included."""
    if expression in known:
        return known[cast(sp.Symbol, expression)]
    if expression.is_number:
        return int(not expression.is_Integer)
    base, exponent = expression.as_base_exp()
    if exponent == 1:
        counts = [_roundings(z, known) for z in expression.args]
        return (sum(counts) if expression.is_Mul else max(counts)) + len(counts) - 1
    if exponent.is_negative:
        return _roundings(base**-exponent, known) + 1
    if exponent == sp.S.Half:
        return _roundings(base, known) + 1
    return int(exponent) * (_roundings(base, known) + 1) - 1


def _roundings_of(name: str, function: Function) -> list[int]:
    """Return the roundings in the value of a function and in its Taylor coefficients."""
    formula = _formula(name, function)
    value = int(function.of.func == sp.Pow) or LIBRARY
    known = {x: 0, y: value, w: value}
    for symbol, term in formula.definitions:
        known[symbol] = _roundings(term, known)
    return [2 if name == "cube" else value, *(known[z] for z in formula.outputs)]


def _rational(slope: sp.Expr) -> sp.Expr:
    """Write a derivative by exponentials, for which SymPy finds the zeros."""
    return sp.together(slope.rewrite(sp.exp)).as_numer_denom()[0]


def constants() -> str:
    """Return the codes, and where Taylor coefficients of functions may have extremes."""
    found = [_critical(function) for function in FUNCTIONS.values()]
    width = max(len(places) for _, places in found)
    rows = [[*places, *(width - len(places)) * ["np.nan"]] for _, places in found]
    return "\n".join(
        [
            *(f"{name.upper()} = {code}" for name, code in CODES.items()),
            f"ROUNDINGS = np.array({[_roundings_of(*item) for item in FUNCTIONS.items()]})",
            f"CANCELLING = np.array({[float(f.cancelling) for f in FUNCTIONS.values()]})",
            f"SPACING = np.array({[distance for distance, _ in found]})",
            f"CRITICAL = np.array([{', '.join('[' + ', '.join(map(str, x)) + ']' for x in rows)}])",
        ]
    )


FORMULAS = (
    *_formulas(TaylorSymbol, 2),
    *_formulas(CubicTaylorSymbol, 3),
    *(_formula(*item) for item in FUNCTIONS.items()),
)
