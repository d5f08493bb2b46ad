"""`gaussmap mesh`."""

import re

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
    assert err == ""
    mesh = pytest.importorskip("pyvista").read(f"torus.{suffix}")
    assert mesh.n_cells == int(found[2]) == 2 * int(found[1])


def test_samples_that_are_left_out_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    mesh = gm.sample("wavy_graph", 300, cells=(16, 16)).mesh()
    own = mesh.sample_index[mesh.sample_index >= 0]
    assert len(np.unique(own)) + mesh.left_out == 300
    assert mesh.left_out > 0
    few = ["--count", "300", "--cells", "16", "16"]
    assert main(["mesh", "wavy_graph", *few, "-o", "graph.ply"]) == 0
    assert f", {mesh.left_out} of the samples left out, " in capsys.readouterr().out
