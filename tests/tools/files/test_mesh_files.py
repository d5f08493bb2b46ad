"""What stands in files of meshes, to the last bit."""

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.files.formats import MESH_SUFFIXES

from ...refusals import refused
from ...shapes import CORNERS, FIELDS, square
from ...shapes import square as mesh
from .made import columns_of, ply_by_trimesh
from .made import make as samples


def noise(count: int = 5000) -> gm.Mesh:
    """Vertices of all sizes, and triangles between any of them; the first one has no area."""
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    triangles = rng.integers(0, count, (2 * count, 3))
    triangles[0] = 7
    vertices = rng.normal(size=(count, 3)) * 10.0 ** rng.integers(-300, 30, (count, 1))
    vertices[0] = -0.0, 5e-324, 0.1
    return gm.Mesh(vertices, normals, rng.normal(size=(count, 2)), triangles, np.arange(count) - 1)


def rows(path: Path, first: str) -> np.ndarray:
    """Return the numbers of the lines of a text that begin with a word."""
    lines = [line.replace("/", " ").split() for line in path.read_text().splitlines()]
    return np.array([[float(x) for x in line[1:]] for line in lines if line[0] == first])


def test_obj_holds_every_bit(tmp_path):
    mesh = noise()
    mesh.write(tmp_path / "a.obj")
    assert rows(tmp_path / "a.obj", "v").tobytes() == mesh.vertices.tobytes()
    assert rows(tmp_path / "a.obj", "vn").tobytes() == mesh.normals.tobytes()
    corners = rows(tmp_path / "a.obj", "f")
    for number in range(3):  # of the point, the texture coordinates and the normal
        np.testing.assert_array_equal(corners[:, number::3], mesh.triangles + 1)
    assert rows(tmp_path / "a.obj", "vt").tobytes() == mesh.uv.tobytes()


def test_ply_holds_every_bit(tmp_path):
    mesh = noise()
    mesh.write(tmp_path / "a.ply")
    raw = ply_by_trimesh(tmp_path / "a.ply")
    expected = np.hstack([mesh.vertices, mesh.normals, mesh.uv])
    vertices = raw["vertex"]["data"]
    assert vertices.dtype.names == ("x", "y", "z", "nx", "ny", "nz", "u", "v")
    assert np.stack([vertices[x] for x in vertices.dtype.names], axis=1).tobytes() == (
        expected.tobytes()
    )
    np.testing.assert_array_equal(raw["face"]["data"]["vertex_indices"]["f1"], mesh.triangles)


def test_stl_has_the_normals_of_triangles(tmp_path):
    mesh = noise()
    mesh.write(tmp_path / "a.stl")
    content = (tmp_path / "a.stl").read_bytes()
    assert not content.startswith(b"solid")  # which would say that it is text
    assert int.from_bytes(content[80:84], "little") == len(mesh.triangles)
    floats = np.frombuffer(content[84:], [("f", "<f4", 12), ("attribute", "<u2")])["f"]
    corners = mesh.vertices[mesh.triangles]
    assert floats[:, 3:].tobytes() == corners.astype("<f4").tobytes()
    assert floats[0, :3].tolist() == [0, 0, 0]
    sizes = np.linalg.norm(floats[:, :3], axis=1)
    # Where squares of lengths do not underflow a normal has the length 1.
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    usual = np.abs(across).max(axis=1) > 1e-140
    assert usual.sum() > 100
    np.testing.assert_allclose(sizes[usual], 1, atol=1e-6)
    assert np.isfinite(floats[:, :3]).all()


@pytest.mark.parametrize("suffix", [".vtu", ".vtp"])
def test_vtk_reads_every_bit(tmp_path, suffix):
    pv = pytest.importorskip("pyvista")
    mesh = noise()
    mesh.write(tmp_path / f"a{suffix}")
    again = pv.read(tmp_path / f"a{suffix}")
    assert isinstance(again, pv.PolyData if suffix == ".vtp" else pv.UnstructuredGrid)
    assert np.asarray(again.points).tobytes() == mesh.vertices.tobytes()
    connectivity = again.regular_faces if suffix == ".vtp" else again.cells_dict[5]
    np.testing.assert_array_equal(connectivity, mesh.triangles)
    uv = {"uv": mesh.uv} if suffix == ".vtp" else {"u": mesh.uv[:, 0], "v": mesh.uv[:, 1]}
    expected = {"normals": mesh.normals, "sample_index": mesh.sample_index} | uv
    assert set(again.point_data.keys()) == set(expected)
    for name, array in expected.items():
        found = np.asarray(again.point_data[name])
        assert found.dtype == array.dtype
        assert found.tobytes() == array.tobytes()
    assert again.point_data.active_normals_name == "normals"


