"""The coefficients of a spline from values of a surface: local averages (paper, Sect. 3.1)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..base.checks import pair_of_cells
from ..base.errors import InputError, SurfaceError
from ..base.limits import MOST
from ..base.memory import check_memory
from ..base.scales import LARGEST_EXPONENT
from ..domain.domain import Boundary, Domain, cells_between
from .ghosts import Border, coefficients_with_ring
from .inner_coefficients import Values, from_grid, from_values
from .missing import filled
from .spline import Spline

__all__ = ["apart", "checked_cells", "fit_grid", "fit_values", "not_too_large"]

# Points that are declared to be one may be this far apart, relative to the size of the surface.
SAME_POINT = 1e-6


def fit_values(values: Values, domain: Domain, boundary: Boundary, name: str) -> Spline:
    """Return the spline of values at the centres and vertices of cells."""
    return _spline(*from_values(values), domain, boundary, name)


def fit_grid(points: NDArray[np.float64], domain: Domain, boundary: Boundary, name: str) -> Spline:
    """Return the spline with one cell between any four neighbouring points (m, n, 3) of a grid.

    Missing points are replaced by the nearest ones.
    """
    checked_cells(cells_between(points.shape, boundary))
    inner, border = from_grid(not_too_large(filled(points), name), boundary)
    return _spline(inner, border, domain, boundary, name)


def _spline(
    inner: NDArray[np.float64], border: Border, domain: Domain, boundary: Boundary, name: str
) -> Spline:
    """Return a spline; SurfaceError if its coefficients are subnormal numbers."""
    coefficients = coefficients_with_ring(inner, border, boundary)
    if 0.0 < float(np.abs(coefficients).max()) < 2.0**-LARGEST_EXPONENT:
        raise SurfaceError(
            f"the coordinates of {name!r} are too small to compute with: choose another unit of "
            "length, in which some are larger than 1e-301."
        )
    return Spline(coefficients, domain, boundary, name)


def apart(
    first: NDArray[np.float64], second: NDArray[np.float64], points: NDArray[np.float64]
) -> bool:
    """Return whether points that should be equal differ by more than rounding."""
    extent = points.max(axis=0).max(axis=0) - points.min(axis=0).min(axis=0)  # fastest this way
    size = float(extent.max())
    rounding = 64.0 * float(np.spacing(np.abs(points).max()))
    return float(np.abs(first - second).max()) > SAME_POINT * size + rounding


def not_too_large(points: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """Return points; SurfaceError if they are so large that formulas would overflow."""
    if np.abs(points).max() > 2.0**LARGEST_EXPONENT:
        raise SurfaceError(
            f"the coordinates of {name!r} are too large to compute with: choose another unit of "
            "length, in which they are smaller than 1e301."
        )
    return points


def checked_cells(cells: Sequence[int]) -> tuple[int, int]:
    """Return numbers of cells (m, n); InputError if there are too few or too many."""
    m, n = pair_of_cells(cells)
    if min(m, n) < 3:
        raise InputError(f"at least 3 x 3 cells are needed, not {m} x {n}.")
    if m * n > MOST:
        raise InputError(f"at most {MOST:,} cells are possible, not {m:,} x {n:,}.")
    check_memory("cells", m * n)
    return m, n
