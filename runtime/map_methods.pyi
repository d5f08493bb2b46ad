"""The methods of `GaussMap` that are defined in tools/; `map_methods.py` loads them."""

class Methods:
    from ..tools.cad.reached import conditions_of as _conditions_of
    from ..tools.gauss_map.image_curves import border_image as border_image
    from ..tools.gauss_map.image_curves import folds as folds
    from ..tools.gauss_map.image_curves import margin as margin
    from ..tools.pictures.gauss_map_plot import plot as plot
    from ..tools.support_points import support as support
