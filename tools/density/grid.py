"""Samples on a grid of parameter lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...runtime.base.aliases import Indices
from ...runtime.samples.fields import GRID_NAMES
from ...runtime.samples.samples import Samples
from .cells import Cells


@dataclass(frozen=True, eq=False)
class Grid:
    """Samples on a grid: cells whose places are the samples, and the indices of the grid lines.

    `rows` and `columns` (N,) are, for each sample, the indices of its lines v = const and u =
    const, or −1 for a sample between lines. `lines` are the numbers of lines u = const and v =
    const.
    """

    cells: Cells
    rows: Indices
    columns: Indices
    lines: tuple[int, int]

    def __len__(self) -> int:
        return len(self.rows)

    def __add__(self, other: Grid) -> Grid:
        """Return the samples of this grid, followed by the samples of the grid of another piece.

        The line indices of the other grid follow the line indices of this grid.
        """
        rows, columns = (
            np.concatenate([x, np.where(y < 0, -1, y + first)])
            for x, y, first in zip(
                (self.rows, self.columns),
                (other.rows, other.columns),
                self.lines[::-1],
                strict=True,
            )
        )
        lines = self.lines[0] + other.lines[0], self.lines[1] + other.lines[1]
        return Grid(self.cells + other.cells, rows, columns, lines)

    @property
    def border(self) -> int:
        """The number of samples at the boundary of a trim, next to a crossing without a sample."""
        from scipy.ndimage import binary_erosion

        inside = np.zeros(self.lines, dtype=np.bool_)
        on = self.rows >= 0
        inside[self.columns[on], self.rows[on]] = True
        return int(inside.sum() - binary_erosion(inside, border_value=1).sum())


def lines_of(grid: Grid | None, count: int, fields: Sequence[str]) -> dict[str, Indices]:
    """Return the fields row and column, as far as they are in `fields`, for `count` samples.

    The first samples are the samples of the grid; for all other samples, row and column are −1.
    """
    found = {name: np.full(count, -1, dtype=np.int64) for name in GRID_NAMES if name in fields}
    if grid is not None:
        for name, numbers in zip(GRID_NAMES, (grid.rows, grid.columns), strict=True):
            if name in found:
                found[name][: len(grid)] = numbers
    return found


def without_lines(samples: Samples) -> Samples:
    """Return samples without the fields row and column if none of them is on a grid."""
    if samples.row is None or samples.column is None or (samples.row >= 0).any():
        return samples
    return replace(samples, row=None, column=None)
