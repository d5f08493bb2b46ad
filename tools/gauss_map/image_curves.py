"""Folds and boundary images of Gauss maps, where the number of points with a normal changes.

The Gauss map folds along the parabolic curves. Across the image of a fold, the number of points
with a normal changes by two; across the image of a boundary, by one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ...runtime.base.aliases import Array, Flags
from ...runtime.base.errors import InputError
from ...runtime.base.kept import kept
from ...runtime.directions.unit import as_normals
from ...runtime.domain.loops import CORNERS
from ...runtime.domain.trim import Trim, polygons_of
from ...runtime.map import GaussMap
from ...runtime.onto_surface.on_spline import OnSpline, on_grids
from ...runtime.spline.spline import Spline
from .curvature import Curvature
from .image_curve import Curves, ImageCurve, Traced, jets_of_spline
from .parabolic import checked_tolerance, zeros_of
from .polylines import dense, inside

# The number of segments of a side of the domain, or of a line as long, before refinement.
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
        The curves, with a vertex at each cusp. On a spline, folds are parabolic lines of patches,
        and edges of patches across which K changes its sign.

    Raises
    ------
    InputError
        For a tolerance out of range, and for parts.

    Warns
    -----
    GaussmapWarning
        If the curvature cannot be computed on more than 0.01 % of the domain, inside the trim:
        folds end there.

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
        The open sides of the domain, and the loops of a trim, where they are boundaries. Both sides
        of a mirrored seam count as open: normals change to the opposite ones there.

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
    surface = geometry.surface or geometry.spline
    zeros, trim = zeros_of(surface, tolerance), surface.trim
    zeros.warn(stacklevel=5)
    for uv in zeros.polylines():
        for part in [uv] if trim is None else inside(uv, trim.contains, zeros.onto):
            yield zeros.traced(part, tolerance)


def _borders(geometry: OnSpline, tolerance: float) -> Iterator[Traced]:
    """Yield the boundaries of a geometry: sides of the domain, and the loops of a trim."""
    curves, surface = Curves(), geometry.surface
    curves.jets = Curvature(surface).jets if surface else jets_of_spline(geometry.spline)
    curves.size = geometry.spline.extent[0]
    for uv in [*_sides(geometry), *_loops(geometry)]:
        yield curves.traced(uv, tolerance)


def _sides(geometry: OnSpline) -> Iterator[Array]:
    """Yield the sides of the domain that bound the surface, as polylines (k, 2) of the parameters.

    The sides of a mirrored seam count as such, since normals change to the opposite ones there.
    """
    spline = geometry.spline
    for axis, (ends, other) in enumerate(zip(spline.boundary, spline.domain[::-1], strict=True)):
        along, (low, high) = np.linspace(*other, PARTS_OF_SIDE + 1), spline.domain[axis]
        for end, value in zip(ends, (low, high), strict=True):
            if end in ("open", "mirrored"):
                line, inwards = np.full((len(along), 2), value), np.zeros(2)
                line[:, 1 - axis] = along
                inwards[axis] = ON_BORDER * (low + high - 2.0 * value)
                yield from _inside(_trim_of(geometry), line, inwards[None])


def _loops(geometry: OnSpline) -> Iterator[Array]:
    """Yield the loops of the trim inside the domain; InputError if it has other boundaries."""
    spline, trim = geometry.spline, _trim_of(geometry)
    size = np.diff(spline.domain)[:, 0]
    if trim is None:
        return
    for part in trim.parts:
        polygons = polygons_of(part)
        if not polygons:
            raise InputError(
                f"the border of {spline.name!r} is not known: its trim is a predicate, or "
                "leaves out missing points; trim it by loops."
            )
        others = replace(trim, parts=tuple(x for x in trim.parts if x is not part))
        for polygon in polygons:
            line = dense(np.concatenate([polygon, polygon[:1]]), size / PARTS_OF_SIDE)
            for uv in _cut(spline, _cut(spline, [line], 0), 1):
                yield from _inside(others, uv, ON_BORDER * size * CORNERS)


def _trim_of(geometry: OnSpline) -> Trim | None:
    """Return the trim of the surface, or of a spline without one."""
    return (geometry.surface or geometry.spline).trim


def _cut(spline: Spline, lines: Iterable[Array], axis: int) -> Iterator[Array]:
    """Yield the parts of polylines (k, 2) inside the domain along `axis`, away from open sides.

    At a mirrored seam, polylines are cut, and parts beyond it are moved into the domain. Polylines
    across a periodic seam stay whole.
    """
    kind, (low, high), other = spline.boundary[axis][0], spline.domain[axis], 1 - axis
    if kind == "periodic":
        yield from lines
        return
    nudge = 0.0 if kind == "mirrored" else ON_BORDER * (high - low)

    def in_domain(uv: Array) -> Flags:
        return (uv[:, axis] >= low + nudge) & (uv[:, axis] <= high - nudge)

    for line in lines:
        turns = np.floor((line[:, axis] - low) / (high - low))
        for k in np.unique(turns) if kind == "mirrored" else (0.0,):
            uv = line.copy()
            uv[:, axis] -= k * (high - low)
            if k % 2.0:
                uv[:, other] = sum(spline.domain[other]) - uv[:, other]
            yield from inside(uv, in_domain)


def _inside(trim: Trim | None, uv: Array, nudges: Array) -> list[Array]:
    """Return the parts of a polyline (k, 2) that some of `nudges` (m, 2) moves into the trim."""
    if trim is None:
        return [uv]

    def contains(uv: Array) -> Flags:
        near = (uv + nudges[:, None]).reshape(-1, 2)
        return np.any(trim.contains(near).reshape(len(nudges), -1), axis=0)

    return inside(uv, contains)
