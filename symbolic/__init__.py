"""The mathematics of gaussmap in SymPy: derived once, exactly, and printed as kernels and LaTeX.

`formulas` holds every formula by its name. `BezierTriangle` does the algebra for one given patch.
"""

from collections.abc import Mapping
from types import MappingProxyType

from . import curve, gaussian_image, mesh, patch, spline, support
from .bezier import BezierTriangle
from .formula import Formula

__all__ = ["BezierTriangle", "Formula", "formulas"]

formulas: Mapping[str, Formula] = MappingProxyType(
    {
        formula.name: formula
        for module in (patch, gaussian_image, spline, support, mesh, curve)
        for formula in module.FORMULAS
    }
)
