"""The parabolic points of a smooth surface: K = 0 (paper, Remark 3.1).

Contour lines on a grid find the curves across which K changes its sign; each vertex is then moved
to a zero of K. Newton's method finds the points where K touches zero.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...runtime.surface.surface import Surface
from .critical_points import critical_zeros
from .curvature_field import SURE, CurvatureField
from .rectangles import merged
from .sign_grid import SignGrid
from .zero_curves import zero_curves

__all__ = ["field_of", "search"]

Array = NDArray[np.float64]
PANELS = (8, 8)
MOST_PANELS = 64
# The least number of cells of the grid along the domain, and along a panel. It is doubled up to the
# largest where curves are closer to each other than a cell, or smaller.
CELLS, CELLS_A_PANEL, MOST_CELLS = 128, 8, 512
# A group of cells in which K is zero up to its error counts as a point up to this side, in cells.
FEW_CELLS = 4
TINY = float(np.finfo(float).tiny)


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


def search(
    field: CurvatureField, size: Array
) -> tuple[list[tuple[Array, bool]], Array, Array, Array]:
    """Return the zeros of K, all in parameters.

    These are polylines (k, 2) with whether they are closed; places (k, 2) where K is zero without a
    change of sign; rectangles around these (k, 2, 2), low and high corner; and rectangles where K
    is zero up to its error. Curves closer than `size` (2,), in parameters, cross or are a point.
    """
    panels = max(field.noise.shape)
    cells = max(CELLS // panels, CELLS_A_PANEL)
    while True:
        grid = SignGrid(field, cells)
        saddles, touched, unclear = critical_zeros(grid, size)
        if not unclear or 2 * cells * panels > MOST_CELLS:
            break
        cells *= 2
    curves, touched = zero_curves(grid, saddles, touched)
    return curves, *_regions(grid, touched, size)


def _regions(grid: SignGrid, touched: Array, size: Array) -> tuple[Array, Array, Array]:
    """Return points (k, 2) where K touches zero, boxes around them, and rectangles of flat regions.

    A few flat cells, away from others and from curves, are such a point.
    """
    from scipy.ndimage import find_objects, label, maximum_filter

    points = np.zeros_like(grid.flat)
    points[grid.cells_at(touched)] = True
    groups = np.zeros(grid.flat.shape, dtype=np.int64)
    label(maximum_filter(grid.flat | points, 2 * FEW_CELLS + 1), output=groups)
    groups = np.where(grid.flat | points, groups, 0)
    group_of = groups[grid.cells_at(touched)]
    # So far from a point K may be zero up to its error.
    curving = np.abs(np.diagonal(grid.field.hessian(touched), axis1=1, axis2=2)) + TINY
    doubt = np.sqrt(2.0 * SURE * grid.field.noise_at(touched)[:, None] / curving)
    reach = np.clip(doubt, 0.5 * size, grid.sizes(grid.cells_at(touched)))
    low, high = np.array([line[[0, -1]] for line in grid.lines]).T
    places, boxes, flat = [], [], np.zeros_like(grid.flat)
    for k, where in enumerate(find_objects(groups), start=1):
        cells = np.argwhere((groups[where] == k) & grid.flat[where]) + [x.start for x in where]
        at = tuple(cells.T)
        if len(cells) and (np.ptp(cells, axis=0).max() >= FEW_CELLS or grid.near_curves[at].any()):
            flat[at] = True
            continue
        here, around = touched[group_of == k], reach[group_of == k]
        corners = grid.at(np.concatenate([cells, cells + 1]))
        hull = np.concatenate([here - around, here + around, corners])
        boxes.append([hull.min(axis=0), hull.max(axis=0)])
        middle = hull.mean(axis=0, keepdims=True)
        found = here if len(here) else middle
        places.append(found[np.abs(found - middle).max(axis=1).argmin()])
    boxes = np.clip(np.reshape(boxes, (-1, 2, 2)), low, high)
    return np.reshape(places, (-1, 2)), boxes, merged(grid.rectangles(flat))
