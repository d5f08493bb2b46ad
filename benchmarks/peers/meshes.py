"""Points on a mesh of 205,000 triangles, random or Poisson-disk: trimesh, Open3D, PyMeshLab.

The meshes have the exact normals of the surface at their vertices. Samples get interpolated
normals, which are more accurate than the normals of the triangles.
"""

# Only `make bench-peers` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .forms import Array, ClosedForm
from .peer import Points, Work, tuned

CELLS = 320**2
CHOICE = 10  # the number of random points for each farthest point


def triangles(form: ClosedForm, cells: int = CELLS) -> tuple[Array, Array, np.ndarray]:
    """Return vertices, their normals, and triangles (2 cells or a little less, 3)."""
    u, v = form.lattice(cells)
    numbers = np.arange(u.size * v.size).reshape(u.size, v.size)
    for axis, ends in enumerate(form.surface.boundary):
        if ends[0] == "periodic":
            numbers = np.concatenate([numbers, numbers.take([0], axis=axis)], axis=axis)
    a, b, c, d = (
        x.ravel() for x in (numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:])
    )
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    points, normals = form.evaluate(u, v)
    return points.reshape(-1, 3), normals.reshape(-1, 3), faces


def unit(vectors: Array) -> Array:
    """Return vectors divided by their lengths."""
    x, y, z = vectors.T
    return vectors / np.sqrt(x * x + y * y + z * z)[:, None]


# --- trimesh --------------------------------------------------------------------------------------


def trimesh_by_area(form: ClosedForm, count: int) -> Work:
    """Prepare random points, uniform by area."""
    return _trimesh(form, count, by_curvature=False)


def trimesh_by_curvature(form: ClosedForm, count: int) -> Work:
    """Prepare random points; triangles have the weight |K|, from angle defects at their corners."""
    return _trimesh(form, count, by_curvature=True)


def _trimesh(form: ClosedForm, count: int, by_curvature: bool) -> Work:
    import trimesh
    from trimesh.sample import sample_surface
    from trimesh.triangles import points_to_barycentric

    points, normals, faces = triangles(form)
    mesh = trimesh.Trimesh(points, faces, vertex_normals=normals, process=False)
    weight = None
    if by_curvature:
        # the angle defects at an open boundary are its turning, and not curvature
        defects = np.where(_on_border(form), 0.0, np.abs(mesh.vertex_defects))
        weight = (defects / mesh.vertex_degree)[faces].sum(axis=1)
    corners, corner_normals = mesh.triangles, np.asarray(mesh.vertex_normals)[faces]

    def work() -> Points:
        found, face = sample_surface(mesh, count, face_weight=weight, seed=1)[:2]
        places = points_to_barycentric(corners[face], found)
        return np.asarray(found), unit(np.einsum("nk,nkx->nx", places, corner_normals[face]))

    return work


def _on_border(form: ClosedForm) -> np.ndarray:
    """Return a mask of the vertices of the mesh on open boundaries of the domain."""
    u, v = form.lattice(CELLS)
    border = np.zeros((u.size, v.size), dtype=bool)
    for axis, ends in enumerate(form.surface.boundary):
        if ends[0] == "open":
            np.moveaxis(border, axis, 0)[[0, -1]] = True
    return border.ravel()


# --- Open3D ---------------------------------------------------------------------------------------


def open3d_by_area(form: ClosedForm, count: int) -> Work:
    """Prepare random points, uniform by area."""
    return _open3d(form, lambda mesh: mesh.sample_points_uniformly(count))


def open3d_poisson(form: ClosedForm, count: int) -> Work:
    """Prepare points with even distances: of five times `count` points, close ones are removed."""
    return _open3d(form, lambda mesh: mesh.sample_points_poisson_disk(count))


def open3d_farthest(form: ClosedForm, count: int) -> Work:
    """Prepare farthest points of a random cloud: each is the one farthest from those before it."""
    return _open3d(
        form,
        lambda mesh: mesh.sample_points_uniformly(CHOICE * count).farthest_point_down_sample(count),
    )


def _open3d(form: ClosedForm, sampled: Callable[[Any], Any]) -> Work:
    import open3d

    points, normals, faces = triangles(form)
    mesh = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(points), open3d.utility.Vector3iVector(faces)
    )
    mesh.vertex_normals = open3d.utility.Vector3dVector(normals)
    open3d.utility.random.seed(1)

    def work() -> Points:
        cloud = sampled(mesh)
        return np.asarray(cloud.points), np.asarray(cloud.normals)

    return work


# --- PyMeshLab ------------------------------------------------------------------------------------


def pymeshlab_poisson(form: ClosedForm, count: int) -> Work:
    """Prepare points with even distances.

    The requested number is found by trial: PyMeshLab's own search (exactnumflag) is ten times
    slower.
    """
    import pymeshlab

    points, normals, faces = triangles(form)
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(points, faces, v_normals_matrix=normals))

    def sampled(asked: float) -> Points:
        meshes.set_current_mesh(0)
        meshes.generate_sampling_poisson_disk(samplenum=round(asked))
        cloud = meshes.current_mesh()
        found = cloud.vertex_matrix(), unit(cloud.vertex_normal_matrix())
        meshes.delete_current_mesh()
        return found

    asked = tuned(sampled, 0.7 * count, count, 1.0)
    return lambda: sampled(asked)
