"""`parabolic_points`: the points of a spline or a surface with vanishing Gaussian curvature."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.checks import as_float, pair_of_cells
from ...runtime.base.errors import GaussmapWarning, InputError, shown
from ...runtime.base.wording import plural
from ...runtime.fitting.fit import fit, spline_of
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from .classes import PatchClass, classify_patches
from .critical_points import critical_zeros
from .curvature import Curvature
from .image_curve import ImageCurve, Traced, followed, jets_of_spline
from .parabolic_spline import polylines_of
from .rectangles import merged
from .sign_grid import SignGrid
from .zero_curves import zero_curves

__all__ = [
    "ParabolicPoint",
    "ParabolicPoints",
    "checked_tolerance",
    "parabolic_points",
    "size_of_spline",
    "traced_curves",
]

# The numbers of cells of the grid along u and v. It is refined where curves are closer to each
# other than a cell, or smaller, and where more than this share of its cells contains curves.
CELLS, MOST_CELLS, CROWDED = 128, 512, 1 / 8
# The least share of the domain without curvature that gets a warning.
WORTH_A_WARNING = 1e-4
# Isolated zeros of K whose cells are this close are one.
TOGETHER = 4
# Derivatives of K below this bound count as zero: along the direction in which the normal is
# constant, relative to the gradient of K (so on curves with one normal, such as the top circle of a
# torus); and the gradient itself, relative to its maximum on the curve, where curves cross.
NO_CHANGE = 1e-6


@dataclass(frozen=True, eq=False)
class ParabolicPoint:
    """A point at which the curvature touches zero without a change of sign.

    Attributes
    ----------
    uv : (2,) float64 array
        The parameters of the point.
    point : (3,) float64 array
        The point in space.
    box : (2, 2) float64 array
        Lowest and highest parameters of the rectangle that isolates it. If the rectangle is longer
        than the tolerance, it contains a curve of such points, or a closed curve too small to
        trace, or K is zero up to its error on all of it.

    Examples
    --------
    >>> import gaussmap as gm
    >>> f = ("u", "v", "u**4 + u**2*v**2 + v**4")
    >>> bowl = gm.Surface.from_sympy(f, ("u", "v"), domain=((-1, "9/10"), (-1, "9/10")))
    >>> place, = gm.gauss_map.parabolic_points(bowl).isolated
    >>> place.uv.round(3) + 0.0, place.point.round(3) + 0.0
    (array([0., 0.]), array([0., 0., 0.]))
    >>> bool((place.box[0] <= place.uv).all() and (place.uv <= place.box[1]).all())
    True

    """

    uv: Array
    point: Array
    box: Array = field(repr=False)


@dataclass(frozen=True, eq=False)
class ParabolicPoints:
    """The parabolic points of a surface.

    Attributes
    ----------
    curves : tuple of ImageCurve
        Curves across which the Gaussian curvature changes its sign. They end at the boundary of the
        surface, at a "mirrored" seam, and where they meet or cross; one may lie on the boundary.
    isolated : tuple of ParabolicPoint
        Points at which the curvature touches zero without a change of sign.
    flat : (k, 2, 2) float64 array
        Rectangles of the parameter plane (lowest and highest corner) in which the curvature
        vanishes up to its error.
    developable : bool
        Whether the curvature vanishes up to its error everywhere.

    Examples
    --------
    >>> import gaussmap as gm
    >>> found = gm.gauss_map.parabolic_points("torus")
    >>> found
    ParabolicPoints(2 curves, 0 isolated, 0 flat rectangles)
    >>> len(found.curves), len(found.isolated), len(found.flat), found.developable
    (2, 0, 0, False)

    """

    curves: tuple[ImageCurve, ...]
    isolated: tuple[ParabolicPoint, ...]
    flat: Array
    developable: bool

    def __repr__(self) -> str:
        counts = f"{plural(len(self.curves), 'curve')}, {len(self.isolated):,} isolated"
        whole = ", developable" if self.developable else ""
        return f"ParabolicPoints({counts}, {plural(len(self.flat), 'flat rectangle')}{whole})"


def parabolic_points(
    surface: Surface | Spline | str,
    *,
    tolerance: float = 1e-4,
    cells: Sequence[int] | None = None,
) -> ParabolicPoints:
    """Find the parabolic points of a surface or a spline (paper, Sect. 3.2 and Remark 3.1).

    Parameters
    ----------
    surface : Surface, Spline or str
        For a `Spline`, and a surface given by a grid of points, which is a spline, the result
        consists of exact lines inside patches and the edges across which the curvature changes its
        sign. Any other `Surface` must be smooth; its own curvature is used.
    tolerance : float, default 1e-4
        Largest distance of polylines from the curves in space, and largest size of the rectangles
        that isolate points, relative to the size of the surface and of its domain; 1e-7 to 0.1.
    cells : pair of int, optional
        The least numbers (m, n) of cells of the grid whose signs of K locate the curves, at most
        512 each; the grid has at least 128 × 128. For a grid of points, the cells of its spline
        (see `fit`).

    Returns
    -------
    ParabolicPoints
        Curves across which K changes its sign, isolated zeros of K, and flat rectangles.

    Raises
    ------
    InputError
        For a tolerance out of range, invalid `cells`, `cells` together with a spline, or any other
        object than a surface or a spline.
    SurfaceError
        If the surface cannot be evaluated.

    Warns
    -----
    GaussmapWarning
        If the curvature cannot be computed on more than 0.01 % of the domain, such as where the
        surface is singular; these parts are left out.

    Notes
    -----
    The signs of K at the nodes of a grid locate the curves; each vertex is then moved to a zero of
    K. Newton's method finds the critical points of K where it is zero: curves cross there, or K
    touches zero. Where curves are closer to each other than a cell, or closed and smaller, the grid
    is refined to at most 512 × 512 cells. Curves that are still too small become `isolated` points,
    and those too close may be joined wrongly; a pair of small curves within one cell can be missed.

    K is computed from the derivatives of the surface, or of the NumPy functions that a callable is
    made of. Other callables are differentiated by finite differences, with an estimate of the error
    of K. Where K is less than its error, its sign is not used: such rectangles are `flat`.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.gauss_map.parabolic_points(gm.surfaces.torus())
    ParabolicPoints(2 curves, 0 isolated, 0 flat rectangles)

    """
    limit, surface = checked_tolerance(tolerance), named(surface)
    if isinstance(surface, Surface) and surface.grid is not None:
        surface, cells = fit(surface, cells), None
    if isinstance(surface, Spline):
        return _of_spline(spline_of(surface, cells), limit)
    if not isinstance(surface, Surface):
        raise InputError(
            f"parabolic_points takes a Surface or a Spline, not {type(surface).__name__}."
        )
    return _Zeros(surface, limit, _checked_cells(cells)).points()


def traced_curves(surface: Surface | Spline, tolerance: float) -> list[Traced]:
    """Return the curves of `parabolic_points`, in a form that can be refined."""
    if isinstance(surface, Spline):
        return _curves_of_spline(surface, classify_patches(surface), tolerance)
    return _Zeros(surface, tolerance, (CELLS, CELLS)).curves()


# --- splines --------------------------------------------------------------------------------------


def _of_spline(spline: Spline, tolerance: float) -> ParabolicPoints:
    classes = classify_patches(spline)
    curves = _curves_of_spline(spline, classes, tolerance)
    flat = np.isin(classes, (PatchClass.PLANAR, PatchClass.DEVELOPABLE, PatchClass.SINGULAR))
    cells = np.flatnonzero(flat.reshape(-1, 4).all(axis=1))
    i, j = np.divmod(cells, spline.cells[1])
    corners = np.stack([[i, j], [i + 1, j + 1]]).transpose(2, 0, 1)
    boxes = spline.frame[:2] + corners * spline.frame[2:]
    return ParabolicPoints(tuple(x.curve for x in curves), (), merged(boxes), bool(flat.all()))


def _curves_of_spline(spline: Spline, classes: NDArray[np.int8], tolerance: float) -> list[Traced]:
    jets, size = jets_of_spline(spline), size_of_spline(spline)
    return [followed(uv, jets, size, tolerance) for uv in polylines_of(spline, classes)]


def size_of_spline(spline: Spline) -> float:
    """Return the diagonal of the bounding box of the coefficients."""
    points = spline.coefficients[1:-1, 1:-1].reshape(-1, 3)
    return math.hypot(*np.ptp(points, axis=0))


# --- surfaces -------------------------------------------------------------------------------------


class _Zeros:
    """The zeros of K of a surface."""

    def __init__(self, surface: Surface, tolerance: float, cells: tuple[int, int]) -> None:
        self.surface, self.tolerance, self.curvature = surface, tolerance, Curvature(surface)
        # Curves closer than this, relative to the domain, cross or are a point.
        self.size = 0.125 * tolerance
        while True:
            self.grid = SignGrid(self.curvature, cells)
            finer = 2 * cells[0], 2 * cells[1]
            if self.grid.crossed.mean() <= CROWDED or max(finer) > MOST_CELLS:
                self.critical = critical_zeros(self.grid, self.size)
                if not self.critical.unclear or max(finer) > MOST_CELLS:
                    break
            cells = finer

    def points(self) -> ParabolicPoints:
        """Return the result of `parabolic_points`; warn if K is unknown on a part of the domain."""
        grid = self.grid
        unknown = float(grid.areas[grid.unknown].sum())
        if unknown > WORTH_A_WARNING:
            warnings.warn(
                f"the curvature of {self.surface.name!r} cannot be computed on "
                f"{100.0 * unknown:.3g} % of its domain, which is left out; the spline of the "
                "surface (`fit`) has parabolic points everywhere.",
                GaussmapWarning,
                stacklevel=3,
            )
        curves = tuple(x.curve for x in self.curves())
        whole = bool(grid.flat.all())
        return ParabolicPoints(curves, self._isolated(), merged(grid.rectangles(grid.flat)), whole)

    def curves(self) -> list[Traced]:
        """Return the curves across which K changes its sign."""
        K = self.curvature
        return [
            followed(uv, K.jets, K.size, self.tolerance, K.onto_zeros, self._with_cusps)
            for uv in zero_curves(self.grid, self.critical.saddles)
        ]

    def _isolated(self) -> tuple[ParabolicPoint, ...]:
        """Return the isolated zeros of K, one for each cluster, with boxes."""
        from scipy.ndimage import label, maximum_filter

        touched, reach = self.critical.touched, self.critical.reach
        cells = self.grid.cells_at(touched)
        here = np.zeros(self.grid.flat.shape, dtype=bool)
        here[cells] = True
        groups = np.zeros(here.shape, dtype=np.int64)
        label(maximum_filter(here, 2 * TOGETHER + 1), output=groups)
        found = []
        for k in range(1, groups.max(initial=0) + 1):
            own = groups[cells] == k
            box = np.stack([(touched - reach)[own].min(axis=0), (touched + reach)[own].max(axis=0)])
            middle = np.abs(touched[own] - box.mean(axis=0)).max(axis=1).argmin()
            place = touched[own][middle]
            box = np.clip(box, self.curvature.low, self.curvature.high)
            found.append(ParabolicPoint(place, self.curvature.jets(place[None])[0, 0], box))
        return tuple(found)

    def _with_cusps(self, uv: Array) -> tuple[Array, Indices]:
        """Return a curve (k, 2) with the cusps of its image as vertices, and the indices of these.

        At a cusp, the derivative of K along the direction in which the normal is constant vanishes
        and changes its sign.
        """
        change, along = self._change(uv)
        known = np.flatnonzero(np.abs(change) > NO_CHANGE)
        cusps, new = list[int](), dict[int, Array]()
        for i, j in pairwise(known.tolist()):
            turns = np.prod(np.sign(np.einsum("kx,kx->k", along[i:j], along[i + 1 : j + 1])))
            if change[i] * change[j] * turns > 0.0:
                continue
            if j == i + 1:
                new[j] = self._cusp_between(uv[i], uv[j], along[i])
            cusps.append(i + 1 + sum(x <= i for x in new))
        places = np.fromiter(new, np.int64, len(new))
        values = np.reshape(list(new.values()), (-1, 2))
        return np.insert(uv, places, values, axis=0), np.array(cusps, dtype=np.int64)

    def _cusp_between(self, start: Array, end: Array, before: Array) -> Array:
        """Return the cusp (2,) between two vertices."""
        from scipy.optimize import brentq

        def place(share: float) -> Array:
            return self.curvature.onto_zeros(start[None] + share * (end - start))

        def value(share: float) -> float:
            change, along = self._change(place(share))
            return float(change[0] * np.sign(along[0] @ before))

        return place(float(brentq(value, 0.0, 1.0, xtol=1e-12)))[0]  # pyright: ignore[reportArgumentType]

    def _change(self, uv: Array) -> tuple[Array, Array]:
        """Return the derivative (k,) of K along the direction in which the normal is constant.

        It is relative to the length of the gradient of K. Also returns the direction (k, 2),
        relative to the domain.
        """
        _, gradient, _ = self.curvature.derivatives(uv)
        u, v = self.curvature.extent
        e, f, g = self.curvature.at(uv).second_form.T * [[u * u], [u * v], [v * v]]
        along = np.where(np.abs(e) > np.abs(g), [-f, e], [g, -f]).T
        with np.errstate(invalid="ignore"):
            along = along / np.linalg.norm(along, axis=1, keepdims=True)
            size = np.linalg.norm(gradient, axis=1)
            changes = np.einsum("kx,kx->k", gradient, along) / size
            changes = np.where(size > NO_CHANGE * np.nanmax(size), changes, 0.0)
        return np.nan_to_num(changes), np.nan_to_num(along)


# --- arguments ------------------------------------------------------------------------------------


def checked_tolerance(tolerance: float) -> float:
    """Return a tolerance of curves; InputError if it is out of range."""
    try:
        value = as_float(tolerance)
    except TypeError:
        raise InputError(f"tolerance must be a number, not {shown(tolerance)}.") from None
    if not 1e-7 <= value <= 0.1:
        raise InputError(f"tolerance must lie between 1e-7 and 0.1, and is {shown(tolerance)}.")
    return value


def _checked_cells(cells: Sequence[int] | None) -> tuple[int, int]:
    m, n = (CELLS, CELLS) if cells is None else pair_of_cells(cells)
    if max(m, n) > MOST_CELLS:
        raise InputError(f"at most {MOST_CELLS} x {MOST_CELLS} cells can be used, not {m} x {n}.")
    return max(m, CELLS), max(n, CELLS)
