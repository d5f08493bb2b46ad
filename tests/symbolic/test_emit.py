"""What is emitted computes the formulas, exactly; generated/ is up to date."""

import ast
import math
import os
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator
from fractions import Fraction
from itertools import islice
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from gaussmap.generated import vectors
from gaussmap.symbolic import emit, files, formulas, loops, support, surfaces
from gaussmap.symbolic.__main__ import main
from gaussmap.symbolic.formula import Formula
from gaussmap.symbolic.notation import VectorSymbol, scalar
from gaussmap.symbolic.positions import position
from gaussmap.symbolic.printer import operations, source_of

from .calls import flat, grouped

LOOPS = "support_function.py"
PYTHON_FILES = sorted(path.name for path in files.GENERATED.glob("*.py"))
POSITIONS = {name: position(surface) for name, surface in surfaces.CATALOGUE.items()}


# --- running source on long numbers ---------------------------------------------------------------

DIGITS = 60


class ExactLiterals(ast.NodeTransformer):
    """Turn float literals into fractions, and take off decorators."""

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        if not isinstance(node.value, float):
            return node
        exact = ast.parse(f"Number({str(Fraction(node.value))!r})", mode="eval").body
        for part in ast.walk(exact):
            ast.copy_location(part, node)
        return exact

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.decorator_list = []
        return self.generic_visit(node)


TYPES = {name: getattr(vectors, name) for name, _ in emit.KINDS.values()}
TYPES |= {x.__name__: x for x in (vectors.Arc, vectors.Hessian, vectors.Patch)}
LONG = {"Number": lambda x: mp.mpmathify(Fraction(x)), "math": mp, **TYPES}


def function_of(file: str, name: str, names: dict[str, Any]) -> Any:
    """Return a function of generated/ with exact literals; `make coverage` sees its lines run."""
    path = files.GENERATED / file
    tree = ast.parse(path.read_text(encoding="utf-8"))
    tree.body = [x for x in tree.body if isinstance(x, ast.FunctionDef) and x.name == name]
    namespace = {**names, "__name__": f"gaussmap.generated.{path.stem}"}
    exec(compile(ExactLiterals().visit(tree), path, "exec"), namespace)
    return namespace[name]


def inputs_of(formula, seed: int) -> dict[str, Any]:
    """Return random numbers for the inputs of a formula."""
    generator = random.Random(seed)
    return {
        x.name: mp.mpf(2 * generator.randint(-40, 40) + 1) / (2 * generator.randint(1, 15))
        for x in formula.in_components().inputs
    }


def expected(formula, inputs: dict[str, Any]) -> list[Any]:
    """Evaluate the undecomposed expressions of the outputs in SymPy."""
    plain = formula.in_components().inputs
    numbers = {x: sp.Float(str(inputs[x.name]), DIGITS) for x in plain}
    values = [sp.N(x.xreplace(numbers), DIGITS) for x in formula.expanded().values()]
    return [mp.mpmathify(x) for x in values]


def are_same(found: list[Any], wanted: list[Any]) -> bool:
    pairs = zip(found, wanted, strict=True)
    return all(abs(x - y) <= mp.mpf(10) ** -40 * (1 + abs(y)) for x, y in pairs)


def real_cases(formula) -> Iterator[tuple[dict[str, Any], list[Any]]]:
    """Yield inputs for which all roots are real, and the outputs."""
    for seed in range(200):
        inputs = inputs_of(formula, seed)
        values = expected(formula, inputs)
        if not any(isinstance(x, mp.mpc) for x in values):
            yield inputs, values


def emitted_functions() -> list[Any]:
    """Return the functions in generated/ that are formulas: file and name."""
    cases = []
    for file in PYTHON_FILES:
        text = (files.GENERATED / file).read_text(encoding="utf-8")
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef) and node.name in formulas and file != LOOPS:
                cases.append(pytest.param(file, node.name, id=f"{file}:{node.name}"))
    return cases


