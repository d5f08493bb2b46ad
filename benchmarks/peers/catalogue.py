"""All peers, in the order of the table."""

from __future__ import annotations

from .cad import gmsh_by_curvature, opencascade_by_angle
from .forms import ClosedForm
from .meshes import (
    open3d_by_area,
    open3d_poisson,
    pymeshlab_poisson,
    trimesh_by_area,
    trimesh_by_curvature,
)
from .peer import Peer, Work
from .recipe import by_curvature, by_grid
from .splines import geomdl_by_grid, splipy_by_curvature, splipy_by_grid


def _grid(form: ClosedForm, count: int) -> Work:
    return lambda: by_grid(form, count)


def _recipe(form: ClosedForm, count: int) -> Work:
    return lambda: by_curvature(form, count)[:2]


MILLION = 1_000_000
K = r"\|K\|"  # in a table of Markdown
RECIPE = Peer(f"NumPy, {K} recipe, closed form", K, "numpy", _recipe, MILLION, rounds=5)
SPLIPY_RECIPE = Peer(
    f"Splipy, {K} recipe, B-spline", K, "splipy", splipy_by_curvature, 20_000, on_net=True
)
GMSH = Peer("Gmsh, curvature size", "κmax", "gmsh", gmsh_by_curvature, 50_000)
PEERS = (
    Peer("NumPy, (u,v) grid, closed form", "no", "numpy", _grid, MILLION, rounds=5),
    RECIPE,
    Peer("Splipy, (u,v) grid", "no", "splipy", splipy_by_grid, 100_000, rounds=5, on_net=True),
    SPLIPY_RECIPE,
    Peer("trimesh, random by area", "no", "trimesh", trimesh_by_area, 100_000, rounds=5),
    Peer(f"trimesh, random by {K}", K, "trimesh", trimesh_by_curvature, 100_000, rounds=5),
    Peer("Open3D, random by area", "no", "open3d", open3d_by_area, 100_000, rounds=5),
    Peer("Open3D, Poisson disk", "no", "open3d", open3d_poisson, 20_000),
    Peer("PyMeshLab, Poisson disk", "no", "pymeshlab", pymeshlab_poisson, 20_000),
    GMSH,
    Peer("Open CASCADE, angular deflection", "angle", "OCP", opencascade_by_angle, 10_000),
    Peer("geomdl, (u,v) grid", "no", "geomdl", geomdl_by_grid, 10_000, on_net=True),
)
