"""The methods of `Mesh` that write files or make objects of other libraries."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ...runtime.base.extras import from_extra
from .formats import write_mesh
from .of_samples import polydata

if TYPE_CHECKING:
    import pyvista
    import trimesh

    from ..meshes.mesh import Mesh


def write(self: Mesh, path: str | os.PathLike[str]) -> None:
    """Write the mesh to a file; its suffix, in any case, chooses the format.

    An existing file is replaced once the new one is complete; if anything fails, it stays as it
    was. The same mesh gives the same bytes.

    Parameters
    ----------
    path : str or os.PathLike
        Name of the file. The suffix is one of

        - `.ply`: binary; vertices with normals and u, v.
        - `.obj`: text in full precision; vertices with normals, and texture coordinates, see
          `Mesh.corner_uv`.
        - `.stl`: binary, float32; triangles alone.
        - `.3mf`: vertices and triangles, for 3-D printers, with the unit of length, or millimetres
          if it is unknown.
        - `.vtu`: VTK's unstructured grid with normals, u, v and `sample_index`; this and `.vtp`
          need the extra `vtk`.
        - `.vtp`: VTK's PolyData with normals, uv and `sample_index`.
        - `.glb`: binary glTF with normals, and u and v as the attribute `_UV`, float32; needs the
          extra `trimesh`. It is closed where the mesh is; but a vertex on a crease, such as a
          sharp edge of a CAD part, is repeated for each of its normals. Coordinates are unchanged,
          while viewers show y upwards.

    Raises
    ------
    UnknownNameError
        If the suffix is none of these.
    FileError
        If the file cannot be written.
    MissingExtraError
        For a `.glb` file without the extra `trimesh`, a file of VTK without `vtk`.
    InputError
        If the mesh has no triangles, more vertices than a `.ply` file can number, or larger
        coordinates than a `.glb` file can hold.

    Examples
    --------
    >>> import gaussmap as gm
    >>> from pathlib import Path
    >>> gm.sample("torus", 200, cells=(16, 16)).mesh().write("torus.stl")
    >>> Path("torus.stl").stat().st_size  # 84 + 50 · 400
    20084

    """
    write_mesh(self, path)


def to_pyvista(self: Mesh) -> pyvista.PolyData:
    """Return the mesh with normals, uv and sample_index as point data.

    Returns
    -------
    pyvista.PolyData
        A copy, as with the other conversions.

    Raises
    ------
    MissingExtraError
        Without the extra `vtk`.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.sample("torus", 200, cells=(16, 16)).mesh().to_pyvista().n_cells
    400

    """
    pv = from_extra("pyvista", "vtk", "this")
    data = pv.PolyData.from_regular_faces(self.vertices.copy(), self.triangles)
    arrays = {"normals": self.normals, "uv": self.uv, "sample_index": self.sample_index}
    return polydata(pv, data, arrays)


def to_trimesh(self: Mesh) -> trimesh.Trimesh:
    """Return the mesh with its normals, and uv and sample_index as vertex attributes.

    Returns
    -------
    trimesh.Trimesh
        The mesh.

    Raises
    ------
    MissingExtraError
        Without the extra `trimesh`.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.sample("torus", 200, cells=(16, 16)).mesh().to_trimesh().is_watertight
    True

    """
    return from_extra("trimesh", "trimesh", "this").Trimesh(
        self.vertices.copy(),
        self.triangles.copy(),
        vertex_normals=self.normals.copy(),
        vertex_attributes={"uv": self.uv.copy(), "sample_index": self.sample_index.copy()},
        process=False,
    )
