"""`parabolic_points`: the points of a spline or a surface with vanishing Gaussian curvature."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...runtime.base.aliases import Array
from ...runtime.base.checks import as_float, pair_of_cells
from ...runtime.base.errors import InputError, shown
from ...runtime.base.wording import plural
from ...runtime.fitting.fit import fit, spline_of
from ...runtime.spline.nets import AnySpline
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from .image_curve import ImageCurve, Zeros
from .parabolic_spline import ZerosOfSpline
from .parabolic_surface import CELLS, MOST_CELLS, ZerosOfSurface
from .rectangles import merged


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
        than the tolerance, it contains a curve of such points or a closed curve too small to
        trace, or K is zero up to its error in the whole rectangle.

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
    surface: Surface | Spline | str, *, tolerance: float = 1e-4, cells: Sequence[int] | None = None
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
    if isinstance(surface, AnySpline):
        surface = spline_of(surface, cells)
    elif not isinstance(surface, Surface):
        raise InputError(
            f"parabolic_points takes a Surface or a Spline, not {type(surface).__name__}."
        )
    zeros = zeros_of(surface, limit, _checked_cells(cells))
    zeros.warn(stacklevel=3)
    isolated = [ParabolicPoint(uv, zeros.jets(uv[None])[0, 0], box) for uv, box in zeros.isolated()]
    curves = tuple(zeros.traced(uv, limit).curve for uv in zeros.polylines())
    flat = merged(zeros.flat, zeros.lines)
    return ParabolicPoints(curves, tuple(isolated), flat, bool(zeros.flat.all()))


def zeros_of(
    surface: Surface | Spline, tolerance: float, cells: tuple[int, int] = (CELLS, CELLS)
) -> Zeros:
    """Return the zeros of K, the points of `parabolic_points`."""
    if isinstance(surface, Spline):
        return ZerosOfSpline(surface)
    return ZerosOfSurface(surface, cells, 0.125 * tolerance)


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
