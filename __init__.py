"""gaussmap: curvature-dependent sampling of surfaces by their support functions.

import gaussmap as gm

samples = gm.sample(gm.surfaces.torus(major=1.0, minor=0.35), count=10_000)
samples.points, samples.normals, samples.gaussian_curvature
samples.write("torus.ply")
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import symbolic
    from .runtime import surfaces
    from .runtime.covering import covering_radius
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
    from .runtime.files.formats import read_samples
    from .runtime.formulas import formulas
    from .runtime.gaussian.boundary import BoundaryArc
    from .runtime.gaussian.classes import PatchClass, classify_patches
    from .runtime.gaussian.image import GaussianImage, GaussianImages
    from .runtime.gaussian.parabolic import (
        ParabolicCurve,
        ParabolicPoint,
        ParabolicPoints,
        parabolic_points,
    )
    from .runtime.gaussian.parabolic_lines import ParabolicLine, Piece, parabolic_lines, split_patch
    from .runtime.meshes.mesh import Mesh
    from .runtime.regions import cap, spherical_polygon
    from .runtime.samples import Samples, SamplingReport
    from .runtime.sampling import sample, sample_many
    from .runtime.silhouette import silhouette
    from .runtime.sphere import fibonacci, healpix, icosphere, random_normals
    from .runtime.spline import Spline, fit
    from .runtime.stream import sample_stream
    from .runtime.support.branches import Branches
    from .runtime.support.convolution import Convolution, convolve
    from .runtime.support.function import SupportFunction
    from .runtime.surface import Surface

__version__ = "0.1.0"

__all__ = [
    "BoundaryArc",
    "Branches",
    "Convolution",
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
    "Mesh",
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
    "cap",
    "circle",
    "classify_patches",
    "convolve",
    "covering_radius",
    "fibonacci",
    "fit",
    "fit_curve",
    "formulas",
    "healpix",
    "icosphere",
    "parabolic_lines",
    "parabolic_points",
    "polygon_distance",
    "random_normals",
    "read_samples",
    "sample",
    "sample_curve",
    "sample_many",
    "sample_stream",
    "silhouette",
    "spherical_polygon",
    "split_patch",
    "surfaces",
    "symbolic",
]

# Where the names are, each loaded when it is asked for: SymPy and Numba take their time.
_MODULES = {"surfaces": "runtime.surfaces", "symbolic": "symbolic"}
_NAMES = {
    "runtime.covering": "covering_radius",
    "runtime.curves.circle": "circle",
    "runtime.curves.curve": "Curve",
    "runtime.curves.polygon": "polygon_distance",
    "runtime.curves.samples": "CurveReport CurveSamples",
    "runtime.curves.sampling": "sample_curve",
    "runtime.curves.spline": "CurveSpline fit_curve",
    "runtime.errors": "FileError GaussmapError GaussmapWarning InputError MissingExtraError "
    "MissingFieldError SurfaceError UnknownNameError",
    "runtime.formulas": "formulas",
    "runtime.gaussian.boundary": "BoundaryArc",
    "runtime.gaussian.classes": "PatchClass classify_patches",
    "runtime.gaussian.image": "GaussianImage GaussianImages",
    "runtime.gaussian.parabolic": "ParabolicCurve ParabolicPoint ParabolicPoints parabolic_points",
    "runtime.gaussian.parabolic_lines": "ParabolicLine Piece parabolic_lines split_patch",
    "runtime.files.formats": "read_samples",
    "runtime.regions": "cap spherical_polygon",
    "runtime.meshes.mesh": "Mesh",
    "runtime.samples": "Samples SamplingReport",
    "runtime.sampling": "sample sample_many",
    "runtime.silhouette": "silhouette",
    "runtime.sphere": "fibonacci healpix icosphere random_normals",
    "runtime.spline": "Spline fit",
    "runtime.stream": "sample_stream",
    "runtime.support.branches": "Branches",
    "runtime.support.convolution": "Convolution convolve",
    "runtime.support.function": "SupportFunction",
    "runtime.surface": "Surface",
}
_HOMES = {name: module for module, names in _NAMES.items() for name in names.split()}


def __getattr__(name: str) -> object:
    if name in _MODULES:
        value = import_module(f".{_MODULES[name]}", __name__)
    elif name in _HOMES:
        value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value  # found without this function from now on
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
