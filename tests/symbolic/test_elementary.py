"""Elementary functions: coefficients, their extremes and roundings, compared with mpmath."""

import math
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from gaussmap.generated import elementary as generated
from gaussmap.symbolic.elementary import (
    FIRST_PART,
    FORMULAS,
    FUNCTIONS,
    LAST_PART,
    LIBRARY,
    SECOND_PART,
    x,
)
from hypothesis import given
from hypothesis import strategies as st

EACH = pytest.mark.parametrize("name", [k for k in FUNCTIONS if k != "sign"])
# Where a function is tried; sin and cos for several periods.
INTERVALS = {
    "reciprocal": (0.1, 4.0),
    "sqrt": (0.01, 4.0),
    "log": (0.01, 4.0),
    "asin": (-0.99, 0.99),
    "sinc": (1.0, 7.0),
}
SECOND = {
    **{"sin": mp.cos, "cos": mp.sin, "sinh": mp.cosh, "cosh": mp.sinh},
    "erf": lambda z: math.exp(-float(z) * float(z)),  # with the rounding of the square
    "sinc": mp.cos,
}


def row(name: str) -> int:
    return list(FUNCTIONS).index(name)


def function(name: str) -> Any:
    """Return a function of mpmath."""
    powers = {"reciprocal": lambda z: 1 / z, "square": lambda z: z**2, "cube": lambda z: z**3}
    return powers.get(name) or getattr(mp, name)


def coefficients(name: str, place: float) -> list[float]:
    """Return the generated coefficients f1, f2, f3 at a place, from correct values."""
    formula = FORMULAS[row(name)]
    value = function(name)(mp.mpf(place))
    second = SECOND.get(name, mp.mpf)(mp.mpf(place))
    known = {"x": place, "y": float(value), "w": float(second)}
    found = getattr(generated, formula.name)
    inputs = [known[z.name] for z in formula.inputs]
    return [float(z) for z in getattr(found, "py_func", found)(*inputs)]


DERIVATIVES = {
    name: sp.lambdify(x, function.coefficients, "mpmath") for name, function in FUNCTIONS.items()
}


def exact(name: str, place: float) -> list[Any]:
    """Return the Taylor coefficients 0, …, 3 at a place, with 40 digits."""
    if name == "sinc" and abs(place) < 1e-8:  # the quotient of zeros
        return [mp.mpf(1), mp.mpf(-place) / 3, mp.mpf(-1) / 6, mp.mpf(place) / 30]
    with mp.workdps(80):
        return [+z for z in DERIVATIVES[name](mp.mpf(place))]


@EACH
@given(data=st.data())
def test_coefficients_are_those_of_taylor(name, data):
    """The error is at most that of the table, with correctly rounded values."""
    place = data.draw(st.floats(*INTERVALS.get(name, (-7.0, 7.0)), allow_subnormal=False))
    for k, (found, value) in enumerate(
        zip(coefficients(name, place), exact(name, place)[1:], strict=True), 1
    ):
        size = abs(value) + generated.CANCELLING[row(name)]
        with mp.workdps(40):
            assert (
                abs(mp.mpf(found) - value)
                <= generated.ROUNDINGS[row(name), k] * 2.0**-53 * size + 1e-40
            )


@given(st.floats(-1.0, 1.0, allow_subnormal=False))
def test_the_series_of_sinc(place):
    series = getattr(generated.sinc_series, "py_func", generated.sinc_series)
    for k, (found, value) in enumerate(zip(series(place), exact("sinc", place), strict=True)):
        allowed = generated.ROUNDINGS[row("sinc"), k] * (abs(value) + 1.0)
        assert abs(found - value) <= allowed * 2.0**-53


@given(st.floats(-40.0, 40.0), st.floats(0.0, 4.0))
def test_slopes_of_sinc(place, step):
    """Between two places the function and its coefficients change no more than the slopes allow."""
    changes = [
        abs(x - y) for x, y in zip(exact("sinc", place), exact("sinc", place + step), strict=True)
    ]
    assert all(x <= y * (step + 1e-9) for x, y in zip(changes, generated.SINC_SLOPES, strict=True))


