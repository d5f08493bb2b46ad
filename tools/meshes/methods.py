"""The methods of `Mesh` that files define: `methods.pyi` says what they are."""

from __future__ import annotations

from ...runtime.base.later import Later

__all__ = ["Methods"]

FILES = "gaussmap.tools.files.of_meshes"


class Methods:
    """What is made of a mesh."""

    __slots__ = ()

    to_open3d = Later(FILES)
    to_pyvista = Later(FILES)
    to_trimesh = Later(FILES)
    write = Later(FILES)
