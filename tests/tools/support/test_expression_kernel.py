"""Users' support functions: interpreted for few normals, compiled for many, with the same bits."""

import os
import subprocess
import sys
from functools import partial
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.support import expression_kernel

# With kinks, poles, logarithms of negative numbers and overflow among 400 normals.
EXPRESSIONS = [
    "sqrt(4*n_x**2 + n_y**2 + n_z**2) + exp(n_x)*atan2(n_y, n_z)",
    "Abs(n_x) + sqrt(n_y)",
    "(n_x**4 + n_y**4 + n_z**4)**(1/4)",
    "Piecewise((n_x, n_x > 0), (n_y**2, True))",
    "log(n_x)/n_y + asin(2*n_z)",
    "exp(1000*n_x) + exp(exp(9*n_z))",
    "1/n_x + sqrt(1/n_y)",
]


def branches(h: Any, normals: np.ndarray) -> list[np.ndarray]:
    found = gm.SupportFunction.from_sympy(h).branches(normals)
    return [found.points, found.gaussian_curvature, found.mean_curvature]


@pytest.mark.compiled
@pytest.mark.parametrize("h", EXPRESSIONS)
def test_both_ways_give_the_same_bits(h: str, monkeypatch: pytest.MonkeyPatch) -> None:
    normals = np.concatenate([gm.fibonacci(400), np.eye(3), -np.eye(3)])
    results = []
    for most in (10**9, 0):
        monkeypatch.setattr(expression_kernel, "MOST_INTERPRETED", most)
        expression_kernel.kernel_of.cache_clear()
        results.append(branches(h, normals))
    for interpreted, compiled in zip(*results, strict=True):
        np.testing.assert_array_equal(interpreted, compiled)


@pytest.mark.compiled
def test_few_normals_are_interpreted_and_many_are_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled: list[Any] = []
    monkeypatch.setattr(expression_kernel, "jit", lambda x: compiled.append(x) or x)
    monkeypatch.setattr(expression_kernel, "MOST_INTERPRETED", 20)
    h = gm.SupportFunction.from_sympy("sqrt(n_x**2 + 11*n_y**2 + n_z**2)")
    counts = []
    for _ in range(3):  # 12, 24, 36 normals
        h.branches(gm.fibonacci(12))
        counts.append(len(compiled))
    assert counts == [0, 1, 1]


@pytest.mark.compiled
@pytest.mark.slow
def test_machine_code_of_an_expression_is_kept(tmp_path: Any) -> None:
    code = (
        "import gaussmap as gm\n"
        "from numba.core import event\n"
        "from gaussmap.tools.support import expression_kernel\n"
        "expression_kernel.MOST_INTERPRETED = 0\n"
        "with event.install_recorder('numba:compile') as compiled:\n"
        "    for h in ('n_x**2', 'n_y**2'):\n"
        "        print(gm.SupportFunction.from_sympy(h).branches([[0.6, 0.0, 0.8]]).points)\n"
        "print(len(compiled.buffer) > 0)\n"
    )
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    run = partial(subprocess.run, capture_output=True, text=True, check=True, env=environment)
    (*first, compiled), (*second, again) = (
        run([sys.executable, "-c", code]).stdout.splitlines() for _ in range(2)
    )
    assert first == second
    assert first[0] != first[1]
    assert (compiled, again) == ("True", "False")


def test_where_functions_of_math_raise_errors() -> None:
    """Where C's functions return inf or nan, Python's raise an error."""
    assert len(branches("log(n_x)", -np.eye(3))[0]) == 0
