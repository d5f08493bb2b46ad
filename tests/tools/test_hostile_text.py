"""Texts of users run nothing, and what cannot be computed is refused in one sentence."""

import os
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.symbolic import BezierTriangle
from hypothesis import given

from ..refusals import refused as sentence_of
from ..shapes import SQUARE
from ..texts import texts

CODE = "__import__('os').system('touch ran')"

RUNS = [
    CODE, f"u + {CODE}", f"Piecewise((u, {CODE} == 0))", "open('ran', 'w')",
    'exec(\'open("ran", "w")\')', "eval('1')", "exit()", "quit()", "breakpoint()", "print(u)",
    "show_config() + u", "save(u, v)", "fromfile(u)", "ImmutableMatrix(1, 1, print)",
    "Matrix(1, 1, print)", "Lambda(u, u)(print)", "Function('f')(u)", "Symbol('u')", "sympify('1')",
    "Symbol(name=u)", "'u'", "lambdify(u, u)", "u.__class__.__mro__", "sin.__globals__", "u[0]",
    "[u for u in (1, 2)]", "(lambda: u)()", "(u := 1)", "u if u else v", "f'{u}'",
    "sin(u, evaluate=False)", "sin(*(u, v))", "await u", "u; import os",
    "u\nimport os", "u # \x00", "\udc80",
]  # fmt: skip

TOO_LARGE = [
    "9**9**9", "2**(10**9)", "2**-(10**9)", "2.0**(2.0**(2.0**100))", "sqrt(2)**(10**9)",
    "(2*u)**(10**9)", "u**(10**9)", "((u**2000)**2000)**2000", "Pow(9, Pow(9, 9))",
    "root(u, 10**-9)", "exp(10**9*log(2))", "exp(10**9*log(2) + u)", "2**(10**9*log(3)/log(2))",
    "exp(exp(exp(exp(10))))", "floor(exp(exp(exp(10))))", "Max(exp(exp(exp(10))), 3)",
    "factorial(10**7)*u", "factorial(factorial(factorial(9)))", "binomial(10**8, 10**7)",
    "gamma(10**7)", "fibonacci(10**8)", "legendre(10**6, u)", "Sum(9**9**k, (k, 0, 9))",
    "Rational(1, 10**5000)", "1e999*u", "1" * 5000,
]  # fmt: skip

TOO_LONG = [
    "(" * 5000 + "u" + ")" * 5000, "sin(" * 2000 + "u" + ")" * 2000, "-" * 10_000 + "u",
    "~" * 10_000 + "u", "not " * 4000 + "u", "u" + "**u" * 5000, "u" + "+u" * 9000,
    "u" + "+u" * 10**6, "Sum(u, (k, 1, 10**9))",
    f"Min({', '.join(f'sin({k}*u)' for k in range(100))})",
    f"Max({', '.join(f'Max(u, cos({k}*u))' for k in range(9))})", "Sum(Min(u, k), (k, 1, 999))",
    "Sum(Sum(Sum(u*k*j*i, (k, 1, 999)), (j, 1, 999)), (i, 1, 999))",
]  # fmt: skip

WRONG_TYPES = [
    "sech(Pow(pi*2, 2 >= oo))", "sech(Pow(pi*2, 2 >= 1))", "acsch(2 < 3)",
    "atan2(E, 10**50) + (3 < 3)", "atan(Eq(atan2(10**50, tan(factorial2(tan(1)))), 99))",
]  # fmt: skip

NOT_COMPILED = [
    "harmonic(hermite(3, Mod(u, 2)))", "FallingFactorial(u, 100)**20", "Mod((u + 1)**2000, u)",
    "Integral(u, u)", "Derivative(u**2, u)", "O(u)", "Limit(u, u, 0)", "factorial(u)",
    "besselj(0, u)", "f(u)",
]  # fmt: skip

HOSTILE = [*RUNS, *TOO_LARGE, *TOO_LONG, *WRONG_TYPES, *NOT_COMPILED]


# A call raises InputError with one short line that can be printed.
refused = partial(sentence_of, r"\.$")


@pytest.fixture(autouse=True)
def nothing_runs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> Any:
    """Fail if a text calls what a text has no business to call, or leaves a file."""
    monkeypatch.chdir(tmp_path)
    calls: list[str] = []
    for module, name in ((os, "system"), (np, "show_config"), (np, "save")):
        monkeypatch.setattr(module, name, lambda *_, name=name, **__: calls.append(name))
    yield
    assert calls == []
    assert capfd.readouterr().out == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", HOSTILE, ids=lambda x: ascii(x[:30]))
