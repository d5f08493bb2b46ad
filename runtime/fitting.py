"""From a surface to the spline that approximates it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .collapsed import found_sides
from .domain import Domain
from .errors import InputError, SurfaceError, in_memory
from .ghosts import Sides
from .misfit import misfit_to_data, probe_of
from .missing import known_of_values
from .quasi_interpolant import apart, checked_cells, fit_grid, fit_values, not_too_large
from .spline import Spline
from .surface import Surface
from .surfaces import named

__all__ = ["DEFAULT_CELLS", "fit", "spline_of"]

DEFAULT_CELLS = (64, 64)


def spline_of(
    surface: Surface | Spline | str, cells: Sequence[int] | None, dtype: DTypeLike = np.float64
) -> Spline:
    """Return a spline unchanged, or the spline of a surface or of a surface's name.

    Raises InputError for `cells` with a spline; SurfaceError if its points are beyond the range of
    `dtype`.
    """
    if isinstance(surface, Spline) and cells is not None:
        raise InputError("cells=... is for surfaces; this spline already has its cells.")
    spline = surface if isinstance(surface, Spline) else fit(surface, cells)
    largest, limits = float(np.abs(spline.coefficients).max()), np.finfo(np.zeros(0, dtype).dtype)
    if not float(limits.tiny) <= largest <= float(limits.max) and largest > 0.0:
        raise SurfaceError(
            f"the coordinates of {spline.name!r} are too {'large' if largest > 1.0 else 'small'} "
            f"for {limits.dtype}; choose another unit of length or dtype=numpy.float64."
        )
    return spline


@in_memory
def fit(surface: Surface | str, cells: Sequence[int] | None = None) -> Spline:
    """Approximate a surface by a C¹ quadratic spline.

    The quasi-interpolant (paper, Sect. 3.1) is exact on quadratics. The error of positions falls
    with the third power of the cell size, that of normals with the second (13). A spline rounds
    lines where the normal of a NURBS turns: fit its pieces one by one (see `Surface.pieces`).

    Parameters
    ----------
    surface : Surface or str
        The surface, or its name in the catalogue (see `gaussmap.surfaces`).
    cells : (int, int), optional
        The numbers of cells along u and v, at least 3. By default 64 × 64, or one cell between
        any four neighbouring points of a grid.

    Returns
    -------
    Spline
        The spline, with four quadratic patches in each cell. Its `misfit` tells how far it is from
        the surface.

    Raises
    ------
    InputError
        For unusable `cells`, and more of them than a narrow domain can hold.
    UnknownNameError
        If there is no surface of that name.
    SurfaceError
        If the surface cannot be evaluated, or does not close where its ends say so.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.fit("torus", (16, 16))
    Spline(16 × 16 cells of torus)

    """
    surface = named(surface)
    if not isinstance(surface, Surface):
        raise InputError(
            f"a Surface or its name is needed, not {type(surface).__name__}; make one by "
            "gm.Surface.from_callable, from_sympy, from_nurbs or from_grid."
        )
    sides = found_sides(surface)
    trim = surface.trim and surface.trim.with_boundary(sides.boundary)
    surface = replace(surface, boundary=sides.boundary, trim=trim)
    if surface.grid is not None:
        return replace(_fit_data(surface, surface.grid, cells), apexes=sides.apexes)
    spline = _fitted(surface, DEFAULT_CELLS if cells is None else cells)
    misfit = probe_of(surface, spline.cells).misfit(spline)
    return replace(spline, misfit=misfit, trim=surface.trim, apexes=sides.apexes)


def _fit_data(surface: Surface, grid: NDArray[np.float64], cells: Sequence[int] | None) -> Spline:
    """Return the spline of a grid of points, by default with one cell between any four of them."""
    spline = (
        fit_grid(grid, surface.domain, surface.boundary, surface.name)
        if cells is None
        else _fitted(surface, cells)
    )
    misfit = misfit_to_data(spline, grid, surface.boundary)
    trim = surface.trim
    if trim is not None and cells is not None and np.isnan(grid).any():
        known = known_of_values(
            trim.parts[0].contains, spline.domain, spline.boundary, spline.cells
        )
        trim = trim.and_(known)
    return replace(spline, misfit=misfit, trim=trim)


def _fitted(surface: Surface, cells: Sequence[int]) -> Spline:
    """Return the quasi-interpolant of a surface that can be evaluated anywhere."""
    m, n = checked_cells(cells)
    lines = _lines(surface.domain, m, n)
    centres, vertices = _values(surface, *lines)
    middles = _middles(surface, *lines)
    return fit_values(centres, vertices, middles, surface.domain, surface.boundary, surface.name)


def _values(
    surface: Surface, lines_u: NDArray[np.float64], lines_v: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Evaluate a surface at the centres (m, n, 3) and vertices (m + 1, n + 1, 3) of its cells.

    Vertices on a seam are made bitwise equal, so that the spline closes exactly.
    """
    centres = not_too_large(surface.evaluate(lines_u[1::2, None], lines_v[1::2]), surface.name)
    vertices = not_too_large(surface.evaluate(lines_u[::2, None], lines_v[::2]), surface.name)
    for axis, (along, ends) in enumerate(zip("uv", surface.boundary, strict=True)):
        rows = np.swapaxes(vertices, 0, axis)
        if ends[0] in ("periodic", "mirrored"):
            first = rows[0] if ends[0] == "periodic" else rows[0, ::-1].copy()
            if apart(rows[-1], first, vertices):
                raise SurfaceError(
                    f"surface {surface.name!r} does not close along {along}: its two ends must be "
                    f"the same{'' if ends[0] == 'periodic' else ', mirrored'}."
                )
            rows[-1] = first
        for end, place, row in zip(ends, surface.domain[axis], (0, -1), strict=True):
            if end == "pole" and apart(rows[row], rows[row, :1], vertices):
                raise SurfaceError(
                    f"surface {surface.name!r} has no pole at {along} = {place}: it is not "
                    "one point there."
                )
    return centres, vertices


def _middles(surface: Surface, lines_u: NDArray[np.float64], lines_v: NDArray[np.float64]) -> Sides:
    """Evaluate a surface in the middle of the edges at the ends of v, and at the ends of u."""
    at_v = not_too_large(surface.evaluate(lines_u[1::2], lines_v[[0, -1], None]), surface.name)
    at_u = not_too_large(surface.evaluate(lines_u[[0, -1], None], lines_v[1::2]), surface.name)
    return (at_v[0], at_v[1]), (at_u[0], at_u[1])


def _lines(domain: Domain, m: int, n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the parameters of the edges and middles of the cells, in turn, along u and v."""
    lines = []
    for along, (low, high), count in zip("uv", domain, (m, n), strict=True):
        line = low + (high - low) * (np.arange(2 * count + 1) / (2 * count))
        if not (np.diff(line) > 0.0).all():
            raise InputError(
                f"the domain of {along} is too narrow for {count} cells: ({low}, {high})."
            )
        lines.append(line)
    return lines[0], lines[1]
