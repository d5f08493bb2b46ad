"""Tapes: 2-jets of points, and bounds over boxes, compared with values of 32 digits."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import gaussmap as gm
import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from gaussmap.runtime.tape.kernels.points import LANES, Tape
from gaussmap.symbolic.elementary import LIBRARY
from gaussmap.symbolic.surfaces import CATALOGUE
from hypothesis import assume, example, given
from hypothesis import strategies as st

from ...products import covering
from . import made
from .made import ORDERS, balls_on, boxes, check, errors_on, jets_at, used_radii

DIGITS = 32
# Half widths of boxes relative to the domain: cells of a search, smaller ones, points.
WIDTHS = (1 / 32, 1e-3, 1e-9, 0.0)

u, v = sp.symbols("u v", real=True)


# --- what is compared -----------------------------------------------------------------------------


def regular_sinc(x: Any) -> Any:
    """Return sin(x)/x as a power series of x², which has no quotient at 0, nor have derivatives."""
    return sp.hyper((), (sp.Rational(3, 2),), -(x**2) / 4)


def exact_coefficients(position: Any, first: sp.Symbol, second: sp.Symbol) -> Callable[..., Any]:
    """Return the function of numbers of mpmath that gives Taylor coefficients (10, 3)."""
    position = [sp.sympify(x).replace(sp.sinc, regular_sinc) for x in position]
    entries = [
        (sp.diff(x, first, i, second, j) if i + j else x) / sp.factorial(i) / sp.factorial(j)
        for i, j in ORDERS
        for x in position
    ]
    function = sp.lambdify((first, second), entries, "mpmath", cse=True)
    return lambda s, t: np.array(function(mp.mpf(s), mp.mpf(t)), dtype=object).reshape(10, 3)


@cache
def of_catalogue(name: str) -> Callable[..., Any]:
    surface = CATALOGUE[name]
    defaults: Any = surface.defaults
    position = [x.subs(defaults) for x in surface.position]
    return exact_coefficients(position, surface.u, surface.v)


def boxes_of(surface: gm.Surface, count: int, width: float, seed: int) -> tuple[np.ndarray, ...]:
    """Return boxes in a domain, whose half widths are relative to it, and a place in each."""
    low, high = np.array(surface.domain).T
    return boxes(low, high, width * (high - low), count, seed)


# --- the catalogue --------------------------------------------------------------------------------


def tape_of(name: str) -> Tape:
    return made.tape_of(gm.surfaces.surface(name))


@covering(name=gm.surfaces.names(), width=WIDTHS)
def test_bounds_contain_exact_values(name, width):
    surface = gm.surfaces.surface(name)
    with mp.workdps(DIGITS):
        check(tape_of(name), of_catalogue(name), boxes_of(surface, 50, width, 1))


@pytest.mark.parametrize("name", ["torus", "sphere", "catenoid", "wavy_graph", "moebius_band"])
def test_bounds_of_third_derivatives_are_attained(name):
    """A tenth less would be wrong: the largest error at corners of boxes is the radius."""
    surface = gm.surfaces.surface(name)
    centres, widths, _ = boxes_of(surface, 40, 1e-3, 4)
    balls = balls_on(tape_of(name), centres, widths)
    used = used_radii(balls, of_catalogue(name), centres, widths)
    assert np.median(used[:, 6:][balls[:, 1, 6:] > 1e-9]) > 0.9


@pytest.mark.parametrize("name", CATALOGUE)
def test_bounds_of_rounding_are_a_few_units_for_each_operation(name):
    surface = gm.surfaces.surface(name)
    centres, widths, _ = boxes_of(surface, 40, 1 / 32, 5)
    sizes = np.abs(balls_on(tape_of(name), centres, widths)[:, :, :6]).sum(axis=1)
    few = 4.0 * len(tape_of(name).operations) * 2.0**-53
    assert (errors_on(tape_of(name), centres, widths) <= few * sizes.max()).all()


def test_a_tile_has_the_bits_of_its_boxes():
    """What is computed for a box does not depend on what is computed with it."""
    surface = gm.surfaces.dupin_cyclide()
    tape = tape_of("dupin_cyclide")
    centres, widths, places = boxes_of(surface, 2 * LANES + 5, 1 / 32, 6)
    balls, errors = balls_on(tape, centres, widths), errors_on(tape, centres, widths)
    jets = jets_at(tape, places)
    for k in range(len(centres)):
        one = slice(k, k + 1)
        assert (balls_on(tape, centres[one], widths[one])[0] == balls[k]).all()
        assert (errors_on(tape, centres[one], widths[one])[0] == errors[k]).all()
        assert (jets_at(tape, places[one])[0] == jets[k]).all()


def test_bounds_of_order_two_are_those_of_order_three():
    centres, widths, _ = boxes_of(gm.surfaces.torus(), 50, 1 / 32, 7)
    second, third = (balls_on(tape_of("torus"), centres, widths, order) for order in (2, 3))
    assert (second == third[:, :, :6]).all()


# --- expressions ----------------------------------------------------------------------------------

leaves = st.one_of(
    st.sampled_from([u, v]),
    st.integers(-3, 3).map(sp.Integer),
    st.fractions(-2, 2, max_denominator=9).map(lambda x: sp.Rational(x.numerator, x.denominator)),
    st.sampled_from([sp.pi, sp.sqrt(2), sp.Float(0.1)]),
)
FUNCTIONS = (sp.sin, sp.cos, sp.tan, sp.exp, sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.log, sp.sqrt,
             sp.asin, sp.acos, sp.erf, sp.sinc, lambda x: 1 / x)  # fmt: skip


def larger(parts: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.one_of(
        st.builds(lambda x, y: x + y, parts, parts),
        st.builds(lambda x, y: x * y, parts, parts),
        st.builds(lambda x, y: x - y, parts, parts),
        st.builds(lambda x, k: x**k, parts, st.integers(2, 9)),
        st.builds(lambda f, x: f(x), st.sampled_from(FUNCTIONS), parts),
        st.builds(
            lambda x, p: (x**2 + 1) ** p,
            parts,
            st.sampled_from([sp.Rational(1, 3), sp.Rational(-5, 2)]),
        ),
    )


expressions = st.recursive(leaves, larger, max_leaves=8)


def is_bounded(x: Any) -> bool:
    """Say whether an expression is real and not huge on the box that is tried."""
    return not x.has(sp.zoo, sp.nan, sp.oo, sp.I, sp.Abs) and x.count_ops() < 60


@pytest.mark.compiled  # singularities raise without compilation
@given(
    st.tuples(expressions, expressions, expressions),
    st.floats(-1.0, 1.0),
    st.floats(0.3, 1.5),
    st.sampled_from(WIDTHS),
)
@example((u, v, sp.sinc(u)), 0.0, 1.0, 1 / 32)
@example((u, v, sp.sinc(u) ** 2), 1 / 32, 1.0, 1 / 32)  # next to 0 at the side of the box
def test_bounds_contain_exact_values_of_any_expression(position, s, t, width):
    assume(all(is_bounded(x) for x in position))
    try:
        tape = gm.Surface.from_sympy(position, (u, v), ((-1, 1), (0.25, 1.75))).tape
    except gm.errors.InputError:  # 1/(u - u)
        tape = None
    if tape is None:
        return
    centre, widths = np.array([[s, t]]), np.full((1, 2), width)
    signs = np.array([(0, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)])
    places = np.nextafter(centre + signs * widths, centre)
    exact = exact_coefficients(position, u, v)
    balls, errors = balls_on(tape, centre, widths)[0], errors_on(tape, centre, widths)[0]
    jets = jets_at(tape, places)
    with mp.workdps(2 * DIGITS):
        for k, place in enumerate(places.tolist()):
            try:
                values = exact(*place)
            except (ZeroDivisionError, ValueError):  # a pole
                assert np.isinf(balls[1]).any()
                continue
            real = np.array([mp.im(x) == 0 for x in values.ravel()]).reshape(10, 3)
            values = np.where(real, values, math.nan)
            radii = np.where(real, balls[1], math.inf)
            assert (~real <= np.isinf(balls[1])).all()
            known = np.isfinite(radii)
            distance = abs(values[known] - balls[0][known].astype(object))
            assert (distance <= radii[known].astype(object)).all()
            known = np.isfinite(errors)
            distance = abs(values[:6][known] - jets[k][known].astype(object))
            assert (distance <= errors[known].astype(object)).all()


# --- where there are no bounds --------------------------------------------------------------------


@pytest.mark.compiled
@pytest.mark.parametrize(
    "text",
    [
        "1/u", "sign(u)", "sqrt(u)", "log(u)", "asin(10*u)", "u**(1/3)", "tan(10*u)",
        "exp(1000*u**-2)",
    ],
)  # fmt: skip
def test_radii_are_infinite_where_there_is_a_singularity(text):
    square = (-1, 1), (-1, 1)
    tape = made.tape_of(gm.Surface.from_sympy(("u", "v", text), ("u", "v"), square))
    centres, widths = np.array([[0.1, 0.0]]), np.array([[0.2, 0.1]])
    middles, radii = balls_on(tape, centres, widths)[0]
    assert np.isfinite(middles).all()
    assert np.isfinite(radii[:, :2]).all()
    assert np.isinf(radii[1:, 2]).any()
    assert not np.isnan(radii).any()
    assert not np.isnan(errors_on(tape, centres, widths)).any()


ANGLES = np.random.default_rng(3)
QUARTERS = np.arange(-3000.0, 3000.0) * (math.pi / 2.0)
CASES = {
    "small": ANGLES.uniform(-7.0, 7.0, 3000),
    "tiny": 10.0 ** ANGLES.uniform(-300.0, 0.0, 500),
    "large": ANGLES.uniform(-(2.0**18), 2.0**18, 3000),
    "beyond": np.array([2.0**18, 1e6, 1e15, 1e300]),
    "next to quarters": QUARTERS * (1.0 + 1e-9 * ANGLES.normal(size=len(QUARTERS))),
    "quarters": QUARTERS,
    "eighths": QUARTERS + math.pi / 4.0,
    "most digits lost": np.array([45.553093477052, 91553.86390724055, 229174.47169039503]),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.quick_for("tiny", "large", "beyond", "next to quarters", "most digits lost")
def test_sines_of_tapes_are_as_exact_as_those_of_the_c_library(name: str) -> None:
    """Also where angles are reduced with many digits lost; large ones are left to that."""
    angles = CASES[name]
    x, y = sp.symbols("u v")
    tape = gm.Surface.from_sympy((sp.sin(x), sp.cos(x), y), (x, y), domain=((0, 1), (0, 1))).tape
    assert tape is not None
    found = jets_at(tape, np.stack([angles, np.zeros_like(angles)], axis=1))
    with mp.workdps(80):
        for place, row in zip(angles.tolist(), found, strict=True):
            sine, cosine = mp.sin(mp.mpf(place)), mp.cos(mp.mpf(place))
            for value, correct in zip(row[0, :2].tolist(), (sine, cosine), strict=True):
                assert abs(mp.mpf(value) - correct) <= LIBRARY * 2.0**-53 * abs(correct)
