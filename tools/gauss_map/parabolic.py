"""`parabolic_points`: where the Gaussian curvature of a spline or of a surface vanishes."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...generated import gaussian_image as formulas
from ...runtime.base.checks import as_float, pair_of_cells
from ...runtime.base.errors import GaussmapWarning, InputError, shown
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.base.scales import scale_to_one
from ...runtime.domain.domain import brought_inside
from ...runtime.fitting.fit import fit, spline_of
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from .classes import PatchClass, classify_patches
from .curvature_field import CurvatureField
from .parabolic_spline import polylines_of
from .parabolic_surface import field_of, search
from .polylines import refined
from .rectangles import merged

__all__ = [
    "ParabolicCurve",
    "ParabolicPoint",
    "ParabolicPoints",
    "checked_tolerance",
    "curvature",
    "near_zeros",
    "onto_zeros",
    "parabolic_points",
    "points_of_field",
]

Array = NDArray[np.float64]
NEWTON_STEPS = 6
# K of the surface is compared at places this far apart, relative to the domain; curves of the field
# are nearer than that to those of the surface.
STEP, CHORD_STEPS = 1e-6, 2
MOST_CELLS = 128
# A share of the domain that is worth a warning.
WORTH_A_WARNING = 1e-4


@dataclass(frozen=True, eq=False)
class ParabolicCurve:
    """A polyline of parabolic points.

    Attributes
    ----------
    uv : (k, 2) float64 array
        Parameters of the vertices. In a periodic direction they continue beyond the end of the
        domain, without jumps.
    points : (k, 3) float64 array
        The vertices in space.
    closed : bool
        Whether the curve is closed; its last vertex then repeats the first.

    Examples
    --------
    >>> import gaussmap as gm
    >>> curve = gm.gauss_map.parabolic_points("torus").curves[0]
    >>> curve.closed, curve.uv.shape == (len(curve.points), 2)
    (True, True)

    """

    uv: Array
    points: Array
    closed: bool

    def __repr__(self) -> str:
        return f"ParabolicCurve({'closed' if self.closed else 'open'}, {len(self.uv):,} vertices)"


@dataclass(frozen=True, eq=False)
class ParabolicPoint:
    """A place where the curvature touches zero without a change of sign.

    Attributes
    ----------
    uv : (2,) float64 array
        Its parameters.
    point : (3,) float64 array
        The point in space.
    box : (2, 2) float64 array
        Lowest and highest parameters of the rectangle that isolates it. A rectangle longer than the
        tolerance contains a curve of such points, or a closed curve too small to trace, or K is
        zero up to its error on all of it.

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
    curves : tuple of ParabolicCurve
        Curves across which the Gaussian curvature changes its sign. They end at the border of the
        surface, at a "mirrored" seam, and where they meet or cross; one may lie on the border.
    isolated : tuple of ParabolicPoint
        Places where the curvature touches zero without a change of sign.
    flat : (k, 2, 2) float64 array
        Rectangles of the parameter plane (lowest and highest corner) in which it vanishes up to
        its error.
    developable : bool
        Whether it vanishes up to its error everywhere.

    Examples
    --------
    >>> import gaussmap as gm
    >>> found = gm.gauss_map.parabolic_points("torus")
    >>> found
    ParabolicPoints(2 curves, 0 isolated, 0 flat rectangles)
    >>> len(found.curves), len(found.isolated), len(found.flat), found.developable
    (2, 0, 0, False)

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
    surface: Surface | Spline | str,
    *,
    tolerance: float = 1e-4,
    cells: Sequence[int] | None = None,
) -> ParabolicPoints:
    """Find the parabolic points of a surface or a spline (paper, Sect. 3.2 and Remark 3.1).

    Parameters
    ----------
    surface : Surface, Spline or str
        Of a `Spline`, and of a surface given by a grid of points, which is a spline, exact lines
        inside patches and the edges across which the curvature changes its sign. Any other
        `Surface` has to be smooth; its own curvature is used.
    tolerance : float, default 1e-4
        Largest distance of polylines from the curves in space, and largest size of the rectangles
        that isolate points, relative to the size of the surface and of its domain; 1e-7 to 0.1.
    cells : pair of int, optional
        Numbers (m, n) of panels on which a smooth surface is interpolated, at most 128 each. By
        default 8 × 8, or as many as it takes to resolve the surface, at most 64 × 64. For a grid of
        points, the cells of its spline (see `fit`).

    Returns
    -------
    ParabolicPoints
        Curves across which K changes its sign, places where it only touches zero, flat rectangles.

    Raises
    ------
    InputError
        For a tolerance out of range, unusable `cells`, `cells` together with a spline, or anything
        but a surface or a spline.
    SurfaceError
        If the surface cannot be evaluated.

    Warns
    -----
    GaussmapWarning
        If the curvature cannot be computed on more than 0.01 % of the domain (a pole, a crease);
        these parts are left out.

    Notes
    -----
    A smooth surface is interpolated on each panel by polynomials of degree 15 and differentiated.
    The error of K is estimated: it is about 1e-9 where the surface is resolved, and up to 1 % of K
    on the panel where it is not. Where K is less than its error, its sign is not used: such places
    are `flat`. Zeros of K of higher order are located only as accurately as K is known.

    The signs of K on a grid of at least 128 × 128 cells, 8 × 8 or more for each panel, show the
    curves. Bounds of K tell where other curves may be; where they are closer to each other than a
    cell, or closed and smaller, the grid is refined to at most 512 × 512 cells. Those that are
    still smaller or closer are `isolated`, or may be joined wrongly.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.gauss_map.parabolic_points(gm.surfaces.torus())
    ParabolicPoints(2 curves, 0 isolated, 0 flat rectangles)

    """
    limit, surface = checked_tolerance(tolerance), named(surface)
    if isinstance(surface, Spline):
        return _of_spline(spline_of(surface, cells), limit)
    if not isinstance(surface, Surface):
        raise InputError(
            f"parabolic_points takes a Surface or a Spline, not {type(surface).__name__}."
        )
    if surface.grid is not None:
        return _of_spline(fit(surface, cells), limit)
    return points_of_field(surface, field_of(surface, _panels(cells)), limit)


