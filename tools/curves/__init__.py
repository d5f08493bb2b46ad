"""Planar curves (paper, Sect. 4.1): fitting, sampling by normals, polygons, support functions."""

from .curve import Curve
from .curve_sampling import CurveReport, CurveSamples, sample
from .curve_spline import CurveSpline
from .curve_support import CurveBranches, SupportFunction
from .fitting import fit
from .polygon import polygon_distance

__all__ = [
    "Curve",
    "CurveBranches",
    "CurveReport",
    "CurveSamples",
    "CurveSpline",
    "SupportFunction",
    "fit",
    "polygon_distance",
    "sample",
]


def __dir__() -> list[str]:
    return __all__
