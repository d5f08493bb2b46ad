"""Triangle meshes of about a given number of vertices: Gmsh, Open CASCADE, parameter grids.

Vertices at equal positions, as on both sides of a seam, are merged.
"""

# Only `make bench-peers` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from typing import Any

import numpy as np

from .cad import gmsh_mesher, opencascade_faces, opencascade_mesher, opencascade_shape
from .forms import Array, ClosedForm
from .meshes import triangles
from .peer import Points, tuned

Triangles = tuple[Array, np.ndarray]  # vertices (M, 3), corners of triangles as indices (T, 3)
SAME = 1e-9  # the forms have the size 1


def by_grid(form: ClosedForm, count: int) -> Triangles:
    """Return a grid of parameters, each cell cut along one diagonal."""
    points, _, faces = triangles(form, count)
    return points, faces


def gmsh_triangles(form: ClosedForm, count: int) -> Triangles:
    """Return a mesh whose size follows curvature."""
    import gmsh

    meshed = gmsh_mesher(form)

    def made(elements: float) -> Points:
        normals = meshed(elements)[1]
        return joined(*_gmsh_arrays(gmsh, form))[0], normals

    made(tuned(made, 40.0, count, 2.0))
    return joined(*_gmsh_arrays(gmsh, form))


def _gmsh_arrays(gmsh: Any, form: ClosedForm) -> Triangles:
    mesh = gmsh.model.mesh
    tags, points, _ = mesh.getNodes()
    points = np.reshape(points, (-1, 3))
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags] = np.arange(len(tags))
    kind, faces = mesh.getElementType("triangle", 1), []
    for _, tag in gmsh.model.getEntities(2):
        corners = mesh.getElementsByType(kind, tag)[1]
        faces.append(facing_out(form, points, place[np.reshape(corners, (-1, 3))]))
    return points, np.concatenate(faces)


def facing_out(form: ClosedForm, points: Array, faces: np.ndarray) -> np.ndarray:
    """Return the triangles of a face, turned as a whole to the side that the closed form has."""
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    theirs = form.evaluate(*form.parameters(corners.mean(axis=1)))[1]
    return faces if np.einsum("nx,nx->n", normals, theirs).sum() > 0.0 else faces[:, ::-1]


def opencascade_triangles(form: ClosedForm, count: int) -> Triangles:
    """Return a mesh of bounded angular deflection."""
    shape = opencascade_shape(form)
    meshed = opencascade_mesher(form, shape)

    def arrays(angle: float) -> Triangles:
        meshed(angle)
        return joined(*_opencascade_arrays(form, shape))

    def made(angle: float) -> Points:
        points = arrays(angle)[0]
        return points, points

    return arrays(tuned(made, 0.2, count, -2.0))


def _opencascade_arrays(form: ClosedForm, shape: Any) -> Triangles:
    from OCP.BRep import BRep_Tool
    from OCP.TopLoc import TopLoc_Location

    points, faces, before = [], [], 0
    for face in opencascade_faces(shape):
        mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
        nodes = map(mesh.Node, range(1, mesh.NbNodes() + 1))
        part = np.array([(p.X(), p.Y(), p.Z()) for p in nodes])
        numbers = range(1, mesh.NbTriangles() + 1)
        corners = [mesh.Triangle(k).Value(i) - 1 for k in numbers for i in (1, 2, 3)]
        faces.append(before + facing_out(form, part, np.reshape(corners, (-1, 3))))
        points.append(part)
        before += len(part)
    return np.concatenate(points), np.concatenate(faces)


def joined(points: Array, faces: np.ndarray) -> Triangles:
    """Return a mesh without two vertices at one position, and without unused vertices."""
    _, first, place = np.unique(
        np.round(points / SAME), axis=0, return_index=True, return_inverse=True
    )
    corners = place.ravel()[faces]
    ordered = np.sort(corners, axis=1)
    corners = corners[(ordered[:, :-1] < ordered[:, 1:]).all(axis=1)]
    used, corners = np.unique(corners, return_inverse=True)
    return points[first][used], corners.reshape(-1, 3)
