"""Tapes as steps: they compute the expressions, and say what they cannot."""

import math
from typing import Any

import pytest
import sympy as sp
from gaussmap.symbolic.tape import NoTapeError, tape_steps

u, v = sp.symbols("u v", real=True)


def values(steps: list[Any], known: dict[str, float]) -> list[float]:
    """Return the values of all steps, computed in Python."""
    results: list[float] = []
    for name, *arguments in steps:
        if name in "uv":
            results.append(known[name])
        elif name == "parameter":
            results.append(known[arguments[0]])
        elif name == "constant":
            results.append(arguments[0])
        elif name == "power":
            results.append(results[arguments[0]] ** (arguments[1] / 2))
        else:
            function = FUNCTIONS.get(name) or getattr(math, name)
            results.append(function(*(results[k] for k in arguments)))
    return results


FUNCTIONS = {
    "sinc": lambda x: math.sin(x) / x,
    "sign": lambda x: math.copysign(1.0, x),
    "sum": lambda x, y: x + y,
    "product": lambda x, y: x * y,
    "negative": lambda x: -x,
}


@pytest.mark.parametrize(
    "expression",
    [
        u**7, 1 / u**3, u ** sp.Rational(5, 2), u ** sp.Rational(-1, 2), u ** sp.Rational(1, 3),
        u**v, sp.Float(2.5) ** u, u ** sp.Float(0.5), sp.exp(u) - 2 * v, sp.tan(u), sp.cot(u),
        sp.sec(u), sp.csc(u), sp.coth(u), sp.sech(u), sp.csch(u), sp.acos(u), sp.acot(u),
        sp.asinh(u), sp.acosh(u + 2), sp.atanh(u), sp.log(u, 3), sp.sqrt(2) * u / sp.pi,
        sp.Integer(3),
        sp.erf(u) + sp.erfc(u * v), sp.sinc(u), sp.Abs(u) * sp.sign(v - 1),
    ],
)  # fmt: skip
def test_steps_compute_expressions(expression):
    steps, (row, _, _) = tape_steps((expression, u, v), u, v)
    found = values(steps, {"u": 0.7, "v": 0.3})[row]
    assert math.isclose(found, float(expression.subs({u: 0.7, v: 0.3})), rel_tol=1e-13)


@pytest.mark.parametrize(
    "expression",
    [
        sp.floor(u), sp.Mod(u, 2), sp.Max(u, v), sp.Heaviside(u),
        sp.Piecewise((u, u < v), (v, True)), sp.atan2(u, v), sp.I * u, sp.zoo, sp.nan,
        sp.Sum(sp.Symbol("k") * u, (sp.Symbol("k"), 0, 3)), u + sp.Symbol("unknown"),
    ],
)  # fmt: skip
def test_what_has_no_tape_is_refused(expression):
    with pytest.raises(NoTapeError):
        tape_steps((u, v, expression), u, v)


def test_what_is_shared_is_a_single_step():
    shared = sp.sin(u * v) + 1
    steps, outputs = tape_steps((shared, shared**2, sp.exp(shared) + shared), u, v)
    assert [name for name, *_ in steps].count("sin") == 1
    assert len(set(steps)) == len(steps)
    assert all(isinstance(row, int) for row in outputs)


def test_constants_are_nearest_numbers_with_their_distance():
    constants = {
        sp.Rational(1, 3): 1 / 3,
        sp.pi: math.pi,
        sp.Rational(3, 4): 0.75,
        sp.Float(0.1): 0.1,
        sp.sqrt(2): math.sqrt(2),
    }
    for exact, nearest in constants.items():
        steps, (row, _, _) = tape_steps((exact, u, v), u, v)
        name, value, distance = steps[row]
        true = sp.Rational(exact) if exact.is_Float else exact
        error = abs((true - sp.Rational(value)).evalf(40))
        assert (name, value) == ("constant", nearest)
        assert error <= distance <= error * 1.01 <= math.ulp(value)