@pytest.mark.kernels
@pytest.mark.parametrize(("file", "name"), emitted_functions())
def test_generated_functions_are_exact(file, name):
    formula = formulas[name]
    function = function_of(file, name, LONG)
    with mp.workdps(DIGITS):
        cases = [*islice(real_cases(formula), 2)]
        assert len(cases) == 2
        for inputs, values in cases:
            assert are_same(flat(function(**grouped(formula, inputs))), values)


def filled(formula, function, inputs: list[dict[str, Any]], over) -> list[list[Any]]:
    """Run a loop over these inputs, and return its outputs, a list for each row."""
    rows = [grouped(formula, x) for x in inputs]
    arguments = emit.arguments(formula)
    given = [rows[0][x] for x, symbols in arguments.items() if not {*symbols} <= {*over}]
    looped = [
        np.array([flat(row[x]) if len(flat(row[x])) > 1 else row[x] for row in rows], dtype=object)
        for x, symbols in arguments.items()
        if {*symbols} <= {*over}
    ]
    outputs = []
    for group, symbols in emit.grouped(formula.outputs):
        shape = (3, 3) if group else (3,) if isinstance(symbols[0], VectorSymbol) else ()
        outputs.append(np.empty((len(rows), *shape), dtype=object))
    function(*given, *looped, *outputs)
    entries = np.triu_indices(3)
    order = [0, 3, 5, 1, 2, 4]  # xx, yy, zz, xy, xz, yz
    columns = [
        x[(slice(None), *entries)][:, order] if x.ndim == 3 else x.reshape(len(rows), -1)
        for x in outputs
    ]
    return np.concatenate(columns, axis=1).tolist()


@pytest.mark.kernels
@pytest.mark.parametrize("formula", support.LOOPS, ids=lambda x: x.name)
def test_loops_over_normals_are_exact(formula):
    """One patch, and five rows of what the loop is over."""
    over = support.LOOPS[formula]
    function = function_of("support_function.py", formula.name, LONG)
    looped = {x.name for symbol in over for x in getattr(symbol, "components", (symbol,))}
    with mp.workdps(DIGITS):
        first = inputs_of(formula, 0)
        inputs = [
            first | {x: y for x, y in inputs_of(formula, seed).items() if x in looped}
            for seed in range(5)
        ]
        for row, x in zip(filled(formula, function, inputs, over), inputs, strict=True):
            assert are_same(row, expected(formula, x))


@pytest.mark.kernels
@pytest.mark.parametrize("surface", surfaces.CATALOGUE.values(), ids=surfaces.CATALOGUE)
def test_loops_of_surfaces_are_exact(surface):
    """Run on symbols, with the functions of SymPy in the place of those of `math`."""
    formula = POSITIONS[surface.name]
    function = function_of("surfaces.py", surface.name, {"Number": sp.Rational, "math": sp})
    inputs = {symbol.name: symbol for symbol in formula.inputs}
    (row,) = filled(formula, function, [inputs], (surface.u, surface.v))
    for found, value in zip(row, formula.expanded().values(), strict=True):
        assert sp.expand(found - value) == 0 or sp.simplify(found - value) == 0


def test_a_loop_does_not_share_its_names_with_the_formula():
    row = Formula.build("f", "", inputs=[scalar("a")], outputs=[("row", 2 * scalar("a"))])
    with pytest.raises(ValueError, match=r"f and its loop both name \['row'\]"):
        loops.array_function(row, row.inputs)


# --- the source -----------------------------------------------------------------------------------


@pytest.mark.parametrize("file", PYTHON_FILES)
def test_generated_files_import_math_numpy_numba_and_one_another(file):
    tree = ast.parse((files.GENERATED / file).read_text(encoding="utf-8"))
    siblings = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert set(siblings) <= {"typing", "vectors"}
    imported = [
        x.name for node in ast.walk(tree) if isinstance(node, ast.Import) for x in node.names
    ]
    assert set(imported) <= {"math", "numba", "numpy"}


