"""Triangle meshes of about as many vertices: Gmsh, Open CASCADE, and a grid of parameters.

Vertices at one place, as on both sides of a seam, are one.
"""

# Only `make bench-peers` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

import numpy as np

from .cad import gmsh_mesher, opencascade_mesher, opencascade_shape
from .forms import Array, ClosedForm
from .meshes import triangles
from .peer import Points, tuned

__all__ = ["Triangles", "by_grid", "gmsh_triangles", "joined", "opencascade_triangles"]

Triangles = tuple[Array, np.ndarray]  # vertices (M, 3) and their numbers (T, 3)
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
        return joined(*_gmsh_arrays(gmsh))[0], normals

    made(tuned(made, 40.0, count, 2.0))
    return joined(*_gmsh_arrays(gmsh))


def _gmsh_arrays(gmsh: object) -> Triangles:
    mesh = gmsh.model.mesh  # pyright: ignore[reportAttributeAccessIssue]
    tags, points, _ = mesh.getNodes()
    _, corners = mesh.getElementsByType(mesh.getElementType("triangle", 1))
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags] = np.arange(len(tags))
    return np.reshape(points, (-1, 3)), place[np.reshape(corners, (-1, 3))]


def opencascade_triangles(form: ClosedForm, count: int) -> Triangles:
    """Return a mesh of bounded angular deflection."""
    from OCP.BRep import BRep_Tool
    from OCP.TopLoc import TopLoc_Location

    face = opencascade_shape(form)
    meshed = opencascade_mesher(form, face)

    def arrays(angle: float) -> Triangles:
        meshed(angle)
        mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
        nodes = map(mesh.Node, range(1, mesh.NbNodes() + 1))
        points = np.array([(p.X(), p.Y(), p.Z()) for p in nodes])
        numbers = range(1, mesh.NbTriangles() + 1)
        corners = [mesh.Triangle(k).Value(i) - 1 for k in numbers for i in (1, 2, 3)]
        return joined(points, np.reshape(corners, (-1, 3)))

    def made(angle: float) -> Points:
        points = arrays(angle)[0]
        return points, points

    return arrays(tuned(made, 0.2, count, -2.0))


def joined(points: Array, faces: np.ndarray) -> Triangles:
    """Return a mesh with one vertex at a place, of those that triangles have."""
    _, first, place = np.unique(
        np.round(points / SAME), axis=0, return_index=True, return_inverse=True
    )
    corners = place.ravel()[faces]
    ordered = np.sort(corners, axis=1)
    corners = corners[(ordered[:, :-1] < ordered[:, 1:]).all(axis=1)]
    used, corners = np.unique(corners, return_inverse=True)
    return points[first][used], corners.reshape(-1, 3)
