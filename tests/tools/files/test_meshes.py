"""The mesh as a file, read back by other libraries."""

import os
import sys
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.files.formats import MESH_SUFFIXES

from ...refusals import refused
from ...shapes import CORNERS, square

EACH = pytest.mark.parametrize("suffix", MESH_SUFFIXES)
NEEDED = {".vtu": "vtk", ".vtp": "vtk", ".glb": "trimesh"}


class TestFiles:
    @EACH
    def test_the_same_mesh_gives_the_same_bytes(self, tmp_path, suffix, capfd):
        for name in ("one", "other"):
            square().write(tmp_path / f"{name}{suffix}")
        one, other = ((tmp_path / f"{x}{suffix}").read_bytes() for x in ("one", "other"))
        assert one == other
        assert capfd.readouterr() == ("", "")

    @EACH
    def test_what_fails_leaves_the_older_file(self, tmp_path, suffix, monkeypatch):
        path = tmp_path / f"square{suffix}"
        path.write_text("older")

        def fail(*_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(os, "replace", fail)
        refused("cannot be written: No space left", square().write, path, error=gm.errors.FileError)
        assert path.read_text() == "older"
        assert os.listdir(tmp_path) == [path.name]

    def test_upper_case_and_paths(self, tmp_path):
        square().write(str(tmp_path / "A.STL"))
        assert (tmp_path / "A.STL").stat().st_size == 84 + 2 * 50

    @pytest.mark.parametrize("name", ["square", "square.npz", "square.xyz"])
    def test_unknown_suffixes(self, tmp_path, name):
        with pytest.raises(gm.errors.UnknownNameError, match=r"use one of \.ply, \.obj, \.stl"):
            square().write(tmp_path / name)

    def test_no_triangles(self, tmp_path):
        empty = square(triangles=np.empty((0, 3), dtype=np.int64))
        refused("has no triangles", empty.write, tmp_path / "square.ply")
        assert not list(Path(tmp_path).iterdir())

    def test_trimesh_reads_gltf_that_is_closed(self, tmp_path):
        """Vertices at seams and poles are there once, as in the mesh."""
        trimesh = pytest.importorskip("trimesh")
        mesh = gm.sample("torus", 200, cells=(16, 16)).mesh()
        mesh.write(tmp_path / "torus.glb")
        (again,) = trimesh.load_scene(tmp_path / "torus.glb", process=False).geometry.values()
        np.testing.assert_array_equal(again.vertices, mesh.vertices.astype(np.float32))
        np.testing.assert_array_equal(again.faces, mesh.triangles)
        np.testing.assert_allclose(again.vertex_normals, mesh.normals, atol=2e-7)
        uv = again.vertex_attributes["_UV"]
        np.testing.assert_array_equal(uv, mesh.uv.astype(np.float32))
        assert again.is_watertight

    def test_gltf_has_single_precision(self, tmp_path):
        huge = square(vertices=CORNERS * 1e39)
        refused("single precision, for which", huge.write, tmp_path / "a.glb")
        assert not list(Path(tmp_path).iterdir())

    @EACH
    def test_only_some_formats_need_another_library(self, tmp_path, suffix, monkeypatch):
        for library in ("pyvista", "vtkmodules", "trimesh", "meshio"):
            monkeypatch.setitem(sys.modules, library, None)
        path, error = tmp_path / f"square{suffix}", gm.errors.MissingExtraError
        if suffix in NEEDED:
            refused(rf"gaussmap\[{NEEDED[suffix]}\]", square().write, path, error=error)
            assert not list(Path(tmp_path).iterdir())
        else:
            square().write(path)
            assert path.stat().st_size > 84
