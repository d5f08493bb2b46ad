"""Deriving the formulas and writing generated/, each in a fresh interpreter."""

from __future__ import annotations

DERIVE = "from gaussmap.symbolic.__main__ import main"
EMIT = f"import sys, pathlib\n{DERIVE}\nsys.exit(main([], pathlib.Path(sys.argv[1])))"


def test_derive(compare, run):
    compare(run("-c", DERIVE), baselines={"import_sympy": run("-c", "import sympy")}, rounds=3)


def test_emit(compare, run, tmp_path):
    emit = run("-c", EMIT, str(tmp_path / "generated"))
    compare(emit, baselines={"derive": run("-c", DERIVE)}, rounds=1, warm=False)
    assert (tmp_path / "generated" / "patch.py").exists()
