"""From samples to a mesh: vertices, their triangulation, and its improvement."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError, shown
from ...runtime.base.memory import check_memory
from ...runtime.base.progress import tell
from ...runtime.directions.unit import unit_or_zero
from ...runtime.domain.domain import Boundary, closes
from ...runtime.onto_surface.newton import evaluate_on_surface
from ...runtime.spline.spline import Spline
from ...runtime.spline.tips import collapsed_sides
from ...runtime.surface.surface import Surface
from ..support.offset import folded
from .links import neighbours
from .mesh import Mesh
from .places import boundary_of, uv_at
from .triangulated import Prefer, Triangulated, checked_prefer, flip_edges, improved, too_few
from .triangulation import triangulations
from .trimming import trimmed_triangles
from .vertices import Vertices, before_offset, check_fields

if TYPE_CHECKING:
    from ...runtime.samples.samples import Samples

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

WHOLE = 180.0  # degrees: no triangle deviates more


def mesh_of(samples: Samples, spline: Spline, angle: float | None, prefer: str) -> Mesh:
    """Return the mesh of `Samples.mesh`."""
    preferred, largest = checked_prefer(prefer), checked_angle(angle)
    check_fields(samples)
    check_memory("mesh", len(samples))
    mesh = triangulated(samples, spline, must_be_whole=angle is None)
    _check_folds(samples, mesh)
    return finished(mesh, len(samples), preferred, largest)


def _check_folds(samples: Samples, mesh: Triangulated) -> None:
    """Raise InputError for an offset that is trimmed or folded, or has a one-sided base surface.

    An offset by d changes a principal curvature κ to κ' = κ / (1 + d κ). Therefore 1 + d κ has the
    sign of 1 − d κ' = 1 / (1 + d κ), which is known after the offset.
    """
    base = samples.offset_of
    if base is None:
        return
    if base.trimmed:
        raise InputError(
            f"{samples.report.surface!r} has no mesh: its sheets end where they meet each other."
        )
    if any(kinds[0] == "mirrored" for kinds in mesh.boundary):
        raise InputError(
            f"{samples.report.surface!r} has no mesh: the surface has one side, and its offset "
            "jumps where the normals change to the opposite ones."
        )
    turned = np.zeros(len(mesh.points), dtype=np.bool_)
    before = mesh.points - base.distance * mesh.normals
    for first, second in ((0, 1), (1, 2), (2, 0)):
        same = mesh.sides[:, first] == mesh.sides[:, second]
        i, j = mesh.triangles[same, first], mesh.triangles[same, second]
        ways = before[i] - before[j], mesh.points[i] - mesh.points[j]
        turned[i[np.einsum("ex,ex->e", *ways) <= 0.0]] = True
    if {"gaussian_curvature", "mean_curvature"} <= {*samples.fields}:
        own = mesh.sample >= 0
        turned[own] |= folded(samples, -base.distance)[mesh.sample[own]]
    if turned.any():
        raise InputError(
            f"{samples.report.surface!r} folds at {int(turned.sum()):,} of {len(turned):,} "
            "vertices, and has no mesh; choose a smaller distance."
        )


def finished(mesh: Triangulated, samples: int, prefer: Prefer, largest: float) -> Mesh:
    """Return the mesh with improved triangles.

    Triangles that deviate from normals by more than `largest` degrees are left out. `samples` is
    the number of samples.
    """
    if largest < WHOLE:
        flip_edges(mesh, "normals")
        mesh = mesh.within(largest)
    mesh = improved(mesh, prefer, largest)
    if largest < WHOLE:
        mesh = mesh.within(largest)
    return mesh.mesh(samples)


def checked_angle(angle: object) -> float:
    """Return the checked argument `angle`, in degrees: the largest deviation from normals.

    It is 180 for None.
    """
    if angle is None:
        return WHOLE
    if isinstance(angle, bool) or not isinstance(angle, int | float | np.number):
        raise InputError(f"angle must be a number of degrees, not {shown(angle)}.")
    if not 0.0 < angle <= WHOLE:
        raise InputError(f"angle must lie between 0 and 180 degrees, and is {shown(angle)}.")
    return float(angle)


def triangulated(samples: Samples, spline: Spline, must_be_whole: bool = True) -> Triangulated:
    """Triangulate samples; InputError if `must_be_whole` and part of the surface is not covered."""
    boundary = boundary_of(spline)
    tell("triangulating")
    vertices = Vertices.of(samples, spline, boundary)
    if spline.trim is None:
        triangles, sides, adjacent = _triangles(vertices, spline, boundary, must_be_whole)
    else:
        vertices, triangles, sides, adjacent, is_whole = trimmed_triangles(
            vertices, before_offset(samples), spline, _lengths(spline),
            lambda x: _triangles(x, spline, boundary, False),
        )  # fmt: skip
        if not len(triangles) or (must_be_whole and not is_whole):
            raise too_few(len(vertices.sample), spline.name)
    triangles, sides, adjacent = _at_apexes(vertices, spline, triangles, sides, adjacent)
    uv, points, normals = _on_surface(vertices, samples, spline)
    _fill_missing(normals, triangles, sides)
    if samples.offset_of is not None:
        added = vertices.sample < 0
        points[added] += samples.offset_of.distance * normals[added]
    return Triangulated(
        spline.name, uv, vertices.sample, vertices.is_free,
        points, normals, triangles, sides, adjacent, vertices.is_node(samples),
        spline.domain, boundary_of(spline, every=True),
    )  # fmt: skip


def _triangles(
    vertices: Vertices, spline: Spline, boundary: Boundary, must_be_whole: bool
) -> tuple[Indices, Indices, Indices]:
    """Return triangles (k, 3), the sides of the surface at their corners, and their neighbours.

    Raises InputError if there is no triangulation, or if the whole surface is required and not
    covered: each edge must be in two triangles or on an open side of the domain, and the Euler
    characteristic must be that of the surface.
    """
    found = None
    lengths = _lengths(spline)
    for triangles, sides in triangulations(vertices.positions, vertices.is_free, boundary, lengths):
        adjacent, is_closed = neighbours(triangles, ~vertices.is_free)
        found = triangles, sides, adjacent
        if is_closed and _characteristic(triangles, adjacent) == _characteristic_of(boundary):
            return found
    if found is None or must_be_whole:
        raise too_few(len(vertices.sample), spline.name)
    return found


def _characteristic(triangles: Indices, adjacent: Indices) -> int:
    """Return the Euler characteristic of a mesh, from its triangles and their neighbours."""
    edges = (adjacent.size + int(np.count_nonzero(adjacent < 0))) // 2
    used = int(np.count_nonzero(np.bincount(triangles.ravel())))
    return used - edges + len(triangles)


def _characteristic_of(boundary: Boundary) -> int:
    """Return the Euler characteristic of a surface; each pole closes a hole of a band."""
    closing = [closes(kinds) for kinds in boundary]
    if all(closing):
        return int(boundary[0][0] == boundary[1][0] == "mirrored")  # the projective plane
    return sum(end == "pole" for kinds in boundary for end in kinds) if any(closing) else 1


def _lengths(spline: Spline) -> Array:
    """Return the mean lengths (2,) of a spline along u and along v, 1 where they vanish."""
    inner = spline.coefficients[1:-1, 1:-1] * spline.scale
    steps = [np.linalg.norm(np.diff(inner, axis=axis), axis=2).mean() for axis in (0, 1)]
    lengths = np.array(steps) * spline.cells
    return np.where(lengths > 0.0, lengths, 1.0)


def _on_surface(vertices: Vertices, samples: Samples, spline: Spline) -> tuple[Array, Array, Array]:
    """Return parameters, points and unit normals of vertices; NaN for missing normals.

    Added points of an offset are points of the original surface.
    """
    uv = uv_at(spline, vertices.positions)
    points, normals = np.empty((2, len(uv), 3))
    is_sample = vertices.sample >= 0
    own = vertices.sample[is_sample]
    uv[is_sample] = samples.uv[own]
    points[is_sample], normals[is_sample] = samples.points[own], samples.normals[own]
    base = samples.offset_of or samples
    added = uv[~is_sample]
    if not isinstance(base.surface, Surface) or not len(added):
        points[~is_sample], normals[~is_sample] = (
            spline.evaluate(*added.T),
            spline.normals(*added.T),
        )
    else:
        points[~is_sample], found = evaluate_on_surface(base.surface, spline, added)[:2]
        normals[~is_sample] = np.where(found.any(axis=1, keepdims=True), found, np.nan)
    for apex in _apexes(vertices, spline):
        normals[apex[vertices.sample[apex] < 0]] = np.nan
    return uv, points, normals


def _apexes(vertices: Vertices, spline: Spline) -> Iterator[Indices]:
    """Yield the indices of the vertices on each side of the domain that collapses to an apex.

    At an apex the surface has no normal.
    """
    for axis, place in collapsed_sides(spline):
        yield np.flatnonzero(vertices.positions[:, axis] == place)


def _at_apexes(
    vertices: Vertices, spline: Spline, triangles: Indices, sides: Indices, adjacent: Indices
) -> tuple[Indices, Indices, Indices]:
    """Return triangles, sides and neighbours, with the vertices at each apex merged."""
    number = np.arange(len(vertices.sample))
    for apex in _apexes(vertices, spline):
        number[apex] = number[apex[:1]]
    if (number == np.arange(len(number))).all():
        return triangles, sides, adjacent
    triangles = number[triangles]
    kept = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return triangles[kept], sides[kept], neighbours(triangles[kept], ~vertices.is_free)[0]


def _fill_missing(normals: Array, triangles: Indices, sides: Indices) -> None:
    """Set missing normals of vertices, as at apexes, to the mean of the normals around them.

    The mean is 0 if the normals around a vertex are missing, too.
    """
    missing = np.asarray(~np.isfinite(normals).all(axis=1))
    normals[missing] = 0.0
    touching = missing[triangles].any(axis=1)
    corners, side = triangles[touching], sides[touching, :, None]
    sums = np.zeros_like(normals)
    np.add.at(sums, corners, side * (side * normals[corners]).sum(axis=1, keepdims=True))
    normals[missing] = unit_or_zero(sums[missing])
