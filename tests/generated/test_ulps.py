"""Compiled formulas against exact values, in ULPs of the size of their terms.

The bound is the usual one for straight-line code. A result of +, − and × is a sum of terms, and
what is computed is that sum with every term times (1 + δ)ⁿ, |δ| <= u = 2⁻⁵³, where n counts the
roundings that the term has gone through: one for each operation on its way, and those of both
factors at a product. With k the largest of these counts and S the sum of the moduli of the terms,

    |computed − exact| <= γ S,   γ = k u/(1 − k u),

which is k ULPs of S or less. At a quotient a/b the condition S(b)/|b| of the denominator enters:
S = S(a) S(b)/b². That holds to first order in the relative error of b, which has to be small.

The formula as it stands in generated/, alone or in a loop over normals, is executed on `Term`s,
which count all this. `ROUNDINGS` states k for every formula; how far the terms cancel is in S, and
not in k.
"""

import math
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from gaussmap.generated import patch, support_function
from gaussmap.runtime.machine_code.jit import jit
from gaussmap.symbolic import formulas
from gaussmap.symbolic.emit import grouped as outputs_in_groups
from gaussmap.symbolic.notation import VectorSymbol
from hypothesis import assume, given
from hypothesis import strategies as st

from ..symbolic.calls import flat, grouped
from ..symbolic.terms import Term, quotients

UNIT = Fraction(1, 2**53)

# The largest number of roundings of any term of any output.
ROUNDINGS = {
    "forms": 10,
    "support_function": 24,
    "envelope": 8,
    "curvature": 13,
    "orientation": 25,
    "control_normals": 7,
    "over_normals.support_function": 24,
    "over_normals.gradient_at_normal": 44,
    "over_normals.hessian_at_normal": 59,
    "over_normals.curvature_at_normal": 146,
}


def inputs_of(name: str) -> list[str]:
    return [symbol.name for symbol in formula_of(name).in_components().inputs]


def formula_of(name: str) -> Any:
    return formulas[name.removeprefix("over_normals.")]


@cache
def compiled(name: str) -> Any:
    """Return a generated function, compiled."""
    return jit(getattr(support_function, name.removeprefix("over_normals.")))


def results(name: str, inputs: dict[str, Any], *, run_compiled: bool) -> list[Any]:
    """Run a generated function on numbers or terms, a loop on a single normal."""
    if not name.startswith("over_normals."):
        function = getattr(patch, name)
        if not run_compiled:
            function = getattr(function, "py_func", function)
        return flat(function(*grouped(formula_of(name), inputs).values()))
    vectors, normal = grouped(formula_of(name), inputs).values()
    kind = np.float64 if run_compiled else object
    shapes = [(1, 3, 3) if group else (1, 3) if isinstance(x[0], VectorSymbol) else (1,)
              for group, x in outputs_in_groups(formula_of(name).outputs)]  # fmt: skip
    arrays = [np.empty(shape, dtype=kind) for shape in shapes]
    function = compiled(name)
    if not run_compiled:
        function = getattr(function, "py_func", function)
    function(vectors, np.array([normal], dtype=kind), *arrays)
    return [x for array in arrays for x in array.ravel().tolist()]


def exact(name: str, inputs: dict[str, float]) -> list[Term]:
    """Run a generated function on terms."""
    quotients.clear()
    return results(name, {x: Term.of(y) for x, y in inputs.items()}, run_compiled=False)


def check(name: str, inputs: dict[str, float]) -> None:
    """Compare a compiled function with its exact values."""
    k = ROUNDINGS[name]
    gamma = k * UNIT / (1 - k * UNIT)
    computed = results(name, inputs, run_compiled=True)
    for term, result in zip(exact(name, inputs), computed, strict=True):
        slack = 1 + Fraction(len(quotients), 1000)  # second order of the denominators
        assert math.isfinite(result)
        assert abs(Fraction(result) - term.value) <= gamma * term.size * slack


