"""The methods of `Samples` that make objects of other libraries, imported when called."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.extras import from_extra
from ...runtime.samples.fields import columns_of
from .of_faces import columns_of_faces
from .of_terrain import columns_of_terrain

if TYPE_CHECKING:
    import pandas
    import pyvista
    import trimesh

    from ...runtime.samples.samples import Samples


def to_dataframe(self: Samples) -> pandas.DataFrame:
    """Return a table with one row for each sample and the columns of a `.csv` file.

    Returns
    -------
    pandas.DataFrame
        A copy, as with the other conversions.

    Raises
    ------
    MissingExtraError
        Without the extra `pandas`.

    Examples
    --------
    >>> import gaussmap as gm
    >>> table = gm.sample("torus", 200, cells=(16, 16)).to_dataframe()
    >>> len(table), list(table.columns)[:4]
    (200, ['x', 'y', 'z', 'nx'])

    """
    columns = columns_of(self.arrays()) | columns_of_terrain(self)
    pandas = from_extra("pandas", "pandas", "this")
    table = pandas.DataFrame({name: column.copy() for name, column in columns.items()})
    for x in columns_of_faces(self):
        table[x.name] = pandas.array(x.values, dtype=x.dtype)[self.face_index]
    return table


def to_pyvista(self: Samples) -> pyvista.PolyData:
    """Return the points with all other fields as point data.

    Returns
    -------
    pyvista.PolyData
        The points; their normals are the active normals.

    Raises
    ------
    MissingExtraError
        Without the extra `vtk`.
    MissingFieldError
        Unless the samples have the field points.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.sample("torus", 200, cells=(16, 16)).to_pyvista().n_points
    200

    """
    points, pv = self.points, from_extra("pyvista", "vtk", "this")
    arrays = {name: getattr(self, name) for name in self.fields if name != "points"}
    return polydata(pv, pv.PolyData(points.copy()), arrays)


def to_trimesh(self: Samples) -> trimesh.PointCloud:
    """Return the points in float64, with all other fields in `metadata`.

    Returns
    -------
    trimesh.PointCloud
        The points.

    Raises
    ------
    MissingExtraError
        Without the extra `trimesh`.
    MissingFieldError
        Unless the samples have the field points.

    Examples
    --------
    >>> import gaussmap as gm
    >>> cloud = gm.sample("torus", 200, cells=(16, 16)).to_trimesh()
    >>> cloud.vertices.shape, cloud.metadata["normals"].shape
    ((200, 3), (200, 3))

    """
    points = self.points.astype(np.float64)
    arrays = {name: getattr(self, name).copy() for name in self.fields if name != "points"}
    return from_extra("trimesh", "trimesh", "this").PointCloud(points, metadata=arrays)


def polydata(pv: Any, data: Any, arrays: dict[str, NDArray[Any]]) -> Any:  # noqa: ANN401
    """Attach arrays to the points of a PolyData, with the normals as active normals."""
    for name, array in arrays.items():
        # The array is added by VTK itself, since pyvista refuses arrays without elements.
        numbers = array.view(np.uint8) if array.dtype == np.bool_ else array
        data.GetPointData().AddArray(pv.convert_array(numbers, name=name, deep=True))
    if "normals" in arrays:
        data.GetPointData().SetActiveNormals("normals")
    return data
