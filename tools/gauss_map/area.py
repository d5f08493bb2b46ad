"""Solid angles and areas of the Gaussian images of patches, cut at singular points."""

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.tolerances import DOUBLE_ROOT, PARAMETER_ERROR, VANISHING
from .boundary import BoundaryArc
from .classes import PatchClass
from .parabolic_lines import TRIANGLE, pieces_of, singular_points
from .patches import Patches
from .polylines import different
from .solid_angle import by_boundary, is_wide, solid_angles, triangle_of

Array = NDArray[np.float64]


def measures_of(patches: Patches, classes: NDArray[np.int8]) -> tuple[Array, Array]:
    """Return the integrals of K and of |K| (k,) over patches.

    Mixed patches, and patches with a wide range of normals, are cut along their parabolic lines and
    at their singular points.
    """
    normals = patches.normals
    wide = is_wide(normals)
    curved = np.isin(classes, (PatchClass.ELLIPTIC, PatchClass.HYPERBOLIC, PatchClass.MIXED))
    cut = curved & (wide | (classes == PatchClass.MIXED))
    signed = np.zeros(len(patches))
    narrow = ~cut & ~wide
    signed[narrow] = solid_angles(normals[narrow])
    areas = np.abs(signed)
    pieces = [(k, fan) for k in np.flatnonzero(cut) for fan in _fans_of(patches[k : k + 1])]
    if pieces:
        owners = np.array([k for k, _ in pieces])
        of_piece = np.repeat(np.arange(len(pieces)), [len(fan) for _, fan in pieces])
        triangles = np.concatenate([fan for _, fan in pieces])
        parts = solid_angles(triangles)
        regular = triangles[:, range(3), range(3)].any(axis=2)
        for k in np.flatnonzero(np.any(~regular, axis=1)):
            parts[k] = by_boundary(triangles[k], parts[k])
        sums = np.bincount(of_piece, weights=parts, minlength=len(pieces))
        np.add.at(signed, owners, sums)
        np.add.at(areas, owners, np.abs(sums))
    return signed, areas


def _fans_of(patch: Patches) -> list[Array]:
    """Cut each piece of one patch into triangles; return the polar forms (m, 3, 3, 3) of N on them.

    The list has one array for each piece.
    """
    fans = []
    border, others = _on_sides(patch, TRIANGLE), list(singular_points(patch))
    for piece in pieces_of(patch):
        polygon = _snapped(piece.corners, border)
        places = different([*border, *_on_sides(patch, polygon), *others], DOUBLE_ROOT)
        corners = _barycentric(_fan(polygon, places))
        normals = triangle_of(np.repeat(patch.normals, len(corners), axis=0), corners)
        lengths = np.linalg.norm(normals, axis=3)
        normals[lengths <= VANISHING * lengths.max()] = 0.0
        fans.append(normals)
    return fans


def _on_sides(patch: Patches, polygon: Array) -> list[Array]:
    """Return the parameter pairs of the singular points on the sides of a polygon.

    A double parabolic line may have singular points through which no other line passes.
    """
    places = []
    corners = _barycentric(polygon)
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        ends = np.stack([start, end])
        net = np.einsum("ai,bj,ijx->abx", ends, ends, patch.normals[0])
        arc = BoundaryArc(net[[0, 0, 1], [0, 1, 1]], float(patch.normal_noise[0]))
        places += [((1.0 - t) * start + t * end)[:2] for t in arc.singular_points]
    return places


def _snapped(polygon: Array, places: list[Array]) -> Array:
    """Move the corners of a polygon that are near singular points onto these points.

    Corners on multiple parabolic lines are less accurate than the singular points.
    """
    polygon = polygon.copy()
    for place in places:
        polygon[np.abs(polygon - place).max(axis=1) <= DOUBLE_ROOT] = place
    return polygon


def _barycentric(places: Array) -> Array:
    """Return the barycentric coordinates u, v, w (..., 3) of parameter pairs u, v (..., 2)."""
    return np.concatenate([places, 1.0 - places.sum(axis=-1, keepdims=True)], axis=-1)


def _fan(polygon: Array, places: Array) -> Array:
    """Cut a convex polygon into triangles (m, 3, 2) with the given inner points as corners."""
    centre = polygon.mean(axis=0)
    triangles = [np.stack([centre, polygon[k - 1], polygon[k]]) for k in range(len(polygon))]
    for place in places:
        cut = []
        for triangle in triangles:
            weights = np.linalg.solve(np.vstack([triangle.T, np.ones(3)]), [*place, 1.0])
            if weights.min() < -PARAMETER_ERROR or weights.max() > 1.0 - PARAMETER_ERROR:
                cut.append(triangle)
                continue
            for k in range(3):
                if weights[k] > PARAMETER_ERROR:
                    part = triangle.copy()
                    part[k] = place
                    cut.append(part)
        triangles = cut
    return np.array(triangles)