def check_where_bounded(name: str, inputs: dict[str, float]) -> None:
    """Do the same, but leave out inputs with a denominator that may be nothing but rounding."""
    try:
        exact(name, inputs)
    except ZeroDivisionError:
        assume(False)
    assume(all(x.roundings * UNIT * x.size <= abs(x.value) / 1024 for x in quotients))
    check(name, inputs)


# --- inputs ---------------------------------------------------------------------------------------

integers = st.integers(-1000, 1000).map(float)
floats = st.builds(math.ldexp, st.integers(-(2**53), 2**53).map(float), st.integers(-80, -30))


def numbers(name: str, values: st.SearchStrategy[float]) -> st.SearchStrategy[dict[str, float]]:
    """Draw the inputs of a formula, in their order."""
    names = inputs_of(name)
    rows = st.tuples(*[values] * len(names))
    return rows.map(lambda row: dict(zip(names, row, strict=True)))


@st.composite
def nearly_parabolic(draw: st.DrawFn, name: str) -> dict[str, float]:
    """Draw a patch and a normal with D = A C − B² cancelling to a few or to nearly all bits."""
    inputs = draw(numbers(name, draw(st.sampled_from([integers, floats]))))
    a, b, c, n = ([Fraction(inputs[f"{x}_{axis}"]) for axis in "xyz"] for x in "abcn")
    A, B = (sum(x * y for x, y in zip(vector, n, strict=True)) for vector in (a, b))
    assume(A != 0 and n[2] != 0)
    c_z = (B * B / A - c[0] * n[0] - c[1] * n[1]) / n[2]
    bits = draw(st.integers(4, 60))
    inputs["c_z"] = float(c_z * (1 + draw(st.sampled_from([-1, 1])) * Fraction(1, 2**bits)))
    assume(abs(inputs["c_z"]) < 2.0**60)
    return inputs


@st.composite
def nearly_flat(draw: st.DrawFn, name: str) -> dict[str, float]:
    """Draw a patch that is nearly a plane: its orientation is a small remainder."""
    inputs = draw(numbers(name, integers))
    slope_x, slope_y = draw(floats), draw(floats)
    bits = draw(st.integers(4, 50))
    for key in [key for key in inputs if key.endswith("_z") and not key.startswith("n_")]:
        stem = key.removesuffix("_z")
        height = slope_x * inputs[f"{stem}_x"] + slope_y * inputs[f"{stem}_y"]
        inputs[key] = height + math.ldexp(inputs[key], -bits)
    return inputs


EACH = pytest.mark.parametrize("name", ROUNDINGS)


@EACH
@given(data=st.data())
@pytest.mark.quick_for("forms", "curvature")
def test_integer_patches(name, data):
    check_where_bounded(name, data.draw(numbers(name, integers)))


@pytest.mark.compiled
@EACH
@given(data=st.data())
@pytest.mark.quick_for("support_function", "orientation")
def test_patches_of_any_floats(name, data):
    check_where_bounded(name, data.draw(numbers(name, floats)))


@pytest.mark.parametrize(
    ("name", "patches"),
    [("forms", nearly_parabolic), ("orientation", nearly_parabolic),
     ("envelope", nearly_flat), ("orientation", nearly_flat)],
)  # fmt: skip
@given(data=st.data())
def test_patches_whose_terms_cancel(name, patches, data):
    check_where_bounded(name, data.draw(patches(name)))


@pytest.mark.parametrize("name", ["forms", "envelope", "orientation", "control_normals"])
@given(data=st.data())
def test_small_integers_are_exact(name, data):
    """Without a quotient all values on the way are integers or halves below 2⁵³."""
    inputs = data.draw(numbers(name, st.integers(-15, 15).map(float)))
    for term, result in zip(
        exact(name, inputs),
        flat(getattr(patch, name)(*grouped(formula_of(name), inputs).values())),
        strict=True,
    ):
        assert Fraction(result) == term.value


# --- the bound itself -----------------------------------------------------------------------------


@EACH
def test_the_stated_number_of_roundings_is_that_of_the_formula(name):
    inputs = {key: float(3 * k * k % 17 + 1) for k, key in enumerate(inputs_of(name))}
    assert max(term.roundings for term in exact(name, inputs)) == ROUNDINGS[name]
