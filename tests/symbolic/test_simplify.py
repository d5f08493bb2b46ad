"""Straight-line code: what the passes do."""

from collections import Counter

import pytest
import sympy as sp
from gaussmap.symbolic import Formula, formulas
from gaussmap.symbolic.notation import scalar, substitute
from gaussmap.symbolic.simplify import straight_line

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
