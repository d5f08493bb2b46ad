"""Detection of blocks of one height that are missing data rather than water."""

from __future__ import annotations

import numpy as np

from ..base.aliases import Array, Flags

__all__ = ["suspicious_block"]


# The least number of heights of a block, and its least part of all heights.
FEWEST, SMALLEST = 16, 1e-3
# Shores are about as steep as the land. A block is missing data if the median step at its boundary
# exceeds this multiple of the QUANTILE of the steps elsewhere.
STEEPER, QUANTILE = 3.0, 0.99


def suspicious_block(heights: Array) -> tuple[float, int] | None:
    """Return the height of a block of missing data in heights (m, n), and its size; or None.

    The block is a connected area of the lowest or the highest value, which is 0 unless the area
    reaches the boundary of the grid. Heights jump at its boundary, unlike at a lake or the sea.
    """
    known = ~np.isnan(heights)
    if not known.any():
        return None
    for value in (float(np.nanmin(heights)), float(np.nanmax(heights))):
        block = _largest_block(heights == value)
        size = int(block.sum())
        if size < max(FEWEST, SMALLEST * heights.size) or size == int(known.sum()):
            continue
        at_border = any(block[x].any() for x in (0, -1)) or block[:, [0, -1]].any()
        if (value == 0.0 or at_border) and _jumps(heights, block):
            return value, size
    return None


def _largest_block(same: Flags) -> Flags:
    """Return the largest connected part of flags (m, n)."""
    if same.sum() < FEWEST:
        return np.zeros_like(same)
    from scipy.ndimage import label

    numbers = np.asarray(label(same)[0])  # pyright: ignore[reportIndexIssue]
    return numbers == 1 + int(np.argmax(np.bincount(numbers.ravel())[1:]))


def _jumps(heights: Array, block: Flags) -> bool:
    """Return whether steps at the boundary of a block are much higher than those elsewhere."""
    across, elsewhere = [], []
    for axis in (0, 1):
        steps, inside = np.abs(np.diff(heights, axis=axis)), np.diff(block, axis=axis)
        low = np.take(block, np.arange(block.shape[axis] - 1), axis)
        known = ~np.isnan(steps)
        across.append(steps[inside & known])
        elsewhere.append(steps[~inside & ~low & known])
    border, others = np.concatenate(across), np.concatenate(elsewhere)
    if len(border) == 0 or len(others) == 0:
        return False
    usual = float(np.quantile(others, QUANTILE))
    return usual > 0.0 and float(np.median(border)) > STEEPER * usual
