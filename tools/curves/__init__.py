"""Planar curves (paper, Sect. 4.1): fitting, sampling by normals, support functions."""

from .curve import Curve
from .curve_sampling import CurveReport, CurveSamples, sample
from .curve_spline import CurveSpline
from .curve_support import CurveBranches, SupportFunction
from .fitting import fit

__all__ = [
    "Curve",
    "CurveBranches",
    "CurveReport",
    "CurveSamples",
    "CurveSpline",
    "SupportFunction",
    "fit",
    "sample",
]


def __dir__() -> list[str]:
    return __all__
