"""Offsets of samples: x + d n, with the same normals, and their curvatures."""

import math
import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from ...generated import support as formulas
from ...runtime.base.aliases import Array, Flags
from ...runtime.base.checks import finite_number, yes_or_no
from ...runtime.base.errors import GaussmapWarning, InputError
from ...runtime.base.formula_calls import python_function
from ...runtime.base.tolerances import CURVATURE_ERROR
from ...runtime.base.trees import tree_of
from ...runtime.samples.fields import missing_fields
from ...runtime.samples.offset_of import OffsetOf
from ...runtime.samples.report import count_infinite, have_large_squares
from ...runtime.samples.samples import Samples
from ...runtime.samples.whole import Whole
from ...runtime.spline.nets import AnySpline
from ...runtime.surface.surface import Surface
from ..sampling.sample import sample

# To compute one of these fields of an offset, the samples must have the same field, and the fields
# given here.
NEEDED = {
    "points": ("normals",),
    "gaussian_curvature": ("mean_curvature",),
    "mean_curvature": ("gaussian_curvature",),
}


# Distances from a surface are measured to samples of it. For a surface of the size a and a distance
# d, their number is at least LEAST and at least PER_SQUARE (a/d)², so that gaps are about 0.2 d.
# SHORTEST is the least d/a.
LEAST, PER_SQUARE, SHORTEST = 20_000, 15.0, 1.0 / 180.0
ROUNDING = 64.0  # of distances, in units of the last place of coordinates


def offset(samples: Samples, distance: float, trimmed: bool) -> Samples:
    """Return the samples moved by a distance along their normals; see `Samples.offset`."""
    d = finite_number(distance, "distance")
    _check_fields(samples)
    base = samples.offset_of or OffsetOf(0.0, samples.spline, samples.surface)
    if yes_or_no(trimmed, "trimmed"):
        nearer = _nearer(samples, d, base)
        samples, trimmed = samples[~nearer], bool(nearer.any())
    arrays: dict[str, Any] = {x: getattr(samples, x) for x in samples.fields}
    moved: dict[str, Array] = {}
    with np.errstate(all="ignore"):  # infinite curvatures are valid
        if "points" in arrays:
            moved["points"] = arrays["points"] + d * arrays["normals"].astype(np.float64)
        if "support" in arrays:
            moved["support"] = arrays["support"].astype(np.float64) + d
        if "gaussian_curvature" in arrays:
            moved |= _curvatures(samples, d)
        arrays |= {name: array.astype(samples.dtype) for name, array in moved.items()}
    report = replace(
        samples.report,
        surface=f"{samples.report.surface} offset by {d:g}{', trimmed' if trimmed else ''}",
        developable_share=None,  # areas change, except those of planar regions
        infinite_curvatures=count_infinite(arrays),
        fit_distance=None,  # the spline has no offset
        fit_rms=None,
        fit_angle=None,
    )
    origin = replace(base, distance=base.distance + d, trimmed=base.trimmed or trimmed)
    return Samples(**arrays, report=report, offset_of=origin)


def _nearer(samples: Samples, d: float, base: OffsetOf) -> Flags:
    """Return whether samples, moved by d, are nearer to their surface than the total distance.

    The total distance is the sum of d and of earlier offsets. Distances are measured to samples of
    the surface: they may be too large, but not too small.
    """
    surface = base.spline if base.surface is None else base.surface
    if surface is None:
        raise InputError(
            "the offset cannot be trimmed: these samples do not hold their surface (those from a "
            "file, and sums, do not)."
        )
    if lacking := [x for x in ("points", "normals") if x not in samples.fields]:
        raise missing_fields(samples.fields, lacking, "a trimmed offset")
    points = samples.points.astype(np.float64) + d * samples.normals.astype(np.float64)
    far = abs(base.distance + d)
    if far == 0.0:
        return np.zeros(len(points), dtype=np.bool_)
    known = _points_of(surface, far)
    largest = max(float(np.abs(known).max()), far)
    least = 1.0 - ROUNDING * float(np.finfo(samples.dtype).eps) * (largest / far)
    return (
        tree_of(known / far).query(points / far, distance_upper_bound=max(least, 0.0))[0] < np.inf
    )


