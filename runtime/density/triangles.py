"""Triangles in the parameter domains of the patches; samples are chosen among their centroids."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..base.errors import InputError
from ..base.memory import check_memory
from ..base.threads import over_ranges
from ..kernels import triangles as kernels
from ..spline.inside import FINEST, Inside, parameters_of, subcentroids
from .sizing import SizingFunction

__all__ = ["Array", "Indices", "Triangles", "cut_patches", "refuse_more", "subdivisions"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

TRIANGLES_AT_A_TIME = 1 << 13
PATCHES_AT_A_TIME = 1 << 11
# The smallest area of a triangle, relative to the square of the radius asked for: long and narrow
# patches would be cut into too many triangles otherwise.
SMALLEST_AREA = 0.5
# A patch is narrow if its area is less than this part of the square of its own radius. Its
# triangles are bisected, instead of cut into similar ones.
NARROW = 0.1
# Triangles are not cut to sides shorter than this part of those of a patch for their normals: next
# to singular points these turn at once.
DEEPEST = 2.0**-10
# Triangles are numbered by 32 bits.
MOST = 2e9
# A triangle with its centroid outside is tested at the centroids of its parts, PARTS² of them. If
# all of these are outside, it is cut, until it is so large relative to the patch, and then dropped.
PARTS = 4
SMALLEST = PARTS / FINEST


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles of the patches (M,), with corners (M, 3, 2) in the parameters u, v of the patch.

    Each has a place (M, 2), by default its centroid; on a trimmed surface it is inside the trim.
    """

    sizing: SizingFunction
    patches: Indices
    corners: Array
    places: Array | None = None

    def __len__(self) -> int:
        return len(self.patches)

    def __getitem__(self, chosen: Indices | NDArray[np.bool_] | slice) -> Triangles:
        """Return some of the triangles."""
        places = None if self.places is None else self.places[chosen]
        return Triangles(self.sizing, self.patches[chosen], self.corners[chosen], places)

    def __add__(self, other: Triangles) -> Triangles:
        """Return these triangles, followed by others of the same spline."""
        at_centroids = self.places is None and other.places is None
        return Triangles(
            self.sizing,
            np.concatenate([self.patches, other.patches]),
            np.concatenate([self.corners, other.corners]),
            None if at_centroids else np.concatenate([self.uv, other.uv]),
        )

    def at(self, places: Array) -> Triangles:
        """Return the triangles with other places (M, 2)."""
        return Triangles(self.sizing, self.patches, self.corners, places)

    def write(self, rows: Indices, triangles: Triangles) -> None:
        """Replace some of the triangles by as many others."""
        self.patches[rows], self.corners[rows] = triangles.patches, triangles.corners
        if self.places is not None:
            self.places[rows] = triangles.uv

    @property
    def centroids(self) -> Array:
        """The parameters (M, 2) of the centroids."""
        a, b, c = np.moveaxis(self.corners, 1, 0)  # sum(axis=1) takes ten times as long
        return (a + b + c) / 3.0

    @property
    def uv(self) -> Array:
        """The parameters (M, 2) of the places."""
        return self.centroids if self.places is None else self.places

    @property
    def radii(self) -> Array:
        """Radii (M,) of balls around the images of the places that hold the triangles."""
        radii = self._written_by(kernels.radii, self.corners, np.empty(len(self)))
        if self.places is not None:
            # That around the centroid, and the way there.
            radii[(self.places != self.centroids).any(axis=1)] *= 2.0
        return radii

    @property
    def quarters(self) -> Triangles:
        """The triangles cut into four similar ones each, without those outside the trim.

        The four of a triangle (4 M) follow one another if there is no trim.
        """
        return _inside_trim(self.uncut_quarters)

    @property
    def uncut_quarters(self) -> Triangles:
        """The triangles cut into four similar ones each (4 M), which follow one another."""
        check_memory("candidates", 4 * len(self))
        midpoints = (self.corners + np.roll(self.corners, 1, axis=1)) / 2.0
        points = np.concatenate([self.corners, midpoints], axis=1)
        corners = points[:, [[0, 4, 3], [4, 1, 5], [3, 5, 2], [5, 3, 4]]].reshape(-1, 3, 2)
        return Triangles(self.sizing, np.repeat(self.patches, 4), corners)

    @property
    def halves(self) -> Triangles:
        """The triangles bisected at the midpoints of their longest sides (2 M).

        Without those outside the trim.
        """
        check_memory("candidates", 2 * len(self))
        corners = self._written_by(kernels.bisect, self.corners, np.empty((2 * len(self), 3, 2)))
        return _inside_trim(Triangles(self.sizing, np.repeat(self.patches, 2), corners))

    def at_places(self) -> Array:
        """Return scaled point, unit normal, target density and K (M, 8) at the places.

        Of K only the sign counts. At a singular point, the normal and K are 0.
        """
        return self.sizing.geometry.as_candidates(self, self.on_spline())

    def on_spline(self) -> Array:
        """Return what `at_places` returns, all of it from the spline."""
        corners = self.corners
        if self.places is not None:
            corners = np.repeat(self.places[:, None], 3, axis=1)  # whose centroids they are
        sizing, rows = (self.sizing.target, self.sizing.radii), np.empty((len(self), 8))
        return self._written_by(kernels.evaluate_centroids, corners, *sizing, rows)

    def as_samples(self) -> Array:
        """Return rows as of `at_places`, with points, normals and K of what is sampled."""
        return self.sizing.geometry.as_samples(self)

    @property
    def deepest(self) -> NDArray[np.bool_]:
        """Which triangles (M,) are too small to be cut any more for their normals."""
        return np.ptp(self.corners[:, :, 0], axis=1) <= DEEPEST

    def chords(self, rows: Array) -> Array:
        """Return how far normals of what is sampled are from those of rows, see `normal_chords`."""
        return self.sizing.geometry.normal_chords(self, rows)

    def normal_chords(self, rows: Array) -> Array:
        """Return how far normals of each triangle (M,) are from that at its place, at most.

        That is the length of the chord between the unit vectors, or 2 if no bound below √2 is
        known. `rows` are those of `at_places`.
        """
        return self._written_by(kernels.normal_chords, self.corners, rows, np.empty(len(self)))

    def _written_by(self, kernel: Callable[..., None], corners: Array, *arguments: object) -> Array:
        """Return the last argument of a kernel, an array that it writes."""
        spline = self.sizing.spline

        def work(first: int, last: int) -> None:
            kernel(
                spline.coefficients,
                spline.scale,
                self.patches,
                corners,
                first,
                last,
                *arguments,
            )

        for _ in over_ranges(work, len(self), TRIANGLES_AT_A_TIME, self.sizing.threads):
            pass
        return cast(Array, arguments[-1])


