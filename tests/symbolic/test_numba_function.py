"""Formulas of users as compiled functions, by the emitter of this project."""

from collections import Counter
from pathlib import Path

import gaussmap as gm
import numba
import numpy as np
import pytest
import sympy as sp
from gaussmap.symbolic import Cross, Dot, Formula, compiled, formulas, vectors
from gaussmap.symbolic.notation import scalar, substitute
from gaussmap.symbolic.simplify import straight_line

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


# --- passes over straight-line code ---------------------------------------------------------------

x, y, z = (scalar(name) for name in "xyz")


def code(*outputs, terms=()) -> dict[str, str]:
    """Return the straight-line code of a formula in x, y, z as text."""
    formula = Formula.build("name", "", inputs=[x, y, z], terms=terms, outputs=outputs)
    return {symbol.name: str(value) for symbol, value in straight_line(formula).assignments}


def test_what_several_outputs_share_is_computed_once():
    assert code(("p", (x + y) * z), ("q", (x + y) ** 2)) == {
        "t0": "x + y",
        "p": "t0*z",
        "q": "t0**2",
    }


def test_a_temporary_stands_before_its_first_use():
    names = list(code(("p", x * z), ("q", (x + y) * z), ("r", (x + y) * x)))
    assert names == ["p", "t0", "q", "r"]


def test_a_sign_gets_no_name():
    result = code(("p", sp.sin(-x)), ("q", sp.cos(y) * -x), ("r", -x))
    assert not [name for name in result if name.startswith("t")]


@pytest.mark.parametrize("formula", formulas.values(), ids=formulas)
def test_no_temporary_is_used_once(formula):
    named = {symbol for symbol, _ in formula.in_components().definitions}
    assignments = straight_line(formula).assignments
    uses = Counter(
        node for _, value in assignments for node in sp.preorder_traversal(value) if node.is_Symbol
    )
    assert all(uses[symbol] > 1 for symbol, _ in assignments if symbol not in named)


def test_named_terms_stay_even_if_used_once():
    assert code(("p", 2 * scalar("r")), terms=[("r", x + y)]) == {"r": "x + y", "p": "2*r"}


def test_temporaries_avoid_the_names_of_the_formula():
    t0 = scalar("t0")
    formula = Formula.build(
        "name", "", inputs=[t0, y], outputs=[("p", (t0 + y) * y), ("q", (t0 + y) * t0)]
    )
    assert [symbol.name for symbol, _ in straight_line(formula).assignments] == ["t1", "p", "q"]


@pytest.mark.parametrize("formula", formulas.values(), ids=formulas)
def test_the_code_computes_the_formula(formula):
    """Write all temporaries back: what is left is the definition, up to the order of terms."""
    values = {}
    definitions = dict(formula.in_components().definitions)
    for symbol, value in straight_line(formula).assignments:
        if symbol in definitions:
            assert sp.expand(substitute(value, values) - definitions[symbol]) == 0
        else:
            values[symbol] = substitute(value, values)


@pytest.mark.parametrize("formula", formulas.values(), ids=formulas)
def test_no_formula_gets_longer_but_by_the_reciprocal_it_names(formula):
    result = straight_line(formula)
    assert result.operations_after <= result.operations_before + 1
