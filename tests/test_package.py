"""What `import gaussmap` promises: every public name, and nothing heavy."""

import ast
import subprocess
import sys
from pathlib import Path

import gaussmap as gm
import pytest


def test_every_public_name_exists() -> None:
    for name in gm.__all__:
        assert getattr(gm, name) is not None
        assert name in dir(gm)
    with pytest.raises(AttributeError, match="module 'gaussmap' has no attribute 'smaple'"):
        gm.smaple  # pyright: ignore[reportAttributeAccessIssue]  # noqa: B018


def test_names_are_where_type_checkers_look_for_them() -> None:
    """What is loaded on demand, and what the imports say that only type checkers read."""
    tree = ast.parse(Path(str(gm.__file__)).read_text(encoding="utf-8"))
    imports = {
        alias.name: node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.level == 1
        for alias in node.names
    }
    modules = {name: module.rpartition(".")[0] or None for name, module in gm._MODULES.items()}
    assert imports == gm._HOMES | modules
    assert sorted(imports) == gm.__all__


def test_import_loads_nothing_heavy() -> None:
    heavy = "('numba', 'numpy', 'sympy', 'matplotlib', 'pyvista', 'tqdm')"
    code = f"import sys, gaussmap; print([x for x in {heavy} if x in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_sampling_loads_neither_sympy_nor_matplotlib() -> None:
    heavy = "('sympy', 'matplotlib', 'pyvista', 'tqdm')"
    code = f"import sys; from gaussmap import *; print([x for x in {heavy} if x in sys.modules])"
    names = "SupportFunction, parabolic_points, read_samples, sample_stream, surfaces"
    done = subprocess.run(
        [sys.executable, "-c", code.replace("*", names)], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_formulas_by_name() -> None:
    assert gm.formulas["envelope"].source.startswith("eq")
    assert set(gm.formulas) >= {"forms", "support_function", "curvature", "triangle"}
    assert gm.formulas is gm.formulas


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nope", r"^there is no formula 'nope'\. See `gaussmap formulas` for all names\.$"),
        ("envelop", r"^there is no formula 'envelop'; did you mean envelope.*\? See `gaussmap "),
        (3, r"^there is no formula 3\."),
    ],
)
def test_a_formula_of_no_such_name(name: str, message: str) -> None:
    with pytest.raises(gm.UnknownNameError, match=message):
        gm.formulas[name]
    assert name not in gm.formulas
    assert gm.formulas.get(name) is None
    assert repr(gm.formulas) == f"Formulas({len(gm.formulas)} formulas)"
