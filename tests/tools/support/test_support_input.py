"""Support functions that users write: what is refused, and how they are evaluated."""

from collections.abc import Callable
from typing import Any

import gaussmap as gm
import mpmath
import numpy as np
import pytest
import sympy as sp
from gaussmap.tools.support import expression

from ...refusals import refused

given = gm.SupportFunction.from_sympy
k = sp.Symbol("k")
SPHERE = gm.SupportFunction.from_sympy(1)
NOT_A_NUMBER = [float("nan"), float("inf"), "1", None, [1.0, 2.0], 1j]


@pytest.mark.parametrize(
    ("h", "message"),
    [
        ("x*y", "no component of the normal: x, y"),
        ("I*n_x", "uses I, which is not a real number"),
        (sp.I * sp.Symbol("n_x"), "h is not real"),
        ("log(-1)", "a number that is not real"),
        ("nan", "uses nan, which is not a real number"),
        ("1/0", "not finite"),
        (float("nan"), "not finite"),
        ("oo*n_x", "uses oo, which is not a real number"),
        (sp.oo * sp.Symbol("n_x"), "not finite"),
        ("besselj(0, n_x)", "uses besselj, which kernels cannot compute"),
        ("f(n_x)", "uses f, which"),
        ("Integral(n_x, n_x)", "uses Integral, which"),
        ("floor(n_x)", "uses floor, which"),
        (sp.Sum(sp.Symbol("n_x") ** sp.Symbol("k"), (sp.Symbol("k"), 0, 3)), "uses Sum, which"),
        ("n_x +", "is not a SymPy expression"),
        ("n_x > 0", "is not a SymPy expression"),
        ([1, 2], "is not a SymPy expression"),
        (sp.Matrix([1, 2]), "is not a SymPy expression"),
        ("x" * 200, "no component of the normal: x+…"),
        ("besselj(0, n_x)*(" + "+".join(f"n_x**{k}" for k in range(60)) + ")", "…"),
    ],
)
def test_expressions(h: Any, message: str) -> None:
    refused(message, given, h)


@pytest.mark.parametrize(
    "normal", ["xy", "xyzw", ("x", "x", "z"), (1, 2, 3), None, 3, ("a b", "y", "z"), ("if", *"yz")]
)
def test_names_of_the_normal(normal: Any) -> None:
    refused("normal must be three symbols, or their names", given, "1", normal=normal)


@pytest.mark.parametrize(
    ("domain", "message"),
    [
        ("n_z", "must be a condition"),
        ("n_z > 0 and n_x > 0", r"\(n_x > 0\) & \(n_y > 0\)"),
        ("0 < n_z < 1", "must be a condition"),
        (5, "must be a condition"),
        ("n_z >", "must be a condition"),
        ("w > 0", "domain holds symbols that are no component of the normal: w"),
        ("I*n_z > 0", "uses I, which is not a real number"),
        ("besselj(0, n_z) > 0", "uses besselj"),
    ],
)
def test_domains(domain: Any, message: str) -> None:
    refused(message, given, "1", domain=domain)


def test_of_spline_takes_surfaces_and_splines() -> None:
    refused("of_spline takes a Spline or Surface, not int", gm.SupportFunction.of_spline, 5)
    spline = gm.Spline(np.zeros((5, 5, 3)), ((0, 1), (0, 1)), (("open",) * 2,) * 2, "flat")  # pyright: ignore
    refused("cells=", gm.SupportFunction.of_spline, spline, (4, 4))


@pytest.mark.parametrize(
    ("call", "value", "message"),
    [
        *((SPHERE.offset, x, "distance must be a finite number") for x in NOT_A_NUMBER),
        *((SPHERE.scaled, x, "factor must be a finite number") for x in NOT_A_NUMBER),
        (SPHERE.scaled, 0, "factor must not be 0"),
        *((SPHERE.translated, x, r"shape \(3,\)") for x in ([1.0, 2.0], 1.0, [[1.0, 2.0, 3.0]])),
        (SPHERE.translated, [1.0, np.nan, 0.0], "NaN or infinity"),
        (SPHERE.translated, "abc", "real numbers"),
        (SPHERE.rotated, np.eye(2), r"shape \(3, 3\)"),
        (SPHERE.rotated, np.eye(3) * np.nan, "NaN or infinity"),
        *((SPHERE.rotated, x, "orthogonal") for x in (
            np.zeros((3, 3)), 2 * np.eye(3), 1e200 * np.eye(3), np.eye(3) + 1e-9,
        )),
        *((SPHERE.rotated, x, "reflection") for x in (-np.eye(3), np.diag([1.0, 1.0, -1.0]))),
    ],
)  # fmt: skip
def test_operations(call: Callable[..., Any], value: Any, message: str) -> None:
    refused(message, call, value)


def test_only_support_functions_can_be_added() -> None:
    several: Any = sum([SPHERE, SPHERE, SPHERE])
    assert several.branches([[0.0, 0.0, 1.0]]).support.tolist() == [3.0]
    others: Any = (1.0, None, "n_x", gm.surfaces.torus())
    for other in others:
        for one, two in ((SPHERE, other), (other, SPHERE)):
            with pytest.raises(TypeError):
                _ = one + two


# --- users' support functions, by NumPy for a block of normals at a time --------------------------

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
