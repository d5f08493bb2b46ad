"""The parabolic points of a smooth surface: K = 0 by subdivision (paper, Remark 3.1).

A grid finds the curves across which K changes its sign; each vertex of theirs is then improved to
the accuracy of K. Rectangles in which K keeps its sign are subdivided as long as the bounds of K
leave a zero open: what remains at the tolerance are points or curves where K only touches zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..surface import Surface
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
    """What a search found, all in parameters.

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
    """Return on how much of the domain K is not known, and not well: less is better."""
    return field.share(field.unresolved), field.share(field.rough)


def search(field: CurvatureField, size: Array) -> Search:
    """Find the zeros of K; `size` (2,) is how small rectangles have to become, in parameters."""
    grid, found = _fine_enough(field, size)
    polylines, near_crossing = zero_curves(grid, size)
    small, large = parted(grid, merged(np.concatenate([grid.rectangles(grid.flat), found.zero])))
    flat = merged(np.concatenate([grid.rectangles(grid.panels(field.flat)), large]))
    boxes = np.concatenate([found.boxes, small])
    boxes = boxes[~near_crossing[grid.cells_at(boxes.mean(axis=1))]]
    groups = clusters(boxes, size)
    beside = np.array([touching(group, flat, size).any() for group in groups], dtype=bool)
    rim = [boxes[touching(group, boxes, 0.0 * size)] for group in groups[beside]]
    return Search(
        polylines,
        groups[~beside],
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
