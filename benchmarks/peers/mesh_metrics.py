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

PARTS = 6  # every triangle is compared at the barycentric lattice of step 1/PARTS
FEW = 0.05  # the share of triangles with a smallest angle below `Quality.small`
STEPS = 12
DIFFERENCE = 1e-5  # of parameters
SETTLED = 1e-6  # the greatest length of the last step, in the unit of the surface


@dataclass(frozen=True)
class Quality:
    """The errors of a mesh with this number of `vertices`.

    Distances are the largest from the surface to the mesh and back, in the unit of the surface;
    `worst` and `mean` are angles between the normals of both, in degrees. In 95 % of the triangles
    the smallest angle is at least `small` degrees.
    """

    vertices: int
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
        sine, cosine = np.linalg.norm(np.cross(e, f), axis=1), dots(e, f)
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
    """Yield points (T, 3) of triangles (T, 3, 3), for each node of a barycentric lattice."""
    for i in range(PARTS + 1):
        for j in range(PARTS + 1 - i):
            yield np.tensordot(corners, [i / PARTS, j / PARTS, 1 - (i + j) / PARTS], ([1], [0]))


def to_surface(form: ClosedForm, points: Array) -> Array:
    """Return the distances of points near the surface from it.

    The foot of the perpendicular is found in steps: it moves by the tangential component of the
    vector from the foot to the point. A parameter that would leave an open domain is held, and the
    foot moves along the boundary. Raises ArithmeticError if the steps do not converge.
    """
    place = inside(form, np.stack(form.parameters(points)))
    moved = np.zeros(len(points))
    for _ in range(STEPS):
        foot, normals = form.evaluate(*place)
        away = points - foot
        aside = away - dots(away, normals)[:, None] * normals
        found = np.stack(form.parameters(foot + aside))
        last, place = place, inside(form, found)
        for held, other in ((0, 1), (1, 0)):
            left = np.flatnonzero(place[held] != found[held])
            if len(left):
                border = place[:, left]
                border[other] = last[other, left]
                along = along_border(form, border, other)
                near = foot[left] + dots(aside[left], along)[:, None] * along
                place[other, left] = inside(form, np.stack(form.parameters(near)))[other]
        moved = np.linalg.norm(form.evaluate(*place)[0] - foot, axis=1)
    if moved.max() > SETTLED:
        raise ArithmeticError(f"the nearest point of {form.name} is not found")
    return np.linalg.norm(points - form.evaluate(*place)[0], axis=1)


def inside(form: ClosedForm, place: Array) -> Array:
    """Return parameters (2, k) in the domain; a parameter beyond an open end is at that end."""
    result = place.copy()
    for k, (ends, domain) in enumerate(
        zip(form.surface.boundary, form.surface.domain, strict=True)
    ):
        if ends[0] == "open":
            result[k] = np.clip(place[k], *domain)
    return result


def along_border(form: ClosedForm, place: Array, axis: int) -> Array:
    """Return unit tangents of the lines on which only parameter `axis` changes."""
    step = np.zeros((2, 1))
    step[axis] = DIFFERENCE
    found = form.evaluate(*(place + step))[0] - form.evaluate(*(place - step))[0]
    return found / np.linalg.norm(found, axis=1)[:, None]


def dots(left: Array, right: Array) -> Array:
    """Return the scalar products of vectors (k, 3)."""
    return np.einsum("kx,kx->k", left, right)