def test_functions_show_formula_source_and_counts():
    source = emit.function(formulas["parameters"])
    assert source == (
        "@inline\n"
        "def parameters(D, U, V):\n"
        '    """The parameters at which the patch has the normal n.\n'
        "\n"
        "        r = 1/D\n"
        "        u = U*r\n"
        "        v = V*r\n"
        "\n"
        "    Source: eq. (9); 3 operations as written, 3 here.\n"
        '    """\n'
        "    r = 1.0 / D\n"
        "    u = U * r\n"
        "    v = V * r\n"
        "    return u, v"
    )


# --- templates ------------------------------------------------------------------------------------


@pytest.fixture
def template(tmp_path, monkeypatch):
    monkeypatch.setattr(emit, "TEMPLATES", tmp_path)
    (tmp_path / "loop.py.in").write_text("for k in range(3):\n    {{body}}\n{{end}}\n")
    return "loop.py"


@pytest.mark.parametrize(
    ("values", "keys"),
    [({"body": "x"}, r"\['end'\]"), ({"body": "", "end": "", "more": ""}, r"\['more'\]"),
     ({"bod": "", "end": ""}, r"\['bod', 'body'\]")],
)  # fmt: skip
def test_keys_have_to_match(template, values, keys):
    with pytest.raises(ValueError, match=f"loop.py and its values differ in {keys}"):
        emit.render(template, values)


# --- the files ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def derived():
    return files.derive()


@pytest.fixture
def copy(tmp_path, derived, monkeypatch):
    """Return a copy of generated/ to compare with; the derivation is not repeated each time."""
    monkeypatch.setattr("gaussmap.symbolic.__main__.derive", lambda: derived)
    return shutil.copytree(files.GENERATED, tmp_path / "generated")


@pytest.mark.slow
def test_writing_into_a_new_folder(copy):
    assert main([], copy.parent / "new" / "folder") == 0
    assert files.existing(copy.parent / "new" / "folder") == files.existing(copy)


