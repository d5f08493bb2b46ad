"""Discrete Voronoi cells of samples: their centres, and the widest gaps.

The cell of a candidate that no boundary intersects is nearly a parallelogram, with a grid of FINER²
points. The candidates of a bucket share a list of samples. The coordinates of these samples are
relative to the first candidate of the bucket, so that single precision suffices.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ....generated.vectors import Vector
from ....runtime.directions.kernels.vectors import dot, row_vector
from ....runtime.machine_code.jit import inline, jit, loop
from .cells import FINER
from .greedy import SAME_SIDE, around, is_near, normal_of, on_side, squared_distance
from .hash_grids import DENSITY, NORMAL, SQUARE

PLACES = FINER * FINER
# The coordinates of fine points along the sides of a cell, from −1/2 to 1/2.
S = np.repeat((np.arange(FINER, dtype=np.float32) + 0.5) / FINER - 0.5, FINER)
T = np.tile(S[::FINER], FINER)
# The columns of the sides of cells, see kernels/cells.py.
AREA, EXTENT = 6, 7
# A squared distance that is larger than all others.
FAR = np.float32(1e30)
COSINE = np.float32(SAME_SIDE)
# The largest coordinate of a centre in a cell: at edges of cells, surfaces may be singular.
INNER = 0.45
# Bounds of squared distances are larger by this factor, for rounding.
ROUNDING = np.float32(1.0001)


class Lists(NamedTuple):
    """The samples near the candidates of each bucket.

    sides: (M, 8) float32, the sides of the cells of candidates, see kernels/cells.py.
    starts: (buckets + 1,) int32, the index of the first entry of each bucket.
    entries: (E,) int32, indices of samples, bucket by bucket. If it is empty, `enter` only counts
        the samples of each bucket.
    last: (buckets,) int32, the index of the last sample entered for each bucket; −1 for none.
    """

    sides: np.ndarray
    starts: np.ndarray
    entries: np.ndarray
    last: np.ndarray


class Room(NamedTuple):
    """Room for the samples of a list, at most m of them, and for the fine points of a cell.

    near: (6, m) float32, points relative to the first candidate of the bucket, and unit normals.
    squares: (m + 1,) float32, squared distances of the samples from a candidate; FAR for a sample
        that is not on its side of the surface. The entry after the last sample is the minimum.
    bits: (m + 1,) int32, a view of `squares`: floats ≥ 0 and their bits have the same order.
    few: (m,) int32, samples that may be nearest to a fine point, by their positions in the list.
    moments: (m, 4), the moments of the samples, see `add_moments`.
    least: (FINER²,) float32, squared distances of the fine points from the nearest samples.
    nearest: (FINER²,) int32, the nearest samples, by their positions in the list.
    """

    near: np.ndarray
    squares: np.ndarray
    bits: np.ndarray
    few: np.ndarray
    moments: np.ndarray
    least: np.ndarray
    nearest: np.ndarray


def enter(grids, lists, number, bucket, x, n):
    """Enter a sample in the list of a bucket; without room for entries, only count it."""
    # Cells of a grid may share a bucket, which is then visited several times.
    if grids.starts[bucket] < grids.starts[bucket + 1] and lists.last[bucket] != number:
        lists.last[bucket] = number
        if lists.entries.size > 0:
            lists.entries[lists.starts[bucket]] = number
        lists.starts[bucket] += 1


def approach(grids, found, number, bucket, x, n):
    """Find the candidate of a bucket nearest to a point, on the side of the normal n."""
    rows, squares = found
    for at in range(grids.starts[bucket], grids.starts[bucket + 1]):
        square = squared_distance(grids.candidates, at, x)
        if square < squares[number] and on_side(grids.candidates, at, n):
            squares[number] = square
            rows[number] = at


enter_around, approach_around = around(enter), around(approach)


@jit
def list_samples(grids, lists, radius, samples, near):
    """Enter samples (N, 6) in the lists of all buckets with candidates within radius/√w of them.

    Write the indices of the samples near the box of all candidates to `near`, and return their
    number; the lists hold positions in `near`. If `lists.entries` is empty, each of `lists.starts`
    becomes the number of samples of a bucket. Otherwise each of `lists.starts` has to be the
    position of the first entry of a bucket, and becomes the position after its last entry.
    """
    count = 0
    for k in range(samples.shape[0]):
        if is_near(grids, radius, samples, k):
            enter_around(grids, radius, lists, count, row_vector(samples, k), normal_of(samples, k))
            near[count] = k
            count += 1
    return count


@inline
def single(x, y, z):
    """Return a vector in single precision."""
    return Vector(np.float32(x), np.float32(y), np.float32(z))  # pyright: ignore


@inline
def place_of(candidates, at, first):
    """Return the point of a candidate, relative to the first candidate of its bucket."""
    p, q = row_vector(candidates, at), row_vector(candidates, first)
    return single(p.x - q.x, p.y - q.y, p.z - q.z)


@loop
def gather(grids, lists, samples, bucket, room):
    """Write the samples listed for a bucket to the room; return their number."""
    start = lists.starts[bucket]
    count = lists.starts[bucket + 1] - start
    first = grids.starts[bucket]
    for c in range(count):
        k = lists.entries[start + c]
        for x in range(3):
            room.near[x, c] = samples[k, x] - grids.candidates[first, x]
            room.near[3 + x, c] = samples[k, 3 + x]
    return count


@loop
def nearest_square(p, candidates, at, count, room):
    """Return the squared distance of a candidate at p from the nearest sample on its side.

    Write the squared distances from all samples to the room.
    """
    n = single(candidates[at, NORMAL], candidates[at, NORMAL + 1], candidates[at, NORMAL + 2])
    near, squares, bits, end = room.near, room.squares, room.bits, np.uint64(count)
    for k in range(count):
        c = np.uint64(k)  # unsigned: no check for negative indices
        dx, dy, dz = near[0, c] - p.x, near[1, c] - p.y, near[2, c] - p.z
        square = dx * dx + dy * dy + dz * dz
        cosine = near[3, c] * n.x + near[4, c] * n.y + near[5, c] * n.z
        squares[c] = square if cosine >= COSINE else FAR
    squares[end] = FAR
    least = bits[end]
    for k in range(count):  # integers: minima of floats, which may be NaN, are not vectorized
        least = min(least, bits[np.uint64(k)])
    bits[end] = least
    return squares[end]


@loop
def find_in_cell(p, sides, at, square, count, room):
    """Write the nearest sample of each fine point of a cell, and its squared distance, to the room.

    `square` is the result of `nearest_square` for the candidate at p.
    """
    near, squares, least, nearest = room.near, room.squares, room.least, room.nearest
    u, v = row_vector(sides, at), row_vector(sides[:, 3:], at)
    for k in range(PLACES):
        least[np.uint64(k)] = FAR
    within = np.float32(math.sqrt(square)) + sides[at, EXTENT] + sides[at, EXTENT]
    within *= within * ROUNDING
    count_of_few = 0
    for k in range(count):  # without a branch, which no processor predicts
        room.few[np.uint64(count_of_few)] = k
        count_of_few += squares[np.uint64(k)] <= within
    for k in range(count_of_few):
        number = room.few[np.uint64(k)]
        c = np.uint64(number)
        x, y, z = near[0, c] - p.x, near[1, c] - p.y, near[2, c] - p.z
        for i in range(PLACES):
            m = np.uint64(i)
            dx = S[m] * u.x + T[m] * v.x - x
            dy = S[m] * u.y + T[m] * v.y - y
            dz = S[m] * u.z + T[m] * v.z - z
            own, other = dx * dx + dy * dy + dz * dz, least[m]
            nearest[m] = number if own < other else nearest[m]
            least[m] = own if own < other else other


@jit
def add_moments(grids, lists, samples, room, moments):
    """Add the fine points in the cells of candidates to the moments (N, 4) of the nearest samples.

    The moments of a sample are the sum of weights times points (3), and the sum of weights. The
    weight of a point is the area of the cell times w² times the squared distance of the point from
    the sample. A sample at the weighted mean is a critical point of the integral, over its Voronoi
    cell, of w² times the fourth power of the distance. The mean is near the centre of the smallest
    ball around the cell. Candidates without a listed sample are left out.
    """
    candidates, sides, sums = grids.candidates, lists.sides, room.moments
    for bucket in range(grids.starts.size - 1):
        count = gather(grids, lists, samples, bucket, room)
        if count == 0:
            continue
        sums[:count] = 0.0
        first = grids.starts[bucket]
        for at in range(first, grids.starts[bucket + 1]):
            p, density = place_of(candidates, at, first), candidates[at, DENSITY]
            square = nearest_square(p, candidates, at, count, room)
            if square >= FAR:
                continue
            find_in_cell(p, sides, at, square, count, room)
            factor = sides[at, AREA] * density * density
            u, v = row_vector(sides, at), row_vector(sides[:, 3:], at)
            for k in range(PLACES):
                m = np.uint64(k)
                c, weight = np.uint64(room.nearest[m]), factor * room.least[m]
                sums[c, 0] += weight * (p.x + S[m] * u.x + T[m] * v.x)
                sums[c, 1] += weight * (p.y + S[m] * u.y + T[m] * v.y)
                sums[c, 2] += weight * (p.z + S[m] * u.z + T[m] * v.z)
                sums[c, 3] += weight
        for c in range(count):
            k, weight = lists.entries[lists.starts[bucket] + c], sums[c, 3]
            for x in range(3):
                moments[k, x] += sums[c, x] + weight * candidates[first, x]
            moments[k, 3] += weight


@jit
def find_centres(grids, sides, order, points, squares, rows, steps):
    """Find the point of a cell nearest to each of the points of `points` (N, 6).

    A row of `points` has a point, and the normal of a sample. The cell is that of the nearest
    candidate on the side of this normal, in the grids around the point. If the squared distance of
    the point from this candidate is less than that in `squares` (N,), it is written to `squares`,
    order[candidate] to `rows` (N,), and the coordinates of the found point in its cell, at most
    INNER in modulus, to `steps` (N, 2).
    """
    for k in range(points.shape[0]):
        x, n, before = row_vector(points, k), normal_of(points, k), squares[k]
        if before > 0.0 and is_near(grids, grids.radius, points, k):
            approach_around(grids, grids.radius, (rows, squares), k, x, n)
        if squares[k] >= before:
            continue
        at = rows[k]
        rows[k] = order[at]
        u, v = row_vector(sides, at), row_vector(sides[:, 3:], at)
        p = row_vector(grids.candidates, at)
        away = Vector(x.x - p.x, x.y - p.y, x.z - p.z)
        e, f, g = dot(u, u), dot(u, v), dot(v, v)
        along_u, along_v, determinant = dot(away, u), dot(away, v), e * g - f * f
        steps[k, 0] = steps[k, 1] = 0.0
        if determinant > 0.0:  # cells that a boundary intersects have no sides
            s, t = along_u * g - along_v * f, along_v * e - along_u * f
            steps[k, 0] = min(max(s / determinant, -INNER), INNER)
            steps[k, 1] = min(max(t / determinant, -INNER), INNER)


@loop
def turn_of(candidates, at, square, count, room):
    """Return the squared chord between the normals of a candidate and of the nearest sample.

    `square` is the result of `nearest_square` for the candidate.
    """
    n, near = normal_of(candidates, at), room.near
    for k in range(count):
        c = np.uint64(k)
        if room.squares[c] == square:
            dx, dy, dz = near[3, c] - n.x, near[4, c] - n.y, near[5, c] - n.z
            return dx * dx + dy * dy + dz * dz
    return 0.0


@jit
def find_widest(grids, lists, samples, bounds, room, found, gaps):
    """Find the point of each cell that is farthest from all samples, if at least least/√w away.

    found (M,): for each cell, the index of this fine point; −1 for the candidate itself, if no
    listed sample is on its side or the chord at the candidate counts; −2 if all points are nearer.
    gaps (M, 2) are w, and w times the squared distance d². If w = κ², this product is about the
    squared chord c² between the normals of the point and of the nearest sample. Where κ jumps, c²
    at the candidate may be larger: then it counts instead, with w = c²/d² up to the ceiling. A
    chord above `most` never counts: the two normals belong to the two sides of an edge. `bounds`
    are `least`, `most` and the ceiling.
    """
    candidates, sides = grids.candidates, lists.sides
    least, most, ceiling = bounds
    for bucket in range(grids.starts.size - 1):
        count, first = gather(grids, lists, samples, bucket, room), grids.starts[bucket]
        for at in range(first, grids.starts[bucket + 1]):
            p, density = place_of(candidates, at, first), candidates[at, DENSITY]
            square = nearest_square(p, candidates, at, count, room)
            found[at], gaps[at, 0], gaps[at, 1] = -2, density, least * least
            if candidates[at, SQUARE] < 0.0:
                continue
            turn = turn_of(candidates, at, square, count, room)
            if least * least <= min(turn, ceiling * square) and turn <= most * most:
                turn = min(turn, ceiling * square)
                found[at], gaps[at, 0], gaps[at, 1] = -1, turn / square, turn
            wide = math.sqrt(square) + sides[at, EXTENT]
            if wide * wide * density < gaps[at, 1]:
                continue
            if square >= FAR:
                found[at], gaps[at, 1] = -1, FAR * density
            else:
                find_in_cell(p, sides, at, square, count, room)
                for m in range(PLACES):
                    if room.least[m] * density >= gaps[at, 1]:
                        found[at], gaps[at, 0], gaps[at, 1] = m, density, room.least[m] * density
