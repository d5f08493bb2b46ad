"""Surfaces as geometries of faces: NURBS, planes, cylinders, cones, spheres and tori.

The surfaces are those of the catalogue and of faces, possibly moved and flipped. The numbers are
those of CAD files, described in `saving`.
"""

import math
from collections.abc import Sequence

import numpy as np

from ...runtime.base.aliases import Array
from ...runtime.surface.moved import AffineMap, Moved
from ...runtime.surface.nurbs import Nurbs
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import CatalogueFunction
from .offset_surface import Turned
from .records import Geometry, Net

# Axes must be perpendicular, and scales equal, up to this error; otherwise circles become ellipses.
SAME = 1e-9


def geometry_of_surface(surface: Surface) -> tuple[Geometry, Array]:
    """Return a surface as the geometry of a face, and a matrix (2, 2) for its parameters.

    The kind of the geometry is a kind of CAD files if possible, otherwise "surface". The matrix
    maps the parameters of the surface to those of the geometry, some of which are lengths. Both
    have the same normals.
    """
    moved = Moved.of(surface)
    function = moved.surface.function
    if isinstance(function, Nurbs):
        return Geometry("nurbs", net=_net(function, moved)), np.eye(2)
    found = None
    if isinstance(function, CatalogueFunction) and function.name == "plane":
        found = _plane(function.values, moved)
    elif (profile := _profile(function)) is not None:
        found = _round(*profile, moved)
    return found or (Geometry("surface", surface=surface), np.eye(2))


def _net(nurbs: Nurbs, moved: Moved) -> Net:
    points, weights = moved.map.points(nurbs.control_points), nurbs.points[:, :, 3:]
    u, v = nurbs.knots
    if moved.turned:
        points, weights, u = points[::-1], weights[::-1], sum(moved.ends) - u[::-1]
    return Net(nurbs.degrees, (u, v), points, weights[:, :, 0] if weights.size else None)


def _plane(slopes: Sequence[float], moved: Moved) -> tuple[Geometry, Array]:
    """Return the plane z = slopes · (u, v) after its motion, and the matrix for its parameters."""
    along_u, along_v = moved.map.directions(np.column_stack([np.eye(2), slopes]))
    origin = moved.map.shift
    if moved.turned:
        origin, along_u = origin + sum(moved.ends) * along_u, -along_u
    axes, parameters = np.linalg.qr(np.stack([along_u, along_v], axis=1))
    signs = np.copysign(1.0, np.diag(parameters))
    x, y = (axes * signs).T
    numbers = np.concatenate([origin, x, y, np.cross(x, y)])
    return Geometry("plane", numbers), signs[:, None] * parameters


def _profile(function: object) -> tuple[str, tuple[float, ...]] | None:
    """Return the kind and sizes of the profile of a surface of revolution about the z axis.

    The sizes of a "line" are r, dr/dv, z and dz/dv at v = 0. The sizes of a "circle" are the
    distance of its centre from the axis, and its radius. None is returned for other functions.
    """
    match function:
        case CatalogueFunction("cylinder", (radius, height)):
            return "line", (radius, 0.0, 0.0, height)
        case CatalogueFunction("cone", (bottom, top, height)):
            return "line", (bottom, top - bottom, 0.0, height)
        case CatalogueFunction("sphere", (radius,)):
            return "circle", (0.0, radius)
        case CatalogueFunction("torus", radii):
            return "circle", radii
    if not isinstance(function, Turned) or function.curve.control_points.shape[0] != 2:
        return None
    curve, (low, high) = function.curve, function.curve.knots[0][[0, -1]].tolist()
    first, last = curve.control_points[:, 0]
    if curve.points.shape[2] > 3 or first[1] != 0.0 or last[1] != 0.0:
        return None
    slope = (last - first) / (high - low)
    r, _, z = first - low * slope
    return "line", (float(r), float(slope[0]), float(z), float(slope[2]))


def _round(kind: str, sizes: Sequence[float], moved: Moved) -> tuple[Geometry, Array] | None:
    """Return a cylinder, cone, sphere or torus after its motion, and the matrix for parameters.

    None means that the moved surface is of none of these kinds.
    """
    map_ = moved.map
    if moved.turned:  # u is mapped to the sum of the ends of its interval, minus u
        cosine, sine = math.cos(sum(moved.ends)), math.sin(sum(moved.ends))
        mirror = np.array([(cosine, sine, 0.0), (sine, -cosine, 0.0), (0.0, 0.0, 1.0)])
        map_ = map_.after(AffineMap(mirror, np.zeros(3)))
    scales = np.linalg.norm(map_.matrix, axis=0)
    axes = (map_.matrix / scales).T
    apart = np.abs(axes @ axes.T - np.eye(3)).max()
    apart = max(apart, np.abs(scales[: 3 if kind == "circle" else 2] / scales[0] - 1.0).max())
    if not apart <= SAME:
        return None
    across, _, along = scales.tolist()
    if kind == "circle":
        major, minor = across * np.array(sizes)
        numbers = [minor] if major == 0.0 else [major, minor]
        frame = [map_.shift, *axes, numbers]
        return Geometry("torus" if major else "sphere", np.concatenate(frame)), np.eye(2)
    radius, wider, z, longer = sizes
    wider, longer = across * wider, along * longer
    if not longer > 0.0:
        return None
    numbers = [across * radius, *([math.atan2(wider, longer)] if wider else [])]
    frame = [map_.shift + along * z * axes[2], *axes, numbers]
    parameters = np.diag([1.0, math.hypot(wider, longer)])
    return Geometry("cone" if wider else "cylinder", np.concatenate(frame)), parameters
