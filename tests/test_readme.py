"""Every example of the README runs, and those of the guide with what else there is."""

import re
import shlex
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
MORE = (ROOT / "docs" / "guides" / "more.md").read_text(encoding="utf-8")


def blocks(language: str, page: str = README) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)


CELLS = blocks("{code-cell} ipython3", MORE)  # which `make docs` runs, too


def test_the_readme_is_short() -> None:
    assert len(README.splitlines()) <= 180
    assert len(blocks("python")) == 4
    assert len(CELLS) == 9


@pytest.mark.parametrize(
    "source", [*blocks("python"), *(pytest.param(x, marks=pytest.mark.slow) for x in CELLS)]
)
def test_python(source: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(source, "README.md", "exec"), {"__name__": "__main__"})


def test_command_line(tmp_path, monkeypatch, capsys, main):
    monkeypatch.chdir(tmp_path)
    x, y = np.meshgrid(np.linspace(-1, 1, 50), np.linspace(-1, 1, 40))
    np.save("heights.npy", 100 * np.exp(-3 * (x * x + y * y)))
    commands = [line for block in blocks("sh") for line in block.splitlines()]
    assert len(commands) >= 5
    for command in commands:
        program, *arguments = shlex.split(command)
        assert program == "gaussmap"
        code = main(arguments)
        printed = capsys.readouterr()
        assert code == 0, f"{command}: {printed.err}"
        assert printed.out.strip()
        if "-o" in arguments:
            assert Path(arguments[arguments.index("-o") + 1]).stat().st_size > 1000


def test_the_two_commands_are_targets() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for line in blocks("console")[0].splitlines():
        assert re.search(rf"^{line.removeprefix('make ')}:", makefile, re.MULTILINE)


def test_the_formula_is_that_of_the_patch() -> None:
    """The one in LaTeX, read by SymPy, against the derived one."""
    shown = re.match(r"h\(n\) = n \\cdot p - \\frac\{(.*)\}\{(.*)\}, .*\n", blocks("math")[0])
    definitions = gm.formulas["support_function"].definitions
    symbols = {str(symbol): symbol for symbol, _ in definitions}
    numerator, denominator = (
        sp.parse_expr(str(text).replace(r"\,", "*").replace("^", "**"), symbols)
        for text in shown.groups()
    )
    *earlier, (_, h) = definitions
    for symbol, value in reversed(earlier[5:]):  # D, U and V, in terms of A, …, Q
        h = h.subs(symbol, value)
    of_a_point = h.subs({symbols["P"]: 0, symbols["Q"]: 0})
    assert sp.simplify(h - of_a_point + numerator / denominator) == 0
