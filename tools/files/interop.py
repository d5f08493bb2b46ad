"""Samples and meshes as the objects of other libraries, each loaded when it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.extras import from_extra
from ...runtime.samples.fields import columns_of

if TYPE_CHECKING:
    import open3d  # pyright: ignore[reportMissingImports]
    import pandas
    import pyvista
    import trimesh

    from ...runtime.samples.arrays import SampleArrays
    from ..meshes.mesh import Mesh

__all__ = [
    "mesh_to_open3d",
    "mesh_to_pyvista",
    "mesh_to_trimesh",
    "samples_to_dataframe",
    "samples_to_open3d",
    "samples_to_pyvista",
    "samples_to_trimesh",
]


def samples_to_dataframe(samples: SampleArrays) -> pandas.DataFrame:
    """Return what `Samples.to_dataframe` returns."""
    columns = columns_of(samples.arrays())
    pandas = from_extra("pandas", "pandas", "this")
    return pandas.DataFrame({name: column.copy() for name, column in columns.items()})


def samples_to_pyvista(samples: SampleArrays) -> pyvista.PolyData:
    """Return what `Samples.to_pyvista` returns."""
    points, pv = samples.points, from_extra("pyvista", "vtk", "this")
    arrays = {name: getattr(samples, name) for name in samples.fields if name != "points"}
    return _polydata(pv, pv.PolyData(points.copy()), arrays)


def samples_to_trimesh(samples: SampleArrays) -> trimesh.PointCloud:
    """Return what `Samples.to_trimesh` returns."""
    points = samples.points.astype(np.float64)
    arrays = {name: getattr(samples, name).copy() for name in samples.fields if name != "points"}
    return from_extra("trimesh", "trimesh", "this").PointCloud(points, metadata=arrays)


def samples_to_open3d(samples: SampleArrays) -> open3d.geometry.PointCloud:
    """Return what `Samples.to_open3d` returns."""
    points, library = samples.points, from_extra("open3d", "open3d", "this")
    cloud = library.geometry.PointCloud(_vectors(library, points))
    if "normals" in samples.fields:
        cloud.normals = _vectors(library, samples.normals)
    return cloud


def mesh_to_pyvista(mesh: Mesh) -> pyvista.PolyData:
    """Return what `Mesh.to_pyvista` returns."""
    pv = from_extra("pyvista", "vtk", "this")
    data = pv.PolyData.from_regular_faces(mesh.vertices.copy(), mesh.triangles)
    arrays = {"normals": mesh.normals, "uv": mesh.uv, "sample_index": mesh.sample_index}
    return _polydata(pv, data, arrays)


def mesh_to_trimesh(mesh: Mesh) -> trimesh.Trimesh:
    """Return what `Mesh.to_trimesh` returns."""
    return from_extra("trimesh", "trimesh", "this").Trimesh(
        mesh.vertices.copy(),
        mesh.triangles.copy(),
        vertex_normals=mesh.normals.copy(),
        vertex_attributes={"uv": mesh.uv.copy(), "sample_index": mesh.sample_index.copy()},
        process=False,
    )


def mesh_to_open3d(mesh: Mesh) -> open3d.geometry.TriangleMesh:
    """Return what `Mesh.to_open3d` returns."""
    library = from_extra("open3d", "open3d", "this")
    triangles = library.utility.Vector3iVector(mesh.triangles.astype(np.int32))
    result = library.geometry.TriangleMesh(_vectors(library, mesh.vertices), triangles)
    result.vertex_normals = _vectors(library, mesh.normals)
    return result


def _polydata(pv: Any, data: Any, arrays: dict[str, NDArray[Any]]) -> Any:  # noqa: ANN401
    """Give points their arrays, with the normals as such."""
    for name, array in arrays.items():
        # By way of VTK: pyvista refuses arrays without elements.
        numbers = array.view(np.uint8) if array.dtype == np.bool_ else array
        data.GetPointData().AddArray(pv.convert_array(numbers, name=name, deep=True))
    if "normals" in arrays:
        data.GetPointData().SetActiveNormals("normals")
    return data


def _vectors(library: Any, rows: NDArray[Any]) -> Any:  # noqa: ANN401
    return library.utility.Vector3dVector(rows.astype(np.float64))
