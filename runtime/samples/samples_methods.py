"""The methods of `Samples` that are defined in tools/; `samples_methods.pyi` has their signatures.

Each is imported at first use, as are the names of the package (see `__init__.pyi`), so that this
module does not import modules that use samples.
"""

from ..base.later import Later

DENSITY, TOOLS = "gaussmap.tools.density.methods", "gaussmap.tools.derived"
OTHERS = "gaussmap.tools.files.of_samples"


class Methods:
    """Comparisons of samples with their surface, and results derived from samples."""

    __slots__ = ()

    coverage = Later(DENSITY)
    in_order = Later(DENSITY)
    normal_deviation = Later(DENSITY)
    progressive = Later(DENSITY)

    mesh = Later(TOOLS)
    offset = Later(TOOLS)
    plot = Later("gaussmap.tools.pictures.plot", "plot_samples")
    to_dataframe = Later(OTHERS)
    to_pyvista = Later(OTHERS)
    to_trimesh = Later(OTHERS)
    unobstructed = Later(TOOLS)
    view = Later("gaussmap.tools.viewer.view")
    weights = Later(TOOLS)
    write = Later(TOOLS)
