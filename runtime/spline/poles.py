"""Poles of splines: collapsed sides around which the surface is smooth.

The coefficients around a pole are exactly in one plane, so that the pole has one normal. The
patches next to a pole have an edge that is collapsed to a point p. The first ring of coefficients
is at p + d, with a vector d for each coefficient, and the ghosts are at p − d. The normal of a
patch at p is along the cross product of two sums of neighbouring vectors d. If all vectors d lie in
one plane, this normal is the same for all patches, and the Gaussian images of the patches close
around it without a gap. On a smooth surface the distances of d from such a plane are of third order
in the size of a cell. They must be exactly zero: therefore each d is rounded to x a + y b with
integers x, y and two vectors a, b of integers, all in units of the rounding of the coordinates.
"""

import math

import numpy as np

from ...generated.spline import beyond_edge
from ..base.aliases import Array, Flags
from ..base.formula_calls import python_function
from ..domain.domain import Boundary, BoundaryPair

# The number of pairs a, b from which the plane closest to the ring is chosen.
CANDIDATES = 4096
# The lengths of a and b are one to two times √(BALANCE d), where d is the distance of neighbours in
# the ring, in units of the rounding of coordinates. With longer vectors, the plane of a and b is
# closer to the plane of the ring; with shorter vectors, points x a + y b are closer to the
# coefficients of the ring.
BALANCE = 1.0 / 32.0


def spread_missing(bad: Flags, boundary: Boundary, rows: int) -> None:
    """Set all flags `bad` (m, n) in the `rows` next to a pole if one of these flags is set."""
    for axis, end in np.ndindex(2, 2):
        near = np.swapaxes(bad, 0, axis)[-rows:] if end else np.swapaxes(bad, 0, axis)[:rows]
        if boundary[axis][end] == "pole" and near.any():
            near[:] = True


def without_poles(boundary: Boundary) -> Boundary:
    """Return boundary conditions with open sides in place of poles: poles do not allow NaN."""

    def pair(ends: BoundaryPair) -> BoundaryPair:
        return ("open", "open") if "pole" in ends else ends

    return pair(boundary[0]), pair(boundary[1])


def close_pole(rows: Array, outside: int, first: int) -> None:
    """Write the row outside a pole and the first row inside, in one plane; see `ring_around`."""
    ring, pole = ring_around(rows[first, 1:-1])
    rows[first, 1:-1] = ring
    rows[outside, 1:-1] = python_function(beyond_edge)(pole, ring)


def ring_around(ring: Array) -> tuple[Array, Array]:
    """Return a ring of coefficients (m, 3) moved into one plane, and the pole in its middle.

    All coordinates are multiples of a small power of two, so that 2 p − ring is exact for the pole
    p. A ring that does not run around p, due to rounding, is not moved into a plane.
    """
    grain = 4.0 * float(np.spacing(np.abs(ring).max()))
    ring = np.round(ring / grain)
    pole = ring[0] + np.round((ring - ring[0]).mean(axis=0))  # exactly 0 where all are equal
    planar = _planar(ring - pole)
    return ((ring if planar is None else pole + planar) * grain, pole * grain)


def _planar(offsets: Array) -> Array | None:
    """Return offsets (m, 3) moved into one plane, as integers; None if they do not run around 0."""
    size = float(np.abs(offsets).max())
    axes, radius = _axes(offsets / (size or 1.0))
    length = math.sqrt(BALANCE * 2.0 * math.pi * radius * size / len(offsets))
    a, b = _lattice(axes, max(1.0, length))
    coordinates = np.round(np.linalg.lstsq(np.stack([a, b], axis=1), offsets.T)[0].T)
    sums = coordinates + np.roll(coordinates, 1, axis=0)
    after = np.roll(sums, -1, axis=0)
    if not (sums[:, 0] * after[:, 1] > sums[:, 1] * after[:, 0]).all():
        return None
    return coordinates[:, :1] * a + coordinates[:, 1:] * b


def _axes(offsets: Array) -> tuple[Array, float]:
    """Return an orthonormal basis (2, 3) of the plane of a ring, and the width of the ring.

    The normal of the plane is the vector area of the ring, which turns counterclockwise around it.
    The width is the root mean square of the offsets along the narrower principal axis.
    """
    normal = np.cross(offsets, np.roll(offsets, -1, axis=0)).sum(axis=0)
    _, _, rows = np.linalg.svd(normal[None] / (np.abs(normal).max() or 1.0))
    axes = rows[1:]
    if np.cross(*axes) @ normal < 0.0:
        axes = axes[::-1]
    return axes, float(np.linalg.svd(offsets @ axes.T)[1][-1]) / math.sqrt(len(offsets))


def _lattice(axes: Array, length: float) -> Array:
    """Return two integer vectors (2, 3) that span a plane close to the plane of `axes` (2, 3).

    Their lengths are between `length` and twice `length`, up to rounding.
    """
    lengths = length * np.linspace(1.0, 2.0, CANDIDATES)
    pairs = np.round(lengths[:, None, None] * axes)
    normals = np.cross(pairs[:, 0], pairs[:, 1])
    sizes = np.linalg.norm(normals, axis=1)
    tilts = np.linalg.norm(np.cross(normals, np.cross(*axes)), axis=1)  # accurate for small angles
    return pairs[np.argmin(np.divide(tilts, sizes, out=np.ones_like(sizes), where=sizes > 0.0))]
