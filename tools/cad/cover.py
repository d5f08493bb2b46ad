"""Covering a part with samples, greedily, as `density.cover` does for a surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...runtime.density.cover import Cover
from .cells import Cells
from .space import Space

__all__ = ["PartCover"]

# The radii of the cells of candidates, relative to the covering radius.
FINE = 0.4


class PartCover(Cover):
    """Samples of a part: some that are given, (N, 6) scaled points and normals, and added ones."""

    sizing: Space
    triangles: Cells

    def __init__(
        self,
        space: Space,
        given: NDArray[np.float64] | None = None,
        show_count: Callable[[int], object] = lambda count: None,
    ) -> None:
        """Begin with given samples, whose curvatures nobody asks for."""
        self.sizing, self.show_count, self.grid = space, show_count, None
        points = np.empty((0, 6)) if given is None else given
        self._begin_with(points, np.zeros(len(points)), cast(Any, space.nothing()))
        self.fine = FINE

    @property
    def added(self) -> Any:  # noqa: ANN401
        """The cells at whose places the added samples lie."""
        return super().added

    def take_candidates(self, radius: float, widest: float) -> None:
        """Take candidates for sweeps with radii that fall from `widest` to this radius."""
        self.radius, self.triangles = widest, self.sizing.cut(self.fine * radius)
        self._candidates = self._with_distances(self.triangles.at_places(), radius, widest)

    def put(self, cells: Cells) -> None:
        """Add the places of some cells as samples."""
        self.add(cast(Any, cells))

    def whole(self) -> Any:  # noqa: ANN401 - cells, as triangles
        """Return few cells, which make up the part."""
        return self.sizing.evaluated(
            replace(self.sizing.first, space=self.sizing), with_border=True
        )

    def missing(self) -> Cells:
        """Return a cell near the middle of each piece that has no sample, if it has a cell."""
        return self.sizing.middles(np.setdiff1d(self.sizing.first.pieces, self.added.pieces))

    def remove_last(self, number: int) -> None:
        """Remove samples that were added last, as long as their pieces have others."""
        numbers = np.bincount(self.added.pieces, minlength=len(self.sizing.pieces))
        removed: list[int] = []
        for k in range(len(self.added) - 1, -1, -1):
            if len(removed) == number:
                break
            if numbers[self.added.pieces[k]] > 1:
                numbers[self.added.pieces[k]] -= 1
                removed.append(k)
        self.keep(np.setdiff1d(np.arange(len(self.added)), removed))
        self.renew_distances(self.radius)
