"""`parabolic_points`: where the Gaussian curvature of a spline or of a surface vanishes."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..checks import whole_number
from ..errors import GaussmapWarning, InputError
from ..spline import Spline, fit, spline_of
from ..surface import Surface
from .classes import PatchClass, classify_patches
from .curvature_field import CurvatureField
from .parabolic_spline import polylines_of
from .parabolic_surface import field_of, search
from .polylines import refined
from .rectangles import merged
from .saddles import critical_points

__all__ = ["ParabolicCurve", "ParabolicPoint", "ParabolicPoints", "parabolic_points"]

Array = NDArray[np.float64]
NEWTON_STEPS = 6
MOST_CELLS = 128
# A share of the domain that is worth a warning.
WORTH_A_WARNING = 1e-4


@dataclass(frozen=True, eq=False)
class ParabolicCurve:
    """A polyline of parabolic points: `uv` (k, 2) in the parameters, `points` (k, 3) in space.

    A closed curve repeats its first point at the end. In a periodic direction the parameters run on
    beyond the end of the domain, so that they do not jump.
    """

    uv: Array
    points: Array
    closed: bool

    def __repr__(self) -> str:
        return f"ParabolicCurve({'closed' if self.closed else 'open'}, {len(self.uv):,} vertices)"


@dataclass(frozen=True, eq=False)
class ParabolicPoint:
    """A place where the curvature touches zero without a change of sign.

    `uv` (2,) are its parameters, `point` (3,) its place in space. `box` (2, 2) holds the lowest and
    the highest parameters of the rectangle that isolates it; one that is longer than the tolerance
    holds whole curves of such points, or a closed curve too small to follow, or K is zero up to
    its error on all of it.
    """

    uv: Array
    point: Array
    box: Array


@dataclass(frozen=True, eq=False)
class ParabolicPoints:
    """The parabolic points of a surface.

    `curves` are those across which the Gaussian curvature changes its sign; they end at the
    border of the surface, at a "flip" seam, and where they meet or cross, and one may lie on the
    border. `isolated` are those where it only touches zero. `flat` (k, 2, 2) are rectangles of the
    parameter plane (lowest and highest corner) in which it vanishes up to its error; `developable`
    says that it does so everywhere.
    """

    curves: tuple[ParabolicCurve, ...]
    isolated: tuple[ParabolicPoint, ...]
    flat: Array
    developable: bool

    def __repr__(self) -> str:
        counts = f"{len(self.curves):,} curves, {len(self.isolated):,} isolated"
        whole = ", developable" if self.developable else ""
        return f"ParabolicPoints({counts}, {len(self.flat):,} flat rectangles{whole})"


def parabolic_points(
    surface: Surface | Spline,
    *,
    tolerance: float = 1e-4,
    cells: Sequence[int] | None = None,
) -> ParabolicPoints:
    """Find the parabolic points of a surface or a spline (paper, Sect. 3.2 and Remark 3.1).

    Of a `Spline`, and of a surface that was given by a grid of points, which is a spline: the lines
    inside patches and the edges across which the curvature changes its sign; they are exact.

    Of any other `Surface`: of the surface itself, which has to be smooth. It is interpolated on
    `cells` = (m, n) panels by polynomials of degree 15 and differentiated; without `cells` 8 × 8
    panels, or as many more as it takes, at most 64 × 64. The error of K is estimated: it is about
    1e-9 where the surface is resolved, and up to 1 % of K on the panel where it is not. Where K is
    less than its error, its sign is not used: such places are `flat`. Where K has a zero of a
    higher order, its place is known no better than K. Two curves that are nearer than one cell of a
    grid (1/16 of a panel) may be missed, and so may a crossing from which they part by less than a
    cell in 16. Parts of the domain where the curvature cannot be computed (a pole, a crease) are
    left out, with a GaussmapWarning if they are more than 0.01 % of it.

    `tolerance` is relative to the size of the surface and of its domain: so far may polylines be
    from the curves in space, and so small are the rectangles that isolate points. Raises InputError
    unless it lies between 1e-7 and 0.1, for unusable `cells`, and for `cells` beside a spline;
    SurfaceError if the surface cannot be evaluated.
    """
    limit = _tolerance(tolerance)
    if isinstance(surface, Spline):
        return _of_spline(spline_of(surface, cells), limit)
    if not isinstance(surface, Surface):
        raise InputError(
            f"parabolic_points takes a Surface or a Spline, not {type(surface).__name__}."
        )
    if surface.grid is not None:
        return _of_spline(fit(surface, cells), limit)
    return _of_surface(surface, limit, _panels(cells))


def _of_spline(spline: Spline, tolerance: float) -> ParabolicPoints:
    classes = classify_patches(spline).reshape(-1, 4)
    curves = []
    size = tolerance * _size(spline.coefficients[1:-1, 1:-1].reshape(-1, 3))
    for uv, closed in polylines_of(spline):
        finer = refined(uv, lambda x: _evaluated(spline, x), size, lambda x: x)
        curves.append(ParabolicCurve(finer, _evaluated(spline, finer), closed))
    flat = np.isin(classes, (PatchClass.PLANAR, PatchClass.DEVELOPABLE, PatchClass.SINGULAR))
    i, j = np.divmod(np.flatnonzero(flat.all(axis=1)), spline.cells[1])
    corners = np.stack([[i, j], [i + 1, j + 1]]).transpose(2, 0, 1)
    boxes = spline.frame[:2] + corners * spline.frame[2:]
    return ParabolicPoints(tuple(curves), (), merged(boxes), bool(flat.all()))


def _of_surface(
    surface: Surface, tolerance: float, panels: tuple[int, int] | None
) -> ParabolicPoints:
    field = field_of(surface, panels)
    extent = np.array([high - low for low, high in surface.domain])
    found = search(field, 0.125 * tolerance * extent)
    if found.unresolved > WORTH_A_WARNING:
        warnings.warn(
            f"the curvature of {surface.name!r} cannot be computed on "
            f"{100.0 * found.unresolved:.3g} % of its domain (a pole, a crease, fine detail, or "
            "coordinates with too few digits), which is left out; the spline of the surface "
            "(`fit`) has parabolic points everywhere.",
            GaussmapWarning,
            stacklevel=3,
        )
    grid = surface.evaluate(*np.meshgrid(*(np.linspace(*ends, 17) for ends in surface.domain)))
    size = tolerance * _size(grid.reshape(-1, 3))
    limits = _limits(surface)
    curves = []
    for uv, closed in found.polylines:
        finer = refined(
            uv,
            lambda x: _evaluated(surface, x),
            size,
            lambda x: np.clip(_onto_curve(field, x), *limits),
        )
        curves.append(ParabolicCurve(finer, _evaluated(surface, finer), closed))
    isolated = []
    for box in found.boxes:
        uv = _lowest(field, box)
        isolated.append(ParabolicPoint(uv, _evaluated(surface, uv[None])[0], box))
    return ParabolicPoints(tuple(curves), tuple(isolated), found.flat, bool(field.flat.all()))


# --- places on the curves and points K = 0 --------------------------------------------------------


def _onto_curve(field: CurvatureField, places: Array) -> Array:
    """Move places (k, 2) along the gradient of K to where it vanishes, by Newton steps."""
    for _ in range(NEWTON_STEPS):
        K, slope = field.evaluate(places), field.gradient(places)
        square = np.einsum("kx,kx->k", slope, slope)
        step = np.divide(K, square, out=np.zeros_like(K), where=square > 0.0)
        places = places - step[:, None] * slope
    return places


def _lowest(field: CurvatureField, box: Array) -> Array:
    """Return the place in a rectangle where the gradient of K vanishes, else its middle."""
    middle = box.mean(axis=0)
    place = critical_points(field, middle[None], box[1] - box[0])
    inside = ((box[0] <= place[0]) & (place[0] <= box[1])).all()
    return place[0] if inside else middle


# --- arguments and evaluation ---------------------------------------------------------------------


def _evaluated(surface: Surface | Spline, uv: Array) -> Array:
    """Return the points (k, 3) at parameters (k, 2), which may lie beyond a periodic end."""
    inside = uv.copy()
    for axis, ((low, high), ends) in enumerate(zip(surface.domain, surface.ends, strict=True)):
        if ends[0] == "wrap":
            inside[:, axis] = low + np.mod(inside[:, axis] - low, high - low)
    return surface.evaluate(inside[:, 0], inside[:, 1])


def _limits(surface: Surface) -> tuple[Array, Array]:
    """Return the lowest and highest parameters, infinite where the surface is periodic."""
    pairs = [
        (-np.inf, np.inf) if ends[0] == "wrap" else domain
        for domain, ends in zip(surface.domain, surface.ends, strict=True)
    ]
    low, high = np.array(pairs).T
    return low, high


def _size(points: Array) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _tolerance(tolerance: float) -> float:
    try:
        value = float(tolerance)
    except (TypeError, ValueError):
        raise InputError(f"tolerance must be a number, not {tolerance!r}.") from None
    if not 1e-7 <= value <= 0.1:
        raise InputError(f"tolerance must lie between 1e-7 and 0.1, and is {tolerance!r}.")
    return value


def _panels(cells: Sequence[int] | None) -> tuple[int, int] | None:
    if cells is None:
        return None
    try:
        m, n = cells
    except (TypeError, ValueError):
        raise InputError(f"cells must be a pair of whole numbers (m, n), not {cells!r}.") from None
    m, n = whole_number(m, "cells[0]"), whole_number(n, "cells[1]")
    if max(m, n) > MOST_CELLS:
        raise InputError(f"at most {MOST_CELLS} x {MOST_CELLS} cells can be used, not {m} x {n}.")
    return m, n
