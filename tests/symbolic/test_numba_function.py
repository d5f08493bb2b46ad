"""Formulas of users as compiled functions, by the emitter of this project."""

from pathlib import Path

import gaussmap as gm
import numba
import numpy as np
import pytest
import sympy as sp
from gaussmap.symbolic import Cross, Dot, Formula, compiled, vectors

from ..refusals import refused

K, H = sp.symbols("K H", real=True)
d, e, q, N = vectors(("d", "e", "q", "N"))


def shape_index() -> Formula:
    return Formula.build(
        "shape_index",
        "The shape index $S$ of Koenderink.",
        inputs=[K, H],
        terms=[("r", sp.sqrt(sp.Abs(H**2 - K)))],
        outputs=[("S", 2 / sp.pi * sp.atan2(H, sp.Symbol("r", real=True)))],
    )


def tilt() -> Formula:
    return Formula.build(
        "tilt",
        "The normal $N$, and its part $t$ along $q$.",
        inputs=[d, e, q],
        outputs=[("N", Cross(d, e)), ("t", Dot(N, q))],
    )


def test_a_measure_of_samples() -> None:
    samples = gm.sample("torus", normals=gm.fibonacci(100))
    found = compiled(shape_index())(samples.gaussian_curvature, samples.mean_curvature)
    k1, k2 = samples.principal_curvatures.T
    expected = 2 / np.pi * np.arctan2(k1 + k2, np.abs(k1 - k2))
    assert np.allclose(found, expected, atol=1e-9)
    assert 0.1 < found.min() < 0.3 < 0.5 < found.max()


def test_vectors_broadcast() -> None:
    random = np.random.default_rng(1)
    left, right, along = random.normal(size=(4, 1, 3)), random.normal(size=(5, 3)), [0, 0, 2]
    normal, part = compiled(tilt())(left, right, along)
    assert np.allclose(normal, np.cross(left, right), atol=1e-15)
    assert np.allclose(part, 2 * np.cross(left, right)[..., 2], atol=1e-14)
    one, number = compiled(tilt())([1, 0, 0], [0, 1, 0], along)
    assert one.tolist() == [0, 0, 1]
    assert number == 2.0


@pytest.mark.parametrize("name", ["envelope", "linear_forms", "parameters", "principal_radii"])
def test_it_is_what_make_generate_writes(name: str) -> None:
    """There is one emitter: the source is that in generated/, with the same counts."""
    formula = gm.formulas[name]
    text = (Path(gm.__path__[0]) / "generated/patch.py").read_text(encoding="utf-8")
    if name in ("envelope", "linear_forms"):
        refused("all vectors of one patch", compiled, formula, error=ValueError)
        return
    found = compiled(formula)
    assert found.source in text
    before, after = found.operations
    assert f"{before} operations as written, {after} here" in found.source
    assert found.latex == formula.latex()


def test_the_scalar_function_in_a_kernel() -> None:
    cross = compiled(tilt()).scalar_function

    @numba.njit
    def total(rows):
        result = 0.0
        for k in range(len(rows)):
            row = (rows[k, 0], rows[k, 1], rows[k, 2])
            normal, part = cross(row, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
            result += part + normal.x
        return result

    rows = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    assert total(rows) == (1.0 - 3.0) + (4.0 - 6.0)


def test_errors() -> None:
    refused("takes a Formula, not str", compiled, "x + y", error=TypeError)
    refused("takes 2 arrays, K, H, not 1", compiled(shape_index()), [1.0], error=TypeError)
    with pytest.raises(ValueError, match=r"d must have the shape \(…, 3\), not \(2,\)"):
        compiled(tilt())([1, 2], [1, 2, 3], [1, 2, 3])
    row = sp.Symbol("row", real=True)
    clash = Formula.build("clash", "Twice $x$.", inputs=[row], outputs=[("y", 2 * row)])
    refused("both name", compiled, clash, error=ValueError)