@pytest.mark.parametrize("suffix", [x for x in MESH_SUFFIXES if x != ".glb"])
def test_large_numbers_warn_of_nothing(tmp_path, suffix):
    mesh = noise(100)
    huge = gm.Mesh(mesh.vertices * 1e270, mesh.normals, mesh.uv, mesh.triangles, mesh.sample_index)
    huge.write(tmp_path / f"a{suffix}")
    assert (tmp_path / f"a{suffix}").stat().st_size > 5000


# --- files of meshes, read by other libraries -----------------------------------------------------

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


# --- objects of other libraries -------------------------------------------------------------------

DTYPES = pytest.mark.parametrize("dtype", [np.float64, np.float32])


@DTYPES
@pytest.mark.parametrize("fields", [FIELDS, ("points",)])
@pytest.mark.parametrize("count", [0, 12])
def test_pandas_has_copies_of_the_columns(count, fields, dtype):
    found = samples(count, dtype=dtype, fields=fields)
    frame = found.to_dataframe()
    columns = columns_of(found)
    assert list(frame) == list(columns)
    for name, column in columns.items():
        assert frame[name].dtype == column.dtype
        np.testing.assert_array_equal(frame[name], column)
        assert not np.shares_memory(frame[name].to_numpy(), column)


# How points of samples and their other arrays are read, and vertices, triangles and normals of
# meshes. Open3D is half a gigabyte, and not installed for development: see `make bench-peers`.
LIBRARIES: dict[str, tuple[Callable[..., Any], ...]] = {
    "pyvista": (
        lambda x: x.points, lambda x, name: x.point_data[name],
        lambda x: (x.points, x.regular_faces, x.point_data["normals"]),
        lambda x, name: x.point_data[name],
    ),
    "trimesh": (
        lambda x: x.vertices, lambda x, name: x.metadata[name],
        lambda x: (x.vertices, x.faces, x.vertex_normals),
        lambda x, name: x.vertex_attributes[name],
    ),
}  # fmt: skip


@DTYPES
@pytest.mark.parametrize("library", LIBRARIES)
def test_samples(library, dtype):
    pytest.importorskip(library)
    points, data, *_ = LIBRARIES[library]
    found = samples(dtype=dtype)
    cloud = getattr(found, f"to_{library}")()
    np.testing.assert_array_equal(points(cloud), found.points)
    for name in FIELDS[1:]:
        np.testing.assert_array_equal(data(cloud, name), getattr(found, name))


@pytest.mark.parametrize("library", LIBRARIES)
def test_mesh(library):
    pytest.importorskip(library)
    _, _, parts, data = LIBRARIES[library]
    ours = mesh()
    theirs = getattr(ours, f"to_{library}")()
    vertices, triangles, normals = parts(theirs)
    np.testing.assert_array_equal(vertices, ours.vertices)
    np.testing.assert_array_equal(triangles, ours.triangles)
    atol = 1e-15 if library == "trimesh" else 0.0
    np.testing.assert_allclose(normals, ours.normals, rtol=0, atol=atol)
    for name in ("uv", "sample_index"):
        np.testing.assert_array_equal(data(theirs, name), getattr(ours, name))


def test_pyvista_has_copies():
    pytest.importorskip("pyvista")
    found, surface = samples(), mesh()
    assert samples(0).to_pyvista().n_points == 0
    found.to_pyvista().points.fill(100.0)
    found.to_pyvista().point_data["uv"].fill(100.0)
    surface.to_pyvista().points.fill(100.0)
    assert not any((x == 100.0).any() for x in (found.points, found.uv, surface.vertices))


@pytest.mark.parametrize(
    ("library", "extra", "convert"),
    [
        ("pandas", "pandas", lambda: samples().to_dataframe()),
        ("pyvista", "vtk", lambda: samples().to_pyvista()),
        ("pyvista", "vtk", lambda: mesh().to_pyvista()),
        ("trimesh", "trimesh", lambda: samples().to_trimesh()),
        ("trimesh", "trimesh", lambda: mesh().to_trimesh()),
    ],
)
def test_a_library_that_is_not_installed(library, extra, convert, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    message = rf'^this needs {library}, but it is not installed; run: .* "gaussmap\[{extra}\]"$'
    refused(message, convert, error=gm.errors.MissingExtraError)


@pytest.mark.parametrize("convert", ["to_pyvista", "to_trimesh"])
def test_points_are_needed(convert):
    with pytest.raises(gm.errors.MissingFieldError, match="add 'points' to the fields"):
        getattr(samples(fields=("uv",)), convert)()
