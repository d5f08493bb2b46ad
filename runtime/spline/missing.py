"""Grids with missing points: the patches of their spline that do not depend on these points."""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags
from ..base.checks import as_float
from ..base.errors import GaussmapWarning, InputError, shown
from ..domain.domain import Boundary, Domain
from ..domain.inside import extremes_around
from .kernels.spline import control_nets, patches_at
from .poles import spread_missing, without_poles
from .quasi_interpolant import Border, coefficients_with_ring, from_grid, from_values, values_at

# The usual values of missing elevations.
USUAL_NODATA = (-9999.0, -99999.0, -32768.0, float(np.finfo(np.float32).min))
USUAL_LARGE_NODATA = (float(np.finfo(np.float32).max), 1e20)
# If the lowest or the highest value differs from the given `nodata` by at most this fraction, that
# value may be the number that means missing data, and `nodata` a copy of it with six digits.
NEAR = 1e-5
# A block of missing data has at least this many heights, and at least this fraction of all heights.
FEWEST, SMALLEST = 16, 1e-3
# A block counts as missing data if the median step of height at its boundary exceeds the QUANTILE
# of the steps elsewhere by a factor of STEEPER. (Shores of water are about as steep as the land.)
STEEPER, QUANTILE = 3.0, 0.99
# The number of rows of points next to a pole on which all patches around it depend.
ROWS_AT_POLE = 3


@dataclass(frozen=True, eq=False)
class Known:
    """The patches of a spline that do not depend on missing points.

    `patches` (4 m n,) is True for these patches; `cells` (m, n) are the numbers of cells.
    """

    domain: Domain
    cells: tuple[int, int]
    patches: Flags

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return whether points (k, 2) of the domain are in known patches, as booleans (k,)."""
        low, high = np.array(self.domain).T
        cells, found = (uv - low) / (high - low) * self.cells, np.empty(len(uv), dtype=np.int64)
        patches_at(*self.cells, cells, found, np.empty((len(uv), 2)))
        return self.patches[found]

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> Flags | None:
        """Return a mask (m, n) of the cells next to a boundary of the known patches.

        Returns None if the known patches have another domain or other cells.
        """
        if (domain, cells) != (self.domain, self.cells):
            return None
        least, most = extremes_around(self.patches.reshape(*cells, 4).astype(np.float64))
        return least < most

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Return 0 for all boxes (k, 4): surfaces with such a trim are not proved."""
        return np.zeros(len(boxes), np.int8)


def checked_nodata(nodata: Any) -> float:  # noqa: ANN401
    """Return the number that means missing data; InputError if it is not a number."""
    try:
        return as_float(nodata)
    except TypeError:
        raise InputError(f"nodata must be a number, not {shown(nodata)}.") from None


def without_nodata(points: Array, nodata: object, name: str) -> Array:
    """Return points or elevations with NaN in place of `nodata`.

    If `nodata` is None, or if no value equals it, possibly because of rounding, a warning names
    values that look like missing data.
    """
    if nodata is None:
        _warn_of_nodata(points, name)
        return points
    value = checked_nodata(nodata)
    with np.errstate(over="ignore"):
        bad = (points == value) | (points == float(np.float32(value)))
    if not bad.any() and not math.isnan(value):
        _warn_of_nodata(points, name, value)
    if points.ndim == 3:
        bad = bad.any(axis=2, keepdims=True)
    return np.where(bad, np.nan, points)


def _warn_of_nodata(points: Array, name: str, given: float | None = None) -> None:
    instead = "" if given is None else f" instead of {given:.9g}, which is none of its values"
    lowest = float(np.fmin.reduce(points, axis=None, initial=np.inf))
    highest = float(np.fmax.reduce(points, axis=None, initial=-np.inf))
    for value, usual in ((lowest, USUAL_NODATA), (highest, USUAL_LARGE_NODATA)):
        near = given is not None and abs(value - given) <= NEAR * abs(given)
        if (value in usual or near) and lowest < highest:
            _warn(
                f"{name} holds {value:.9g} {int((points == value).sum()):,} times, which often "
                f"means that there is no data; if so, say {value:.9g} as nodata{instead}."
            )
            return
    block = _suspicious_block(points) if points.ndim == 2 else None
    if block is not None:
        _warn(
            f"{name} holds a block of {block[1]:,} heights of {block[0]:.9g}, where the others end "
            f"abruptly: there may be no data; if so, say {block[0]:.9g} as nodata{instead}."
        )


