"""Meshes to files, complete or not at all; see `io.atomic_path`."""

from __future__ import annotations

import io
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..io import atomic_path, known_suffix, write_polydata

if TYPE_CHECKING:
    from .mesh import Mesh

__all__ = ["MESH_SUFFIXES", "write_mesh"]

MESH_SUFFIXES = (".ply", ".obj", ".stl", ".vtk", ".vtu", ".vtp")
MOST_VERTICES = 2**31 - 1


def write_mesh(mesh: Mesh, path: str | os.PathLike[str]) -> None:
    """Write a mesh to a file; its suffix, in any case, chooses the format.

    An existing file is replaced once the new one is complete; if anything fails, it stays as it
    was. The same mesh gives the same bytes.

    - `.ply`: binary; vertices with normals and u, v.
    - `.obj`: text of 17 digits; vertices with normals.
    - `.stl`: binary, float32; triangles alone.
    - `.vtk`, `.vtu`: VTK's unstructured grid with normals, u, v and `sample`.
    - `.vtp`: VTK's PolyData with the same arrays; needs the extra `vtk`.

    Raises UnknownNameError if the suffix is none of `MESH_SUFFIXES`, FileError if the file cannot
    be written, InputError if the mesh has no triangles, or more vertices than a `.ply` file can
    number, and MissingExtraError if a `.vtp` file is asked and pyvista is not installed.
    """
    suffix = known_suffix(path, MESH_SUFFIXES)
    if not len(mesh.triangles):
        raise InputError("this mesh has no triangles, and so there is nothing to write.")
    with atomic_path(path) as temporary:
        _WRITERS[suffix](mesh, temporary)


def _write_ply(mesh: Mesh, path: Path) -> None:
    import meshio

    if len(mesh.vertices) > MOST_VERTICES:
        raise InputError("a .ply file numbers vertices by 32 bits; write a .vtu file instead.")
    columns = dict(zip(("nx", "ny", "nz"), mesh.normals.T, strict=True))
    columns |= dict(zip("uv", mesh.uv.T, strict=True))
    cells: list[Any] = [("triangle", mesh.triangles.astype(np.int32))]
    buffer = io.BytesIO()
    meshio.write(buffer, meshio.Mesh(mesh.vertices, cells, point_data=columns), file_format="ply")
    buffer.seek(0)
    with open(path, "wb") as file:
        for line in iter(buffer.readline, b"end_header\n"):
            # meshio's comment holds the time, which differs run by run; older readers know `int`.
            is_comment = line.startswith(b"comment ")
            line = b"comment written by gaussmap with meshio\n" if is_comment else line
            file.write(line.replace(b" uint8 int32 ", b" uchar int "))
        file.write(b"end_header\n")
        shutil.copyfileobj(buffer, file)


def _write_obj(mesh: Mesh, path: Path) -> None:
    # Not meshio: its triangles leave out which normals their corners have.
    corners = np.repeat(mesh.triangles + 1, 2, axis=1)
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write("# written by gaussmap\n")
        np.savetxt(file, mesh.vertices, "v %.17g %.17g %.17g")
        np.savetxt(file, mesh.normals, "vn %.17g %.17g %.17g")
        np.savetxt(file, corners, "f %d//%d %d//%d %d//%d")


def _write_stl(mesh: Mesh, path: Path) -> None:
    _write_by_meshio(mesh, path, "stl", binary=True)


def _write_vtk(mesh: Mesh, path: Path) -> None:
    _write_by_meshio(mesh, path, "vtk", binary=True)


def _write_vtu(mesh: Mesh, path: Path) -> None:
    _write_by_meshio(mesh, path, "vtu", binary=True)


def _write_by_meshio(mesh: Mesh, path: Path, file_format: str, binary: bool) -> None:
    import meshio

    data = {"normals": mesh.normals, "sample": mesh.sample}
    data |= dict(zip("uv", np.ascontiguousarray(mesh.uv.T), strict=True))
    whole = meshio.Mesh(
        mesh.vertices,
        [("triangle", mesh.triangles)],
        point_data=None if file_format == "stl" else data,
    )
    meshio.write(path, whole, file_format=file_format, binary=binary)


def _write_vtp(mesh: Mesh, path: Path) -> None:
    from ..interop import mesh_to_pyvista

    write_polydata(mesh_to_pyvista(mesh), path)


_WRITERS: dict[str, Callable[[Mesh, Path], None]] = {
    ".ply": _write_ply,
    ".obj": _write_obj,
    ".stl": _write_stl,
    ".vtk": _write_vtk,
    ".vtu": _write_vtu,
    ".vtp": _write_vtp,
}
