"""Uniform unit normals in the plane, on the circle or an arc of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.checks import whole_number
from ..base.memory import check_memory

__all__ = ["arc_of_normals", "circle"]


def circle(count: int) -> NDArray[np.float64]:
    """Return uniform unit normals on the circle, for planar curves.

    Parameters
    ----------
    count : int
        The number of normals, at least 1.

    Returns
    -------
    (count, 2) float64 array
        Unit normals; normal k is at the angle 2π (k + ½)/count. They have the symmetries of the set
        of angles, bit for bit: reflections in both axes if `count` is even, and in the diagonals if
        it is a multiple of 4.

    Raises
    ------
    InputError
        If `count` is not an integer in this range.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.directions.circle(4).round(3).tolist()
    [[0.707, 0.707], [-0.707, 0.707], [-0.707, -0.707], [0.707, -0.707]]

    """
    total = whole_number(count, "count")
    check_memory("circle", total)
    # Angles are integers in units of 1/(8 count) of a turn: a quarter turn has 2 count units, and
    # its second half is the mirror image of the first one.
    quarter, place = np.divmod(4 * (2 * np.arange(total) + 1), 2 * total)
    beyond = place > total
    angle = np.pi / (4 * total) * np.where(beyond, 2 * total - place, place)
    x = np.cos(angle)
    y = np.where(place == total, x, np.sin(angle))
    x, y = np.where(beyond, y, x), np.where(beyond, x, y)
    choices = np.array([[x, y], [-y, x], [-x, -y], [y, -x]])
    return np.ascontiguousarray(choices[quarter, :, np.arange(total)])


def arc_of_normals(low: float, high: float, count: int) -> NDArray[np.float64]:
    """Return unit normals (count, 2) at the middles of equal parts of an interval of angles."""
    angle = low + (high - low) * ((np.arange(count) + 0.5) / count)
    return np.column_stack([np.cos(angle), np.sin(angle)])
