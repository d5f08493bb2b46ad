"""The test of vectors for unit length."""

from __future__ import annotations

import numpy as np

from ...machine_code.jit import jit

# The squares of lengths that are 1 up to rounding differ from 1 by at most this: 2.5 units in the
# last place above 1, 5 units below 1, where units are half as large.
NEAR = 5.6e-16


@jit
def are_unit(vectors, first, last):
    """Return whether the rows [first, last) of `vectors` (S, 3) have unit length, up to rounding.

    `normalized` leaves such vectors unchanged: it divides by a length only if the length differs
    from 1 by more than 4.5e-16, which allows for another rounding of the sum of squares.
    """
    far = 0
    for k in range(first, last):
        x, y, z = vectors[np.uint64(k), 0], vectors[np.uint64(k), 1], vectors[np.uint64(k), 2]
        square = x * x + y * y + z * z
        far += 1 - (abs(square - 1.0) <= NEAR)
    return far == 0
