"""Texts of users: what they mean, their two types, and what SymPy may compute for them."""

from typing import Any, cast

import pytest
import sympy as sp
from gaussmap.symbolic.expression import NORMAL, array_function
from gaussmap.symbolic.reading import (
    MOST_BITS,
    MOST_DERIVED,
    MOST_EXACT,
    MOST_STEPS,
    ReadingError,
    free_symbols,
    is_differentiable,
    read,
    replaced,
)
from hypothesis import given
from sympy.logic.boolalg import Boolean

from ..texts import texts

SYMBOLS = {name: sp.Symbol(name, real=True) for name in ("u", "v")}
u, v = SYMBOLS.values()
LONG = "+".join(f"{k}*u**{k}*v" for k in range(1, 161))  # 961 steps


def refused(text: str, reason: str, **named: Any) -> None:
    with pytest.raises(ReadingError, match=reason):
        read(text, SYMBOLS, **named)


def size(expression: sp.Basic) -> int:
    return sum(1 for _ in sp.preorder_traversal(expression))


# --- what texts mean ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expression"),
    [
        ("u^2 + 1/3", "u**2 + 1/3"),
        ("1 - u - v + 2*u/v/3", "1 - u - v + 2*u/(3*v)"),
        ("-2*u % 3", "-2*u - 3*floor(-2*u/3)"),
        ("7*u // 2", "floor(7*u/2)"),
        ("root(u, 3) + cbrt(u) + sqrt(u)", "sqrt(u) + 2*u**Rational(1, 3)"),
        ("Sum(cos(k*u)/k, (k, 1, 3))", "cos(u) + cos(2*u)/2 + cos(3*u)/3"),
        ("Product(u + k, (k, 0, 1))", "u*(u + 1)"),
        ("Sum(Product(u + k, (u, 1, k)), (k, 2, 3)) + u", "132 + u"),
        ("Piecewise((u, u < 1/2), (1, True))", "Piecewise((u, u < 1/2), (1, True))"),
        ("(u > 0) & ~(u > 1) | (u == 3)", "Eq(u, 3) | ((u > 0) & (u <= 1))"),
        ("ITE(u > 1, v > 0, sqrt(2) < 3/2)", "ITE(u > 1, v > 0, True)"),
        ("exp(-3)*E**3*pi", "pi"),
        ("abs(u) - Abs(u) + ln(u)/log(u)", "1"),
        ("log(8, 2) + cos(pi/3) + atan(1)", "3 + 1/2 + pi/4"),
        ("2*Heaviside(u) - sign(u)", "1"),
        ("sqrt(8) + sqrt(u**2)", "2*sqrt(2) + Abs(u)"),
    ],
)
def test_mathematics_is_read(text: str, expression: str) -> None:
    assert read(text, SYMBOLS) == cast(Any, sp.sympify)(expression, locals=SYMBOLS)


def test_constants_are_floats_unless_they_are_short() -> None:
    assert read("sin(1)*u", SYMBOLS) == sp.Float(0.8414709848078965) * u
    many = read("+".join(f"sqrt({k})" for k in range(MOST_EXACT)))
    assert many.is_Float
    assert float(cast(Any, many)) == pytest.approx(
        sum(k**0.5 for k in range(MOST_EXACT)), rel=1e-15
    )


def test_exact_numbers_are_not_rounded() -> None:
    assert read("0.1 + 2.5e-3", exact=True) == sp.Rational(41, 400)
    assert read("sqrt(1 + sqrt(2))*sin(1)", exact=True) == sp.sqrt(1 + sp.sqrt(2)) * sp.sin(1)
    refused("+".join(f"sqrt({k})" for k in range(MOST_EXACT)), "too long to be exact", exact=True)
    refused("1e-99999", "too large", exact=True)


def test_high_powers_are_compiled() -> None:
    """A power is no product of a thousand factors."""
    power: Any = read("n_x**1000 + 1", {str(x): x for x in NORMAL})
    assert "numpy.power(n_x, 1000)" in array_function(power)


# --- what is refused ------------------------------------------------------------------------------

