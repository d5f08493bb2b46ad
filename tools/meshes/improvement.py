"""Better triangles: flips of edges towards the normals or to larger angles, and collapses."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from ...runtime.base.errors import InputError, shown
from ...runtime.base.tolerances import NO_AREA
from ..kernels import collapses
from ..kernels import flips as kernels
from .triangulated import Triangulated

__all__ = ["Prefer", "checked_prefer", "flip_edges", "improved"]

Prefer = Literal["normals", "shape"]
KINDS = ("shape", "normals")

# For better shapes a triangle may deviate by this angle (degrees) from a normal at a corner, and
# not more, unless it did before.
LARGEST_DEVIATION = 30.0
# Triangles with smaller angles (degrees) than these are removed, one bound after the other, until
# the angle that this part of all triangles falls below is at least ENOUGH.
SMALLEST = (5.0, 10.0, 15.0, 20.0, 25.0)
PART, ENOUGH = 0.05, 25.0
# For each bound at most this number of times: a collapse may allow another one.
ROUNDS = 4
# No vertex in more triangles than this is moved.
MOST_AROUND = 256


def checked_prefer(prefer: object) -> Prefer:
    """Return what a mesh is to prefer; InputError if that is unknown."""
    if not isinstance(prefer, str) or prefer not in KINDS:
        raise InputError(f"prefer must be 'shape' or 'normals', not {shown(prefer)}.")
    return prefer  # pyright: ignore[reportReturnType]


def improved(mesh: Triangulated, prefer: Prefer, angle: float) -> Triangulated:
    """Return a mesh with better triangles, by flips and, where these do not suffice, collapses.

    For "normals" edges are collapsed at triangles without area only. So are those at samples on a
    graded grid, whose cells may be long: of the others, those in angles below the smallest bound
    are left out. No flip makes a triangle deviate from normals by more than `angle` degrees.
    """
    least = math.cos(math.radians(min(angle, LARGEST_DEVIATION)))
    flip_edges(mesh, prefer, least)
    has_grid = bool(mesh.is_node.any())
    if prefer == "normals" or has_grid:
        mesh = _without_small_angles(mesh, prefer, NO_AREA, least)
    if prefer == "normals":
        return mesh
    if has_grid:
        mesh = replace(mesh, is_free=mesh.is_free & ~mesh.is_node)
        return _without_small_angles(mesh, prefer, math.tan(math.radians(SMALLEST[0])), least)
    for smallest in SMALLEST:
        if smallest > SMALLEST[0] and _has_good_shape(mesh):
            break
        mesh = _without_small_angles(mesh, prefer, math.tan(math.radians(smallest)), least)
    return mesh


def flip_edges(mesh: Triangulated, prefer: Prefer, least: float = 1.0) -> int:
    """Flip edges until no flip improves triangles; return the number of flips.

    For "shape" cosines between triangles and normals may fall, down to `least`.
    """
    return kernels.flip_edges(
        *mesh.arrays(), prefer == "shape", least,
        np.arange(len(mesh.triangles)), np.ones(len(mesh.triangles), dtype=np.bool_),
    )  # fmt: skip


def _has_good_shape(mesh: Triangulated) -> bool:
    """Say whether few enough triangles, but for those on borders, have small angles."""
    inner = mesh.tangents()[(mesh.neighbours >= 0).all(axis=1)]
    few = math.tan(math.radians(ENOUGH))
    return bool(np.count_nonzero(inner < few) <= PART * len(inner))


def _without_small_angles(
    mesh: Triangulated, prefer: Prefer, smallest: float, least: float
) -> Triangulated:
    """Collapse and flip edges at triangles below the tangent `smallest`, while that helps."""
    for _ in range(ROUNDS):
        if mesh.tangents().min(initial=np.inf) >= smallest or not collapses.collapse_edges(
            *mesh.arrays(), mesh.is_free, smallest, least, np.empty(MOST_AROUND, dtype=np.int64)
        ):
            break
        mesh = mesh.chosen(mesh.triangles[:, 0] >= 0)
        flip_edges(mesh, prefer, least)
    return mesh