def test_texts_of_surfaces_and_curves(text: str) -> None:
    refused(gm.Surface.from_sympy, ("u", "v", text), "uv", SQUARE)
    refused(gm.Surface.from_sympy, ("u", "v", "u*v"), "uv", ((0, text), (0, 1)))
    if text not in RUNS[::2] + HOSTILE[::9]:  # others are read by the same function
        return
    refused(gm.Surface.from_sympy, ("u", "v", "u*v"), ("u", text), SQUARE)
    refused(gm.Surface.from_sympy, text, "uv", SQUARE)
    refused(gm.curves.Curve.from_sympy, ("u", text), "u", (0, 1))
    refused(gm.curves.Curve.from_sympy, ("u", "u**2"), "u", (0, text))
    refused(gm.curves.Curve.from_sympy, ("u", "u**2"), text, (0, 1))


@pytest.mark.parametrize("text", [*RUNS, *HOSTILE[len(RUNS) :: 9]], ids=lambda x: ascii(x[:30]))
def test_texts_of_support_functions(text: str) -> None:
    normal = ("u", "v", "w")
    refused(gm.SupportFunction.from_sympy, text, normal)
    refused(gm.SupportFunction.from_sympy, "u", normal, domain=text)
    refused(gm.SupportFunction.from_sympy, "u", normal, domain=f"{text} > 0")
    refused(gm.SupportFunction.from_sympy, "u", ("u", "v", text))


@pytest.mark.parametrize("text", RUNS, ids=lambda x: ascii(x[:30]))
def test_texts_in_lists_and_arrays(text: str) -> None:
    """SymPy's own `sympify` looks into lists, and runs what stands there."""
    for entry in ([text], (text,), {text}, {text: 1}, np.array(text), np.array([text], object)):
        refused(gm.SupportFunction.from_sympy, entry)
        refused(gm.SupportFunction.from_sympy, "1", domain=entry)
        refused(gm.Surface.from_sympy, ("u", "v", entry), "uv", SQUARE)
        refused(gm.Surface.from_sympy, ("u", "v", "u"), "uv", ((0, entry), (0, 1)))


@pytest.mark.parametrize(
    "text", [*RUNS, *TOO_LARGE[::5], *TOO_LONG[::5]], ids=lambda x: ascii(x[:30])
)
def test_texts_of_control_points(text: str) -> None:
    with pytest.raises(ValueError, match=r"is not a coordinate|is not a real number"):
        BezierTriangle([[text] * 3] * 6)
    with pytest.raises(ValueError, match="is not a coordinate"):
        BezierTriangle([[[text]] * 3] * 6)


def test_symbols_of_users_are_no_code() -> None:
    u, code = sp.symbols("u"), sp.Symbol(CODE)
    surface = gm.Surface.from_sympy((u, code, u * code), (u, code), SQUARE)
    assert surface.evaluate(0.5, 0.25).tolist() == [0.5, 0.25, 0.125]
    refused(gm.SupportFunction.from_sympy, code)


def test_deep_expressions_are_refused() -> None:
    x, deep = sp.Symbol("n_x"), sp.Symbol("n_x")
    for _ in range(1000):
        deep = sp.sin(deep, evaluate=False)
    refused(gm.SupportFunction.from_sympy, deep)
    refused(gm.SupportFunction.from_sympy, "1", domain=sp.Gt(deep, 0, evaluate=False))
    refused(gm.curves.Curve.from_sympy, (x, deep), x, (0, 1))


def test_command_line_refuses_formulas_at_once() -> None:
    """In one sentence each, without warnings of SymPy; the time is that of the start, and ample."""
    texts = [*WRONG_TYPES, *NOT_COMPILED[:3]]
    lines = [["u", "v", text, "--domain", "0", "1"] for text in texts]
    lines += [["u", "v", "u*v", "--domain", "0", text] for text in texts]
    code = f"from gaussmap.tools.commands.cli import main\nfor line in {lines}:\n"
    code += "    assert main(['sample', '--formula', *line, '0', '1', '-o', 'x.npz']) == 2"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0
    errors = done.stderr.splitlines()
    assert len(errors) == len(lines)
    assert all(x.startswith("gaussmap: ") and len(x) <= 300 for x in errors)


@given(text=texts(12))
def test_a_random_text_gives_points_or_an_error_of_gaussmap(text: str) -> None:
    try:
        points = gm.Surface.from_sympy(("u", "v", text), "uv", SQUARE).evaluate(0.375, 0.625)
        message = ""
    except gm.GaussmapError as error:
        points, message = np.zeros(3), str(error)
    assert len(message) <= 300
    assert points.dtype == np.float64
    assert points.shape == (3,)
