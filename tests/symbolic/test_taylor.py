"""Taylor polynomials: products and compositions, and bounds of their errors, exactly."""

import math
from fractions import Fraction
from functools import cache
from types import CodeType
from typing import Any

import pytest
import sympy as sp
from gaussmap.symbolic import formulas, taylor
from gaussmap.symbolic.emit import arguments
from gaussmap.symbolic.notation import VectorSymbol
from gaussmap.symbolic.printer import source_of
from gaussmap.symbolic.simplify import straight_line
from hypothesis import given
from hypothesis import strategies as st

from .terms import Term

u, v = sp.symbols("u v")
ORDERS = ("0", "u", "v", "uu", "uv", "vv", "uuu", "uuv", "uvv", "vvv")
EACH = pytest.mark.parametrize("name", [x.name for x in taylor.FORMULAS if "radius" not in x.name])
RADII = {f"{x.name}": f"{x.name[:-1]}radius_{x.name[-1]}" for x in taylor.FORMULAS}


def coefficients(f: Any, order: int) -> dict[str, Any]:
    """Return the Taylor coefficients of a function at (1, 2) up to an order."""
    result = {}
    for axis in ORDERS:
        i, j = axis.count("u"), axis.count("v")
        if i + j <= order:
            derivative = sp.diff(f, u, i, v, j) / sp.factorial(i) / sp.factorial(j)
            value = derivative.subs({u: 1, v: 2})
            result[axis] = sp.N(value, 40)
    return result


def of_symbol(letter: str, values: dict[str, Any]) -> dict[str, Any]:
    return {f"{letter}_{axis}": value for axis, value in values.items()}


@cache
def lines_of(name: str) -> list[tuple[str, CodeType]]:
    """Return the code that is printed for a formula, as names and values."""
    lines = straight_line(formulas[name]).assignments
    return [(x.name, compile(source_of(value), name, "eval")) for x, value in lines]


def run(name: str, values: dict[str, Any]) -> dict[str, Any]:
    """Return the outputs of a formula, from the code that is printed, for any kind of number."""
    names = dict(values)
    for symbol, value in lines_of(name):
        names[symbol] = eval(value, {"math": math}, names)
    return {x.name: names[x.name] for x in formulas[name].outputs}


A, B = sp.sin(u * v) + u**3, sp.exp(u - v) + v**2 * u


@pytest.mark.parametrize("order", [2, 3])
def test_products_are_those_of_functions(order):
    values = of_symbol("a", coefficients(A, order)) | of_symbol("b", coefficients(B, order))
    expected = of_symbol("c", coefficients(A * B, order))
    found = run(f"product_{order}", values)
    assert found.keys() == expected.keys()
    assert all(abs(found[key] - value) < 1e-25 for key, value in expected.items())


@pytest.mark.parametrize("order", [2, 3])
def test_compositions_are_those_of_functions(order):
    z = sp.Symbol("z")
    value = A.subs({u: 1, v: 2})
    outer = {
        f"f{k}": sp.N((sp.diff(sp.tan(z), z, k) / sp.factorial(k)).subs(z, value), 40)
        for k in range(1, order + 1)
    }
    expected = of_symbol("c", coefficients(sp.tan(A), order))
    found = run(f"composition_{order}", of_symbol("a", coefficients(A, order)) | outer)
    assert found.keys() == expected.keys() - {"c_0"}
    assert all(abs(x - expected[key]) < 1e-25 for key, x in found.items())


# --- errors ---------------------------------------------------------------------------------------

fractions = st.fractions(-4, 4, max_denominator=50)


def names_of(name: str) -> list[str]:
    return [x.name for x in formulas[name].in_components().inputs]


def changes(name: str, known: list[tuple[Fraction, Fraction, Fraction]]) -> tuple[Any, Any]:
    """Return the changes of results, and their radii without rounding.

    Known of each input are its value, its error, and the share of the error that it changes by.
    """
    names = names_of(name)
    values = {x: value for x, (value, _, _) in zip(names, known, strict=True)}
    changed = {x: y + error * share for x, (y, error, share) in zip(names, known, strict=True)}
    letters = {"a": "d", "b": "e", "f": "g"}
    errors = {letters[x[0]] + x[1:]: e for x, (_, e, _) in zip(names, known, strict=True)}
    sizes = {x: abs(y) for x, y in values.items()}
    before, after = run(name, values), run(name, changed)
    radii = run(RADII[name], sizes | errors | {"u": Fraction(0)})
    return {f"r{x[1:]}": after[x] - before[x] for x in before}, radii


@EACH
@pytest.mark.quick_for("product_2")
@given(data=st.data())
def test_radii_bound_the_change_by_errors(name, data):
    triple = st.tuples(fractions, fractions.map(abs), st.fractions(-1, 1, max_denominator=9))
    found, radii = changes(name, [data.draw(triple) for _ in names_of(name)])
    assert all(abs(change) <= radii[key] for key, change in found.items())


@EACH
def test_radii_are_attained(name):
    """Where all is positive and as large as it may be, the change is the radius."""
    known = [(Fraction(k + 2, 7), Fraction(1, k + 3), Fraction(1)) for k in range(20)]
    found, radii = changes(name, known[: len(names_of(name))])
    assert found == radii


@EACH
def test_radii_count_the_roundings_of_results(name):
    values = {x: Term.of(Fraction(k + 2, 7)) for k, x in enumerate(names_of(name))}
    zero = {x.name: 0 for x in formulas[RADII[name]].in_components().inputs}
    radii = run(RADII[name], zero | {x: y.value for x, y in values.items()} | {"u": Fraction(1)})
    for key, found in run(name, values).items():
        stated = radii[f"r{key[1:]}"] / found.value
        assert found.roundings <= stated <= found.roundings + 1, key


def test_arguments_are_polynomials():
    assert [*arguments(formulas["product_3"])] == ["a", "b"]
    assert all(isinstance(x, VectorSymbol) for x in formulas["product_3"].inputs)
