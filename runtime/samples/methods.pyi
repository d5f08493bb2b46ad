"""The methods of `Samples` that folders above define; `methods.py` loads them."""

class Methods:
    from ...tools.density.methods import coverage as coverage
    from ...tools.density.methods import normal_deviation as normal_deviation
    from ...tools.density.methods import progressive as progressive
    from ...tools.files.of_samples import to_dataframe as to_dataframe
    from ...tools.files.of_samples import to_open3d as to_open3d
    from ...tools.files.of_samples import to_pyvista as to_pyvista
    from ...tools.files.of_samples import to_trimesh as to_trimesh
    from ...tools.methods import levels as levels
    from ...tools.methods import mesh as mesh
    from ...tools.methods import offset as offset
    from ...tools.methods import plot as plot
    from ...tools.methods import unobstructed as unobstructed
    from ...tools.methods import view as view
    from ...tools.methods import weights as weights
    from ...tools.methods import write as write
