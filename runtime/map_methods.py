"""The methods of `GaussMap` that are defined in tools/; `map_methods.pyi` has their signatures.

Each is imported at first use, so that this module does not import modules that use the map.
"""

from .base.later import Later

CURVES = "gaussmap.tools.gauss_map.image_curves"


class Methods:
    """The results derived from Gauss maps."""

    border_image = Later(CURVES)
    folds = Later(CURVES)
    margin = Later(CURVES)
    plot = Later("gaussmap.tools.pictures.gauss_map_plot")
    support = Later("gaussmap.tools.support_points")

    _conditions_of = Later("gaussmap.tools.cad.reached", "conditions_of")
