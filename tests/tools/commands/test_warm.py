"""`gaussmap warm`: afterwards neither what people do every day nor the README compiles anything."""

import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
import numpy as np
import pytest
from gaussmap.tools.commands import warm
from gaussmap.tools.commands.cli import main

README_TESTS = Path(__file__).parents[2] / "test_readme.py"
EVERY_DAY = [
    ["sample", "torus", "--count", "1000", "-o", "a.ply"],
    ["sample", "torus", "--count", "1000", "--float32", "-o", "a.csv"],
    ["sample", "ellipsoid", "--frequency", "8", "--density", "gauss", "-o", "a.npz"],
    ["sample", "wavy_graph", "--random", "500", "--fields", "points,normals", "-o", "a.ply"],
    ["sample", "heights.npy", "--spacing", "30", "30", "--angle", "5", "-o", "a.npz"],
    ["sample", "cylinder", "--coverage", "0.2", "--density", "uniform", "-o", "a.npz"],
    ["sample", "monkey_saddle", "--count", "500", "--progressive", "-o", "a.npz"],
    ["mesh", "sphere", "--count", "1000", "-o", "a.stl"],
    ["sample", "part.npz", "--count", "500", "-o", "a.ply"],
]


def ran(module: str, *arguments: str, folder: Path) -> str:
    """Run a module in a folder, with the kernels that are compiled there; return what it prints."""
    done = subprocess.run(
        [sys.executable, "-m", module, *arguments],
        cwd=folder, capture_output=True, text=True, check=False,
        env={**os.environ, "NUMBA_CACHE_DIR": str(folder / "cache"), "GAUSSMAP_KERNELS": "0"},
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    return done.stdout


def compiled(folder: Path) -> set[str]:
    """Return what has been compiled: a file for each kernel and the types of its arguments."""
    return {path.name for path in (folder / "cache").glob("kernels-*/*.kernel")}


@pytest.mark.slow
@pytest.mark.compiled
def test_nothing_is_left_to_compile(tmp_path: Path, parts: ModuleType) -> None:
    np.save(tmp_path / "heights.npy", np.hypot(*np.mgrid[-1:1:20j, -1:1:30j]) ** 3)
    parts.all_kinds().save(tmp_path / "part.npz")
    line = ran("gaussmap", "warm", folder=tmp_path)
    assert re.match(r"\d+ kernels compiled in \d+ s, into ", line)
    assert f"into {tmp_path / 'cache' / 'kernels-'}" in line
    ahead = compiled(tmp_path)
    assert len(ahead) > 30
    assert ran("gaussmap", "warm", folder=tmp_path) == "all kernels were compiled already\n"
    assert ran("gaussmap", "warm", "--quiet", folder=tmp_path) == ""
    for command in EVERY_DAY:
        assert ran("gaussmap", *command, folder=tmp_path).startswith("a.")
    ran("pytest", "-q", "-k", "python or command_line", str(README_TESTS), folder=tmp_path)
    assert compiled(tmp_path) == ahead


def test_nothing_can_be_compiled(capsys, monkeypatch):
    monkeypatch.setattr(warm.config, "DISABLE_JIT", 1)
    assert main(["warm"]) == 2
    assert "NUMBA_DISABLE_JIT is set" in capsys.readouterr().err


def test_a_folder_that_cannot_be_written(capsys, monkeypatch):
    monkeypatch.setattr(warm.config, "DISABLE_JIT", 0)
    monkeypatch.setattr(warm, "kept_folder", lambda: None)
    assert main(["warm"]) == 2
    assert "set NUMBA_CACHE_DIR" in capsys.readouterr().err


@pytest.mark.compiled
def test_what_is_compiled_is_counted(capsys, monkeypatch):
    """One compilation of a kernel whose machine code nobody has, for the types on the list."""
    kernel: Any = numba.njit(lambda array: array.size)
    monkeypatch.setattr(warm.signatures, "read", lambda: {"kernel": [["float64 1 C"]]})
    monkeypatch.setattr(warm, "kernel_named", lambda name: kernel)
    assert main(["warm"]) == 0
    out = capsys.readouterr().out
    assert re.fullmatch(rf"1 kernel compiled in \d+ s, into {warm.kept_folder()}\n", out)
    assert [str(x) for x in kernel.nopython_signatures] == [
        "(Array(float64, 1, 'C', False, aligned=True),) -> int64"
    ]
    assert main(["warm"]) == 0
    assert capsys.readouterr().out == "all kernels were compiled already\n"
    assert main(["warm", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
