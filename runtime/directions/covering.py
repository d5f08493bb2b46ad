"""The covering radius: the largest angle between any direction and the nearest one in a set."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from ..base.aliases import Array
from ..base.tolerances import CAP_RADIUS_ERROR
from .regions import angles_between
from .unit import as_normals


def covering_radius(normals: ArrayLike) -> float:
    """Return the largest angle between any direction and the nearest one of the normals.

    If the normals cover the Gaussian image of a surface, every normal of the surface is within this
    angle of the normal of a sample.

    Parameters
    ----------
    normals : (S, 3) array_like
        Directions of any length but 0.

    Returns
    -------
    float
        The angle in degrees, exact up to rounding.

    Raises
    ------
    InputError
        For unusable normals (see `sample`).

    Notes
    -----
    Each facet of the convex hull of the normals bounds an empty cap around its own normal; the
    covering radius is the largest angle of these caps. It refers to the whole sphere. For normals
    within a hemisphere, such as those of a small `cap`, the covering radius is 180° minus the
    radius of the smallest cap that contains the normals.

    Examples
    --------
    >>> import gaussmap as gm
    >>> round(gm.directions.covering_radius([[1, 0, 0], [-1, 0, 0]]), 6)
    90.0
    >>> print(f"{gm.directions.covering_radius(gm.icosphere(16)):.2f}")
    2.73

    """
    directions = as_normals(normals)
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(directions)
    except QhullError:  # coplanar normals, or fewer than four
        return 180.0 - _smallest_cap(directions)
    outwards, corners = hull.equations[:, :3], directions[hull.simplices[:, 0]]
    largest = float(angles_between(outwards, corners).max())
    # If the centre of the sphere is outside the hull, the farthest direction is the normal of no
    # facet.
    return largest if largest <= 90.0 else 180.0 - _smallest_cap(directions)


def _smallest_cap(normals: Array) -> float:
    """Return the radius in degrees, at most 90, of the smallest cap that contains all normals.

    At most three normals determine a cap. The farthest normal outside the cap is added to these,
    which makes the cap larger, until no normal is outside.
    """
    basis, radius = normals[:1], -1.0
    while True:
        centre, basis, grown = _cap_of_few(basis)
        if grown <= radius + CAP_RADIUS_ERROR:
            return min(grown, 90.0)
        radius = grown
        farthest = normals[np.argmin(normals @ centre)]
        if angles_between(farthest, centre) <= radius + CAP_RADIUS_ERROR:
            return min(radius, 90.0)
        basis = np.concatenate([basis, farthest[None]])


def _cap_of_few(normals: Array) -> tuple[Array, Array, float]:
    """Return the smallest cap that contains up to four normals.

    Returns its centre (3,), the normals on its boundary (k, 3), and its radius in degrees.
    """
    found: list[tuple[float, Array, Array]] = []
    for size in (1, 2, 3):
        for rows in combinations(normals, size):
            few = np.array(rows)
            middle = few.sum(axis=0)
            if size == 3:
                across = np.cross(few[1] - few[0], few[2] - few[0])
                middle = np.copysign(1.0, across @ middle) * across
            length = np.linalg.norm(middle)
            if length > 0.0:
                centre = middle / length
                found.append((float(angles_between(normals, centre).max()), centre, few))
    radius, centre, few = min(found, key=lambda x: x[0])
    return centre, few, radius
