"""The methods of `Mesh` that `files` defines; `mesh_methods.py` loads them."""

class Methods:
    from ..files.of_meshes import to_pyvista as to_pyvista
    from ..files.of_meshes import to_trimesh as to_trimesh
    from ..files.of_meshes import write as write
