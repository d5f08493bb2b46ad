"""The methods of `Samples` that are defined in tools/; `samples_methods.py` loads them."""

class Methods:
    from ...tools.density.methods import coverage as coverage
    from ...tools.density.methods import in_order as in_order
    from ...tools.density.methods import normal_deviation as normal_deviation
    from ...tools.density.methods import progressive as progressive
    from ...tools.derived import mesh as mesh
    from ...tools.derived import offset as offset
    from ...tools.derived import unobstructed as unobstructed
    from ...tools.derived import weights as weights
    from ...tools.derived import write as write
    from ...tools.files.of_samples import to_dataframe as to_dataframe
    from ...tools.files.of_samples import to_pyvista as to_pyvista
    from ...tools.files.of_samples import to_trimesh as to_trimesh
    from ...tools.pictures.plot import plot_samples as plot
    from ...tools.viewer.view import view as view
