"""The faces of a part as one space in which samples are placed."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import SurfaceError
from ...runtime.base.kept import kept
from ...runtime.directions.regions import Reach
from ..density.kernels.sizing import TargetDensity
from ..density.space import Space
from .face_pieces import FacePiece, pieces_of
from .part import Part

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PartSpace(Space):
    """The faces of a part that can be sampled; `failed` has the reasons why others cannot be.

    The reasons are given by face index.
    """

    pieces: tuple[FacePiece, ...]
    failed: Mapping[int, str] = field(default_factory=dict)

    @property
    def part(self) -> Part:
        """The part."""
        return self.pieces[0].face.part


def space_of(
    part: Part, threads: int | None, target: TargetDensity | None = None, reach: Reach | None = None
) -> PartSpace:
    """Return the space of a part, or of its points in a `reach`; SurfaceError if it is empty.

    For whole parts, the pieces are cached, but without rasters of their boundaries, which are
    large. The initial cells are cached for each target density, except for powers of |K|, which may
    be many. `reach` must contain its conditions on points of the part already; `reached` puts them
    there.
    """
    target = target or TargetDensity(floor=1.0)
    if reach is None:
        pieces, failed = kept(part, pieces_of, lambda: pieces_of(part.faces))
    else:
        pieces, failed = pieces_of(part.faces, reach)
    if not pieces:
        if reach is not None and len(failed) < len(part.faces):
            has_cap = any(cap.angle < 180.0 for cap in reach._caps)
            bore = " (normals of the wall of a bore are at 90° to its axis)" if has_cap else ""
            raise SurfaceError(
                f"part {part.name!r} has no point in reach: {reach._said(part.unit)}{bore}."
            )
        reason = f": {next(iter(failed.values()))}" if failed else "."
        raise SurfaceError(f"part {part.name!r} has no face that can be sampled{reason}")
    held = {} if reach or target.gauss_weight > 0.0 else kept(part, target, dict)
    copies = tuple(replace(x) for x in pieces)
    return PartSpace(f"part {part.name!r}", copies, target, threads, _held=held, failed=failed)
