"""The methods of `Samples` that rooms above this one define: `methods.pyi` says what they are.

Each is loaded when it is first asked for, as the names of the package are (see `__init__.pyi`).
Nothing here imports what stands on samples.
"""

from __future__ import annotations

from ..base.later import Later

__all__ = ["Methods"]

DENSITY, TOOLS = "gaussmap.runtime.density.methods", "gaussmap.tools.methods"
OTHERS = "gaussmap.tools.files.of_samples"


class Methods:
    """Samples compared with their surface, and what is made of them."""

    __slots__ = ()

    coverage = Later(DENSITY)
    normal_deviation = Later(DENSITY)
    progressive = Later(DENSITY)

    levels = Later(TOOLS)
    mesh = Later(TOOLS)
    offset = Later(TOOLS)
    plot = Later(TOOLS)
    to_dataframe = Later(OTHERS)
    to_open3d = Later(OTHERS)
    to_pyvista = Later(OTHERS)
    to_trimesh = Later(OTHERS)
    unobstructed = Later(TOOLS)
    view = Later(TOOLS)
    weights = Later(TOOLS)
    write = Later(TOOLS)
