"""Formulas as code on double-doubles."""

import pytest
from gaussmap.symbolic import formulas
from gaussmap.symbolic.double_double import double_double_function


def test_operations_become_calls() -> None:
    lines = double_double_function(formulas["eliminated_forms"]).splitlines()
    assert lines[:3] == [
        "@jit",
        "def double_double_eliminated_forms(A, B, C, P, Q):",
        '    """As `eliminated_forms`, of double-doubles."""',
    ]
    assert [line.strip() for line in lines[3:]] == [
        "D = minus(times(A, C), times(B, B))",
        "U = minus(times(B, Q), times(C, P))",
        "V = minus(times(B, P), times(A, Q))",
        "W = minus(minus(D, U), V)",
        "return D, U, V, W",
    ]


def test_powers_of_two_are_exact_factors() -> None:
    assert "multiple(mu_sw_x, 4.0)" in double_double_function(formulas["triangle"])


@pytest.mark.parametrize("name", ["parameters", "edge_point"])
def test_other_operations_are_refused(name: str) -> None:
    with pytest.raises(NotImplementedError, match=r"double-doubles|power of two"):
        double_double_function(formulas[name])
