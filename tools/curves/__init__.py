"""Planar curves (paper, Sect. 4.1): fitting, sampling by normals, polygons, support functions."""

from .curve import Curve
from .fitting import fit
from .polygon import polygon_distance
from .samples import CurveReport, CurveSamples
from .sampling import sample
from .spline import CurveSpline
from .support import CurveBranches, SupportFunction

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
