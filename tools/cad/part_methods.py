"""The methods of `Part` that are defined in modules which import `Part`.

Each method is loaded on first access, so that this module imports no other module of parts.
`part_methods.pyi` declares the methods.
"""

from ...runtime.base.later import Later

MEASURES, PLOT = "gaussmap.tools.cad.measures", "gaussmap.tools.pictures.plot"
SELECTION = "gaussmap.tools.cad.selection"
FROM_SURFACES = "gaussmap.tools.cad.from_surfaces"
REACHED, SAMPLING = "gaussmap.tools.cad.reached", "gaussmap.tools.cad.part_sampling"


class Methods:
    """Public methods of `Part`, and private functions that `Part` and its base class call."""

    plot = Later(PLOT, "plot_part")
    select = Later(SELECTION)

    _face_columns = Later("gaussmap.tools.cad.face_columns", "face_columns")

    _bounds_of = Later("gaussmap.tools.support_points", "bounds_of")
    _made_of = Later(FROM_SURFACES, "part_of_surfaces")
    _gap_of = Later(MEASURES, "gap_of")
    _volume_of = Later(MEASURES, "volume_of")

    _boundaries = Later(REACHED, "with_edges")
    _sampled = Later(SAMPLING, "sample_part")
    _samples_at = Later(SAMPLING, "samples_at")
    _space = Later(REACHED, "reached")
