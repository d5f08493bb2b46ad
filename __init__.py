"""gaussmap: curvature-dependent sampling of surfaces by their support functions.

import gaussmap as gm

samples = gm.sample(gm.surfaces.torus(major=1.0, minor=0.35), count=10_000)
samples.points, samples.normals, samples.gaussian_curvature
samples.write("torus.ply")
"""

from importlib import import_module
from typing import TYPE_CHECKING

from .runtime import surfaces
from .runtime.curves.circle import circle
from .runtime.curves.curve import Curve
from .runtime.curves.polygon import polygon_distance
from .runtime.curves.samples import CurveReport, CurveSamples
from .runtime.curves.sampling import sample_curve
from .runtime.curves.spline import CurveSpline, fit_curve
from .runtime.errors import (
    FileError,
    GaussmapError,
    GaussmapWarning,
    InputError,
    MissingExtraError,
    MissingFieldError,
    SurfaceError,
    UnknownNameError,
)
from .runtime.gaussian.classes import PatchClass, classify_patches
from .runtime.gaussian.image import BoundaryArc, GaussianImage, GaussianImages
from .runtime.gaussian.parabolic import (
    ParabolicCurve,
    ParabolicPoint,
    ParabolicPoints,
    parabolic_points,
)
from .runtime.gaussian.parabolic_lines import ParabolicLine, Piece, parabolic_lines, split_patch
from .runtime.io import read_samples
from .runtime.samples import Samples, SamplingReport
from .runtime.sampling import sample, sample_many
from .runtime.sphere import fibonacci, icosphere
from .runtime.spline import Spline, fit
from .runtime.stream import sample_stream
from .runtime.support.branches import Branches
from .runtime.support.function import SupportFunction
from .runtime.surface import Surface

if TYPE_CHECKING:
    from . import symbolic
    from .symbolic import formulas

__version__ = "0.1.0"

__all__ = [
    "BoundaryArc",
    "Branches",
    "Curve",
    "CurveReport",
    "CurveSamples",
    "CurveSpline",
    "FileError",
    "GaussianImage",
    "GaussianImages",
    "GaussmapError",
    "GaussmapWarning",
    "InputError",
    "MissingExtraError",
    "MissingFieldError",
    "ParabolicCurve",
    "ParabolicLine",
    "ParabolicPoint",
    "ParabolicPoints",
    "PatchClass",
    "Piece",
    "Samples",
    "SamplingReport",
    "Spline",
    "SupportFunction",
    "Surface",
    "SurfaceError",
    "UnknownNameError",
    "circle",
    "classify_patches",
    "fibonacci",
    "fit",
    "fit_curve",
    "formulas",
    "icosphere",
    "parabolic_lines",
    "parabolic_points",
    "polygon_distance",
    "read_samples",
    "sample",
    "sample_curve",
    "sample_many",
    "sample_stream",
    "split_patch",
    "surfaces",
    "symbolic",
]


def __getattr__(name: str) -> object:
    """Load SymPy only when the formulas are asked for."""
    if name == "symbolic":
        return import_module(".symbolic", __name__)
    if name == "formulas":
        return import_module(".symbolic", __name__).formulas
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
