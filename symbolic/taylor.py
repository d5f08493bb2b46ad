"""Taylor polynomials in two variables: products, compositions, and bounds of their errors.

A function of u and v has at a point the Taylor polynomial

    a_0 + a_u s + a_v t + a_uu s² + a_uv s t + a_vv t² + …,

whose coefficients are derivatives divided by factorials. The coefficients of products and
compositions are sums of products with positive factors. If factors with |x| <= X, |y| <= Y, |z| <=
Z have errors up to D_x, D_y, D_z, then their product x y z changes by at most

    D_x Y Z + (X + D_x) D_y Z + (X + D_x) (Y + D_y) D_z.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp

from .formula import Formula, Parts, formula
from .notation import CubicTaylorSymbol, TaylorSymbol, scalar

Coefficients = dict[str, Any]
Symbols = Mapping[sp.Symbol, sp.Symbol]

# The largest absolute values of a, b, f, increased by bounds of their errors, have the names s, t,
# F.
LARGEST = str.maketrans("abf", "stF")

s, t = sp.symbols("s t")  # u and v relative to the point
u = scalar("u")  # unit roundoff


def _orders(axis: str) -> tuple[int, int]:
    return axis.count("u"), axis.count("v")


def _polynomial(symbol: TaylorSymbol) -> sp.Expr:
    powers = (s**i * t**j for i, j in map(_orders, symbol.AXES))
    terms = (x * y for x, y in zip(symbol.components, powers, strict=True))
    return sum(terms, start=sp.S.Zero)


def _coefficients(expression: sp.Expr, axes: Sequence[str]) -> Coefficients:
    """Return the coefficients of a polynomial in s and t, by their names such as "uv"."""
    polynomial: Any = sp.Poly(expression, s, t)
    return {x: sp.expand(polynomial.coeff_monomial(_orders(x))) for x in axes}


def _product(a: TaylorSymbol, b: TaylorSymbol) -> Coefficients:
    return _coefficients(_polynomial(a) * _polynomial(b), a.AXES)


def _composition(f: Sequence[sp.Symbol], a: TaylorSymbol) -> Coefficients:
    """Return the coefficients of f_1 p + f_2 p² + …, where p is a without its constant term."""
    p = _polynomial(a) - a.components[0]
    terms = (x * p ** (k + 1) for k, x in enumerate(f))
    return _coefficients(sum(terms, start=sp.S.Zero), a.AXES[1:])


def _factors(product: sp.Expr) -> list[Any]:
    """Return the factors of a product of symbols, repeated for powers."""
    powers: list[Any] = [x.as_base_exp() for x in sp.Mul.make_args(product)]
    return [base for base, exponent in powers for _ in range(int(exponent))]


def _parted(term: Any) -> tuple[Any, list[Any]]:  # noqa: ANN401 - SymPy has no types
    """Return the numerical factor of a product, and the other factors."""
    number, rest = term.as_coeff_Mul()
    return number, _factors(rest)


def _change(value: sp.Expr, errors: Symbols, largest: Symbols) -> sp.Expr:
    """Return a bound of the change of a sum of products if its symbols change by their errors."""
    terms = [
        number * sp.Mul(*(largest[x] for x in row[:k]), errors[row[k]], *row[k + 1 :])
        for number, row in map(_parted, sp.Add.make_args(value))
        for k in range(len(row))
    ]
    return sp.Add(*terms)


def _roundings(value: sp.Expr) -> int:
    """Return the largest number of roundings that a term of a sum of products undergoes."""
    terms = [_parted(term) for term in sp.Add.make_args(value)]
    return len(terms) - 1 + max(len(row) - (number == 1) for number, row in terms)


def _radii(of: Coefficients, inputs: Sequence[sp.Symbol], errors: Symbols) -> Parts:
    """Return the parts of a formula for bounds of the errors of coefficients, sums of products.

    Its named terms are the absolute values increased by their errors, and the coefficients computed
    from these.
    """
    symbols = {x for value in of.values() for x in value.free_symbols}
    largest = {x: scalar(x.name.translate(LARGEST)) for x in errors if x in symbols}
    sums = [(largest[x].name, x + errors[x]) for x in largest]
    sizes = {k: value.xreplace(largest) for k, value in of.items()}
    radii = {
        k: _change(value, errors, largest) + _roundings(value) * u * scalar(f"L_{k}")
        for k, value in of.items()
    }
    return Parts(
        inputs=[*inputs, u], terms=[*sums, *_named("L", sizes)], outputs=_named("r", radii)
    )


def _named(letter: str, values: Coefficients) -> list[tuple[str, Any]]:
    return [(f"{letter}_{axis}", value) for axis, value in values.items()]


def _formulas(kind: type[TaylorSymbol], order: int) -> list[Formula]:
    a, b, d, e = (kind(x) for x in "abde")
    f, g = ([scalar(f"{x}{k}") for k in range(1, order + 1)] for x in "fg")
    sizes = *a.components, *b.components, *f
    errors = dict(zip(sizes, (*d.components, *e.components, *g), strict=True))

    @formula(
        f"product_{order}",
        f"The Taylor coefficients $c$ of the product of two functions, up to order {order}.",
    )
    def product() -> Parts:
        return Parts(inputs=[a, b], outputs=_named("c", _product(a, b)))

    @formula(
        f"product_radius_{order}",
        f"Bounds $r$ of the errors of `product_{order}` if coefficients of absolute values up to "
        "$a$ and $b$ have errors up to $d$ and $e$; $u$ is the unit of rounding.",
    )
    def product_radius() -> Parts:
        return _radii(_product(a, b), [a, d, b, e], errors)

    @formula(
        f"composition_{order}",
        f"The Taylor coefficients $c$, from order 1 to {order}, of a function of the function with "
        "the coefficients $a$; $f1$, $f2$, … are those of the outer function at the value of the "
        "inner one.",
    )
    def composition() -> Parts:
        return Parts(inputs=[*f, a], outputs=_named("c", _composition(f, a)))

    @formula(
        f"composition_radius_{order}",
        f"Bounds $r$ of the errors of `composition_{order}` if coefficients of absolute values up "
        "to $f$ and $a$ have errors up to $g$ and $d$; $u$ is the unit of rounding.",
    )
    def composition_radius() -> Parts:
        return _radii(_composition(f, a), [*f, *g, a, d], errors)

    return [product, product_radius, composition, composition_radius]


FORMULAS = (*_formulas(TaylorSymbol, 2), *_formulas(CubicTaylorSymbol, 3))