@pytest.mark.parametrize("name", [k for k, f in FUNCTIONS.items() if k != "sign" and not f.slopes])
def test_coefficients_are_monotone_between_extremes(name):
    """Otherwise the values at the ends of an interval and at extremes were no bounds."""
    low, high = INTERVALS.get(name, (-7.0, 7.0))
    spacing, places = generated.SPACING[row(name)], generated.EXTREMES[row(name)]
    extremes = [*places[np.isfinite(places)]]
    if spacing > 0.0:
        extremes = [k * spacing for k in range(-10, 10)]
    ends = sorted({low, high, *(z for z in extremes if low < z < high)})
    for start, end in pairwise(ends):
        steps = np.linspace(start, end, 40)[1:-1]
        values = np.array([[float(z) for z in exact(name, step)] for step in steps])
        for column in values.T:
            differences = np.diff(column)
            assert (differences >= 0.0).all() or (differences <= 0.0).all(), (start, end)


@EACH
def test_singularities_are_places_of_the_table(name):
    singular = {"reciprocal": [0.0], "log": [0.0]}.get(name, [])
    assert set(singular) <= set(generated.EXTREMES[row(name)])


@pytest.mark.parametrize("name", [k for k, f in FUNCTIONS.items() if f.cancelling])
def test_sums_of_absolute_values_are_bounded_where_terms_cancel(name):
    """Evaluated with all signs positive, from the source of the formula."""
    formula = FORMULAS[row(name)]
    for place in np.linspace(1.0 if name == "sinc" else 0.0, 5.0, 51):
        known = {"x": abs(place), "y": abs(float(function(name)(place)))}
        if name in SECOND:  # of erf, with the error of the square
            known["w"] = abs(float(SECOND[name](place))) * (1.0 + place**2 * (name == "erf"))
        values: dict[Any, Any] = {}
        for symbol, term in formula.definitions:
            positive = positive_terms(term)
            values[symbol] = positive.subs(
                {z: known.get(z.name, values.get(z)) for z in positive.free_symbols}
            )
        largest = max(float(values[z]) for z in formula.outputs)
        assert largest <= FUNCTIONS[name].cancelling * (1 + 1e-12)


def positive_terms(expression: Any) -> Any:
    """Return an expression with all numbers positive, but for those in denominators' exponents."""
    if expression.is_Number:
        return abs(expression)
    if not expression.args:
        return expression
    if expression.is_Pow:
        return positive_terms(expression.base) ** expression.exp
    return expression.func(*map(positive_terms, expression.args))


def test_other_functions_have_no_cancelling_terms():
    """Terms of one sign: all coefficients of their sums are positive, or x is small."""
    for name, f in FUNCTIONS.items():
        if f.cancelling or name in (
            "asin",
            "sign",
        ):  # (1 − x)(1 + x), whose factors are exact to a rounding
            continue
        for _, term in FORMULAS[row(name)].definitions:
            assert not term.is_Add or all(not z.could_extract_minus_sign() for z in term.args), name


@pytest.mark.parametrize("name", [k for k in FUNCTIONS if hasattr(math, k)])
def test_the_c_library_is_as_exact_as_is_assumed(name):
    low, high = INTERVALS.get(name, (-7.0, 7.0))
    for place in np.random.default_rng(0).uniform(low, high, 500).tolist():
        with mp.workdps(40):
            value = function(name)(mp.mpf(place))
            assert abs(getattr(math, name)(place) - value) <= LIBRARY * 2.0**-53 * abs(value)


def test_angles_below_a_number_are_not_so_near_to_quarters_that_the_last_part_is_too_short():
    """The rest of π/2 times k, rounded, is less than the angle that is left: its error is one."""
    bits = 300
    with mp.workprec(bits + 60):
        quarter = int(mp.floor(mp.pi / 2 * mp.mpf(2) ** bits))
    last = LAST_PART * 2**bits
    assert abs(FIRST_PART + SECOND_PART + LAST_PART - sp.Rational(quarter, 2**bits)) < 2.0**-121
    count = math.ceil(2.0**18 / (math.pi / 2.0))
    for k in range(1, count):
        exact = k * quarter
        angle = int(exact / 2**bits * 2.0**52) << (bits - 52)  # the float that is nearest
        assert k * int(last) < abs(angle - exact)
