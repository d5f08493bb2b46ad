"""Delaunay triangulations of points in the parameter domain, across its seams.

Qhull knows no seams, so that the domain is mapped to a surface without seams. A domain that is
periodic in one parameter is mapped to a sphere, a pole to one point and an open side to a circle of
latitude; the convex hull, without its plane faces inside these circles, is a Delaunay triangulation
of the sphere. A Möbius band is half of a band that is symmetric about the centre of the sphere. A
domain that is periodic in both parameters is continued periodically in the plane, and one copy of
each triangle is taken. An open domain is a rectangle.
"""

import math
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.threads import over_ranges
from ...runtime.base.tolerances import CIRCLE_HEIGHT_ERROR
from ...runtime.domain.domain import Boundary, closes
from ...runtime.surface.kernels import surfaces as kernels

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
# Triangles (k, 3), and for their corners (k, 3) 1, or −1 where the corner is a mirrored copy.
Triangulation = tuple[Indices, Indices]

# The latitude of an open side is between the first and the last of these; it is the second one if
# the opposite side is a pole.
LATITUDES = (math.pi / 18, math.pi / 3, math.pi / 2.25)
# Random displacements of points in a first and in further attempts, relative to the mean distance
# of points. Without them, four or more points of a lattice that lie on one circle might be
# triangulated differently in their copies. If no points are copied, an attempt without
# displacements comes first.
DISPLACEMENTS = (1e-6, 1e-3)
# Free points keep this distance from open sides and from poles.
INSIDE = 5e-10
# The height, relative to the shorter side, by which sides of a rectangle are curved outwards, so
# that their points are extreme points of the convex hull. Triangles at more curved sides would be
# turned over on the rectangle.
BULGE = 0.05
# A domain that is periodic in both parameters is continued beyond its sides: in the first attempts
# by these numbers of mean distances of points, then by these fractions of a period.
STEPS, MARGINS = (10.0, 30.0), (0.25, 1.0)
# The domain is cut into strips of about this number of points, for threads.
STRIP = 25_000


def triangulations(
    positions: Array, is_free: NDArray[np.bool_], boundary: Boundary, lengths: Array
) -> Iterator[Triangulation]:
    """Yield triangulations of positions (k, 2) in the unit square; use the next if one fails.

    Positions that are not free lie on an open side or at a pole, and are not displaced. `boundary`
    are the boundary conditions, `lengths` (2,) the lengths of the surface along u and v. A triangle
    runs counterclockwise in the unit square at its corner of the smallest index; its other corners
    may be copies. A position that coincides with another one may belong to no triangle.
    """
    from scipy.spatial import QhullError

    closing = [axis for axis in (0, 1) if closes(boundary[axis])]
    has_copies = len(closing) == 2 or any(boundary[axis][0] == "mirrored" for axis in closing)
    distance = 1.0 / math.sqrt(len(positions))
    for displacement, margin in _attempts(has_copies, distance):
        rng = np.random.default_rng(len(positions))
        moved = positions + displacement * distance * rng.uniform(-1.0, 1.0, positions.shape)
        for axis in {0, 1} - set(closing):
            moved[:, axis] = np.clip(moved[:, axis], INSIDE, 1.0 - INSIDE)
        moved = np.where(is_free[:, None], moved, positions)
        with suppress(QhullError):  # fewer points than a triangulation needs, or all collinear
            if len(closing) == 2:
                yield _by_copies(moved, boundary, lengths, margin)
            elif closing:
                yield _on_sphere(moved, boundary, lengths, closing[0])
            else:
                curved = np.where(is_free[:, None], moved, _curved(moved, lengths))
                triangles = delaunay(curved * lengths)
                yield triangles, np.ones_like(triangles)


def _attempts(has_copies: bool, distance: float) -> list[tuple[float, float]]:
    """Return the pairs of a displacement and a margin to try in turn.

    `distance` is the mean distance of points.
    """
    if not has_copies:
        return [(x, 0.0) for x in (0.0, *DISPLACEMENTS)]
    near = [steps * distance for steps in STEPS if steps * distance < MARGINS[0]]
    first = [(DISPLACEMENTS[0], margin) for margin in near]
    first += [(DISPLACEMENTS[1], margin) for margin in near[-1:]]
    return first + [(x, margin) for margin in MARGINS for x in DISPLACEMENTS]


# --- open rectangles ------------------------------------------------------------------------------


def _curved(positions: Array, lengths: Array) -> Array:
    """Return positions; on the sides of the unit square, they are moved outwards to a parabola.

    After u and v are multiplied by `lengths` (2,), the four parabolas have equal heights.
    """
    heights = 4.0 * BULGE * positions * (1.0 - positions) * (lengths.min() / lengths)[::-1]
    outwards = np.where(positions == 0.0, -1.0, np.where(positions == 1.0, 1.0, 0.0))
    return positions + outwards * heights[:, ::-1]


def delaunay(points: Array) -> Indices:
    """Return the triangles (k, 3) of points (n, 2) of the plane, counterclockwise."""
    from scipy.spatial import Delaunay

    triangles = Delaunay(points).simplices
    a, b, c = (points[triangles[:, k]].T for k in range(3))
    is_clockwise = (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0])
    return _turned(triangles, is_clockwise)


