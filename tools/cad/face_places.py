"""The points of a face that have given normals, and undecided boxes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ...runtime.proof.index import Undecided

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class FacePlaces(NamedTuple):
    """Points of a face, and undecided boxes, which may contain further points.

    numbers (k,) are the indices of normals, uv (k, 2) parameters, radius (k, 2) bounds of their
    errors, and sign (k,) the signs of the Gaussian curvature.
    """

    numbers: Indices
    uv: Array
    radius: Array
    sign: Array
    undecided: Undecided

    def reversed_in(self, total: float) -> FacePlaces:
        """Return the same points for the parameter total − u instead of u."""
        uv, boxes, middles = self.uv.copy(), self.undecided.boxes.copy(), self.undecided.uv.copy()
        uv[:, 0], middles[:, 0] = total - uv[:, 0], total - middles[:, 0]
        boxes[:, :2] = total - boxes[:, 1::-1]
        rounding = np.array([2.0**-52 * abs(total), 0.0])
        open_ = self.undecided._replace(boxes=boxes, uv=middles)
        return self._replace(uv=uv, radius=self.radius + rounding, undecided=open_)


class FaceIndex(Protocol):
    """An index that finds all points of a face with given normals."""

    def query(self, normals: Array, threads: int | None = None) -> FacePlaces:
        """Return all points with unit normals (S, 3), except those in undecided boxes."""
        ...


def undecided(numbers: Indices, boxes: Array, kind: int, border: bool) -> Undecided:
    """Return undecided boxes (k, 4) of one kind, for the normals with indices `numbers` (k,)."""
    count = len(numbers)
    return Undecided(
        numbers, boxes, np.full(count, kind), np.full(count, border), np.full(count, np.nan),
        boxes.reshape(-1, 2, 2).mean(axis=2),
    )  # fmt: skip


NO_NUMBERS = np.empty(0, np.int64)
NOTHING = FacePlaces(
    NO_NUMBERS, np.empty((0, 2)), np.empty((0, 2)), np.empty(0),
    undecided(NO_NUMBERS, np.empty((0, 4)), 0, border=False),
)  # fmt: skip


def joined(parts: Sequence[FacePlaces]) -> FacePlaces:
    """Return the points of several pieces of a face, sorted by the indices of their normals."""
    parts = [x for x in parts if len(x.numbers) or len(x.undecided.numbers)]
    if len(parts) < 2:
        return parts[0] if parts else NOTHING
    numbers, uv, radius, sign = (
        np.concatenate(x) for x in zip(*(part[:4] for part in parts), strict=True)
    )
    boxes = Undecided._make(
        np.concatenate(x) for x in zip(*(part.undecided for part in parts), strict=True)
    )
    order = np.argsort(numbers, kind="stable")
    of_boxes = np.argsort(boxes.numbers, kind="stable")
    return FacePlaces(
        numbers[order], uv[order], radius[order], sign[order],
        Undecided._make(x[of_boxes] for x in boxes),
    )  # fmt: skip
