"""The positions of the lines of a grid along one parameter, for given steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...runtime.base.aliases import Array, Indices

# A part of an interval is cut into at least this number of subintervals.
FEWEST = 4.0


@dataclass(frozen=True, eq=False)
class Axis:
    """An interval of a parameter, with k subintervals between the `edges` (k + 1,).

    The unit is a cell of the spline. The edges increase. The edges with the indices `breaks`, which
    include the first and the last edge, separate parts. The first and the last line of a part are
    half a step away from its ends.
    """

    edges: Array
    breaks: Indices

    @classmethod
    def of(cls, length: float, number: int, breaks: Array) -> Axis:
        """Divide the interval from 0 to `length` into about `number` subintervals and at breaks."""
        ends = np.concatenate([[0.0], breaks, [length]])
        counts = np.maximum(np.ceil(np.diff(ends) * (number / length)), FEWEST).astype(np.int64)
        parts = [
            low + (high - low) * np.arange(count) / count
            for low, high, count in zip(ends[:-1], ends[1:], counts.tolist(), strict=True)
        ]
        return cls(np.concatenate([*parts, [length]]), np.concatenate([[0], np.cumsum(counts)]))

    @property
    def middles(self) -> Array:
        """The midpoints (k,) of the subintervals."""
        return (self.edges[1:] + self.edges[:-1]) / 2.0

    @property
    def widths(self) -> Array:
        """The widths (k,) of the subintervals."""
        return np.diff(self.edges)

    def lengths(self, steps: Array) -> Array:
        """Return the length of each part in steps; `steps` (k,) are given for the subintervals."""
        return np.add.reduceat(self.widths / steps, self.breaks[:-1])

    def lines(self, steps: Array, numbers: Indices) -> Array:
        """Return the positions of lines: numbers[i] lines in part i, about `steps` (k,) apart.

        The distances are in proportion to the steps, which are given for the subintervals.
        """
        found = []
        for first, last, number in zip(
            self.breaks[:-1], self.breaks[1:], numbers.tolist(), strict=True
        ):
            steps_so_far = np.cumsum(self.widths[first:last] / steps[first:last])
            steps_so_far = np.concatenate([[0.0], steps_so_far])
            places = (np.arange(number) + 0.5) * (steps_so_far[-1] / number)
            found.append(np.interp(places, steps_so_far, self.edges[first : last + 1]))
        return np.concatenate(found)
