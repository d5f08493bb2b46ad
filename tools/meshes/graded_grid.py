"""Meshes of samples on a graded grid: its cells, each cut along a diagonal, without any search.

Here x and y are the parameters u and v in the unit square, or v and u if there is a pole at an end
of u: poles are at ends of y.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...runtime.domain.domain import BoundaryPair
from ...runtime.spline.spline import Spline
from .places import ON_SIDE, boundary_of, on_side
from .vertices import Vertices

if TYPE_CHECKING:
    from ...runtime.samples.samples import Samples

__all__ = ["GradedGrid", "Lines"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

# Places between lines are rounded to this part of a cell: a sample that close lies on a line.
FINE = 2.0**-20
# The parameters of samples on a line differ by at most this part of the distance of lines: float32
# rounds them by 6e-8 of the domain.
STRAIGHT = 1e-3
# A periodic parameter needs this number of lines: then no edge joins two vertices twice.
FEWEST = 3
# At most this part of the samples may be off the grid: with more, flips alone may leave folds.
MOST_OFF = 0.3


@dataclass(frozen=True, eq=False)
class Lines:
    """The lines of one parameter of a grid, from its low to its high end.

    `places` ascend. They are those of samples, and those of ends that are open or poles; `added`
    are the numbers of lines before and after those of samples, 0 or 1.
    """

    places: Array
    ends: BoundaryPair
    added: tuple[int, int]

    @classmethod
    def of(cls, positions: Array, ends: BoundaryPair) -> Lines | None:
        """Return the lines of samples at positions (k, lines); None if these are not straight."""
        closes = ends[0] == "periodic"
        off, places = positions - positions[0], positions[0]
        if closes:
            off, places = off - np.rint(off), places[0] + (places - places[0]) % 1.0
        steps = np.diff(places, append=places[0] + 1.0)
        before, after = np.roll(steps, 1), steps.copy()
        if not closes:
            before[0] = after[-1] = 1.0
        nearest = np.minimum(before, after)
        if nearest.min() <= 0.0 or (np.abs(off).max(axis=0) > STRAIGHT * nearest).any():
            return None
        if closes:
            return None if len(places) < FEWEST else cls(places, ends, (0, 0))
        low, high = int(places[0] > ON_SIDE), int(places[-1] < 1.0 - ON_SIDE)
        if (ends[0] == "pole" and not low) or (ends[1] == "pole" and not high):
            return None
        inner = places[1 - low : len(places) - 1 + high]
        return cls(np.concatenate([[0.0], inner, [1.0]]), ends, (low, high))

    @property
    def closes(self) -> bool:
        """Whether the parameter is periodic."""
        return self.ends[0] == "periodic"

    @property
    def cells(self) -> int:
        """The number of cells between the lines."""
        return len(self.places) if self.closes else len(self.places) - 1

    def at(self, numbers: Array) -> Array:
        """Return positions (k,) from numbers of lines."""
        places = np.append(self.places, self.places[0] + 1.0)
        positions = np.interp(numbers, np.arange(len(places)), places)
        return positions % 1.0 if self.closes else positions

    def numbers(self, positions: Array) -> Array:
        """Return positions (k,) as numbers of lines: 2.5 is between the third and the fourth."""
        places, first = self.places, self.places[0]
        if self.closes:
            places, positions = np.append(places, first + 1.0), first + (positions - first) % 1.0
        else:
            on_end = np.abs(positions - np.rint(positions)) <= ON_SIDE
            positions = np.where(on_end, np.rint(positions), positions)
        return np.interp(positions, places, np.arange(len(places)))


@dataclass(frozen=True, eq=False)
class GradedGrid:
    """Samples at the nodes of lines of x and y, and nodes that are added at ends.

    `nodes` (lines of y, lines of x) are numbers of vertices: the first ones are the samples.
    `vertices` have positions x, y; `places` (k, 2) are the same as numbers of lines. `between` are
    the numbers of vertices between the lines. `is_swapped` says whether x and y are v and u.
    """

    x: Lines
    y: Lines
    nodes: Indices
    vertices: Vertices
    places: Array
    between: Indices
    is_swapped: bool

    @classmethod
    def of(cls, samples: Samples, spline: Spline) -> GradedGrid | None:
        """Return the lattice of samples.

        None unless they are on a complete grid, but for some in between, and the surface is neither
        trimmed nor one-sided.
        """
        numbers = None if spline.trim is not None else _numbers(samples)
        if numbers is None:
            return None
        boundary = boundary_of(spline, apexes=True)
        with_poles = ["pole" in ends for ends in boundary]
        if "mirrored" in boundary[0] + boundary[1] or all(with_poles):
            return None
        positions = spline.in_cells(samples.uv.astype(np.float64)) / spline.cells
        positions = np.clip(positions, 0.0, 1.0)
        if with_poles[0]:
            numbers, positions, boundary = numbers.T, positions[:, ::-1], boundary[::-1]
        x = Lines.of(positions[numbers, 0], boundary[0])
        y = Lines.of(positions[numbers.T, 1], boundary[1])
        if x is None or y is None:
            return None
        return cls._between(x, y, numbers, positions, with_poles[0])

    @classmethod
    def _between(
        cls, x: Lines, y: Lines, numbers: Indices, positions: Array, is_swapped: bool
    ) -> GradedGrid:
        """Add the nodes at ends."""
        count = len(positions)
        nodes = np.pad(numbers, (y.added, x.added), constant_values=-1)
        is_added = nodes < 0
        at_poles = [row for row, end in zip((0, -1), y.ends, strict=True) if end == "pole"]
        is_added[at_poles, 1:] = False
        row, column = np.nonzero(is_added)
        nodes[is_added] = count + np.arange(len(row))
        nodes[at_poles] = nodes[at_poles, :1]
        places = np.stack([x.numbers(positions[:, 0]), y.numbers(positions[:, 1])], axis=1)
        places = np.rint(places / FINE) * FINE
        own = np.indices(numbers.shape)
        places[numbers] = np.stack([own[1] + x.added[0], own[0] + y.added[0]], axis=-1)
        places = np.concatenate([places, np.stack([column, row], axis=1).astype(np.float64)])
        added = np.stack([x.places[column], y.places[row]], axis=1)
        sample = np.concatenate([np.arange(count), np.full(len(row), -1)])
        vertices = Vertices(np.concatenate([positions, added]), sample, _is_free(places, x, y))
        between = np.setdiff1d(np.arange(count), numbers)
        return cls(x, y, nodes, vertices, places, between, is_swapped)

    def along(self, axis: int) -> Lines:
        """Return the lines of x (axis 0) or y (axis 1)."""
        return self.y if axis else self.x

    def uv(self, positions: Array) -> Array:
        """Return positions u, v (k, 2) of positions x, y."""
        return positions[:, ::-1] if self.is_swapped else positions

    def on_side(self, axis: int, place: int, along: Array) -> Array:
        """Return positions (k, 2) at an end of x (axis 0) or y (axis 1), at lines of the other."""
        return on_side(axis, place, self.along(1 - axis).at(along))

    def triangles(self) -> tuple[Indices, Indices]:
        """Return triangles (k, 3), counterclockwise in x and y, and their cells (k,)."""
        closes = ((0, int(self.y.closes)), (0, int(self.x.closes)))
        nodes = np.pad(self.nodes, closes, mode="wrap")
        a, b, c, d = nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, 1:], nodes[1:, :-1]
        triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
        cell = np.arange(len(triangles)) // 2
        at_pole = (triangles[:, 0] == triangles[:, 1]) | (triangles[:, 1] == triangles[:, 2])
        return triangles[~at_pole], cell[~at_pole]


def _is_free(places: Array, x: Lines, y: Lines) -> Flags:
    """Say which places are neither on an open side nor at a pole."""
    is_free = np.ones(len(places), dtype=bool)
    for along, lines in zip(places.T, (x, y), strict=True):
        if not lines.closes:
            is_free &= (along > 0.0) & (along < lines.cells)
    return is_free


def _numbers(samples: Samples) -> Indices | None:
    """Return the numbers of the samples at the nodes (rows, columns) of a complete grid."""
    row, column = samples.row, samples.column
    if row is None or column is None:
        return None
    on_grid = np.flatnonzero((row >= 0) & (column >= 0))
    if len(on_grid) < max((1.0 - MOST_OFF) * len(row), 1.0):
        return None
    shape = int(row[on_grid].max()) + 1, int(column[on_grid].max()) + 1
    if shape[0] * shape[1] != len(on_grid):
        return None
    numbers = np.full(shape, -1)
    numbers[row[on_grid], column[on_grid]] = on_grid
    return None if (numbers < 0).any() else numbers
