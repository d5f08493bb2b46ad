"""How well a triangle mesh represents a surface: distances, angles between normals, shapes."""

# Only `make bench-peers` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from .forms import Array, ClosedForm
from .metrics import Places, angles
from .triangles import Triangles

__all__ = ["FEW", "PARTS", "Quality", "quality", "to_surface"]

PARTS = 6  # every triangle is compared at the barycentric lattice of step 1/PARTS
FEW = 0.05  # of the smallest angles are below the one that is told
STEPS = 12
SETTLED = 1e-6  # how far, in the unit of the surface, the last step may still go


@dataclass(frozen=True)
class Quality:
    """How well a mesh of `vertices` and `triangles` represents a surface.

    Distances are the largest from the surface to the mesh and back, in the unit of the surface;
    `worst` and `mean` are angles between the normals of both, in degrees. Of `small` degrees at
    least are the angles of 95 % of the triangles.
    """

    vertices: int
    triangles: int
    to_mesh: float
    to_surface: float
    worst: float
    mean: float
    small: float

    @property
    def hausdorff(self) -> float:
        """The larger one of both distances."""
        return max(self.to_mesh, self.to_surface)


def quality(form: ClosedForm, places: Places, mesh: Triangles) -> Quality:
    """Compare a mesh with the exact surface."""
    points, triangles = mesh
    cells, nearest = closest(mesh, places.points)
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    turned = angles(normals[cells], places.normals)
    return Quality(
        len(points),
        len(triangles),
        float(np.linalg.norm(nearest - places.points, axis=1).max()),
        max(float(to_surface(form, part).max()) for part in on_mesh(corners)),
        float(turned.max()),
        float(turned.mean()),
        float(np.quantile(smallest_angles(corners), FEW)),
    )


def smallest_angles(corners: Array) -> Array:
    """Return the smallest angle of each triangle (T, 3, 3), in degrees."""
    found = []
    for k in range(3):
        e, f = (corners[:, (k + x) % 3] - corners[:, k] for x in (1, 2))
        sine, cosine = np.linalg.norm(np.cross(e, f), axis=1), np.einsum("kx,kx->k", e, f)
        found.append(np.degrees(np.arctan2(sine, cosine)))
    return np.min(found, axis=0)


def closest(mesh: Triangles, places: Array) -> tuple[np.ndarray, Array]:
    """Return the nearest triangle of each place, and the nearest point of it (VTK, exact)."""
    import pyvista as pv

    found: Any = pv.PolyData.from_regular_faces(*mesh).find_closest_cell(
        places, return_closest_point=True
    )
    return found


def on_mesh(corners: Array) -> Iterator[Array]:
    """Yield places on all triangles (T, 3, 3): one after the other of their barycentric lattice."""
    for i in range(PARTS + 1):
        for j in range(PARTS + 1 - i):
            yield np.tensordot(corners, [i / PARTS, j / PARTS, 1 - (i + j) / PARTS], ([1], [0]))


def to_surface(form: ClosedForm, points: Array) -> Array:
    """Return the distances of points near the surface from it.

    The foot of the perpendicular moves by what separates the point from the normal there. A
    parameter that would leave an open domain is held. ArithmeticError if the foot does not settle.
    """
    ends = np.array(form.surface.domain)
    is_open = [ends[0] == "open" for ends in form.surface.boundary]

    def held(near: Array) -> tuple[Array, Array]:
        u, v = (
            np.clip(x, *end) if fixed else x
            for x, end, fixed in zip(form.parameters(near), ends, is_open, strict=True)
        )
        return form.evaluate(u, v)

    foot, normals = held(points)
    moved = np.zeros(len(points))
    for _ in range(STEPS):
        away = points - foot
        aside = away - np.einsum("kx,kx->k", away, normals)[:, None] * normals
        last, (foot, normals) = foot, held(foot + aside)
        moved = np.linalg.norm(foot - last, axis=1)
    if moved.max() > SETTLED:
        raise ArithmeticError(f"the nearest point of {form.name} is not found")
    return np.linalg.norm(points - foot, axis=1)
