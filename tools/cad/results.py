"""The faces of a part as one space in which samples are placed, and the weights of samples."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import MissingFieldError, SurfaceError
from ...runtime.base.kept import kept
from ...runtime.base.trees import tree_of
from ...runtime.directions.regions import Reach
from ...runtime.samples.samples import Samples
from ..density.cells import AREA, by_piece
from ..density.kernels.sizing import TargetDensity
from ..density.space import Space
from .face_pieces import FacePiece, pieces_of
from .part import Part

__all__ = ["PartSpace", "space_of", "weights_of"]

Array = NDArray[np.float64]

# The number of cells per sample; cells give their areas to the samples.
CELLS_A_SAMPLE = 16


@dataclass(frozen=True, eq=False)
class PartSpace(Space):
    """The faces of a part that can be sampled; `failed` has the reasons of the others, by index."""

    pieces: tuple[FacePiece, ...]
    failed: Mapping[int, str] = field(default_factory=dict)


def space_of(
    part: Part, threads: int | None, target: TargetDensity | None = None, reach: Reach | None = None
) -> PartSpace:
    """Return the space of a part, or of its normals in a `reach`; SurfaceError if it is empty.

    For whole parts, the first cells are cached, except for powers of K, of which there are many; so
    are the attributes of pieces, except rasters of their boundaries, which are large.
    """
    target = target or TargetDensity(floor=1.0)
    if reach is None:
        pieces, failed = kept(part, pieces_of, lambda: pieces_of(part.faces))
    else:
        pieces, failed = pieces_of(part.faces, reach)
    if not pieces:
        if reach is not None and len(failed) < len(part.faces):
            raise SurfaceError(
                f"no normal of part {part.name!r} is within the {reach._smallest.angle:g}° of the "
                "reach; "
                "those of the wall of a bore are at 90° to its axis."
            )
        reason = f": {next(iter(failed.values()))}" if failed else "."
        raise SurfaceError(f"part {part.name!r} has no face that can be sampled{reason}")
    held = {} if reach or target.gauss_weight > 0.0 else kept(part, target, dict)
    copies = tuple(replace(x) for x in pieces)
    return PartSpace(f"part {part.name!r}", copies, target, threads, _held=held, failed=failed)


def weights_of(part: Part, samples: Samples) -> Array:
    """Return the weights of samples (N,): the area on their own face that is nearest to each.

    They add up to the area of each face, or of its part in the reach of the samples. Faces without
    samples do not count. Samples on edges, or not regular, have weight 0.
    """
    found, faces = np.zeros(len(samples)), samples.face_index
    if faces is None:
        raise MissingFieldError(
            "weights of a part need the field 'face_index', and these samples hold "
            f"{', '.join(samples.fields)} only."
        )
    on_edge = samples.other_face_index
    inner = samples._regular if on_edge is None else samples._regular & (on_edge < 0)
    space = space_of(part, None, reach=samples.report._in_reach)
    points = space.scaled_points(samples.points)
    cells = space.uniform.cut(math.sqrt(space.area / (CELLS_A_SAMPLE * max(len(samples), 1))))
    for k, rows in by_piece(cells):
        piece = space.pieces[k]
        here = np.flatnonzero((faces == piece.face.index) & inner)
        if len(here):
            nearest = tree_of(points[here]).query(cells.rows[rows, :3])[1]
            shares = np.bincount(nearest, cells.numbers[rows, AREA], len(here))
            total = shares.sum()
            equal = np.full(len(here), 1.0 / len(here))
            found[here] = piece.area * (shares / total if total > 0.0 else equal)
    return found
