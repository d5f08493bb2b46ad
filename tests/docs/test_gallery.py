"""The notebooks of docs/gallery/ run without an error, and are those of their scripts."""

import os
import subprocess
import sys

import nbformat
import pytest
from gaussmap.docs import notebooks

SCRIPTS = sorted(notebooks.GALLERY.glob("*.py"))
EACH = pytest.mark.parametrize("script", SCRIPTS, ids=lambda x: x.stem)
MOST = 150_000  # bytes of a notebook


def read(path):
    return nbformat.read(path, as_version=4)


def assert_shown(path):
    """Check that a notebook has a picture, and neither errors nor warnings."""
    outputs = [x for cell in read(path).cells for x in cell.get("outputs", ())]
    assert any("image/png" in x.get("data", {}) for x in outputs)
    assert not [x for x in outputs if x.output_type == "error" or x.get("name") == "stderr"]


def run(*arguments, folder):
    # In a process of its own: what Jupyter warns of is not for these tests.
    environment = os.environ | {"IPYTHONDIR": str(folder), "JUPYTER_CONFIG_DIR": str(folder)}
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def sources(cells):
    return [(cell.cell_type, cell.id, cell.source) for cell in cells.cells]


def test_there_are_six_tasks():
    names = {x.stem for x in SCRIPTS}
    assert names == {"cad", "inspection", "learning", "meshing", "registration", "teaching"}
    assert {x.stem for x in notebooks.GALLERY.glob("*.ipynb")} == names


@EACH
def test_committed_notebook_is_of_its_script_and_small(script):
    committed = script.with_suffix(".ipynb")
    assert sources(read(committed)) == sources(notebooks.notebook(script))
    assert committed.stat().st_size < MOST


@EACH
def test_committed_notebook_shows_what_it_does(script):
    assert_shown(script.with_suffix(".ipynb"))


@EACH
def test_notebook_runs(script, tmp_path):
    ended = run(notebooks.__file__, script.stem, "--to", str(tmp_path), folder=tmp_path)
    assert ended.returncode == 0, ended.stderr[-3000:]
    assert_shown(tmp_path / f"{script.stem}.ipynb")


def test_a_cell_that_fails_is_an_error(tmp_path):
    (tmp_path / "wrong.py").write_text("# %%\n1 / 0\n", encoding="utf-8")
    lines = [
        "from pathlib import Path",
        "from gaussmap.docs.notebooks import executed",
        "executed(Path('wrong.py'), Path())",
    ]
    ended = run("-c", "; ".join(lines), folder=tmp_path)
    assert ended.returncode != 0
    assert "ZeroDivisionError" in ended.stderr