def _points_of(surface: Surface | AnySpline | Whole, distance: float) -> Array:
    """Return points of a surface, with gaps between them that are small relative to a distance."""
    count, edges = LEAST, isinstance(surface, Whole)
    while True:
        found = sample(surface, count, density="uniform", edges=edges, fields=("points",))
        size = math.hypot(*np.ptp(found.points, axis=0))
        if distance < SHORTEST * size:
            raise InputError(
                f"the offset cannot be trimmed: the distance, {distance:g}, is less than 1/180 of "
                f"the size of the surface, {size:g}."
            )
        needed = math.ceil(PER_SQUARE * (size / distance) ** 2)
        if needed <= count:
            return found.points
        count = needed


def _curvatures(samples: Samples, d: float) -> dict[str, Array]:
    """Return K and H of the offset, and warn if it is folded.

    Where a radius becomes 0, up to the rounding of 1 + 2 H d + K d², the Gaussian curvature is
    infinite with its old sign (NaN if it was 0) and the mean curvature NaN.
    """
    K = samples.gaussian_curvature.astype(np.float64)
    H = samples.mean_curvature.astype(np.float64)
    _check_squares(samples, H)
    _, K_offset, H_offset = python_function(formulas.offset_curvature)(K, H, d)
    vanishing, turned = _growth(samples, d)
    if turned.any():
        _warn(samples, d, turned)
    return {
        "gaussian_curvature": np.where(vanishing, K * np.inf, K_offset),
        "mean_curvature": np.where(vanishing, np.nan, H_offset),
    }


def folded(samples: Samples, distance: float) -> Flags:
    """Return a mask of samples at which an offset folds, or which are singular: K is infinite."""
    with np.errstate(all="ignore"):
        return _growth(samples, distance)[1] | np.isinf(samples.gaussian_curvature)


def _growth(samples: Samples, d: float) -> tuple[Flags, Flags]:
    """Return two masks of samples: a radius becomes 0; a radius becomes 0 or changes its sign."""
    K = samples.gaussian_curvature.astype(np.float64)
    H = samples.mean_curvature.astype(np.float64)
    s, m = python_function(formulas.offset_growth)(K, H, d)
    terms = size_of_terms(K, H, d)
    rounding = CURVATURE_ERROR * float(np.finfo(samples.dtype).eps)
    vanishing = (terms < np.inf) & (np.abs(s) <= rounding * terms)
    return vanishing, vanishing | (s < 0.0) | (m < 0.0)


def size_of_terms(K: Array, H: Array, d: float) -> Array:
    """Return the sum of the moduli of the terms of 1 + 2 H d + K d²."""
    return 1.0 + 2.0 * np.abs(d * H) + np.abs(d * d * K)


def _check_squares(samples: Samples, H: Array) -> None:
    """Raise InputError if K, about the square of H, overflows or underflows."""
    K = samples.gaussian_curvature
    too_large = have_large_squares(H, K.dtype)
    squares = np.maximum(np.abs(K), H * H)
    too_small = float(np.abs(H).max(initial=0.0)) > 0.0 and squares.max() < np.finfo(K.dtype).tiny
    if too_large or too_small:
        raise InputError(
            f"the curvatures of the offset cannot be computed: squares of those of the samples are "
            f"too {'small' if too_small else 'large'} for {K.dtype}; choose another unit of "
            "length, or sample without curvatures."
        )


def _check_fields(samples: Samples) -> None:
    for name, needed in NEEDED.items():
        missing = [x for x in needed if x not in samples.fields]
        if name in samples.fields and missing:
            raise missing_fields(samples.fields, missing, f"the offset of {name}")


def _warn(samples: Samples, d: float, turned: Flags) -> None:
    """Warn of samples at which the offset is folded, with the smallest radius of curvature."""
    towards = -np.sign(d) * samples[turned].principal_curvatures
    largest = np.where(np.isnan(towards), np.inf, towards).max()  # NaN: a curvature is infinite
    warnings.warn(
        f"surface {samples.report.surface!r}: the distance {d:g} reaches a radius of curvature at "
        f"{int(turned.sum()):,} of {len(samples):,} samples, where the offset folds; the smallest "
        f"radius on that side is {1.0 / largest:g}.",
        GaussmapWarning,
        stacklevel=5,
    )
