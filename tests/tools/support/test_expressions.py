"""Users' support functions: evaluated by NumPy, for a block of normals at a time."""

from typing import Any

import gaussmap as gm
import mpmath
import numpy as np
import pytest
import sympy as sp
from gaussmap.tools.support import expression

# With kinks, poles, logarithms of negative numbers and overflow among 400 normals.
EXPRESSIONS = [
    "sqrt(4*n_x**2 + n_y**2 + n_z**2) + exp(n_x)*atan2(n_y, n_z)",
    "Abs(n_x) + sqrt(n_y)",
    "(n_x**4 + n_y**4 + n_z**4)**(1/4)",
    "Piecewise((n_x, n_x > 0), (n_y**2, True))",
    "log(n_x)/n_y + asin(2*n_z)",
    "exp(1000*n_x) + exp(exp(9*n_z))",
    "1/n_x + sqrt(1/n_y)",
    "Max(n_x, 2*n_y) + Min(n_y, n_z)**2 + sign(n_z)",
    "erf(n_x) + sinh(n_y)*acosh(2 + n_z)",
    "10**30*n_x + n_y/3",
]
NORMALS = np.concatenate([gm.fibonacci(400), np.eye(3), 0.0 - np.eye(3)])


@pytest.mark.parametrize("h", EXPRESSIONS)
def test_values(h: str) -> None:
    """As SymPy evaluates them, with 30 digits; where that is not real and finite, no branch."""
    found = gm.SupportFunction.from_sympy(h)(NORMALS)
    symbols = sp.symbols("n_x n_y n_z", real=True)
    names: Any = {str(x): x for x in symbols}
    exact = sp.lambdify(symbols, sp.sympify(h, names), "mpmath")  # pyright: ignore[reportCallIssue]
    seen = 0
    for normal, value in zip(NORMALS, found, strict=True):
        try:
            wanted: Any = complex(exact(*map(mpmath.mpf, normal)))
        except (ZeroDivisionError, OverflowError):
            wanted = complex(np.nan)
        if np.isfinite(value):
            assert abs(value - wanted) <= 1e-12 * max(abs(wanted), 1.0)
            seen += 1
        elif np.isfinite(wanted) and wanted.imag == 0.0:
            assert np.abs(normal).min() < 1e-9 or abs(wanted) > 1e300  # a kink or a pole
    assert seen > 80


def test_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    h = gm.SupportFunction.from_sympy(EXPRESSIONS[0], domain="n_z > -1/2")
    whole = h.branches(NORMALS)
    monkeypatch.setattr(expression, "AT_A_TIME", 7)
    by_blocks = h.branches(NORMALS)
    for name in ("normal_index", "points", "hessian", "gaussian_curvature"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(by_blocks, name))


def test_where_functions_of_math_raise_errors() -> None:
    assert len(gm.SupportFunction.from_sympy("log(n_x)").branches(-np.eye(3)).points) == 0
