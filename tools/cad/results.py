"""What is known of samples of a part: their fields, weights, coverage and deviation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.checks import finite_array
from ...runtime.base.errors import MissingFieldError, SurfaceError
from ...runtime.base.trees import tree_of
from ...runtime.density.coverage import coverage_by
from ...runtime.density.deviation import NormalDeviation, angle_by, deviation_by, places_for
from ...runtime.kernels.refine import evaluate_jets
from ...runtime.kernels.sizing import TargetDensity
from ...runtime.samples.fields import dtype_of
from ...runtime.samples.samples import Samples
from .at_normals import Given
from .cells import AREA, Cells, by_piece
from .face_pieces import pieces_of
from .part import Part
from .space import Space

__all__ = [
    "arrays_of",
    "coverage_of",
    "deviation_of",
    "reached_angle",
    "reached_coverage",
    "space_of",
    "weights_of",
]

Array = NDArray[np.float64]

# The search for the coverage ends when the bound is within this factor of a distance found.
TIGHT = 1.02
# Cells for each sample, whose areas are divided among the samples.
CELLS_A_SAMPLE = 16


def space_of(part: Part, threads: int | None, target: TargetDensity | None = None) -> Space:
    """Return the space of a part; SurfaceError if no face can be sampled."""
    pieces, failed = pieces_of(part.faces)
    if not pieces:
        reason = f": {next(iter(failed.values()))}" if failed else "."
        raise SurfaceError(f"part {part.name!r} has no face that can be sampled{reason}")
    return Space(part.name, tuple(pieces), target or TargetDensity(), threads, failed=failed)


def arrays_of(
    space: Space, added: Cells, given: Given, fields: Sequence[str], dtype: DTypeLike
) -> dict[str, NDArray[Any]]:
    """Return fields of the samples at normals, followed by those at places of cells."""
    found = _evaluated(space, added)
    joined = {name: np.concatenate([given.arrays[name], found[name]]) for name in given.arrays}
    pieces = np.concatenate([given.pieces, added.pieces])
    joined["support"] = np.einsum("ij,ij->i", joined["points"], joined["normals"])
    joined["face_index"] = np.array([x.face.index for x in space.pieces])[pieces]
    joined["solid_index"] = np.array([x.face.solid_index for x in space.pieces])[pieces]
    return {name: joined[name].astype(dtype_of(name, dtype), copy=False) for name in fields}


def _evaluated(space: Space, cells: Cells) -> dict[str, NDArray[Any]]:
    """Return the surfaces at the places of cells."""
    order = np.argsort(cells.pieces, kind="stable")
    count, sorted_ = len(cells), cells[order]
    points, normals = np.empty((count, 3)), np.empty((count, 3))
    gaussian, mean = np.empty(count), np.empty(count)
    for k, rows in by_piece(sorted_):
        jets = space.pieces[k].surface.jets(*sorted_.places[rows].T.copy())
        here, scales = order[rows], np.array([space.unit, *space.pieces[k].sizes])
        n, K, H = np.empty((len(here), 3)), np.empty(len(here)), np.empty(len(here))
        evaluate_jets(jets, scales, n, K, H)
        points[here], normals[here], gaussian[here], mean[here] = jets[:, 0], n, K, H
    return {
        "points": points,
        "normals": normals,
        "uv": cells.places,
        "gaussian_curvature": gaussian,
        "mean_curvature": mean,
        "normal_index": np.full(count, -1),
        "on_surface": np.ones(count, dtype=np.bool_),
    }


def coverage_of(part: Part, points: NDArray[np.floating], threads: int | None) -> float:
    """Return what `Samples.coverage` returns, for points (N, 3)."""
    space = space_of(part, threads)
    return reached_coverage(space, space.scaled_points(points)) / space.unit


def reached_coverage(space: Space, points: Array, asked: float = math.inf) -> float:
    """Return a bound of the distance from the part to the nearest of scaled points (N, 3)."""
    if len(points) == 0:
        return math.inf
    uniform = space.uniform
    radius = min(asked, 2.0 * math.sqrt(space.area / len(points)))
    cells: Any = uniform.cut(radius)
    return coverage_by(cells, space.area, points, asked, TIGHT)


def deviation_of(
    part: Part, points: NDArray[np.floating], normals: NDArray[np.floating], threads: int | None
) -> NormalDeviation:
    """Return what `Samples.normal_deviation` returns, for points and normals (N, 3)."""
    normals, space = finite_array(normals, (len(points), 3), "normals"), space_of(part, threads)
    return deviation_by(_places(space, len(points)), space.scaled_points(points), normals, threads)


def reached_angle(space: Space, normals: Array) -> float:
    """Return the largest angle that is found from a normal of the part to the nearest of (N, 3)."""
    if len(normals) == 0:
        return 180.0
    return angle_by(_places(space, len(normals)), normals, space.threads)


def _places(space: Space, samples: int) -> Any:  # noqa: ANN401 - cells, as triangles
    """Return cells at whose places normals are compared with those of samples first."""
    return space.uniform.cut(math.sqrt(space.area / places_for(samples)))


def weights_of(part: Part, samples: Samples) -> Array:
    """Return what `Samples.weights` returns: the areas (N,) nearest to each on its own face.

    They add up to the area of the face. Of faces without samples, the area is left out; samples on
    edges have none.
    """
    found, faces = np.zeros(len(samples)), samples.face_index
    if faces is None:
        raise MissingFieldError(
            "weights of a part need the field 'face_index', and these samples hold "
            f"{', '.join(samples.fields)} only."
        )
    on_edge = samples.other_face_index
    inner = np.ones(len(samples), np.bool_) if on_edge is None else on_edge < 0
    space = space_of(part, None)
    points = space.scaled_points(samples.points)
    cells = space.uniform.cut(math.sqrt(space.area / (CELLS_A_SAMPLE * max(len(samples), 1))))
    for k, rows in by_piece(cells):
        face = space.pieces[k].face
        here = np.flatnonzero((faces == face.index) & inner)
        if len(here):
            nearest = tree_of(points[here]).query(cells.rows[rows, :3])[1]
            shares = np.bincount(nearest, cells.numbers[rows, AREA], len(here))
            total = shares.sum()
            equal = np.full(len(here), 1.0 / len(here))
            found[here] = face.area * (shares / total if total > 0.0 else equal)
    return found
