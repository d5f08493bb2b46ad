"""What `import gaussmap` promises: every public name, and nothing heavy."""

import subprocess
import sys

import gaussmap as gm
import pytest


def test_every_public_name_exists() -> None:
    for name in gm.__all__:
        assert getattr(gm, name) is not None


def test_import_loads_neither_sympy_nor_matplotlib() -> None:
    heavy = "('sympy', 'matplotlib', 'meshio', 'pyvista', 'tqdm')"
    code = f"import sys, gaussmap; print([x for x in {heavy} if x in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
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
