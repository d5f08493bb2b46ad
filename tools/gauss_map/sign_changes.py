"""Lines between the nodes of a grid that separate values ≥ 0 from negative values."""

from collections.abc import Callable, Hashable

import numpy as np
from numpy.typing import NDArray

from .chains import chained

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
# Values count as growing from a boundary if, next to it, they exceed their error by this factor.
CLEAR = 100.0
TINY = float(np.finfo(float).tiny)


def sign_changes(
    values: Array, kinds: tuple[str, str], places: Callable[[Integers, Integers], Array]
) -> list[tuple[list[Array], bool]]:
    """Return the lines between nodes with values ≥ 0 and < 0, and whether each is closed.

    No line crosses a cell that has NaN at a corner. In a cell with four crossed sides, the sign of
    the mean of its corners decides which sides are joined. `places` returns the points (k, 2) in
    which a line crosses the sides between nodes (k, 2) and (k, 2). A line has several parts (k, 2)
    if it crosses seams: `kinds` are "periodic" or "mirrored" where the ends along u or along v are
    identified.
    """
    from contourpy import LineType, contour_generator

    size = np.abs(values) / (np.nanmax(np.abs(values), initial=0.0) or 1.0)
    # Linear interpolation of these values puts vertices into the middle third of the sides of
    # cells.
    apart = np.where(values >= 0.0, 1.0 + size, -1.0 - size)
    # contourpy counts the second axis first.
    lines = contour_generator(z=apart.T, corner_mask=False, line_type=LineType.Separate).lines(0.0)
    if not lines:
        return []
    # The midpoints of the crossed sides, in halves of a cell.
    codes = [np.rint(2.0 * np.asarray(x)).astype(np.int64) for x in lines]
    last = 2 * np.array(values.shape) - 2

    def name(code: Integers) -> Hashable:
        """Return a key for a side of a cell; sides that a seam identifies have the same key."""
        for axis, kind in enumerate(kinds):
            if kind in ("periodic", "mirrored") and code[axis] == last[axis]:
                code = np.where(np.arange(2) == axis, 0, code)
                if kind == "mirrored":
                    code[1 - axis] = last[1 - axis] - code[1 - axis]
        return tuple(code.tolist())

    every = np.concatenate(codes)
    ends = np.cumsum([len(x) for x in codes])[:-1]
    parts = np.split(places(every // 2, (every + 1) // 2), ends)
    return [
        ([parts[number][:: -1 if turned else 1] for number, turned in chain], closed)
        for chain, closed in chained([(name(x[0]), name(x[-1])) for x in codes])
    ]


def with_borders(values: Array, noise: Array, kinds: tuple[str, str]) -> Array:
    """Return values whose sign changes at the open boundaries on which they are zero.

    The boundary is then a line between values ≥ 0 and < 0. Values count as zero up to `noise`. They
    must grow linearly from the boundary: otherwise they only touch zero.
    """
    result = values.copy()
    for axis, kind in enumerate(kinds):
        value, size, error = (np.swapaxes(x, 0, axis) for x in (result, np.abs(values), noise))
        for end, inner, next_ in ((0, 1, 2), (-1, -2, -3)):
            grows = (size[inner] >= CLEAR * error[inner]) & (size[inner] >= 0.375 * size[next_])
            zero = (size[end] <= error[end]) & grows & (kind == "open")
            pairs = zero[1:] & zero[:-1]
            along = np.append(pairs, False) | np.append(False, pairs)
            value[end] = np.where(along, np.copysign(TINY, -value[inner]), value[end])
    return result
