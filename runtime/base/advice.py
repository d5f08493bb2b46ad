"""Advice for input that is not a surface: meshes, point clouds, file names."""

import os
from pathlib import Path

CAD_SUFFIXES = (".step", ".stp", ".iges", ".igs", ".brep", ".brp", ".rle")
RASTER_SUFFIXES = (".tif", ".tiff", ".asc")
_MESH_SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf", ".vtk", ".vtu", ".vtp")
NO_MESHES = (
    "meshes are not taken, because triangles have no curvature; give the CAD file from which it "
    "was made (.step, .iges), points in a grid (m, n, 3), or a formula"
)
NO_CLOUDS = (
    "points (N, 3) in no order are not taken, because they do not say which are neighbours; give "
    "points in a grid (m, n, 3), elevations (m, n) with their spacing, or a CAD file"
)


def is_mesh_file(name: str) -> bool:
    """Return whether a file is a mesh, by its suffix."""
    return Path(name).suffix.lower() in _MESH_SUFFIXES


def file_advice(name: str) -> str | None:
    """Return advice on a file name that was given as a surface; None for unknown types of files."""
    suffix = Path(name).suffix.lower()
    if suffix in CAD_SUFFIXES:
        return f"read the CAD file first: gm.sample(gm.read_cad({name!r}), ...)"
    if suffix in (".npy", ".npz"):
        return f"read the points first: gm.sample(gm.Surface.from_grid(numpy.load({name!r})), ...)"
    if suffix in RASTER_SUFFIXES:
        return f"read the elevations first: gm.sample(gm.terrain({name!r}), ...)"
    return NO_MESHES if suffix in _MESH_SUFFIXES else None


def is_of_geomdl(value: object) -> bool:
    """Return whether a value is a NURBS surface of geomdl, by its attributes."""
    return _has(value, "degree_u", "degree_v", "knotvector_u", "knotvector_v", "ctrlpts")


def is_of_splipy(value: object) -> bool:
    """Return whether a value is a spline of Splipy, by its attributes."""
    return _has(value, "bases", "controlpoints", "rational")


def is_raster(value: object) -> bool:
    """Return whether a value is an open dataset of rasterio, by its attributes."""
    return _has(value, "read", "transform", "crs", "nodatavals")


def _has(value: object, *names: str) -> bool:
    return all(hasattr(value, name) for name in names)


def about_value(value: object) -> str:
    """Return advice on a value that is not a surface: usually the call that makes a surface."""
    if is_of_geomdl(value) or is_of_splipy(value):
        return "make one by gm.Surface.from_nurbs(surface)"
    if is_raster(value):
        return "make one by gm.terrain(dataset)"
    if isinstance(value, os.PathLike) and (advice := file_advice(str(value))):
        return advice
    items = value if isinstance(value, list | tuple) else ()
    if any(isinstance(x, str) or _has(x, "name") for x in items):
        return "gm.Part(surfaces) makes one of several, gm.sample_many(surfaces, ...) samples each"
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        if len(shape) == 2 and shape[1] == 3:
            return NO_CLOUDS
        grid = "points" if len(shape) == 3 else "elevations, spacing=(dx, dy)"
        return f"make one by gm.Surface.from_grid({grid})"
    if hasattr(value, "vertices") and (hasattr(value, "faces") or hasattr(value, "triangles")):
        return NO_MESHES
    if hasattr(value, "faces"):
        return "a face of a part has one: part.faces[0].surface"
    if hasattr(value, "surface"):
        return "give its surface: value.surface"
    if callable(value):
        return "make one by gm.Surface.from_callable(f, ((u0, u1), (v0, v1)))"
    return "make one by gm.Surface.from_callable, from_sympy, from_nurbs or from_grid"
