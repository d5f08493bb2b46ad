"""Samples and meshes as objects of other libraries, which are not needed until then."""

import sys
from collections.abc import Callable
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused
from ...shapes import FIELDS
from ...shapes import square as mesh
from .made import columns_of
from .made import make as samples

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
