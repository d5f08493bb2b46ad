"""The methods of `Mesh` defined in other modules; `mesh_methods.pyi` declares them."""

from ...runtime.base.later import Later

FILES = "gaussmap.tools.files.of_meshes"


class Methods:
    """The methods that write a mesh or convert it."""

    __slots__ = ()

    to_pyvista = Later(FILES)
    to_trimesh = Later(FILES)
    write = Later(FILES)
