"""The faces of a CAD part as triangles, for pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import SurfaceError
from ..cad.face_pieces import FacePiece, pieces_of
from ..cad.part import Part
from .scene import Scene

__all__ = ["part_scene"]

FLAT, CURVED = 2, 40  # grid lines across a plane, and across other faces
SMALL = 12  # of parts with many faces
MANY = 60
PIECES = 160  # into which the border of a face is divided, about


def part_scene(part: Part, seen_from: NDArray[np.float64] | None = None) -> Scene:
    """Return the scene of a part: triangles of its faces, and their borders as lines.

    Raises SurfaceError if no face can be used.
    """
    fine = SMALL if len(part) > MANY else CURVED
    pieces, _ = pieces_of(part.faces)
    if not pieces:
        raise SurfaceError(f"{part.name!r} has no face that can be drawn.")
    drawn = [_drawn(piece, fine) for piece in pieces]
    triangles = np.concatenate([triangles for triangles, _ in drawn])
    lines = tuple(line for _, lines in drawn for line in lines)
    return Scene.made(triangles[:, [0, 1, 2, 2]], lines, seen_from)


def _drawn(piece: FacePiece, fine: int) -> tuple[NDArray[np.float64], list[NDArray[np.float64]]]:
    """Return triangles (k, 3, 3) of a face, and its border as lines."""
    from scipy.spatial import Delaunay

    surface = piece.surface
    low, high = np.array(surface.domain).T
    size = high - low
    loops = [np.clip(low + size * _divided((x - low) / size), low, high) for x in piece.polygons]
    across = FLAT if piece.face.kind == "plane" else fine
    grid = np.stack(np.meshgrid(*np.linspace(low, high, across + 1).T, indexing="ij"), axis=2)
    if surface.trim is None:
        places = grid.reshape(-1, 2)
    else:
        inner = grid.reshape(-1, 2)
        inner = inner[surface.trim.contains(inner)]
        places = np.unique(np.concatenate([inner, *(x[:-1] for x in loops)]), axis=0)
    triangles = Delaunay((places - low) / size, qhull_options="QJ Pp").simplices
    if surface.trim is not None:
        triangles = triangles[surface.trim.contains(places[triangles].mean(axis=1))]
    points = surface.evaluate(*places.T)
    return points[triangles], [surface.evaluate(*loop.T) for loop in loops]


def _divided(loop: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a closed polygon in the unit square with more points; the first one is repeated."""
    closed = np.concatenate([loop, loop[:1]])
    steps = np.diff(closed, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    counts = np.maximum(np.ceil(lengths * PIECES / max(lengths.sum(), 1e-300)), 1).astype(int)
    parts = [
        start + np.arange(count)[:, None] / count * step
        for start, step, count in zip(closed[:-1], steps, counts, strict=True)
    ]
    return np.concatenate([*parts, closed[-1:]])
