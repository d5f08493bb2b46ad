"""Expressions as source for kernels."""

import math

import pytest
import sympy as sp
from gaussmap.symbolic.printer import operations, source_of

x, y, z = sp.symbols("x y z", real=True)


@pytest.mark.parametrize(
    ("expression", "source"),
    [
        (x + y, "x + y"), (y - x, "y - x"), (-x - y, "-x - y"), (x * z - y**2, "x * z - y * y"),
        (-x * z + y * z, "y * z - x * z"), (x**3, "x * x * x"), (x**2 * y / z, "x * x * y / z"),
        (1 / x, "1.0 / x"), (1 / x**2, "1.0 / (x * x)"), (2 / x, "2 / x"),
        (x / (y * z**2), "x / (y * z * z)"), (x / (y + z), "x / (y + z)"),
        (1 / (y + z), "1.0 / (y + z)"), (x * (y + z), "x * (y + z)"),
        (-x * (y - z), "-x * (y - z)"), (x / 2, "0.5 * x"), (-3 * x / 8, "-0.375 * x"),
        (2 * x / 3, "(2.0 / 3.0) * x"), (y - x / 3, "y - (1.0 / 3.0) * x"), (2 * x, "2 * x"),
        (sp.Integer(7), "7"), (sp.Rational(1, 4), "0.25"),
        (x + sp.Rational(1, 3), "x + (1.0 / 3.0)"), (sp.sqrt(x), "math.sqrt(x)"),
        (sp.sqrt(x + y), "math.sqrt(x + y)"), (1 / sp.sqrt(x), "1.0 / math.sqrt(x)"),
        (y / sp.sqrt(x), "y / math.sqrt(x)"), (sp.sqrt(x) ** 3, "x * math.sqrt(x)"),
        ((x + y) ** 2, "(x + y) * (x + y)"),
        (sp.sin(x) * sp.cosh(y), "math.sin(x) * math.cosh(y)"), (2 * sp.pi, "2 * math.pi"),
        (x**y, "math.pow(x, y)"), (x ** sp.Rational(1, 4), "math.pow(x, 0.25)"),
        (x ** sp.Rational(-3, 4), "1.0 / math.pow(x, 0.75)"),
        (x ** sp.Rational(1, 3), "math.pow(x, (1.0 / 3.0))"), (2**x, "math.pow(2, x)"),
        (y / x**z, "math.pow(x, -z) * y"),
    ],
)  # fmt: skip
def test_source(expression, source):
    printed = source_of(expression)
    assert printed == source
    values = {"x": 1.75, "y": 0.625, "z": -2.5}
    evaluated = eval(printed, {"math": math}, values)
    exact = expression.subs({sp.Symbol(k, real=True): sp.Rational(v) for k, v in values.items()})
    assert evaluated == pytest.approx(float(exact), rel=1e-15)


def test_integers_stay_integers():
    """Kernels run on Python integers too, to decide signs exactly."""
    big = 10**30
    assert eval(source_of(2 * x - 3 * y**2), {}, {"x": big, "y": big}) == 2 * big - 3 * big**2


def test_integers_beyond_64_bits_are_floats():
    assert source_of(x * 2**63) == "9223372036854775808.0 * x"
    assert source_of(-(2**63) + x * 0) == "-9223372036854775808"


def test_functions_that_math_does_not_have_are_refused():
    with pytest.raises(NotImplementedError):
        source_of(sp.besselj(0, x))


@pytest.mark.parametrize(
    ("expression", "count"),
    [(x, 0), (x + y, 1), (x - y, 1), (-x, 1), (-2 * x, 1), (x * y * z, 2), (x / y, 1), (1 / x, 1),
     (x**2, 1), (x**5, 4), (1 / x**3, 3), (sp.sqrt(x), 1), (1 / sp.sqrt(x), 2), (sp.sin(x * y), 2),
     (2 * x / 3, 1), (x / 2, 1), (x / 3 + y / 6, 3), (2 * sp.pi * x, 1), (2 * sp.pi, 0)],
)  # fmt: skip
def test_operations(expression, count):
    assert operations([expression]) == count
    assert operations([expression, expression]) == 2 * count
