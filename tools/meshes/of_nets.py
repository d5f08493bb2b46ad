"""Meshes of splines of nets: each patch is one triangle, or is divided into equal triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.checks import whole_number
from ...runtime.base.memory import check_memory
from ...runtime.directions.unit import unit_or_zero
from ...runtime.spline.joints import linked
from .creased import CreasedMesh, mean_normals

if TYPE_CHECKING:
    from ...runtime.spline.nets import NetSpline


class Parts(NamedTuple):
    """A division of a triangle into n² equal triangles, whose L corners are at `places` (L, 2).

    Places are parameter pairs. The `corners` (3,) of the whole triangle, the points on its `edges`
    (3, n + 1), and the `triangles` (n², 3) are indices of `places`, counterclockwise. Edges are
    ordered as in `runtime.spline.joints`.
    """

    places: Array
    corners: Indices
    edges: Indices
    triangles: Indices

    @classmethod
    def of(cls, n: int) -> Parts:
        """Divide the triangle (0, 0), (1, 0), (0, 1) into n² equal triangles."""
        i, j = np.nonzero(np.add.outer(np.arange(n + 1), np.arange(n + 1)) <= n)
        number = np.full((n + 1, n + 1), -1)
        number[i, j] = np.arange(len(i))
        ends = np.array([(n, 0), (0, n), (0, 0)])
        start, end = np.roll(ends, -1, axis=0), np.roll(ends, -2, axis=0)
        step = np.arange(n + 1)[:, None, None]
        along = (start * (n - step) + end * step) // n
        edges = number[along[..., 0], along[..., 1]].T
        (a, b), (c, d) = ((x[y], z[y]) for x, z, y in ((i, j, i + j < n), (i, j, i + j < n - 1)))
        upright = np.stack([number[a + 1, b], number[a, b + 1], number[a, b]], axis=1)
        inverted = np.stack([number[c, d + 1], number[c + 1, d], number[c + 1, d + 1]], axis=1)
        places = np.stack([i, j], axis=1) / n
        return cls(places, number[tuple(ends.T)], edges, np.concatenate([upright, inverted]))


def mesh(self: NetSpline, parts: int = 1) -> CreasedMesh:
    """Return a mesh in which each patch is one triangle, or several.

    Its vertices are the corners of the triangles, each once. Neighbouring patches share the points
    on their joint, so that the mesh is closed where the nets are, and they share the normals there
    if the joint is smooth.

    Parameters
    ----------
    parts : int, default 1
        The number of parts of each edge of a patch, at equal steps of the parameters; a patch has
        the square of this number of triangles. All vertices are points of the spline.

    Returns
    -------
    CreasedMesh
        The vertices, triangles, and normals: `normals` at vertices, `corner_normals` at corners of
        triangles, which differ at creases. `face_index` are the patches of triangles. Triangles
        with equal corners, at a collapsed edge of a patch, are left out.

    Raises
    ------
    InputError
        Unless `parts` is a whole number of at least 1, and for a mesh that needs more than the free
        memory.

    Examples
    --------
    >>> import gaussmap as gm
    >>> torus = gm.Spline.from_nets(gm.fit("torus", (8, 8)).control_nets, name="torus")
    >>> mesh = torus.mesh(parts=3)
    >>> mesh, mesh.closed, mesh.euler_characteristic
    (CreasedMesh(1,152 vertices, 2,304 triangles on torus), True, 0)

    """
    n = whole_number(parts, "parts")
    size = (n + 1) * (n + 2) // 2
    check_memory("mesh", self.patches * size)
    inside = Parts.of(n)
    smooth, joined = _links(self, inside)
    count, vertex = linked(self.patches * size, *joined)
    _, first = np.unique(vertex, return_index=True)
    patches = np.repeat(np.arange(self.patches), size)
    uv = np.tile(inside.places, (self.patches, 1))
    normals = _normals(self, patches, uv, smooth)
    rows = (inside.triangles + size * np.arange(self.patches)[:, None, None]).reshape(-1, 3)
    a, b, c = vertex[rows].T  # at a collapsed edge, two corners may be one vertex
    proper = (a != b) & (b != c) & (c != a)
    rows = rows[proper]
    return CreasedMesh(
        self._points_in_patches(patches[first], uv[first]),
        mean_normals(vertex[rows], normals[rows], count),
        uv[first], vertex[rows], np.full(count, -1), self.name,
        corner_normals=normals[rows], face_index=patches[rows[:, 0]],
    )  # fmt: skip


Links = tuple[Indices, Indices]


def _links(spline: NetSpline, inside: Parts) -> tuple[Links, Links]:
    """Return the pairs of points with equal normals, and the pairs of points with equal positions.

    Point l of patch k has the index L k + l.
    """
    topology, size = spline.topology, len(inside.places)
    first = size * np.arange(spline.patches)[:, None]
    edges = (first[:, None] + inside.edges).reshape(3 * spline.patches, -1)
    point = edges[topology.is_point]

    def across(pairs: Indices) -> Indices:
        """Pair the points of two edges with opposite directions, for J pairs of edges (J, 2).

        Also pair consecutive points of each collapsed edge.
        """
        along = np.stack([edges[pairs[:, 0]], edges[pairs[:, 1], ::-1]]).reshape(2, -1)
        return np.concatenate([along, np.stack([point[:, 1:], point[:, :-1]]).reshape(2, -1)], 1)

    corners = (first + inside.corners).ravel()
    _, known, number = np.unique(topology.numbers[:, :3], return_index=True, return_inverse=True)
    same = np.stack([corners, corners[known[number.ravel()]]])
    one, other = across(topology.pairs[topology.joints.smooth])
    all_one, all_other = np.concatenate([across(topology.pairs), same], axis=1)
    return (one, other), (all_one, all_other)


def _normals(spline: NetSpline, patches: Indices, uv: Array, smooth: Links) -> Array:
    """Return the unit normals (k, 3) of patches at parameters; linked points share a normal.

    If all patches around a point are singular there, they share a normal only if their normals
    agree.
    """
    singular, _, N = spline._regular_places(patches, uv)
    own = unit_or_zero(N)
    count, group = linked(len(own), *smooth)
    regular = _any(count, group, ~singular)
    total = np.zeros((count, 3))
    some = np.flatnonzero(~singular | ~regular[group])
    np.add.at(total, group[some], own[some])
    shared = unit_or_zero(total)[group]
    chord = 2.0 * np.sin(0.5 * np.radians(spline.smooth))
    apart = _any(count, group, np.linalg.norm(own - shared, axis=1) > chord) & ~regular
    return np.where(apart[group, None], own, shared)


def _any(count: int, group: Indices, flags: Flags) -> Flags:
    """Return for each group (count,) whether any of its members is flagged."""
    return np.bincount(group[flags], minlength=count) > 0