def _of_spline(spline: Spline, tolerance: float) -> ParabolicPoints:
    classes = classify_patches(spline)
    curves = []
    scale = spline.scale
    size = tolerance * _size(spline.coefficients[1:-1, 1:-1].reshape(-1, 3) * scale)
    for uv, closed in polylines_of(spline, classes):
        finer = refined(uv, lambda x: scale * _evaluated(spline, x), size, lambda x: x)
        curves.append(ParabolicCurve(finer, _evaluated(spline, finer), closed))
    flat = np.isin(classes, (PatchClass.PLANAR, PatchClass.DEVELOPABLE, PatchClass.SINGULAR))
    cells = np.flatnonzero(flat.reshape(-1, 4).all(axis=1))
    i, j = np.divmod(cells, spline.cells[1])
    corners = np.stack([[i, j], [i + 1, j + 1]]).transpose(2, 0, 1)
    boxes = spline.frame[:2] + corners * spline.frame[2:]
    return ParabolicPoints(tuple(curves), (), merged(boxes), bool(flat.all()))


def points_of_field(surface: Surface, field: CurvatureField, tolerance: float) -> ParabolicPoints:
    """Return the parabolic points of a surface with this field of K; see `parabolic_points`."""
    extent = np.array([high - low for low, high in surface.domain])
    polylines, places, boxes, flat = search(field, 0.125 * tolerance * extent)
    unresolved = field.share(field.unresolved)
    if unresolved > WORTH_A_WARNING:
        warnings.warn(
            f"the curvature of {surface.name!r} cannot be computed on "
            f"{100.0 * unresolved:.3g} % of its domain (a pole, a crease, fine detail, or "
            "coordinates with too few digits), which is left out; the spline of the surface "
            "(`fit`) has parabolic points everywhere.",
            GaussmapWarning,
            stacklevel=3,
        )
    grid = surface.evaluate(*np.meshgrid(*(np.linspace(*ends, 17) for ends in surface.domain)))
    scale = scale_to_one(float(np.ptp(grid, axis=(0, 1)).max()))
    size = tolerance * _size(grid.reshape(-1, 3) * scale)
    curves = []
    for uv, closed in polylines:
        finer = refined(
            uv,
            lambda x: scale * _evaluated(surface, x),
            size,
            lambda x: near_zeros(surface, field, x),
        )
        finer = onto_zeros(surface, field, finer)
        curves.append(ParabolicCurve(finer, _evaluated(surface, finer), closed))
    isolated = map(ParabolicPoint, places, _evaluated(surface, places), boxes)
    return ParabolicPoints(tuple(curves), tuple(isolated), flat, bool(field.flat.all()))