def cut_patches(sizing: SizingFunction, radius: float) -> Triangles:
    """Cut all patches into triangles that lie within radius/√w of the images of their centroids.

    w is the largest target density of the patch. Triangles of long and narrow patches may reach
    farther. Those outside the trim are left out. Raises InputError if there were more than MOST
    triangles.
    """
    parts, narrow = subdivisions(sizing, radius)
    ends = np.cumsum(parts * parts)
    patches, corners = np.empty(ends[-1], dtype=np.int64), np.empty((ends[-1], 3, 2))

    def work(first: int, last: int) -> None:
        kernels.cut_patches(parts, ends, first, last, patches, corners)

    for _ in over_ranges(work, len(parts), PATCHES_AT_A_TIME, sizing.threads):
        pass
    triangles = _inside_trim(Triangles(sizing, patches, corners))
    return _bisect_narrow(triangles, narrow, radius) if narrow.any() else triangles


def _bisect_narrow(triangles: Triangles, narrow: NDArray[np.bool_], radius: float) -> Triangles:
    """Bisect the triangles of narrow patches until their radii or their areas are small enough."""
    sizing, left = triangles.sizing, narrow[triangles.patches]
    rates, share = np.sqrt(sizing.largest) / radius, 1.0
    areas = sizing.areas * rates * rates
    done, triangles = triangles[~left], triangles[left]
    while len(triangles):
        here = triangles.patches
        left = (triangles.radii * rates[here] > 1.0) & (share * areas[here] > SMALLEST_AREA)
        done, triangles, share = done + triangles[~left], triangles[left].halves, share / 2.0
    return done


