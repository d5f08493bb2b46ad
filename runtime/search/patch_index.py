"""The index of a spline: for each bin of the sphere, the patches that may have normals in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Indices
from ..base.kept import kept
from ..base.threads import over_ranges
from ..directions.unit import perpendicular
from ..spline.nets import AnySpline, NetSpline
from ..spline.spline import Spline
from ..spline.tips import tips_of
from .in_nets import errors_of
from .kernels.lists import (
    FINEST,
    NUMBER,
    Lists,
    count_keys,
    list_pieces,
    order_normals,
    place_keys,
    write_caps,
)
from .kernels.pieces import CHORD, DATA_BOUND, Pieces, write_net_pieces, write_pieces

# An index of all patches takes 240 bytes a patch, and is cached with the spline. A spline with more
# than MOST_PATCHES patches has an index for each range of patches; each search makes them anew.
MOST_PATCHES = 1 << 20
# Rounding errors of coordinates are assumed to be at most this fraction of a cell. With larger
# ones, the search would take regular points for lines, or leave all pairs of a patch and a normal
# to exact decisions.
MOST_NOISE = 2.0**-20
PIECES_AT_A_TIME, NORMALS_AT_A_TIME = 1 << 12, 1 << 16
# Bins are halved as long as a piece is listed in at most this number of bins on average.
BINS_PER_PIECE = 7.0
# The initial capacity of the array of keys (bin, piece).
KEYS_PER_PIECE = 16
# Normals are sorted by bins with at least this many normals on average.
NORMALS_PER_BIN = 4
# The size of bins is computed from a subset of about this many pieces, at evenly spaced indices.
LOOKED_AT = 1 << 10
# If all normals are in a cap, bins cover only this cap, unless the tangent of half its opening
# angle exceeds WIDEST_CAP. Smaller tangents than NARROWEST_CAP are replaced by NARROWEST_CAP.
WIDEST_CAP, NARROWEST_CAP = 0.5, 2.0**-30


@dataclass(frozen=True, eq=False)
class Index:
    """Pieces of a surface, and for each bin of the sphere the pieces that may have normals in it.

    `first` is the index of the first piece among all patches of the spline, `most` the largest
    number of pieces in one bin. Threads share an index: it is never changed.
    """

    pieces: Pieces
    lists: Lists
    first: int
    most: int

    @property
    def bounds(self) -> Array:
        """For each of the K pieces, a bound of the errors of its forms U, V, W."""
        return self.pieces.patches[:, DATA_BOUND]


def index_of(spline: AnySpline, threads: int | None, first: int = 0) -> Index:
    """Return the index of the patches [first, first + MOST_PATCHES) of a spline.

    If these are all patches, the index is cached with the spline.
    """

    def make() -> Index:
        last = min(first + MOST_PATCHES, spline.patches)
        if isinstance(spline, NetSpline):
            pieces = _of_nets(spline, first, last)
        else:
            pieces = _of_grid(spline, first, last, threads)
        lists = _listed(spline, pieces.cones, first)
        return Index(pieces, lists, first, int(np.diff(lists.starts).max()))

    return kept(spline, Index, make) if spline.patches <= MOST_PATCHES else make()


def open_sides(spline: Spline) -> NDArray[np.bool_]:
    """Return which sides of the domain are open (4,), in the order south, east, north, west."""
    (west, east), (south, north) = spline.boundary
    return np.array([end == "open" for end in (south, east, north, west)])


def _of_grid(spline: Spline, first: int, last: int, threads: int | None) -> Pieces:
    """Return the patches [first, last) of a spline on a grid, as pieces."""
    pieces, start = Pieces.new(last - first), first // 4
    mu, scale, noise = spline.coefficients, spline.scale, min(spline.noise, MOST_NOISE)

    def work(low: int, high: int) -> None:
        net = np.empty((6, 4))
        write_pieces(mu, scale, noise, start, start + low, start + high, net, pieces)

    list(over_ranges(work, (last - first) // 4, PIECES_AT_A_TIME, threads))
    return pieces


def _of_nets(spline: NetSpline, first: int, last: int) -> Pieces:
    """Return the patches [first, last) of a spline of nets, as pieces."""
    pieces = Pieces.new(last - first)
    vectors, angles, bounds = (
        np.ascontiguousarray(x[first:last])
        for x in (spline.vectors, spline.topology.angles, errors_of(spline))
    )
    noise = min(spline.noise, MOST_NOISE)
    write_net_pieces(vectors, noise, angles, bounds, np.empty((6, 4)), pieces)
    return pieces


def _listed(spline: AnySpline, cones: Array, first: int) -> Lists:
    """Return, for each bin, the list of patches with the given cones, without patches at tips.

    `first` is the index of the patch of the first cone among all patches of the spline.
    """
    tips = tips_of(spline)
    if tips is None:
        return listed(cones)
    kept = np.flatnonzero(~tips.collapsed[first : first + len(cones)])
    lists = listed(cones[kept])
    return lists._replace(members=kept.astype(np.int32)[lists.members])


def listed(cones: Array) -> Lists:
    """Return, for each bin of the sphere, the list of pieces whose cones (K, 8) meet it."""
    frame, tangent = _frame_of(cones)
    faces, inverse = 6 if tangent == 1.0 else 1, np.linalg.inv(frame).astype(np.float64)
    level = _level_of(cones, faces, tangent)
    caps = np.empty((faces << 2 * level, 4))
    write_caps(inverse, faces, level, caps)
    # The least cosine between a direction in a bin and the axis of the cube's face with the bin.
    least = (1.0 - 1e-12) / math.sqrt(1.0 + 2.0 * tangent**2)
    keys = np.empty(0, np.int64)
    room = KEYS_PER_PIECE * len(cones)
    while room > len(keys):
        keys = np.empty(room, np.int64)
        room = list_pieces(cones, caps, frame, faces, level, 1.0 / tangent, least, keys)
    keys = sorted_keys([keys[:room]], 32, len(caps))
    starts = np.searchsorted(keys, np.arange(len(caps) + 1) << 32)
    return Lists(frame, inverse, faces, level, starts, (keys & NUMBER).astype(np.int32))


def _frame_of(cones: Array) -> tuple[Array, float]:
    """Return a linear map (3, 3) from a cap that contains all cones to a face of the unit cube.

    The second result is the tangent of half the opening angle of the cap. If it exceeds WIDEST_CAP,
    the results are the identity and 1: the bins then cover all six faces of the cube.
    """
    axes, chords = cones[:, :3], cones[:, CHORD]
    mean = axes.mean(axis=0)
    size = float(np.linalg.norm(mean))
    everything = np.eye(3), 1.0
    if size < 0.8:
        return everything
    across, along = perpendicular(mean / size)
    directions = np.stack([across, along, mean / size])
    x, y, height = directions @ axes.T
    if not (height - chords > 0.5).all():
        return everything
    # A bound of the tangent of the largest angle between a direction of a cone and the mean axis:
    # the tangent for the axis of the cone, plus a bound of the increase by its half angle.
    far = (np.hypot(x, y) / height + chords / (height * (height - chords))).max()
    tangent = max(float(far) * (1.0 + 1e-9), NARROWEST_CAP)
    if tangent > WIDEST_CAP:
        return everything
    return directions / [[tangent], [tangent], [1.0]], tangent


def _level_of(cones: Array, faces: int, tangent: float) -> int:
    """Return how often each face of the cube is halved, along both directions, to make bins.

    It is the largest number for which a piece is in at most BINS_PER_PIECE bins on average, and for
    which there are at most as many bins as pieces (four on each face are always allowed).
    """
    chords = cones[:: max(len(cones) // LOOKED_AT, 1), CHORD] / tangent
    level = 0
    while level < FINEST and faces << 2 * (level + 1) <= max(len(cones), faces << 2):
        bins = np.minimum((1.0 + chords * (2 << level)) ** 2, float(faces << 2 * (level + 1)))
        if bins.mean() > BINS_PER_PIECE:
            break
        level += 1
    return level


def ordered(normals: Array, lists: Lists, threads: int | None) -> Indices:
    """Return keys bin << 32 | index of normals (S, 3), sorted by bins.

    The bins in the keys are the finest ones. The keys are sorted only by coarser bins, which hold
    at least NORMALS_PER_BIN normals on average. Normals outside all bins have no key.
    """
    keys = np.empty(len(normals), np.int64)

    def work(first: int, last: int) -> None:
        order_normals(normals, lists.frame, lists.faces, first, last, keys)

    list(over_ranges(work, len(keys), NORMALS_AT_A_TIME, threads))
    if lists.faces == 1:
        keys = keys[keys >= 0]
    level = 0
    while level < FINEST and (lists.faces << 2 * level + 2) * NORMALS_PER_BIN <= len(keys):
        level += 1
    return sorted_keys([keys], 32 + 2 * (int(FINEST) - level), lists.faces << 2 * level)


def sorted_keys(parts: Sequence[Indices], shift: int, count: int) -> Indices:
    """Return all keys of `parts`, sorted by their leading bits key >> shift, which are < `count`.

    The sort is stable.
    """
    starts = np.zeros(count + 1, np.int32)
    for keys in parts:
        count_keys(keys, shift, starts)
    np.cumsum(starts, out=starts)
    found = np.empty(int(starts[-1]), np.int64)
    for keys in parts:
        place_keys(keys, shift, starts, found)
    return found
