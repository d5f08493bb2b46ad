"""The parabolic points of a smooth surface: K = 0 by subdivision (paper, Remark 3.1).

Contour lines on a grid find the curves across which K changes its sign; each vertex is then moved
to a zero of K. Rectangles in which K keeps its sign are subdivided as long as K may vanish there,
by its bounds: those left at the tolerance hold points or curves where K touches zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...runtime.surface.surface import Surface
from .curvature_field import CurvatureField
from .rectangles import clusters, merged, touching
from .sign_grid import SignGrid
from .touching_zeros import TouchingZeros, parted, touching_zeros
from .zero_curves import zero_curves

__all__ = ["Search", "field_of", "search"]

Array = NDArray[np.float64]
PANELS = (8, 8)
MOST_PANELS = 64
# Cells of the grid along a side of a panel; doubled where a curve is too small for them.
CELLS = 16
MOST_LINES = 512


@dataclass(frozen=True, eq=False)
class Search:
    """The zeros of K, all in parameters.

    `polylines` are (k, 2) with whether they are closed; `boxes` (k, 2, 2) are rectangles (low and
    high corner) that hold zeros of K without a change of sign, and `flat` (k, 2, 2) those where K
    is zero up to its error. `unresolved` is the share of the domain where K is not known.
    """

    polylines: list[tuple[Array, bool]]
    boxes: Array
    flat: Array
    unresolved: float


def field_of(surface: Surface, cells: tuple[int, int] | None) -> CurvatureField:
    """Return K on panels: as many as asked, or as many as resolve the most of the domain."""
    panels = PANELS if cells is None else cells
    best = CurvatureField.of_surface(surface, panels)
    while cells is None and (best.unresolved | best.rough).any() and max(panels) < MOST_PANELS:
        panels = (2 * panels[0], 2 * panels[1])
        finer = CurvatureField.of_surface(surface, panels)
        if _known(finer) < _known(best):
            best = finer
    return best


def _known(field: CurvatureField) -> tuple[float, float]:
    """Return the shares of the domain where K is unresolved, and where it is not accurate."""
    return field.share(field.unresolved), field.share(field.rough)


def search(field: CurvatureField, size: Array) -> Search:
    """Find the zeros of K; rectangles are subdivided to the `size` (2,), in parameters."""
    grid, found = _fine_enough(field, size)
    polylines, near_crossing = zero_curves(grid, size)
    small, large = parted(grid, merged(np.concatenate([grid.rectangles(grid.flat), found.zero])))
    flat = merged(np.concatenate([grid.rectangles(grid.panels(field.flat)), large]))
    boxes = np.concatenate([found.boxes, small])
    boxes = boxes[~near_crossing[grid.cells_at(boxes.mean(axis=1))]]
    groups = clusters(boxes, size)
    at_flat = np.array([touching(group, flat, size).any() for group in groups], dtype=bool)
    rim = [boxes[touching(group, boxes, 0.0 * size)] for group in groups[at_flat]]
    return Search(
        polylines,
        groups[~at_flat],
        np.concatenate([flat, *rim]),
        field.share(field.unresolved),
    )


def _fine_enough(field: CurvatureField, size: Array) -> tuple[SignGrid, TouchingZeros]:
    """Double the cells until the signs at their corners show every curve that is not tiny."""
    cells = CELLS
    while True:
        grid = SignGrid(field, cells)
        found = touching_zeros(grid, size, 2 * cells * max(field.noise.shape) > MOST_LINES)
        if found is not None:
            return grid, found
        cells *= 2
