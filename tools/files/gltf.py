"""Binary glTF, for browsers, engines and viewers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...runtime.base.errors import InputError
from ...runtime.base.extras import from_extra

if TYPE_CHECKING:
    from ..meshes.mesh import Mesh

__all__ = ["write_glb"]


def write_glb(mesh: Mesh, path: Path) -> None:
    """Write triangles, vertices and their normals, in single precision."""
    trimesh = from_extra("trimesh", "trimesh", "a .glb file")
    if np.abs(mesh.vertices).max() > np.finfo(np.float32).max:
        raise InputError(
            "a .glb file holds single precision, for which these vertices are too large; choose "
            "another unit of length, or write a .ply file."
        )
    made = trimesh.Trimesh(
        mesh.vertices, mesh.triangles, vertex_normals=mesh.normals, process=False
    )
    path.write_bytes(made.export(file_type="glb", include_normals=True))
