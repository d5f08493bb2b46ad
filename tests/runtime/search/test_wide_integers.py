"""Wide integers: exact arithmetic, and the same with and without compilation."""

import math
from typing import Any

import numpy as np
import pytest
from gaussmap.generated.patch import parameters
from gaussmap.runtime.machine_code.jit import jit
from gaussmap.runtime.search.kernels.wide_integers import rounded, wide
from hypothesis import example, given
from hypothesis import strategies as st

from ...refusals import refused

TWO, THREE = (0, 0), (0, 0, 0)
NUMBERS = st.builds(math.ldexp, st.integers(-(2**53), 2**53).map(float), st.integers(-69, -53))
# The lowest bit of the mantissa of 2⁻⁶⁹.
UNIT = -121
# That of the smallest number, taken as 53 bits.
LEAST = -1126


def in_all_ways(x: float, y: float, found: Any) -> None:
    """Write sums and products of all widths, rounded."""
    a, b, c = wide(x, UNIT, TWO), wide(y, UNIT, TWO), wide(y, UNIT, THREE)
    found[0] = rounded(a - b)
    found[1] = rounded(a * b + b * b - b * a)
    found[2] = rounded(-a * c + (2 * b) * c)
    found[3] = rounded(c * (a * c))
    found[4] = rounded((b * b) * (a * b))


compiled = jit(in_all_ways)


@pytest.mark.compiled
@given(x=NUMBERS, y=NUMBERS)
@example(x=0.0, y=-0.0)
@example(x=-1.0, y=2.0**-69)
def test_wide_integers_are_those_of_python(x: float, y: float) -> None:
    found, expected = np.empty(5), np.empty(5)
    compiled(x, y, found)
    in_all_ways(x, y, expected)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.compiled
def test_subnormal_numbers_are_integers() -> None:
    @jit
    def value(x: Any, unit: Any, found: Any) -> None:
        found[0] = rounded(wide(x, unit, TWO))

    found = np.empty(1)
    for x in (5e-324, -3.5e-320, 2.0**-1022, 2.0**-1021 + 5e-324):
        value(x, LEAST, found)
        assert found[0] == math.ldexp(math.ldexp(x, 1000), -LEAST - 1000) == wide(x, LEAST, TWO)


@pytest.mark.compiled
def test_wide_integers_have_no_quotient() -> None:
    quotients = getattr(parameters, "py_func", parameters)
    refused("Wide", jit(lambda x: quotients(wide(x, UNIT, TWO), 1, 1)), 1.0, error=Exception)
