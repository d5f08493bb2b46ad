"""The lines of a grid of parameters, among them those where second derivatives of a spline jump."""

from __future__ import annotations

import numpy as np

from ...generated.elementary import SPLINE
from ..base.aliases import Array
from ..tape.kernels.points import Tape
from ..tape.kernels.spline_bounds import SLACK

__all__ = ["jumps_of", "lines_of"]


def jumps_of(tape: Tape, axis: int, low: float, high: float) -> Array:
    """Return the u (axis 0) or v between two others where second derivatives of a spline jump."""
    x = tape.spline
    breaks, smooth = ((x.breaks_u, x.smooth_u), (x.breaks_v, x.smooth_v))[axis]
    jumps = breaks[smooth < 2]
    (rows,) = np.nonzero(tape.operations[:, 0] == SPLINE)
    if axis == 0 and len(rows) > 0 and tape.operations[rows[0], 3] == 1:
        jumps = tape.numbers[rows[0], 0] - jumps  # u is reversed
    slack = SLACK * np.abs(breaks[[0, -1]]).sum() if len(breaks) > 0 else 0.0
    return jumps[(jumps > low + slack) & (jumps < high - slack)]


def lines_of(tape: Tape, axis: int, ends: Array, count: int) -> Array:
    """Return the lines of a grid between the two ends of u or v, about `count`, and jumps."""
    low, high = ends.tolist()
    pieces = np.unique([low, high, *jumps_of(tape, axis, low, high)])
    counts = np.maximum(1, np.round(count * np.diff(pieces) / (high - low))).astype(int)
    parts = [
        np.linspace(low, high, k + 1)[:-1]
        for low, high, k in zip(pieces[:-1], pieces[1:], counts, strict=True)
    ]
    return np.append(np.concatenate(parts), high)
