"""Samples that are the same: next to a pole, where a spline may have folds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .pole_charts import PoleChart

__all__ = ["first_at_poles"]

# Samples of one normal that are closer than this, in cells of the spline, are the same: Newton's
# method leaves 1e-12 radians.
SAME_PLACE = 1e-6


def first_at_poles(
    charts: Sequence[PoleChart],
    numbers: NDArray[np.int64],
    uv: NDArray[np.float64],
    found: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Return which samples (k,) are not the same as one before, of the same normal.

    `numbers` (k,) are those of their normals, uv (k, 2) their parameters; `found` (k,) says which
    ones are on the surface: others are never the same.
    """
    first = np.ones(len(uv), dtype=np.bool_)
    for chart in charts:
        rows = np.flatnonzero(chart.near(uv) & found)
        rows = rows[np.argsort(numbers[rows], kind="stable")]
        places = chart.places(uv[rows]) / chart.cell
        shift, again = 1, np.zeros(len(rows), dtype=np.bool_)
        while shift < len(rows):
            of_one_normal = numbers[rows[shift:]] == numbers[rows[:-shift]]
            if not of_one_normal.any():
                break
            close = np.linalg.norm(places[shift:] - places[:-shift], axis=1) < SAME_PLACE
            again[shift:] |= of_one_normal & close
            shift += 1
        first[rows[again]] = False
    return first