def _turned(triangles: NDArray[Any], which: NDArray[np.bool_]) -> Indices:
    result = triangles.astype(np.int64)
    result[which] = result[which][:, [0, 2, 1]]
    return result


def convex_hull(points: Array) -> Indices:
    """Return the triangles (k, 3) of the convex hull of points (n, 3).

    They run counterclockwise as seen from outside.
    """
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    a, b, c = np.moveaxis(points[hull.simplices], 1, 0)
    is_inwards = np.einsum("kx,kx->k", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    return _turned(hull.simplices, is_inwards)


# --- spheres, disks, bands: periodic in one parameter ---------------------------------------------


def _on_sphere(positions: Array, boundary: Boundary, lengths: Array, axis: int) -> Triangulation:
    is_mirrored = boundary[axis][0] == "mirrored"
    turn = math.pi if is_mirrored else 2.0 * math.pi
    lowest, middle, highest = LATITUDES
    wide = float(np.clip(turn * lengths[1 - axis] / lengths[axis] / 2.0, lowest, highest))
    wide = middle if "pole" in boundary[1 - axis] else wide
    latitudes = [
        sign * (math.pi / 2.0 if end == "pole" else wide)
        for sign, end in zip((-1.0, 1.0), boundary[1 - axis], strict=True)
    ]
    longitude = positions[:, axis] * turn
    latitude = latitudes[0] + positions[:, 1 - axis] * (latitudes[1] - latitudes[0])
    points = np.empty((len(positions), 3))
    kernels.positions("sphere")(1.0, longitude, latitude, points)
    if is_mirrored:
        points = np.concatenate([points, -points])
    triangles = convex_hull(points)
    triangles = triangles if axis == 0 else triangles[:, [0, 2, 1]]
    for end, latitude in zip(boundary[1 - axis], latitudes, strict=True):
        if end == "open":
            off_circle = np.abs(points[:, 2] - math.sin(latitude)) > CIRCLE_HEIGHT_ERROR
            triangles = triangles[off_circle[triangles].any(axis=1)]
    number = np.arange(len(points))
    count = len(positions)
    return _one_of_each(triangles, number % count, count, number >= count)


def _one_of_each(
    triangles: Indices, original: Indices, count: int, is_mirrored: NDArray[np.bool_]
) -> Triangulation:
    """Return each triangle once: the copy whose corner of the smallest index is an original.

    Point k is a copy of `original[k]`; the first `count` points are the originals. A triangle with
    two copies of one point is left out.
    """
    a, b, c = (original[triangles[:, k]] for k in range(3))
    first = np.where(a < b, triangles[:, 0], triangles[:, 1])
    first = np.where(c < np.minimum(a, b), triangles[:, 2], first)
    triangles = triangles[(first < count) & (a != b) & (b != c) & (c != a)]
    return original[triangles], np.where(is_mirrored[triangles], -1, 1)


# --- tori and Klein bottles: periodic in both parameters ------------------------------------------


def _by_copies(
    positions: Array, boundary: Boundary, lengths: Array, margin: float
) -> Triangulation:
    points, original = positions, np.arange(len(positions))
    is_mirrored = np.zeros(len(positions), dtype=bool)
    for axis in (0, 1):
        flips = boundary[axis][0] == "mirrored"
        copies = [(points, original, is_mirrored)]
        for step, near in ((1.0, points[:, axis] < margin), (-1.0, points[:, axis] > 1.0 - margin)):
            copy = points[near]
            copy[:, axis] += step
            if flips:
                copy[:, 1 - axis] = 1.0 - copy[:, 1 - axis]
            copies.append((copy, original[near], is_mirrored[near] ^ flips))
        points, original, is_mirrored = (np.concatenate(x) for x in zip(*copies, strict=True))
    strips = max(len(positions) // STRIP, 1)

    def work(k: int, _: int) -> Triangulation:
        return _in_strip(points, original, is_mirrored, lengths, (k, strips, margin))

    triangles, sides = zip(*over_ranges(work, strips, 1, None), strict=True)
    return np.concatenate(triangles), np.concatenate(sides)


def _in_strip(
    points: Array, original: Indices, is_mirrored: NDArray[np.bool_], lengths: Array,
    strip: tuple[int, int, float],
) -> Triangulation:  # fmt: skip
    """Triangulate a strip of the domain with a margin; return the triangles of the strip.

    It is one of equal strips along u. A triangle belongs to the strip if its corner of the smallest
    index is an original in the strip, not a copy.
    """
    number, strips, margin = strip
    along = points[:, 0] * strips - number
    near = np.flatnonzero((along > -margin * strips) & (along < 1.0 + margin * strips))
    # Displaced points may be slightly outside the unit square.
    own = (along[near] >= 0.0) | (number == 0)
    own &= (along[near] < 1.0) | (number == strips - 1)
    own &= original[near] == near
    near = np.concatenate([near[own], near[~own]])
    triangles = delaunay(points[near] * lengths)
    return _one_of_each(triangles, original[near], int(own.sum()), is_mirrored[near])