def _warn(text: str) -> None:
    warnings.warn(text, GaussmapWarning, stacklevel=5)


def _suspicious_block(heights: Array) -> tuple[float, int] | None:
    """Return the value of a block of missing data in heights (m, n), and its size; or None.

    The block is a connected area of the lowest or of the highest value. It must reach the boundary
    of the grid, unless its value is 0. The size is its number of heights. Heights jump at the
    boundary of the block, unlike at the shore of a lake or of the sea.
    """
    known = ~np.isnan(heights)
    if not known.any():
        return None
    for value in (float(np.nanmin(heights)), float(np.nanmax(heights))):
        block = _largest_block(heights == value)
        size = int(block.sum())
        if size < max(FEWEST, SMALLEST * heights.size) or size == int(known.sum()):
            continue
        at_border = any(block[x].any() for x in (0, -1)) or block[:, [0, -1]].any()
        if (value == 0.0 or at_border) and _jumps(heights, block):
            return value, size
    return None


def _largest_block(same: Flags) -> Flags:
    """Return the largest connected area where flags (m, n) are True, as flags (m, n)."""
    if same.sum() < FEWEST:
        return np.zeros_like(same)
    from scipy.ndimage import label

    numbers = np.asarray(label(same)[0])  # pyright: ignore[reportIndexIssue]
    return numbers == 1 + int(np.argmax(np.bincount(numbers.ravel())[1:]))


def _jumps(heights: Array, block: Flags) -> bool:
    """Return whether steps of height at the boundary of a block are much larger than elsewhere."""
    across, elsewhere = [], []
    for axis in (0, 1):
        steps, inside = np.abs(np.diff(heights, axis=axis)), np.diff(block, axis=axis)
        low = np.take(block, np.arange(block.shape[axis] - 1), axis)
        known = ~np.isnan(steps)
        across.append(steps[inside & known])
        elsewhere.append(steps[~inside & ~low & known])
    border, others = np.concatenate(across), np.concatenate(elsewhere)
    if len(border) == 0 or len(others) == 0:
        return False
    usual = float(np.quantile(others, QUANTILE))
    return usual > 0.0 and float(np.median(border)) > STEEPER * usual


# --- patches that do not depend on missing points -------------------------------------------------


def known_of_grid(points: Array, domain: Domain, boundary: Boundary, name: str) -> Known | None:
    """Return the patches of the spline of a grid that do not depend on NaN; None without any NaN.

    Raises InputError if no patch is left.
    """
    bad: Flags = np.any(np.isnan(points), axis=2)
    if not bad.any():
        return None
    spread_missing(bad, boundary, ROWS_AT_POLE)
    zeros = np.zeros((*bad.shape, 3))
    zeros[bad] = np.nan
    known = known_of(*from_grid(zeros, without_poles(boundary)), domain, boundary)
    if not known.patches.any():
        raise InputError(
            f"{int(bad.sum()):,} of the {bad.size:,} points of {name} are missing, and every part "
            "of its spline depends on one of them; fill them, or crop the grid."
        )
    return known


def known_of_values(
    exists: Callable[[Array], Flags], domain: Domain, boundary: Boundary, cells: tuple[int, int]
) -> Known:
    """Return the patches of a quasi-interpolant that depend only on existing values.

    `exists` takes points (k, 2) of the domain and returns whether they have values, (k,).
    """

    def values(u: Array, v: Array) -> Array:
        uv = np.stack(np.broadcast_arrays(u, v), axis=-1)
        bad = ~exists(uv.reshape(-1, 2)).reshape(uv.shape[:2])
        return np.where(bad[..., None], np.nan, np.zeros(3))

    return known_of(*from_values(values_at(values, domain, cells)), domain, boundary)


def known_of(inner: Array, border: Border, domain: Domain, boundary: Boundary) -> Known:
    """Return the patches whose control nets have no NaN.

    `inner` (m, n, 3) are coefficients and `border` the boundary, both with NaN for missing values.
    """
    bad: Flags = np.any(np.isnan(inner), axis=2)
    spread_missing(bad, boundary, 1)  # the coefficients around a pole depend on one another
    inner[bad] = np.nan
    coefficients = coefficients_with_ring(inner, border, without_poles(boundary))
    m, n = inner.shape[:2]
    nets = np.empty((4 * m * n, 6, 3))
    control_nets(coefficients, nets)
    return Known(domain, (m, n), np.asarray(~np.isnan(nets).any(axis=(1, 2))))
