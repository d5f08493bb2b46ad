"""The methods of `GaussMap` that rooms above define: `map_methods.pyi` says what they are.

Each is loaded when it is first asked for. Nothing here imports what stands on the map.
"""

from __future__ import annotations

from .base.later import Later

__all__ = ["Methods"]

CURVES = "gaussmap.tools.gauss_map.image_curves"


class Methods:
    """What is made of Gauss maps."""

    border_image = Later(CURVES)
    folds = Later(CURVES)
    margin = Later(CURVES)
