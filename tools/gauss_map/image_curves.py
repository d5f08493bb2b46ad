"""Folds and borders of Gauss maps: the curves at whose images the number of points changes.

The Gauss map folds along the parabolic curves. Next to the image of one, a normal has two points on
one side and none on the other; next to the image of a border it has one and none. A fold has a cusp
where the direction in which the normal does not turn is tangent to the curve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.errors import InputError
from ...runtime.base.kept import kept
from ...runtime.directions.unit import as_normals
from ...runtime.domain.domain import brought_inside, closes
from ...runtime.domain.loops import Loops
from ...runtime.gauss_map import GaussMap
from ...runtime.place.on_spline import OnSpline
from .parabolic import (
    checked_tolerance,
    curvature,
    near_zeros,
    onto_zeros,
    parabolic_points,
    points_of_field,
)
from .parabolic_surface import field_of
from .polylines import distances, refined

__all__ = ["ImageCurve", "border_image", "folds", "margin"]

Array = NDArray[np.float64]
Onto = Callable[[Array], Array]

# The parts of a side of the domain, before it is refined.
PARTS_OF_SIDE = 16
# The change of K along the direction in which the normal does not turn, relative to its gradient,
# below which it is zero: on curves with one normal, such as the top circle of a torus. So is the
# gradient relative to the largest on the curve, where curves cross.
NO_CHANGE = 1e-6
# Parameters are moved by this part of a cell for differences of K.
STEP = 1e-4
# The tolerance of the curves to which angles are measured.
TOLERANCE = 1e-3
# Places this near to a border, relative to the domain, are on it. Curves whose ends are this near
# to each other, relative to their size, are closed.
ON_BORDER, CLOSED = 1e-9, 1e-6
# The nearest point of a curve is searched among this number of places, then among as many between
# the neighbours of the nearest one, and so on; at last between these, on chords.
PLACES, ROUNDS = 9, 5


@dataclass(frozen=True, eq=False)
class ImageCurve:
    """A curve of a surface at whose image the number of points with a normal changes.

    Attributes
    ----------
    uv : (k, 2) float64 array
        Parameters of the vertices. In a periodic direction they continue beyond the end of the
        domain, without jumps.
    points : (k, 3) float64 array
        The vertices in space, in L.
    normals : (k, 3) float64 array
        The unit normals there: the image.
    closed : bool
        Whether the curve is closed; its last vertex then repeats the first.
    cusps : (c,) int64 array
        Which vertices are cusps of the image of a fold.

    Examples
    --------
    >>> import gaussmap as gm
    >>> fold = gm.GaussMap("wavy_graph").folds()[0]
    >>> len(fold.uv) == len(fold.points) == len(fold.normals), fold.closed, fold.cusps.dtype
    (True, False, dtype('int64'))

    """

    uv: Array
    points: Array
    normals: Array
    closed: bool
    cusps: NDArray[np.int64]

    def __repr__(self) -> str:
        kind = "closed" if self.closed else "open"
        return f"ImageCurve({kind}, {len(self.uv):,} vertices, {len(self.cusps):,} cusps)"


@dataclass(frozen=True, eq=False)
class Tracing:
    """A curve of what is sampled; `onto` moves parameters (k, 2) on its chords to the curve."""

    curve: ImageCurve
    geometry: OnSpline
    onto: Onto

    def angles(self, normals: Array) -> Array:
        """Return the angles (S,), in radians, from normals to the image."""
        from scipy.spatial import KDTree

        uv, last = self.curve.uv, len(self.curve.uv) - 1
        nearest = KDTree(self.curve.normals).query(normals)[1]
        low, high = np.maximum(nearest - 1.0, 0.0), np.minimum(nearest + 1.0, last)
        image = np.empty((PLACES, len(normals), 3))
        for _ in range(ROUNDS):
            places = np.linspace(low, high, PLACES)
            index = np.minimum(places.astype(np.int64), last - 1)
            chord = uv[index] + (places - index)[..., None] * (uv[index + 1] - uv[index])
            found = _points_and_normals(self.geometry, self.onto(chord.reshape(-1, 2)))[1]
            image = found.reshape(*places.shape, 3)
            apart = np.nan_to_num(np.linalg.norm(image - normals, axis=2), nan=2.0)
            best = apart.argmin(axis=0)
            low, high = (
                np.take_along_axis(places, np.clip(best + x, 0, PLACES - 1)[None], axis=0)[0]
                for x in (-1, 1)
            )
        sides = [distances(normals, *ends) for ends in pairwise(image)]
        return 2.0 * np.arcsin(np.minimum(np.nanmin(sides, axis=0) / 2.0, 1.0))


def folds(self: GaussMap, *, tolerance: float = 1e-4) -> tuple[ImageCurve, ...]:
    """Return the folds of the Gauss map: the parabolic curves, and their images.

    Parameters
    ----------
    tolerance : float, default 1e-4
        Largest distance of polylines from the curves, in space relative to the size of the surface,
        and on the sphere in radians; 1e-7 to 0.1. Vertices are on the curves, as far as the
        derivatives of the surface are exact.

    Returns
    -------
    tuple of ImageCurve
        The curves, with a vertex at each cusp. On a spline they run along edges of patches.

    Raises
    ------
    InputError
        For a tolerance out of range, and for parts.

    See Also
    --------
    gaussmap.gauss_map.parabolic_points : also places where K touches zero, and flat regions.

    Examples
    --------
    >>> import gaussmap as gm
    >>> top, below = gm.GaussMap("torus").folds()
    >>> top.closed, abs(top.normals[:, 2]).min().round(12)
    (True, np.float64(1.0))

    """
    limit = checked_tolerance(tolerance)
    return tuple(x.curve for geometry in _geometries(self) for x in _folds(geometry, limit))


def border_image(self: GaussMap, *, tolerance: float = 1e-4) -> tuple[ImageCurve, ...]:
    """Return the borders of the surface, and their images.

    Parameters
    ----------
    tolerance : float, default 1e-4
        As in `folds`.

    Returns
    -------
    tuple of ImageCurve
        The open sides of the domain, and the loops of a trim, as far as they are borders.

    Raises
    ------
    InputError
        For a tolerance out of range, for parts, and for a trim by a predicate, whose border is not
        known.

    Examples
    --------
    >>> import gaussmap as gm
    >>> len(gm.GaussMap("torus").border_image()), len(gm.GaussMap("wavy_graph").border_image())
    (0, 4)

    """
    limit = checked_tolerance(tolerance)
    return tuple(x.curve for geometry in _geometries(self) for x in _borders(geometry, limit))


def margin(self: GaussMap, normals: ArrayLike) -> Array:
    """Return how far normals are from the next change of the number of their points.

    Parameters
    ----------
    normals : (S, 3) array_like
        Directions of any length but 0.

    Returns
    -------
    (S,) float64 array
        Angles, in degrees, to the nearest image of a fold or a border; infinite without any.

    Raises
    ------
    InputError
        For unusable normals, for parts, and for a trim by a predicate.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.GaussMap("torus").margin([[1, 0, 0], [0, 1, 1]]).round(6)
    array([90., 45.])

    """
    asked = as_normals(normals)
    found = np.full(len(asked), np.inf)
    for tracing in kept(self, margin, lambda: _tracings(self)):
        np.minimum(found, tracing.angles(asked), out=found)
    return np.degrees(found)


def _tracings(gauss_map: GaussMap) -> list[Tracing]:
    return [
        tracing
        for geometry in _geometries(gauss_map)
        for trace in (_folds, _borders)
        for tracing in trace(geometry, TOLERANCE)
    ]


def _geometries(gauss_map: GaussMap) -> Sequence[OnSpline]:
    if gauss_map._geometries is None:
        raise InputError(
            "folds, borders and margins are for surfaces, not for parts; take a face.surface."
        )
    return gauss_map._geometries


# --- folds ----------------------------------------------------------------------------------------


def _folds(geometry: OnSpline, tolerance: float) -> Iterator[Tracing]:
    """Yield the folds of what is sampled, those inside its trim."""
    surface = geometry.surface
    if surface is None:
        for curve in parabolic_points(geometry.spline, tolerance=tolerance).curves:
            for uv in _inside(geometry, curve.uv):
                yield _tracing(geometry, uv, lambda uv: uv)
        return
    field = field_of(surface, None)

    def onto(uv: Array) -> Array:
        return onto_zeros(surface, field, near_zeros(surface, field, uv))

    for curve in points_of_field(surface, field, tolerance).curves:
        for uv in _inside(geometry, curve.uv):
            uv, cusps = _with_cusps(geometry, _refined(geometry, uv, tolerance, onto), onto)
            yield _tracing(geometry, uv, onto, cusps)


def _with_cusps(geometry: OnSpline, uv: Array, onto: Onto) -> tuple[Array, NDArray[np.int64]]:
    """Return a fold (k, 2) with its cusps as vertices, and which these are.

    At a cusp, K does not change along the direction in which the normal does not turn; before and
    behind it, it changes by values of different sign.
    """
    change, along = _change_of_curvature(geometry, uv)
    known = np.flatnonzero(np.abs(change) > NO_CHANGE)
    cusps, new = list[int](), dict[int, Array]()
    for i, j in pairwise(known.tolist()):
        turns = np.prod(np.sign(np.einsum("kx,kx->k", along[i:j], along[i + 1 : j + 1])))
        if change[i] * change[j] * turns > 0.0:
            continue
        if j == i + 1:
            new[j] = _cusp_between(geometry, uv[i], uv[j], along[i], onto)
        cusps.append(i + 1 + sum(x <= i for x in new))
    places = np.fromiter(new, np.int64, len(new))
    values = np.reshape(list(new.values()), (-1, 2))
    return np.insert(uv, places, values, axis=0), np.array(cusps, dtype=np.int64)


def _cusp_between(geometry: OnSpline, start: Array, end: Array, before: Array, onto: Onto) -> Array:
    """Return the cusp (2,) between two vertices of a fold."""
    from scipy.optimize import brentq

    def place(share: float) -> Array:
        return onto(start[None] + share * (end - start))

    def value(share: float) -> float:
        change, along = _change_of_curvature(geometry, place(share))
        return float(change[0] * np.sign(along[0] @ before))

    return place(float(brentq(value, 0.0, 1.0, xtol=1e-12)))[0]  # pyright: ignore[reportArgumentType]


def _change_of_curvature(geometry: OnSpline, uv: Array) -> tuple[Array, Array]:
    """Return the change (k,) of K along the direction in which the normal does not turn, and this.

    The change is relative to the length of the gradient of K, the direction (k, 2) in cells.
    """
    surface, frame = geometry.surface, geometry.spline.frame
    assert surface is not None
    inside = np.stack(_brought_inside(geometry, uv), axis=1)
    forms = geometry.forms((inside - frame[:2]) / frame[2:])
    e, f, g = forms[:, 3:6].T
    along = np.where((e > g)[:, None], np.stack([-f, e], axis=1), np.stack([g, -f], axis=1))
    with np.errstate(invalid="ignore"):
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        across = along[:, ::-1] * [-1.0, 1.0]
        slopes = [
            curvature(surface, uv + step) - curvature(surface, uv - step)
            for step in (STEP * frame[2:] * x for x in (along, across))
        ]
        size = np.hypot(*slopes)
        change = np.where(size > NO_CHANGE * np.nanmax(size), slopes[0] / size, 0.0)
    return np.nan_to_num(change), np.nan_to_num(along)


# --- borders --------------------------------------------------------------------------------------


def _borders(geometry: OnSpline, tolerance: float) -> Iterator[Tracing]:
    """Yield the borders of what is sampled: open sides of the domain, and the loops of a trim."""
    for uv in [*_sides(geometry), *_loops(geometry)]:
        for part in _inside(geometry, uv):
            finer = _refined(geometry, part, tolerance, lambda uv: uv)
            yield _tracing(geometry, finer, lambda uv: uv)


def _sides(geometry: OnSpline) -> Iterator[Array]:
    """Yield the open sides of the domain, as polylines (k, 2) of the parameters."""
    spline = geometry.spline
    for axis, (ends, other) in enumerate(zip(spline.boundary, spline.domain[::-1], strict=True)):
        along = np.linspace(*other, PARTS_OF_SIDE + 1)
        for end, value in zip(ends, spline.domain[axis], strict=True):
            if end == "open":
                line = np.stack([np.full(len(along), value), along], axis=1)
                yield line if axis == 0 else line[:, ::-1]


def _loops(geometry: OnSpline) -> Iterator[Array]:
    """Yield the loops of the trim; InputError if it has other borders."""
    trim = geometry.spline.trim
    for part in () if trim is None else trim.parts:
        if not isinstance(part, Loops):
            raise InputError(
                f"the border of {geometry.spline.name!r} is not known: its trim is a predicate, or "
                "leaves out missing points; trim it by loops."
            )
        for polygon in part.polygons:
            yield np.concatenate([polygon, polygon[:1]])


# --- polylines ------------------------------------------------------------------------------------


def _inside(geometry: OnSpline, uv: Array) -> list[Array]:
    """Return the parts of a polyline (k, 2), two vertices or more, that are in or on the trim."""
    trim = geometry.spline.trim
    if trim is None:
        return [uv]
    low, high = np.array(geometry.spline.domain).T
    nudge = ON_BORDER * (high - low)
    near = np.stack([uv + nudge * x for x in ((-1, -1), (-1, 1), (1, -1), (1, 1))])
    inside = trim.contains(near.reshape(-1, 2)).reshape(4, -1).any(axis=0)
    inside &= ((uv >= low - nudge) & (uv <= high + nudge) | _closed(geometry)).all(axis=1)
    ends = np.flatnonzero(np.diff(inside, prepend=False, append=False)).reshape(-1, 2)
    return [uv[first:last] for first, last in ends if last > first + 1]


def _closed(geometry: OnSpline) -> NDArray[np.bool_]:
    return np.array([closes(ends) for ends in geometry.spline.boundary])


def _refined(geometry: OnSpline, uv: Array, tolerance: float, onto: Onto) -> Array:
    """Insert vertices until a polyline is near its curve and its image, relative to both sizes."""
    low, high = (f(geometry.spline.coefficients.reshape(-1, 3), axis=0) for f in (np.min, np.max))
    size = float(np.linalg.norm(high - low))

    def both(uv: Array) -> Array:
        points, normals = _points_and_normals(geometry, uv)
        return np.hstack([points / size, normals])

    return refined(uv, both, tolerance, onto)


def _tracing(
    geometry: OnSpline,
    uv: Array,
    onto: Onto,
    cusps: NDArray[np.int64] = np.empty(0, dtype=np.int64),  # noqa: B008 - it does not change
) -> Tracing:
    points, normals = _points_and_normals(geometry, uv)
    closed = bool(np.linalg.norm(points[0] - points[-1]) <= CLOSED * np.ptp(points, axis=0).max())
    return Tracing(ImageCurve(uv, points, normals, closed, cusps), geometry, onto)


def _points_and_normals(geometry: OnSpline, uv: Array) -> tuple[Array, Array]:
    """Return points and unit normals (k, 3) at parameters; NaN at singular points."""
    jets = geometry.jets(*_brought_inside(geometry, uv))
    normals = np.cross(jets[:, 1], jets[:, 2])
    with np.errstate(invalid="ignore"):
        return jets[:, 0], normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _brought_inside(geometry: OnSpline, uv: Array) -> tuple[Array, Array]:
    u, v = uv.T
    return brought_inside(u, v, geometry.spline.domain, geometry.spline.boundary)
