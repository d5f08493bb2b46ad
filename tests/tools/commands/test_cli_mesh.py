"""`gaussmap mesh`."""

from __future__ import annotations

import re
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.commands.cli import main

FEW = ["--count", "100", "--cells", "8", "8"]


@pytest.mark.parametrize("suffix", ["ply", "obj", "stl", "vtu", "vtp"])
def test_a_mesh_is_written(suffix: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mesh", "torus", *FEW, "-o", f"torus.{suffix}"]) == 0
    out, err = capsys.readouterr()
    pattern = rf"torus\.{suffix}: (\d+) vertices, (\d+) triangles, closed; 95 % have .*\n"
    found = re.fullmatch(pattern, out)
    assert found is not None
    assert err == ""
    mesh = pytest.importorskip("pyvista").read(f"torus.{suffix}")
    assert mesh.n_cells == int(found[2]) == 2 * int(found[1])


@pytest.mark.compiled
def test_samples_that_are_left_out_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    mesh = gm.sample("wavy_graph", 300, cells=(16, 16)).mesh()
    own = mesh.sample_index[mesh.sample_index >= 0]
    assert len(np.unique(own)) + mesh.left_out == 300
    assert mesh.left_out > 0
    few = ["--count", "300", "--cells", "16", "16"]
    assert main(["mesh", "wavy_graph", *few, "-o", "graph.ply"]) == 0
    assert f", {mesh.left_out} of the samples left out, " in capsys.readouterr().out


def test_a_missing_library_is_told_at_once(monkeypatch, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["mesh", "torus", "-o", "torus.glb"]) == 2
    assert 'run: pip install "gaussmap[trimesh]"' in capsys.readouterr().err


def test_normals_of_a_part(capsys: pytest.CaptureFixture[str]) -> None:
    normals = gm.icosphere(16)
    np.save("cap.npy", normals[normals[:, 2] > 0.9])
    part = ["mesh", "torus", "--normals", "cap.npy", "--cells", "8", "8", "-o", "cap.ply"]
    assert main([*part, "--deviation", "10"]) == 0
    out = capsys.readouterr().out
    worst = float(re.findall(r"([\d.]+)° \(worst\)", out)[0])
    assert worst <= 10.0
    assert "edges on the border" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["torus", "-o", "torus.npz"], "use one of .ply, .obj, .stl, .3mf, .vtu, .vtp, .glb"),
        (["torus", "-o", "no/torus.ply"], "create the folder first"),
        (["torus", *FEW, "--deviation", "0", "-o", "a.ply"], "angle must lie between 0 and 180"),
        (["torus", "--deviation", "wide", "-o", "torus.ply"], "it must be a number, not 'wide'"),
        (["torus", "--prefer", "size", "-o", "torus.ply"], "'size' is not one of"),
        (["torus", "--count", "3", "--cells", "8", "8", "-o", "a.ply"], "too few"),
        (["plane", *FEW, "--density", "gauss", "-o", "plane.ply"], "there are no samples"),
    ],
)
@pytest.mark.filterwarnings("ignore::gaussmap.GaussmapWarning")
def test_errors_are_lines(arguments, message, capsys):
    assert main(["mesh", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    (line,) = [x for x in err.splitlines() if "warning" not in x]
    assert line.startswith("gaussmap: error: ")
    assert message in line
    assert not list(Path().iterdir())
