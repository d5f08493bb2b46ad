"""Cells: rectangles of parameters, each with a place, a parameter pair that may become a sample.

The place of a cell is inside the trim: it is the midpoint of the cell, or another point of a raster
in the cell if the midpoint is outside. Where the inside is too narrow for the raster, the cell is
replaced by points next to the boundary: *point cells*, which have almost no extent.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.memory import check_memory
from .kernels.cells import cut_into_parts

Sides = NDArray[np.float32]

# The columns of `numbers`, see kernels/cells.py.
RADIUS, CHORD, ALONG_U, ALONG_V, BEND_U, BEND_V, AREA = range(7)
NUMBERS = 7
# Half the size of a point cell, relative to the domain of its piece.
POINT = 1e-9


@dataclass(frozen=True, eq=False)
class Cells:
    """M cells: indices of their `pieces` (M,), boxes (M, 4) as u0, v0, u1, v1, and places (M, 2).

    `whole` (M,) is True for cells that no boundary intersects. `limits` (M,) are least radii of
    curvature, which replace smaller radii; 0 if unknown. `rows` (M, 8) and `numbers` (M, 7) are
    those of kernels/cells.py, lengths and curvatures scaled as in `Space`. These two arrays take
    most of the memory: both are (M, 0) for cells that are not evaluated; `numbers` is (M, 0) for
    cells that keep only their rows.
    """

    pieces: Indices
    boxes: Array
    places: Array
    whole: Flags
    limits: Array
    rows: Array
    numbers: Array

    def __len__(self) -> int:
        return len(self.pieces)

    def __getitem__(self, chosen: Indices | Flags | slice) -> Cells:
        """Return the selected cells."""
        return Cells(*(x[chosen] for x in vars(self).values()))

    def __add__(self, other: Cells) -> Cells:
        """Return these cells, followed by the cells of `other`."""
        return joined([self, other])

    def with_rows(self) -> Cells:
        """Return the same cells with rows and numbers filled with 0."""
        rows, numbers = np.zeros((len(self), 8)), np.zeros((len(self), NUMBERS))
        return replace(self, limits=self.limits.copy(), rows=rows, numbers=numbers)

    def without_rows(self) -> Cells:
        """Return the same cells, not evaluated; they keep their limits."""
        nothing = np.empty((len(self), 0))
        return replace(self, rows=nothing, numbers=nothing)

    def without_numbers(self) -> Cells:
        """Return the same cells with their rows only."""
        return replace(self, numbers=np.empty((len(self), 0)))

    def sorted(self) -> Cells:
        """Return the same cells, sorted by their pieces."""
        if (np.diff(self.pieces) < 0).any():
            return self[np.argsort(self.pieces, kind="stable")]
        return self

    def write(self, rows: Indices, cells: Cells) -> None:
        """Replace the cells with the indices `rows` by the same number of other cells."""
        for mine, others in zip(vars(self).values(), vars(cells).values(), strict=True):
            mine[rows] = others

    # --- radii and chords -------------------------------------------------------------------------

    @property
    def radii(self) -> Array:
        """The radii (M,) of balls around the places; each ball contains its cell."""
        return self.numbers[:, RADIUS]

    @property
    def chords(self) -> Array:
        """The largest chord (M,) between the normal at each place and a normal of its cell.

        An unknown chord is 2.
        """
        return self.numbers[:, CHORD]


def joined(parts: Sequence[Cells]) -> Cells:
    """Return the cells of all parts, concatenated."""
    parts = [x for x in parts if len(x)] or parts[:1]
    if len(parts) == 1:
        return parts[0]
    arrays = zip(*(vars(x).values() for x in parts), strict=True)
    return Cells(*map(np.concatenate, arrays))


def merged(parts: Sequence[Cells]) -> Cells:
    """Return the cells of all parts, sorted by their pieces.

    Arrays are sorted one by one, since copies of all of them would be large.
    """
    pieces = np.concatenate([x.pieces for x in parts])
    if (np.diff(pieces) >= 0).all():
        return joined(parts)
    order = np.argsort(pieces, kind="stable")
    arrays = zip(*(vars(x).values() for x in parts), strict=True)
    return Cells(*(np.concatenate(x)[order] for x in arrays))


def halved(cells: Cells, along_u: Flags) -> Cells:
    """Return the halves (2 M) of cells, not evaluated.

    Where `along_u` (M,) is True, the u interval of the cell is bisected, elsewhere its v interval.
    """
    return into_parts(cells, np.where(along_u[:, None], (2, 1), (1, 2)))


def into_parts(cells: Cells, parts: Indices) -> Cells:
    """Return the parts of cells, not evaluated; their numbers along u and v are `parts` (M, 2)."""
    total = parts.prod(axis=1)
    check_memory("candidates", total.sum())
    owner = np.repeat(np.arange(len(cells)), total)
    boxes = np.empty((len(owner), 4))
    cut_into_parts(np.ascontiguousarray(cells.boxes), np.ascontiguousarray(parts), boxes)
    return new_cells(cells.pieces[owner], boxes, cells.whole[owner], cells.limits[owner])


def runs(numbers: Indices) -> Iterator[tuple[int, slice]]:
    """Yield the runs of equal integers in an array (k,): the integer, and the slice of the run."""
    ends = (np.flatnonzero(np.diff(numbers)) + 1).tolist()
    if len(numbers):
        firsts = [0, *ends]
        yield from zip(
            numbers[firsts].tolist(), map(slice, firsts, [*ends, len(numbers)]), strict=True
        )


def grouped(numbers: Indices) -> Iterator[tuple[int, Indices]]:
    """Yield the distinct integers of an array (k,), sorted, each with its indices in the array."""
    rows = np.argsort(numbers, kind="stable")
    for number, part in runs(numbers[rows]):
        yield number, rows[part]


def new_cells(
    pieces: Indices, boxes: Array, whole: Flags | bool = False, limits: Array | float = 0.0
) -> Cells:
    """Return unevaluated cells of pieces (M,), with the midpoints of their boxes as places."""
    count = len(pieces)
    places, nothing = (boxes[:, :2] + boxes[:, 2:]) / 2.0, np.empty((count, 0))
    whole, limits = np.full(count, whole), np.full(count, limits, dtype=np.float64)
    return Cells(pieces, boxes, places, whole, limits, nothing, nothing)


def points_of(pieces: Indices, places: Array, sizes: Array, limits: Array | float = 0.0) -> Cells:
    """Return unevaluated point cells at parameters (k, 2) of pieces (k,).

    `sizes` (k, 2) are the lengths of the domains of these pieces.
    """
    boxes = np.concatenate([places - POINT * sizes, places + POINT * sizes], axis=1)
    return new_cells(pieces, boxes, True, limits)
