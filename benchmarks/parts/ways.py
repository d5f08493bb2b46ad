"""Who samples parts: gaussmap by density, Gmsh, and farthest points of a dense uniform cloud."""

# Only `make parts-quality` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

import multiprocessing
import resource
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import gaussmap as gm
import numpy as np
from gaussmap.tools.cad.part import Part

from ..peers.forms import Array
from .reference import reference

__all__ = ["BALANCED", "FARTHEST", "GMSH", "LIMIT", "WAYS", "Cloud", "File", "Way", "within"]

Result = TypeVar("Result")

MILLIMETRES = 1e3
# Farthest points are chosen in a cloud of this many places.
CLOUD = 200_000
# Gmsh: before all sizes are scaled a full turn of the normal has ELEMENTS, and the largest size is
# one of LARGEST, relative to the diagonal. The count is met within NEAR, if TRIES are enough for
# that, and CLOSE at any rate. A largest size is given up if the tries take more than LIMIT seconds
# of a processor.
ELEMENTS, LARGEST = 12.0, (1.0, 0.06, 0.04)
NEAR, CLOSE, TRIES = 0.02, 0.05, 7
LIMIT = 180


@dataclass(frozen=True)
class Cloud:
    """Points (N, 3) in millimetres; of each, unit normals (N, k, 3), NaN where it has fewer."""

    points: Array
    normals: Array

    def __len__(self) -> int:
        return len(self.points)


@dataclass(frozen=True)
class File:
    """A file, what Open CASCADE and gaussmap read in it, and how many samples are asked for."""

    path: Path
    shape: Any
    part: Part
    count: int


@dataclass(frozen=True)
class Way:
    """A way to points with normals on a part, about as many as are asked for.

    Of several clouds the one with the smallest product of gap and angle is judged.
    """

    title: str
    clouds: Callable[[File], list[Cloud]]


def sampled(density: str) -> Callable[[File], list[Cloud]]:
    """Return samples of gaussmap."""

    def clouds(file: File) -> list[Cloud]:
        samples = gm.sample(file.part, count=file.count, density=density)
        points = samples.points * (file.part.metres * MILLIMETRES)
        return [Cloud(points, samples.normals[:, None])]

    return clouds


def farthest(file: File) -> list[Cloud]:
    """Choose points, each the one farthest from those before it, in a dense uniform cloud."""
    import open3d

    dense = reference(file.shape, CLOUD, seed=1)
    drawn = np.flatnonzero(dense.areas > 0.0)
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(dense.points[drawn]))
    cloud.normals = open3d.utility.Vector3dVector(dense.normals[drawn])
    chosen = cloud.farthest_point_down_sample(file.count)
    return [Cloud(np.asarray(chosen.points), np.asarray(chosen.normals)[:, None])]


def meshed(file: File) -> list[Cloud]:
    """Return the vertices of meshes by Gmsh, of sizes by curvature with several largest sizes.

    A vertex on an edge has the normals of all faces there. Raises TimeoutError if no largest size
    has a mesh in time.
    """
    clouds = [within(LIMIT, mesh_of, file.path, file.count, largest) for largest in LARGEST]
    done = [x for x in clouds if x is not None]
    if not done:
        raise TimeoutError(f"no mesh within {LIMIT} s")
    return [x for x in done if abs(len(x) / file.count - 1.0) <= CLOSE]


def within(seconds: int, work: Callable[..., Result], *arguments: Any) -> Result | None:
    """Return what work returns, or None if it takes longer than some seconds of a processor.

    It runs in a process of its own, which the system ends then.
    """
    limits = resource.RLIMIT_CPU, (seconds, seconds)
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, context, resource.setrlimit, limits) as pool:
        try:
            return pool.submit(work, *arguments).result()
        except BrokenProcessPool:
            return None


def mesh_of(path: Path, count: int, largest: float) -> Cloud:
    """Return about a count of vertices of a mesh, of a largest size relative to the diagonal."""
    import gmsh

    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", ELEMENTS)
    gmsh.model.occ.importShapes(str(path))
    gmsh.model.occ.synchronize()
    box = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    gmsh.option.setNumber("Mesh.MeshSizeMax", largest * float(np.linalg.norm(box[1] - box[0])))
    return tuned(count)


def tuned(count: int) -> Cloud:
    """Scale all sizes in Gmsh until a mesh has about a count of vertices."""
    import gmsh

    factor, low, high, cloud = 1.0, 0.0, np.inf, Cloud(np.empty((0, 3)), np.empty((0, 1, 3)))
    for _ in range(TRIES):
        gmsh.model.mesh.clear()
        gmsh.option.setNumber("Mesh.MeshSizeFactor", factor)
        gmsh.model.mesh.generate(2)
        cloud = vertices()
        ratio = len(cloud) / count
        if abs(ratio - 1.0) < NEAR:
            break
        low, high = (factor, high) if ratio > 1.0 else (low, factor)
        factor *= np.sqrt(ratio)
        if not low < factor < high:
            factor = (low + high) / 2.0
    return cloud


def vertices() -> Cloud:
    """Return the vertices of the mesh that Gmsh has made."""
    import gmsh

    nodes, points, normals = [], [], []
    for _, tag in gmsh.model.getEntities(2):
        tags, places, parameters = gmsh.model.mesh.getNodes(2, tag, includeBoundary=True)
        nodes.append(tags)
        points.append(np.reshape(places, (-1, 3)))
        normals.append(np.reshape(gmsh.model.getNormal(tag, parameters), (-1, 3)))
    rows, joined = np.concatenate(nodes), np.concatenate(normals)
    once, first, owner = np.unique(rows, return_index=True, return_inverse=True)
    order = np.argsort(owner, kind="stable")
    number = np.empty(len(rows), dtype=np.int64)
    starts = np.searchsorted(owner[order], np.arange(len(once)))
    number[order] = np.arange(len(rows)) - starts[owner[order]]
    found = np.full((len(once), number.max() + 1, 3), np.nan)
    found[owner, number] = joined
    return Cloud(np.concatenate(points)[first], found)


BALANCED = Way("**balanced**", sampled("balanced"))
GMSH = Way("Gmsh, curvature size", meshed)
FARTHEST = Way("Open3D, farthest point", farthest)
WAYS = (
    BALANCED,
    Way("**uniform**", sampled("uniform")),
    GMSH,
    FARTHEST,
)
