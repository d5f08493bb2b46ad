"""Files of triangles that most programs read: .obj, .stl and .glb, which is binary glTF."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...runtime.base.errors import InputError
from ...runtime.base.extras import from_extra
from ...runtime.base.scales import scales_to_one
from ..meshes.texture import split_at_seams
from .tables import write_rows

if TYPE_CHECKING:
    from ..meshes.mesh import Mesh

_STL_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_obj(mesh: Mesh, path: Path) -> None:
    """Write vertices, texture coordinates and normals, and triangles as indices of these three."""
    # trimesh is not used: it writes a fixed number of decimals, which loses small numbers.
    split = mesh.split  # a vertex for each of its normals
    texture = split_at_seams(split.uv, split.triangles, split.domain, split.boundary)
    with open(path, "wb") as file:
        file.write(b"# written by gaussmap\n")
        write_rows(file, "v {} {} {}\n", [*mesh.vertices.T])
        write_rows(file, "vt {} {}\n", [*texture.places.T])
        write_rows(file, "vn {} {} {}\n", [*split.normals.T])
        corners = np.stack([mesh.triangles, texture.corners, split.triangles], axis=2) + 1
        write_rows(file, "f {}/{}/{} {}/{}/{} {}/{}/{}\n", [*corners.reshape(-1, 9).T])


def write_stl(mesh: Mesh, path: Path) -> None:
    """Write the corners and the normal of each triangle, in single precision."""
    corners = mesh.vertices[mesh.triangles]
    rows = np.zeros(len(corners), _STL_ROW)
    with np.errstate(all="ignore"):  # values beyond single precision, triangles without area
        edges = corners[:, 1:] - corners[:, :1]
        edges *= scales_to_one(np.abs(edges).max(axis=2))[..., None]  # each to 1: no underflow
        across = np.cross(edges[:, 0], edges[:, 1])
        size = np.sqrt(np.einsum("ij,ij->i", across, across))[:, None]
        np.divide(across, size, out=rows["normal"], where=size > 0.0, casting="same_kind")
        rows["corners"] = corners
    with open(path, "wb") as file:
        file.write(b"written by gaussmap".ljust(80))
        file.write(np.uint32(len(rows)).astype("<u4").tobytes())
        file.write(rows.data)


def write_glb(mesh: Mesh, path: Path) -> None:
    """Write triangles, vertices, normals, and u and v as the attribute _UV, in single precision.

    A vertex on a crease, such as a sharp edge of a CAD part, is repeated for each of its normals;
    no other vertex is repeated.
    """
    trimesh = from_extra("trimesh", "trimesh", "a .glb file")
    if np.abs(mesh.vertices).max() > np.finfo(np.float32).max:
        raise InputError(
            "a .glb file holds single precision, for which these vertices are too large; choose "
            "another unit of length, or write a .ply file."
        )
    split = mesh.split
    made = trimesh.Trimesh(
        split.vertices,
        split.triangles,
        vertex_normals=split.normals,
        vertex_attributes={"_UV": split.uv.astype(np.float32)},
        process=False,
    )
    path.write_bytes(made.export(file_type="glb", include_normals=True))
