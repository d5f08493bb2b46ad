"""Georeferences: the reference system of coordinates, and the origin subtracted from them."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from .checks import as_float
from .errors import GaussmapWarning, InputError, shown

# Rounding to single precision causes a warning if it moves points by more than this part of their
# spacing.
ROUNDING = 1e-3
# The least number of points from which a spacing is estimated.
FEWEST = 3

Origin = tuple[float, float, float]


@dataclass(frozen=True)
class Georeference:
    """A coordinate reference system (EPSG:number or WKT), the subtracted origin, and the unit.

    The unit is that of lengths, such as "m", if it is known.
    """

    crs: str | None = None
    origin: Origin = (0.0, 0.0, 0.0)
    unit: str | None = None


def checked_origin(origin: Sequence[float] | None) -> Origin:
    """Return an origin x, y, z from two or three numbers; z is 0 by default.

    Returns 0, 0, 0 for None. Raises InputError for other values.
    """
    if origin is None:
        return 0.0, 0.0, 0.0
    try:
        values = [as_float(x) for x in islice(origin, 4)]
    except Exception:  # conversion may raise anything
        values = []
    if len(values) not in (2, 3) or not all(math.isfinite(x) for x in values):
        raise InputError(f"origin must be two or three finite numbers, not {shown(origin)}.")
    x, y, z = [*values, 0.0][:3]
    return x, y, z


def crs_label(crs: str) -> str:
    """Return the label of a reference system: EPSG:number, or the name in its WKT."""
    _, quote, rest = crs.partition('"')
    return rest.partition('"')[0] if quote else crs


def warn_of_rounding(points: NDArray[np.floating], stacklevel: int) -> None:
    """Warn if single precision moves points (N, 3) by more than ROUNDING of their spacing.

    There is no warning if the subtraction of an origin would not help.
    """
    if len(points) < FEWEST:
        return
    low, high = (x.astype(np.float64) for x in (points.min(axis=0), points.max(axis=0)))
    largest = float(np.maximum(np.abs(low), np.abs(high)).max())
    if not math.dist(low, high) < largest < float(np.finfo(np.float32).max):
        return  # an origin would not help
    step = float(np.spacing(np.float32(largest)))
    if step > ROUNDING * math.dist(low, high) / math.sqrt(len(points)):
        x, y = (f"{math.floor(q)}" for q in low[:2])
        warnings.warn(
            f"single precision rounds these coordinates to {step:.2g}; subtract an origin such as "
            f"{x} {y}.",
            GaussmapWarning,
            stacklevel=stacklevel,
        )