UNLISTED = "factorial2", "harmonic", "hermite", "FallingFactorial", "Mod", "gamma", "legendre", "re"
REFUSED: dict[str, tuple[str, ...]] = {
    "truth value where a number belongs": (
        "sech(Pow(pi*2, 2 >= 1))", "acsch(2 < 3)", "atan2(E, 10**50) + (3 < 3)",
        "atan(Eq(atan2(10**50, tan(tan(1))), 99))", "u + True", "-(u > 0)", "2*(u > 0)",
        "u**(u > 0)", "(u > 0) % 2", "(u > 0) < 1", "Max(u, True)",
        "Piecewise((u > 0, u > 0), (1, True))", "Sum(u > k, (k, 0, 2))", "Sum(u, (k, 0, True))",
    ),
    "number where a truth value belongs": (
        "u & v", "(u > 0) | 1", "~u", "not 1", "And(u, u > 0)", "Piecewise((u, u), (1, True))",
    ),
    "not real or not finite": (
        "sqrt(-1)*u", "asin(2)", "log(0)", "0**-1", "Piecewise((1, False))", "1e999"
    ),
    "not finite": ("u/0",),
    "uses I, which is not a real number": ("I*u",),
    "uses oo, which is not a real number": ("2 >= oo",),
    "uses sin with 2 arguments": ("sin(u, v)",),
    "uses Max with 0 arguments": ("Max()",),
    "uses the function cos without arguments": ("u + cos",),
    "uses the function Sum without arguments": ("Sum",),
    "limits of its Sum are not whole": ("Sum(u, (k, 0, v))",),
    "not arithmetic": ("0 < u < 1", "3j", "1or 2"),
    **{f"uses {name}, which kernels cannot compute": (f"u + {name}(3, u)",) for name in UNLISTED},
    # Steps are counted,
    "more than 10,000 operations|nested too deeply": (
        f"Sum(u, (k, 0, {MOST_STEPS}))", "Sum(u, (k, 1, 10**9))",
        "Sum(Sum(Sum(u*k*j*i, (k, 1, 999)), (j, 1, 999)), (i, 1, 999))",
        "+".join("u" * (MOST_STEPS // 2)) + "-u*v" * 2,
    ),
    # and questions to SymPy.
    "than SymPy can examine": (
        f"Abs({LONG})", f"Max({LONG}, u, v)", f"{LONG} < 1",
        f"Piecewise((u, {LONG} < 1), (v, True))", f"sin({LONG}) + cos({LONG})",
        f"({LONG})**(1/3)", f"v**({LONG})", f"({LONG}) % 1",
        "(" * 12 + "u" + "%3 + v)" * 12, "sqrt(1 + " * 60 + "u" + ")" * 60,
        f"Max({', '.join(f'sin({k}*u)' for k in range(24))})",
        f"Min({', '.join(f'Max(u, cos({k}*u))' for k in range(9))})",
        "Sum(Abs(u - k), (k, 1, 200))",
        "Piecewise(" + ",".join(f"({k}, u < {k})" for k in range(200)) + ")",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("text", "reason"), [(x, y) for y, z in REFUSED.items() for x in z])
def test_what_is_refused_and_why(text: str, reason: str) -> None:
    refused(text, reason)


# --- what SymPy may compute -----------------------------------------------------------------------


def test_constants_cost_nothing_however_many_they_are() -> None:
    total = read("Sum(floor(sqrt(2)*k) + Max(sin(k), cos(k)), (k, 1, 120))")
    assert total.is_Float


@pytest.mark.parametrize(
    "text",
    [
        "sin(" * 90 + "u*v" + ")" * 90,
        "Product(u + k*v, (k, 1, 60))",
        "(1 + " * 40 + "u*v" + ")**2*v" * 40,
        "Piecewise((Product(u + k*v, (k, 1, 60)), u > v), (1, True))",
    ],
)
def test_derivatives_that_are_not_written(text: str) -> None:
    assert not is_differentiable([read(text, SYMBOLS)])


@pytest.mark.parametrize(
    "text",
    [
        "(2 + cos(v))*cos(u)",
        "sin(" * 15 + "u*v" + ")" * 15,
        "Product(u + k*v, (k, 1, 9))",
        "+".join(f"u**{j}*v**{k}" for j in range(9) for k in range(9)),
        "exp(-u**2 - v**2)*(u + v)**3/(1 + u*v)",
    ],
)
def test_derivatives_are_as_large_as_estimated(text: str) -> None:
    """SymPy shares and drops terms; what it writes is never larger by more than constants."""
    expression = cast(sp.Expr, read(text, SYMBOLS))
    assert is_differentiable([expression])
    count = 1
    while is_differentiable([expression] * count):
        count *= 2
    estimate = MOST_DERIVED / count  # to a factor of two
    largest = max(size(sp.diff(expression, x, y)) for x in (u, v) for y in (u, v))
    assert largest < 4 * estimate


@pytest.mark.slow
@given(text=texts(25))
def test_any_text_is_read_or_refused(text: str) -> None:
    """No other error and no warning; and what is read is real, typed and bounded."""
    try:
        value = read(text, SYMBOLS)
    except ReadingError:
        return
    assert isinstance(value, sp.Expr | Boolean)
    assert {str(x) for x in value.free_symbols} <= {"u", "v", "k"}  # k, which has no meaning
    assert size(value) <= 2 * MOST_STEPS
    assert not value.has(sp.nan, sp.zoo, sp.oo, sp.I)
    assert all(abs(x.p) < 2**MOST_BITS > x.q for x in cast(Any, value.atoms(sp.Rational)))


def test_an_index_of_a_sum_is_no_symbol_of_the_expression() -> None:
    k, u = sp.Symbol("k"), sp.Symbol("u")
    assert free_symbols(sp.Sum(u**k, (k, 0, 3))) == {u}
    assert replaced(sp.Sum(u**k, (k, 0, 3)), {u: k**2 * u}).free_symbols <= {u, k}
    expression = sp.sin(u) + u**2
    assert replaced(expression, {u: k}) == expression.xreplace({u: k})