def subdivisions(sizing: SizingFunction, radius: float) -> tuple[Indices, NDArray[np.bool_]]:
    """Return into how many parts `cut_patches` divides the sides of each patch (patches,).

    And which patches are narrow: these are not divided. Raises InputError if there were more than
    MOST triangles.
    """
    with np.errstate(divide="ignore", over="ignore"):
        rates = np.sqrt(sizing.largest) / radius
        by_area = np.sqrt(sizing.areas / SMALLEST_AREA) * rates
        parts = np.maximum(np.ceil(np.minimum(sizing.radii * rates, by_area)), 1.0)
        if sizing.spline.inside is not None:
            parts[~sizing.spline.inside.reached] = 1.0
        total = float((parts * parts).sum())
    refuse_more(sizing, total, MOST)
    check_memory("candidates", total)
    narrow = sizing.areas < NARROW * sizing.radii**2
    return np.where(narrow, 1, parts.astype(np.int64)), narrow


def refuse_more(sizing: SizingFunction, number: float, most: float) -> None:
    """Raise InputError if a number of triangles is too large."""
    if not number <= most:
        raise InputError(
            f"surface {sizing.spline.name!r} would have to be searched in more than {most:.0e} "
            "places; ask for a larger coverage or angle, or for fewer samples or normals."
        )


def _inside_trim(triangles: Triangles) -> Triangles:
    """Return the triangles that have a part inside the trim of their spline."""
    inside = triangles.sizing.spline.inside
    if inside is None:
        return triangles
    triangles = triangles[inside.reached[triangles.patches]]
    at_centroid = _contains(triangles, triangles.centroids)
    found = triangles[at_centroid]
    left = triangles[~at_centroid]
    left = left[_may_reach(left, inside)]
    while len(left):
        left, some = _with_places(left)
        found += left[some]
        left = left[~some]
        large = np.ptp(left.corners[:, :, 0], axis=1) > SMALLEST
        left = left[large].uncut_quarters
        at_centroid = _contains(left, left.centroids)
        found += left[at_centroid]
        left = left[~at_centroid]
    found = found[np.argsort(found.patches, kind="stable")]
    return found.at(found.uv)


def _may_reach(triangles: Triangles, inside: Inside) -> NDArray[np.bool_]:
    """Say which triangles with centroids outside may have a part inside."""
    spline, width = triangles.sizing.spline, len(inside.near) // triangles.sizing.spline.cells[0]
    small = np.abs(np.diff(triangles.corners, axis=1)).max(axis=(1, 2)) <= 1.0 / width
    return ~small | inside.is_near(spline, triangles.patches, triangles.centroids)


def _with_places(triangles: Triangles) -> tuple[Triangles, NDArray[np.bool_]]:
    """Give triangles places inside, in the middle of those known; say which ones have one."""
    places = subcentroids(PARTS)
    first, along, across = np.moveaxis(triangles.corners, 1, 0)[..., None, :]
    points = first + places[:, :1] * (along - first) + places[:, 1:] * (across - first)
    is_inside = _contains(triangles, points)
    number = is_inside.sum(axis=1)
    mean = np.where(is_inside[..., None], points, 0.0).sum(axis=1) / np.maximum(number, 1)[:, None]
    squares = ((points - mean[:, None]) ** 2).sum(axis=2)
    best = np.where(is_inside, squares, np.inf).argmin(axis=1)
    return triangles.at(points[np.arange(len(points)), best]), number > 0


def _contains(triangles: Triangles, places: Array) -> NDArray[np.bool_]:
    """Say which places (M, …, 2) of triangles are inside the trim."""
    spline = triangles.sizing.spline
    assert spline.trim is not None
    each = places[0, ..., 0].size if len(places) else 1
    uv = parameters_of(spline, np.repeat(triangles.patches, each), places.reshape(-1, 2))
    return spline.trim.contains(uv, triangles.sizing.threads).reshape(places.shape[:-1])
