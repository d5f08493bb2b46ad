"""The samples of a part at prescribed normals: those of its curved faces."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import GaussmapError, GaussmapWarning
from ...runtime.density.at_normals import sample_at_normals
from ...runtime.place.on_surface import geometry_of
from ...runtime.samples.samples import Samples
from .face_pieces import FacePiece
from .space import Space
from .spline_cells import search_cells

__all__ = ["Given", "given_at_normals"]

Array = NDArray[np.float64]
Arrays = dict[str, NDArray[Any]]

# Faces whose normals fill less than this solid angle have no samples at normals.
LEAST_IMAGE = 1e-9
FIELDS = ("points", "normals", "uv", "gaussian_curvature", "mean_curvature", "normal_index")


@dataclass(frozen=True, eq=False)
class Given:
    """Samples at a number of prescribed normals, on pieces (N,)."""

    normals: int
    arrays: Arrays
    pieces: NDArray[np.int64]

    def rows(self, space: Space) -> Array:
        """Return scaled points and normals (N, 6)."""
        points = space.scaled_points(self.arrays["points"])
        return np.column_stack([points, self.arrays["normals"]])


def given_at_normals(space: Space, normals: Array | None, progress: bool) -> Given:
    """Return all points of the part that have one of normals (S, 3), each once."""
    found: list[tuple[int, Samples]] = []
    if normals is not None:
        images = space.images
        for k, piece in enumerate(space.pieces):
            if images[k] > LEAST_IMAGE:
                found += [(k, x) for x in _of_piece(piece, normals, space, progress)]
    arrays = {name: [getattr(x, name) for _, x in found] for name in (*FIELDS, "on_surface")}
    shapes = {"points": (0, 3), "normals": (0, 3), "uv": (0, 2)}
    types = {"normal_index": np.int64, "on_surface": np.bool_}
    joined = {
        name: np.concatenate(
            [np.empty(shapes.get(name, (0,)), types.get(name, np.float64)), *parts]
        )
        for name, parts in arrays.items()
    }
    pieces = np.repeat(np.array([k for k, _ in found], dtype=np.int64), [len(x) for _, x in found])
    return Given(0 if normals is None else len(normals), joined, pieces)


def _of_piece(piece: FacePiece, normals: Array, space: Space, progress: bool) -> list[Samples]:
    """Return the samples of a face at normals; none, with a warning, where it has no spline."""
    found: list[Samples] = []
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GaussmapWarning)  # of the fit, which is only a start
            for part in piece.surface.pieces():
                geometry = geometry_of(
                    part, search_cells(part), np.float64, "surface", space.threads
                )
                samples = sample_at_normals(geometry, normals, progress).samples
                found += [samples] if samples is not None and len(samples) else []
    except GaussmapError as error:
        warnings.warn(
            f"{piece.face.label} has no samples at normals: {error}", GaussmapWarning, stacklevel=7
        )
    return found
