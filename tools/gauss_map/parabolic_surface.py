"""The parabolic curves and points of a smooth surface, located by the signs of K on a grid."""

import warnings

import numpy as np

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.errors import GaussmapWarning
from ...runtime.surface.surface import Surface
from .critical_points import critical_zeros
from .curvature import Curvature
from .image_curve import Zeros
from .sign_grid import SignGrid
from .zero_curves import zero_curves

# The grid has at least CELLS cells along u and along v, and at most MOST_CELLS. It is refined in
# each of three cases: curves are closer to each other than a cell, a curve is smaller than a cell,
# or more than the fraction CROWDED of the cells contains curves.
CELLS, MOST_CELLS, CROWDED = 128, 512, 1 / 8
# A larger share of the domain without a known curvature causes a warning.
WORTH_A_WARNING = 1e-4
# Isolated zeros of K count as one zero if the blocks of cells around them touch; a block reaches
# this many cells from the cell of the zero.
TOGETHER = 4
# Two quantities count as zero below this bound. The derivative of K in the direction in which the
# normal is constant, relative to the length of the gradient of K, vanishes all along a curve with a
# single normal, such as the top circle of a torus. The length of the gradient, relative to its
# maximum on the curve, vanishes where curves cross.
NO_CHANGE = 1e-6


class ZerosOfSurface(Zeros):
    """The zeros of K of a surface.

    Branches of curves K = 0 closer to each other than `size`, relative to the domain, count as
    crossing curves, or as one point if they form a closed curve.
    """

    def __init__(self, surface: Surface, cells: tuple[int, int], size: float) -> None:
        self.surface, self.curvature = surface, Curvature(surface)
        self.jets, self.size = self.curvature.jets, self.curvature.size
        while True:
            self.grid = SignGrid(self.curvature, cells)
            finer = 2 * cells[0], 2 * cells[1]
            if self.grid.crossed.mean() <= CROWDED or max(finer) > MOST_CELLS:
                self.critical = critical_zeros(self.grid, size)
                if not self.critical.unclear or max(finer) > MOST_CELLS:
                    break
            cells = finer
        self.flat, self.lines = self.grid.flat, self.grid.lines

    def polylines(self) -> list[Array]:
        """Return the curves (k, 2) across which K changes its sign."""
        return zero_curves(self.grid, self.critical.saddles)

    def onto(self, uv: Array) -> Array:
        """Move parameters (k, 2) near the curves onto the curves."""
        return self.curvature.onto_zeros(uv)

    def warn(self, stacklevel: int) -> None:
        """Warn if K is unknown on a part of the domain."""
        grid, trim = self.grid, self.surface.trim
        middles = grid.at(np.argwhere(grid.unknown)) + 0.5 * grid.cell
        inside = True if trim is None else trim.contains(middles)
        unknown = float((grid.areas[grid.unknown] * inside).sum())
        if unknown > WORTH_A_WARNING:
            warnings.warn(
                f"the curvature of {self.surface.name!r} cannot be computed on "
                f"{100.0 * unknown:.3g} % of its domain, which is left out; the spline of the "
                "surface (`fit`) has parabolic points everywhere.",
                GaussmapWarning,
                stacklevel=stacklevel,
            )

    def isolated(self) -> list[tuple[Array, Array]]:
        """Return the isolated zeros of K, one (2,) for each cluster, with boxes (2, 2)."""
        from scipy.ndimage import label, maximum_filter

        touched, reach = self.critical.touched, self.critical.reach
        cells = self.grid.cells_at(touched)
        here = np.zeros(self.grid.flat.shape, dtype=bool)
        here[cells] = True
        groups = np.zeros(here.shape, dtype=np.int64)
        label(maximum_filter(here, 2 * TOGETHER + 1), output=groups)
        found = []
        for k in range(1, groups.max(initial=0) + 1):
            own = groups[cells] == k
            box = np.stack([(touched - reach)[own].min(axis=0), (touched + reach)[own].max(axis=0)])
            middle = np.abs(touched[own] - box.mean(axis=0)).max(axis=1).argmin()
            box = np.clip(box, self.curvature.low, self.curvature.high)
            found.append((touched[own][middle], box))
        return found

    def with_cusps(self, uv: Array) -> tuple[Array, Indices]:
        """Return a curve (k, 2) with the cusps of its image as vertices, and their indices.

        At a cusp, the derivative of K along the direction in which the normal is constant vanishes
        and changes its sign.
        """
        change, along = self._change(uv)
        turns = np.where(np.einsum("kx,kx->k", along[1:], along[:-1]) < 0.0, -1.0, 1.0)
        known = np.flatnonzero(np.abs(change) > NO_CHANGE)
        signs = np.sign(change * np.cumprod([1.0, *turns]))[known]
        changing = np.flatnonzero(signs[1:] != signs[:-1])
        before, after = known[changing], known[changing + 1]
        new = after == before + 1
        cusps = [self._cusp_between(uv[k], uv[k + 1], along[k]) for k in before[new]]
        where = before + 1 + np.cumsum(new) - new
        return np.insert(uv, after[new], np.reshape(cusps, (-1, 2)), axis=0), where

    def _cusp_between(self, start: Array, end: Array, before: Array) -> Array:
        """Return the cusp (2,) between two vertices."""
        from scipy.optimize import brentq

        def place(share: float) -> Array:
            return self.curvature.onto_zeros(start[None] + share * (end - start))

        def value(share: float) -> float:
            change, along = self._change(place(share))
            return float(change[0] * np.sign(along[0] @ before))

        return place(float(brentq(value, 0.0, 1.0, xtol=1e-12)))[0]  # pyright: ignore[reportArgumentType]

    def _change(self, uv: Array) -> tuple[Array, Array]:
        """Return the derivative (k,) of K along the direction in which the normal is constant.

        It is relative to the length of the gradient of K. Also return the direction (k, 2),
        relative to the domain.
        """
        _, gradient, _ = self.curvature.derivatives(uv)
        u, v = self.curvature.extent
        e, f, g = self.curvature.at(uv).second_form.T * [[u * u], [u * v], [v * v]]
        along = np.where(np.abs(e) > np.abs(g), [-f, e], [g, -f]).T
        with np.errstate(invalid="ignore"):
            along = along / np.linalg.norm(along, axis=1, keepdims=True)
            size = np.linalg.norm(gradient, axis=1)
            changes = np.einsum("kx,kx->k", gradient, along) / size
            changes = np.where(size > NO_CHANGE * np.nanmax(size), changes, 0.0)
        return np.nan_to_num(changes), np.nan_to_num(along)
