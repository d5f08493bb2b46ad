"""Texts of users, read as mathematics."""

from typing import Any, cast

import pytest
import sympy as sp
from gaussmap.symbolic.expression import NORMAL, kernel_source
from gaussmap.symbolic.reading import MOST_TERMS, ReadingError, read


@pytest.mark.parametrize(
    ("text", "expression"),
    [
        ("u^2 + 1/3", "u**2 + 1/3"),
        ("-2*u % 3", "Mod(-2*u, 3)"),
        ("7*u // 2", "floor(7*u/2)"),
        ("root(u, 3) + cbrt(u) + sqrt(u)", "sqrt(u) + 2*u**Rational(1, 3)"),
        ("Sum(cos(k*u)/k, (k, 1, 3))", "cos(u) + cos(2*u)/2 + cos(3*u)/3"),
        ("Product(u + k, (k, 0, 1))", "u*(u + 1)"),
        ("Piecewise((u, u < 1/2), (1, True))", "Piecewise((u, u < 1/2), (1, True))"),
        ("(u > 0) & ~(u > 1) | (u == 3)", "Eq(u, 3) | ((u > 0) & (u <= 1))"),
        ("legendre(2, u)", "3*u**2/2 - 1/2"),
        ("factorial(5)*binomial(4, 2)", "720"),
        ("exp(-3)*E**3*pi", "pi"),
        ("abs(u) - Abs(u) + ln(u)/log(u)", "1"),
        ("re(2 + 3j)", "2"),
    ],
)
def test_mathematics_is_read(text: str, expression: str) -> None:
    symbols = {"u": sp.Symbol("u", real=True)}
    assert read(text, symbols) == cast(Any, sp.sympify)(expression, locals=symbols)


def test_sums_are_bounded() -> None:
    assert read(f"Sum(k, (k, 1, {MOST_TERMS}))") == MOST_TERMS * (MOST_TERMS + 1) // 2
    with pytest.raises(ReadingError, match="whole limits"):
        read(f"Sum(k, (k, 0, {MOST_TERMS}))")


def test_decimals_are_exact_where_asked() -> None:
    assert read("0.1 + 2.5e-3", exact=True) == sp.Rational(41, 400)


def test_high_powers_are_compiled() -> None:
    """A power is no product of a thousand factors."""
    power: Any = read("n_x**1000 + 1", {str(x): x for x in NORMAL})
    assert "math.pow(n_x, 1000)" in kernel_source(power)
