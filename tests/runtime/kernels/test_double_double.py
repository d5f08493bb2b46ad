"""Arithmetic on double-doubles: its errors, and the same with and without compilation."""

import math
from fractions import Fraction
from typing import Any

import pytest
from gaussmap.generated.patch import eliminated_forms, parameters
from gaussmap.runtime.formula_calls import python_function
from gaussmap.runtime.kernels.double_double import DoubleDouble, split, two_product, two_sum
from gaussmap.runtime.kernels.jit import jit
from hypothesis import given
from hypothesis import strategies as st

NUMBERS = st.builds(math.ldexp, st.integers(-(2**53), 2**53).map(float), st.integers(-60, 60))
# Half a unit in the last place of the sum, to which the smaller part is rounded.
PAIRS = st.tuples(NUMBERS, NUMBERS).map(lambda x: DoubleDouble(*python_function(two_sum)(*x)))
# The bound of one operation on pairs, relative to the moduli of what is added.
ERROR = Fraction(2) ** -102


def value(pair: Any) -> Fraction:
    return Fraction(pair[0]) + Fraction(pair[1])


@given(x=NUMBERS, y=NUMBERS)
def test_sums_products_and_parts_are_exact(x: float, y: float) -> None:
    assert value(python_function(two_sum)(x, y)) == Fraction(x) + Fraction(y)
    assert value(python_function(two_product)(x, y)) == Fraction(x) * Fraction(y)
    parts = python_function(split)(x)
    assert value(parts) == Fraction(x)
    assert all(part == 0 or (math.frexp(part)[0] * 2**26).is_integer() for part in parts)


@given(x=PAIRS, y=PAIRS)
def test_operators_carry_106_bits(x: DoubleDouble, y: DoubleDouble) -> None:
    size = abs(value(x)) + abs(value(y))
    assert abs(value(x + y) - value(x) - value(y)) <= ERROR * size
    assert abs(value(x - y) - value(x) + value(y)) <= ERROR * size
    assert abs(value(x * y) - value(x) * value(y)) <= ERROR * abs(value(x) * value(y))
    assert value(-x) == -value(x)
    assert value(4 * x) == 4 * value(x)


def on_pairs(A: Any, B: Any, C: Any, P: Any, Q: Any) -> Any:
    """Compute a sum of everything that formulas of patches do."""
    D, U, V, W = eliminated_forms(A, B, C, P, Q)
    return D - 2 * U, -V, W + U


@pytest.mark.compiled
def test_formulas_on_pairs_are_compiled_to_the_same() -> None:
    compiled = jit(on_pairs)
    for k in range(50):
        x = [DoubleDouble(math.sin(7 * k + j), math.ldexp(math.cos(j - k), -56)) for j in range(5)]
        D, U, V, W = python_function(eliminated_forms)(*x)
        assert compiled(*x) == (D - 2 * U, -V, W + U)


def test_pairs_have_no_quotient() -> None:
    with pytest.raises(TypeError):
        python_function(parameters)(*[DoubleDouble(1.0, 0.0)] * 3)