# --- places on the curves K = 0 -------------------------------------------------------------------


def near_zeros(surface: Surface, field: CurvatureField, places: Array) -> Array:
    """Move places (k, 2) along the gradient of the field to where it vanishes, by Newton steps."""
    for _ in range(NEWTON_STEPS):
        K, slope = field.evaluate(places), field.gradient(places)
        square = np.einsum("kx,kx->k", slope, slope)
        step = np.divide(K, square, out=np.zeros_like(K), where=square > 0.0)
        places = places - step[:, None] * slope
    return np.clip(places, *_limits(surface))


def onto_zeros(surface: Surface, field: CurvatureField, places: Array) -> Array:
    """Move places (k, 2) close to curves K = 0 onto them, as far as the derivatives are exact.

    They move along the gradient of the field, by chord steps from one difference of K; those on the
    border of the domain along the border. Places without such a zero near by, as crossings and
    singular points, stay.
    """
    if surface.differences is not None:  # the field is as accurate
        return places
    extent = np.ptp(surface.domain, axis=1)
    low, high = _limits(surface)
    slope = field.gradient(places) * extent * ((low < places) & (places < high))
    with np.errstate(all="ignore"):
        along = extent * slope / np.linalg.norm(slope, axis=1, keepdims=True)
        K = curvature(surface, places)
        rate = (curvature(surface, places + STEP * along) - K) / STEP
        moved, share = places, np.zeros(len(places))
        for _ in range(CHORD_STEPS):
            share -= K / rate
            moved = places + share[:, None] * along
            K = curvature(surface, moved)
        near = np.abs(share) <= STEP
    inside = ((low <= moved) & (moved <= high)).all(axis=1)
    return np.where((near & inside)[:, None], moved, places)


def curvature(surface: Surface, places: Array) -> Array:
    """Return K (k,) of a surface at parameters (k, 2), which may lie beyond a periodic end."""
    u, v = places.T
    jets = surface.jets(*brought_inside(u, v, surface.domain, surface.boundary))
    K = python_function(formulas.gaussian_curvature_of_derivatives)
    return K(*(vector(jets[:, k]) for k in range(1, 6)))


# --- arguments and evaluation ---------------------------------------------------------------------


def _evaluated(surface: Surface | Spline, uv: Array) -> Array:
    """Return the points (k, 3) at parameters (k, 2), which may lie beyond a periodic end."""
    u, v = uv.T
    return surface.evaluate(*brought_inside(u, v, surface.domain, surface.boundary))


def _limits(surface: Surface) -> tuple[Array, Array]:
    """Return the lowest and highest parameters, infinite where the surface is periodic."""
    pairs = [
        (-np.inf, np.inf) if ends[0] == "periodic" else domain
        for domain, ends in zip(surface.domain, surface.boundary, strict=True)
    ]
    low, high = np.array(pairs).T
    return low, high


def _size(points: Array) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def checked_tolerance(tolerance: float) -> float:
    """Return a tolerance of curves; InputError if it is out of range."""
    try:
        value = as_float(tolerance)
    except TypeError:
        raise InputError(f"tolerance must be a number, not {shown(tolerance)}.") from None
    if not 1e-7 <= value <= 0.1:
        raise InputError(f"tolerance must lie between 1e-7 and 0.1, and is {shown(tolerance)}.")
    return value


def _panels(cells: Sequence[int] | None) -> tuple[int, int] | None:
    if cells is None:
        return None
    m, n = pair_of_cells(cells)
    if max(m, n) > MOST_CELLS:
        raise InputError(f"at most {MOST_CELLS} x {MOST_CELLS} cells can be used, not {m} x {n}.")
    return m, n