def test_an_installed_package_keeps_its_kernels(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("gaussmap.symbolic.__main__.PROJECT", tmp_path / "pyproject.toml")
    for arguments in ([], ["--check"]):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 2
        assert "clone the repository, and run `make generate`" in capsys.readouterr().err


@pytest.mark.slow
def test_check_shows_what_differs(copy, capsys):
    text = (copy / "patch.py").read_text(encoding="utf-8")
    (copy / "patch.py").write_text(text.replace("A * C - B * B", "A * C"), encoding="utf-8")
    (copy / "spline.py").unlink()
    (copy / "orphan.py").write_text("pass\n", encoding="utf-8")
    before = files.existing(copy)
    assert main(["--check"], copy) == 1
    out, err = capsys.readouterr()
    assert "--- generated/patch.py\n+++ derived/patch.py\n" in out
    assert "-    D = A * C\n+    D = A * C - B * B\n" in out
    assert "--- generated/orphan.py\n+++ derived/orphan.py\n@@ -1 +0,0 @@\n-pass\n" in out
    assert "+++ derived/spline.py\n@@ -0,0 +1," in out
    assert "derived/vectors.py" not in out
    assert "stale" in err
    assert files.existing(copy) == before


@pytest.mark.slow
def test_writing_removes_orphans_only(copy):
    (copy / "orphan.py").write_text("pass\n", encoding="utf-8")
    (copy / "folder").mkdir()
    assert main([], copy) == 0
    assert files.existing(copy) == files.existing(files.GENERATED)
    assert (copy / "folder").exists()


@pytest.mark.slow
def test_the_command_checks_the_committed_files():
    """Three interpreters with different seeds of the hash: each derives the committed bytes."""
    runs = [
        subprocess.Popen(
            [sys.executable, "-m", "gaussmap.symbolic", "--check"],
            env=os.environ | {"PYTHONHASHSEED": seed},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        for seed in ("0", "1", "2")
    ]
    assert [(run.communicate()[0], run.returncode) for run in runs] == [("", 0)] * 3


# --- expressions as source for kernels ------------------------------------------------------------

x, y, z = sp.symbols("x y z", real=True)


@pytest.mark.parametrize(
    ("expression", "source"),
    [
        (x + y, "x + y"), (y - x, "y - x"), (-x - y, "-x - y"), (x * z - y**2, "x * z - y * y"),
        (-x * z + y * z, "y * z - x * z"), (x**3, "x * x * x"), (x**2 * y / z, "x * x * y / z"),
        (1 / x, "1.0 / x"), (1 / x**2, "1.0 / (x * x)"), (2 / x, "2 / x"),
        (x / (y * z**2), "x / (y * z * z)"), (x / (y + z), "x / (y + z)"),
        (1 / (y + z), "1.0 / (y + z)"), (x * (y + z), "x * (y + z)"),
        (-x * (y - z), "-x * (y - z)"), (x / 2, "0.5 * x"), (-3 * x / 8, "-0.375 * x"),
        (2 * x / 3, "(2.0 / 3.0) * x"), (y - x / 3, "y - (1.0 / 3.0) * x"), (2 * x, "2 * x"),
        (sp.Integer(7), "7"), (sp.Rational(1, 4), "0.25"),
        (x + sp.Rational(1, 3), "x + (1.0 / 3.0)"), (sp.sqrt(x), "math.sqrt(x)"),
        (sp.sqrt(x + y), "math.sqrt(x + y)"), (1 / sp.sqrt(x), "1.0 / math.sqrt(x)"),
        (y / sp.sqrt(x), "y / math.sqrt(x)"), (sp.sqrt(x) ** 3, "x * math.sqrt(x)"),
        ((x + y) ** 2, "(x + y) * (x + y)"),
        (sp.sin(x) * sp.cosh(y), "math.sin(x) * math.cosh(y)"), (2 * sp.pi, "2 * math.pi"),
        (x**y, "math.pow(x, y)"), (x ** sp.Rational(1, 4), "math.pow(x, 0.25)"),
        (x ** sp.Rational(-3, 4), "1.0 / math.pow(x, 0.75)"),
        (x ** sp.Rational(1, 3), "math.pow(x, (1.0 / 3.0))"), (2**x, "math.pow(2, x)"),
        (y / x**z, "math.pow(x, -z) * y"),
    ],
)  # fmt: skip
def test_source(expression, source):
    printed = source_of(expression)
    assert printed == source
    values = {"x": 1.75, "y": 0.625, "z": -2.5}
    evaluated = eval(printed, {"math": math}, values)
    exact = expression.subs({sp.Symbol(k, real=True): sp.Rational(v) for k, v in values.items()})
    assert evaluated == pytest.approx(float(exact), rel=1e-15)


def test_integers_stay_integers():
    """Kernels run on Python integers too, to decide signs exactly."""
    big = 10**30
    assert eval(source_of(2 * x - 3 * y**2), {}, {"x": big, "y": big}) == 2 * big - 3 * big**2


def test_integers_beyond_64_bits_are_floats():
    assert source_of(x * 2**63) == "9223372036854775808.0 * x"
    assert source_of(-(2**63) + x * 0) == "-9223372036854775808"


def test_functions_that_math_does_not_have_are_refused():
    with pytest.raises(NotImplementedError):
        source_of(sp.besselj(0, x))


@pytest.mark.parametrize(
    ("expression", "count"),
    [(x, 0), (x + y, 1), (x - y, 1), (-x, 1), (-2 * x, 1), (x * y * z, 2), (x / y, 1), (1 / x, 1),
     (x**2, 1), (x**5, 4), (1 / x**3, 3), (sp.sqrt(x), 1), (1 / sp.sqrt(x), 2), (sp.sin(x * y), 2),
     (2 * x / 3, 1), (x / 2, 1), (x / 3 + y / 6, 3), (2 * sp.pi * x, 1), (2 * sp.pi, 0)],
)  # fmt: skip
def test_operations(expression, count):
    assert operations([expression]) == count
    assert operations([expression, expression]) == 2 * count
