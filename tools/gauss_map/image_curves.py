"""Folds and boundary images of Gauss maps, where the number of points with a normal changes.

The Gauss map folds along the parabolic curves. Across the image of a fold, the number of points
with a normal changes by two; across the image of a boundary, by one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ...runtime.base.aliases import Array
from ...runtime.base.errors import InputError
from ...runtime.base.kept import kept
from ...runtime.directions.unit import as_normals
from ...runtime.domain.domain import closes
from ...runtime.domain.loops import Loops
from ...runtime.map import GaussMap
from ...runtime.onto_surface.on_spline import OnSpline, on_grids
from .curvature import Curvature
from .image_curve import Curves, ImageCurve, Traced, jets_of_spline
from .parabolic import checked_tolerance, traced_curves

# The number of segments of a side of the domain, before refinement.
PARTS_OF_SIDE = 16
# The tolerance of the curves to which angles are measured.
TOLERANCE = 1e-3
# Parameter pairs within this distance of a boundary, relative to the domain, count as points of the
# boundary.
ON_BORDER = 1e-9


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
        The curves, with a vertex at each cusp. On a spline, folds run along edges of patches.

    Raises
    ------
    InputError
        For a tolerance out of range, and for parts.

    See Also
    --------
    gaussmap.gauss_map.parabolic_points : the parabolic curves of a surface without its trim, with
        points where K touches zero, and flat regions.

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
    """Return the boundary curves of the surface, and their images.

    Parameters
    ----------
    tolerance : float, default 1e-4
        As in `folds`.

    Returns
    -------
    tuple of ImageCurve
        The open sides of the domain, and the loops of a trim, where they are boundaries.

    Raises
    ------
    InputError
        For a tolerance out of range, for parts, and for a trim by a predicate, whose boundary is
        unknown.

    Examples
    --------
    >>> import gaussmap as gm
    >>> len(gm.GaussMap("torus").border_image()), len(gm.GaussMap("wavy_graph").border_image())
    (0, 4)

    """
    limit = checked_tolerance(tolerance)
    return tuple(x.curve for geometry in _geometries(self) for x in _borders(geometry, limit))


def margin(self: GaussMap, normals: ArrayLike) -> Array:
    """Return the angles from normals to the nearest normals at which the number of points changes.

    Parameters
    ----------
    normals : (S, 3) array_like
        Directions of any length but 0.

    Returns
    -------
    (S,) float64 array
        Angles, in degrees, to the nearest image of a fold or a boundary; infinite if the surface
        has neither.

    Raises
    ------
    InputError
        For invalid normals, for parts, and for a trim by a predicate.

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


def _tracings(gauss_map: GaussMap) -> list[Traced]:
    return [
        tracing
        for geometry in _geometries(gauss_map)
        for trace in (_folds, _borders)
        for tracing in trace(geometry, TOLERANCE)
    ]


def _geometries(gauss_map: GaussMap) -> Sequence[OnSpline]:
    if not gauss_map._pieces:
        raise InputError(
            "folds, borders and margins are for surfaces, not for parts; take a face.surface."
        )
    return on_grids(gauss_map._fitted)


def _folds(geometry: OnSpline, tolerance: float) -> Iterator[Traced]:
    """Yield the folds of a geometry inside its trim."""
    for traced in traced_curves(geometry.surface or geometry.spline, tolerance):
        for ends in _inside(geometry, traced.curve.uv):
            yield traced.part(*ends)


def _borders(geometry: OnSpline, tolerance: float) -> Iterator[Traced]:
    """Yield the boundaries of a geometry: open sides of the domain, and the loops of a trim."""
    curves, surface = Curves(), geometry.surface
    curves.jets = Curvature(surface).jets if surface else jets_of_spline(geometry.spline)
    curves.size = geometry.spline.extent[0]
    for uv in [*_sides(geometry), *_loops(geometry)]:
        for first, last in _inside(geometry, uv):
            yield curves.traced(uv[first:last], tolerance)


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
    """Yield the loops of the trim; InputError if it has other boundaries."""
    trim = geometry.spline.trim
    for part in () if trim is None else trim.parts:
        if not isinstance(part, Loops):
            raise InputError(
                f"the border of {geometry.spline.name!r} is not known: its trim is a predicate, or "
                "leaves out missing points; trim it by loops."
            )
        for polygon in part.polygons:
            yield np.concatenate([polygon, polygon[:1]])


def _inside(geometry: OnSpline, uv: Array) -> list[tuple[int, int]]:
    """Return the parts of a polyline (k, 2) in or on the trim, each of two vertices or more.

    A part (first, last) has the vertices [first, last).
    """
    trim = geometry.spline.trim
    if trim is None:
        return [(0, len(uv))]
    low, high = np.array(geometry.spline.domain).T
    nudge = ON_BORDER * (high - low)
    near = np.stack([uv + nudge * x for x in ((-1, -1), (-1, 1), (1, -1), (1, 1))])
    inside = trim.contains(near.reshape(-1, 2)).reshape(4, -1).any(axis=0)
    closed = np.array([closes(ends) for ends in geometry.spline.boundary])
    inside &= ((uv >= low - nudge) & (uv <= high + nudge) | closed).all(axis=1)
    ends = np.flatnonzero(np.diff(inside, prepend=False, append=False)).reshape(-1, 2)
    return [(first, last) for first, last in ends.tolist() if last > first + 1]
