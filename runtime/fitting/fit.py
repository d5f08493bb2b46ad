"""From a surface to the spline that approximates it."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..base.advice import about_value
from ..base.errors import GaussmapWarning, InputError, SurfaceError, in_memory
from ..base.evaluation import returned
from ..base.progress import busy
from ..base.scales import not_too_large
from ..domain.domain import cells_between, places_in
from ..domain.trim import Trim, trimmed
from ..spline.misfit import Misfit
from ..spline.missing import known_of, known_of_values
from ..spline.nets import AnySpline, on_grid
from ..spline.quasi_interpolant import (
    checked_cells,
    completed,
    continued,
    fit_grid,
    fit_values,
    from_values,
    values_at,
)
from ..spline.spline import Spline, short_label
from ..surface.derivatives import Differentiable
from ..surface.sides import close_seams, with_found_sides
from ..surface.surface import Surface
from ..surface.surfaces import named
from .comparison import Comparison, compare_with_data, probe_of, variation
from .tolerance import FAR_OFF, Tolerance, checked_tolerance, refined

# Without cells or tolerance: the least numbers of cells, and the goal for which they are increased.
# At creases no number of cells makes normals accurate: the search ends when they no longer improve.
DEFAULT_CELLS = (64, 64)
DEFAULT = Tolerance(None, 1e-4, 0.1, poles=False, most=(1024, 1024), total=2**16, patience=2)
# The numbers of cells of the first attempt if a tolerance is given.
FEWEST_CELLS = (8, 8)
# A callable is called twice at AGAIN parameters: the points have to agree up to SAME times their
# extent.
AGAIN, SAME = 16, 1e-9


def patches_of(surface: Surface | AnySpline | str, cells: Sequence[int] | None) -> AnySpline:
    """Return a spline unchanged, or fit one to a surface or to a catalogue surface by its name.

    Raises InputError for `cells` with a spline.
    """
    if not isinstance(surface, AnySpline):
        return fit(surface, cells)
    if cells is not None:
        raise InputError("cells=... is for surfaces; this spline already has its cells.")
    return surface


def spline_of(surface: Surface | AnySpline | str, cells: Sequence[int] | None) -> Spline:
    """Return a spline on a grid of cells, see `patches_of`; InputError for a spline of nets."""
    return on_grid(patches_of(surface, cells))


@in_memory
def fit(
    surface: Surface | str,
    cells: Sequence[int] | None = None,
    *,
    tolerance: float | None = None,
    relative_tolerance: float | None = None,
    normal_tolerance: float | None = None,
    progress: bool = False,
) -> Spline:
    """Approximate a surface by a C¹ quadratic spline.

    The quasi-interpolant (paper, Sect. 3.1) is exact on quadratics. The error of positions falls
    with the third power of the cell size, that of normals with the second (13). The `misfit` of the
    spline is this error, measured at thousands of points that the fit does not use, among them
    hundreds on each of several lines along u and along v. A spline rounds the creases of a NURBS:
    fit its pieces one by one (see `Surface.pieces`).

    Collapsed sides of the domain become poles where the surface is smooth there, unless `periodic`
    gives their boundary condition (see `Surface.assumed_open`). At a pole the spline has one
    normal; in the few cells around it, errors of normals fall only with the first power of the cell
    size.

    Parameters
    ----------
    surface : Surface or str
        The surface, or its name in the catalogue (see `gaussmap.surfaces`).
    cells : (int, int), optional
        The numbers of cells along u and v, at least 3. By default, one cell between any four
        neighbouring points of a grid; else 64 × 64 or more, see Notes.
    tolerance : float, optional
        Instead of `cells`: the largest distance between surface and spline, in L. The numbers of
        cells along u and v are doubled until it is reached.
    relative_tolerance : float, optional
        The same, relative to the diagonal of the bounding box of the surface.
    normal_tolerance : float, optional
        The largest angle between the normals of surface and spline, in degrees, from 0.0001 to 90.
        Alone, it goes with a relative tolerance of 1e-4.
    progress : bool, default False
        Show progress on a terminal, after the first second.

    Returns
    -------
    Spline
        The spline, with four quadratic patches in each cell. Its `misfit` is its distance from the
        surface.

    Raises
    ------
    InputError
        For unusable `cells`, or more of them than a narrow domain can hold; for a tolerance that is
        not positive, is below the rounding of the coordinates, or is given together with `cells`.
    UnknownNameError
        If there is no surface of that name.
    SurfaceError
        If the surface cannot be evaluated, or does not close where its boundary conditions say so.

    Warns
    -----
    GaussmapWarning
        If a tolerance is not reached with 4096 cells along u or v, with 2²⁰ cells in all, or with
        one cell between any four points of a grid; or if the default misses its goal by a factor
        of ten.

    Notes
    -----
    By default, cells are increased from 64 × 64 until the distance is 1e-4 of the diagonal, and the
    angle, except next to poles, 0.1°: up to 1024 cells along u or v, and 2¹⁶ in all. If doubling
    the cells does not reduce the error, as at creases, the smaller number is kept.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.fit("torus", (16, 16))
    Spline(16 × 16 cells of torus)
    >>> spline = gm.fit("cylinder", tolerance=1e-4)
    >>> spline
    Spline(32 × 8 cells of cylinder)
    >>> spline.misfit.distance < 1e-4
    True

    """
    asked = checked_tolerance(cells, tolerance, relative_tolerance, normal_tolerance)
    surface = named(surface)
    if not isinstance(surface, Surface):
        raise InputError(
            f"a Surface or its name is needed, not {type(surface).__name__}; "
            f"{about_value(surface)}."
        )
    _check_repeated(surface)
    surface, apexes = with_found_sides(surface)
    with busy(f"fitting {short_label(surface.name)}", progress):
        if surface.grid is not None:
            spline = _fit_data(surface, surface.grid, cells, asked)
        elif cells is None:
            spline = _fit_to(surface, asked)
        else:
            spline = _fitted(surface, cells)
            misfit = probe_of(surface, spline.cells).compare(spline).misfit
            spline = replace(spline, misfit=misfit)
    trim = spline.trim or _trim_of(surface, spline, finest=cells is None)
    return replace(spline, trim=trim, apexes=apexes, georeference=surface.georeference)


def _fit_to(surface: Surface, asked: Tolerance | None) -> Spline:
    """Return a spline of a surface within a tolerance; None stands for the default tolerance."""
    spline = _fitted(surface, DEFAULT_CELLS if asked is None else FEWEST_CELLS)
    probe = probe_of(surface, DEFAULT_CELLS)
    goal = (asked or DEFAULT).of_size(probe.diagonal, probe.largest)
    # A domain that is narrow relative to the size of its parameters has fewer cells.
    most = [
        min(most, max(int((high - low) / np.spacing(max(-low, high)) / 8.0), 64))
        for (low, high), most in zip(surface.domain, goal.most, strict=True)
    ]
    spline, misfit, reached = refined(
        partial(_fitted, surface),
        probe.compare,
        partial(variation, surface),
        spline,
        replace(goal, most=(most[0], most[1])),
    )
    if not reached and (asked is not None or misfit.distance > FAR_OFF * (goal.distance or 0.0)):
        _warn(spline, misfit, "the tolerance" if asked else "the accuracy of the default")
    return replace(spline, misfit=misfit)


def _fit_data(
    surface: Surface,
    grid: NDArray[np.float64],
    cells: Sequence[int] | None,
    asked: Tolerance | None,
) -> Spline:
    """Return the spline of a grid of points, by default with a cell for any four neighbours."""
    if asked is None:
        spline = _fitted(surface, cells) if cells is not None else _finest(surface, grid)
        spline = replace(spline, trim=_trim_of(surface, spline, finest=cells is None))
        misfit = compare_with_data(spline, grid, surface.boundary, spline.trim).misfit
    else:
        spline, misfit = _fit_data_to(surface, grid, asked)
    return replace(spline, misfit=misfit)


def _trim_of(surface: Surface, spline: Spline, finest: bool) -> Trim | None:
    """Return the trim of the spline of a surface.

    Patches of a coarse spline of a grid are left out if they depend on missing points.
    """
    trim, grid = surface.trim, surface.grid
    if trim is None or grid is None or not np.isnan(grid).any():
        return trim
    if finest and spline.cells == cells_between(grid.shape, surface.boundary):
        return trim
    known = known_of_values(trim.parts[0].contains, spline.domain, spline.boundary, spline.cells)
    return trimmed(trim, trim.domain, trim.boundary, known)


def _fit_data_to(
    surface: Surface, grid: NDArray[np.float64], asked: Tolerance
) -> tuple[Spline, Misfit]:
    """Return a spline of a grid of points within a tolerance, and its misfit to the points."""
    if asked.angle is not None:
        raise InputError("normal_tolerance=... is for surfaces; data have no normals.")
    extent = np.nanmax(grid, axis=(0, 1)) - np.nanmin(grid, axis=(0, 1))
    goal = asked.of_size(float(np.hypot.reduce(extent)), float(np.nanmax(np.abs(grid))))
    most = cells_between(grid.shape, surface.boundary)

    def fitted(cells: tuple[int, int]) -> Spline:
        return _finest(surface, grid) if cells == most else _fitted(surface, cells)

    def compare(spline: Spline) -> Comparison:
        return compare_with_data(spline, grid, surface.boundary, surface.trim)

    spline, misfit, reached = refined(
        fitted,
        compare,
        partial(variation, surface),
        fitted((min(FEWEST_CELLS[0], most[0]), min(FEWEST_CELLS[1], most[1]))),
        replace(goal, most=most, total=most[0] * most[1]),
    )
    if not reached:
        spline = fitted(most)
        misfit = compare(spline).misfit
        _warn(spline, misfit, "the tolerance")
    return spline, misfit


def _finest(surface: Surface, grid: NDArray[np.float64]) -> Spline:
    """Return the spline with one cell between any four neighbouring points."""
    return fit_grid(grid, surface.domain, surface.boundary, surface.name)


def _warn(spline: Spline, misfit: Misfit, what: str) -> None:
    m, n = spline.cells
    normals = "" if misfit.angle is None else f", and its normals within {misfit.angle:.3g}°"
    warnings.warn(
        f"surface {spline.name!r}: {what} is not reached; the best spline found, of {m} x {n} "
        f"cells, is within {misfit.distance:.3g}{normals}.",
        GaussmapWarning,
        stacklevel=5,
    )


def _fitted(surface: Surface, cells: Sequence[int]) -> Spline:
    """Return the quasi-interpolant of a surface, from values at the centres and vertices of cells.

    Values that are missing outside of a trim are extrapolated.
    """

    def evaluate(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        return not_too_large(surface.evaluate(u, v), surface.name)

    values = values_at(evaluate, surface.domain, checked_cells(cells))
    close_seams(surface, values.vertices)
    domain, boundary, trim = surface.domain, surface.boundary, surface.trim
    if trim is None or all(np.isfinite(x).all() for x in values[:2]):
        return fit_values(values, domain, boundary, surface.name)
    # The callable has no values at some parameters outside of the trim.
    values = values.filled_by(continued)
    known = known_of(*from_values(values), domain, boundary)
    spline = fit_values(values.filled_by(completed), domain, boundary, surface.name)
    return replace(spline, trim=trimmed(trim, trim.domain, trim.boundary, known))


def _check_repeated(surface: Surface) -> None:
    """Raise SurfaceError if a user's callable returns other points when called again."""
    if surface.grid is not None or isinstance(surface.function, Differentiable):
        return
    u, v = places_in(surface.domain, AGAIN)
    label = f"the callable of surface {surface.name!r}"
    first, second = (returned(surface.function, (u, v), (3,), label) for _ in range(2))
    known = first[np.isfinite(first).all(axis=1)]
    size = float(np.ptp(known, axis=0).max()) if len(known) else 0.0
    with np.errstate(invalid="ignore"):
        same = (np.abs(first - second) <= SAME * size) | (np.isnan(first) & np.isnan(second))
    if not (same | (first == second)).all():
        k = int(np.argmin((same | (first == second)).all(axis=1)))
        raise SurfaceError(
            f"{label} must return the same points each time: at u = {u[k]}, v = {v[k]} they were "
            f"{first[k]}, then {second[k]}."
        )
