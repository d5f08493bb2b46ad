"""How well a cover represents a surface, measured at places: what "balanced" is chosen by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..kernels.nearest import compare_with_nearest
from ..spline.inside import parameters_of
from .cover import Cover
from .nearest import NearestSamples
from .sizing import SizingFunction
from .triangles import Array, Indices, Triangles

__all__ = ["Errors", "places_on"]

# About this number of places.
PLACES = 20_000
# The widest gaps are searched at more places: around this number of them, at this number each, in
# this part of the patch.
SEARCHES = ((300, 16, 1.0), (60, 16, 0.3), (30, 16, 0.1))
# An even sequence in the square (Martin Roberts, 2018): the root of x³ = x + 1.
SEQUENCE = 1.324717957244746 ** -np.array([1.0, 2.0])
# Places are compared in normal space in parts of this number.
AT_A_TIME = 1_000
# Normals closer than this count as one.
SAME_NORMAL = 2.0**-17
# K is 0 below this part of the largest one.
FLAT = 1e-9
# Samples on the same side are searched within this multiple of the distances expected.
FARTHEST = 4.0


@dataclass(frozen=True, eq=False)
class Errors:
    """The largest errors of a cover at places; lengths are scaled, angles are chords.

    Computed when they are asked for; fast if about this `distance` and this `angle` are expected.
    `rows` are `places.as_samples()`.
    """

    cover: Cover
    places: Triangles
    rows: Array
    distance: float
    angle: float

    @cached_property
    def _samples(self) -> NearestSamples:
        return NearestSamples(self.cover.points, self.cover.sizing.threads)

    @cached_property
    def _nearest(self) -> tuple[Array, Indices]:
        """The distances and the numbers of the samples nearest in space."""
        return self._samples.nearest(self.rows, FARTHEST * self.distance)

    @cached_property
    def _compared(self) -> tuple[float, float, Array]:
        """The two largest errors at the samples nearest in space, and the chords of all places."""
        chords = np.empty(len(self.rows))
        largest = compare_with_nearest(self.rows, self.cover.points, self._nearest[1], chords)
        return *largest, chords

    @property
    def in_space(self) -> float:
        """The largest chord between the normals of a place and of the sample nearest in space."""
        return self._compared[0]

    @property
    def tangent(self) -> float:
        """The largest distance from the tangent plane at the sample nearest in space."""
        return self._compared[1]

    @cached_property
    def in_normal(self) -> float:
        """The largest chord between the normal of a place and the nearest one of a sample.

        That is among samples with the same sign of K.
        """
        return _in_normal(self.rows, self.cover, self.angle, self._nearest[1], self._compared[2])

    @cached_property
    def gap(self) -> float:
        """The largest distance from the nearest sample."""
        places, distances = self.places, self._nearest[0]
        widest = distances.max(initial=0.0)
        for number, each, part in SEARCHES:
            if len(places) == 0:
                break
            places = _around(places, _first_of_largest(distances, number), each, part)
            found = self._samples.nearest(places.at_places(), FARTHEST * self.distance)
            distances = found[0]
            widest = max(widest, distances.max(initial=0.0))
        return float(widest)


def places_on(sizing: SizingFunction) -> tuple[Triangles, Array]:
    """Return about PLACES places of a surface that have normals, and what is sampled there.

    One half is even, where gaps may be wide; the other half is dense where the target density is
    large, and so may angles be.
    """
    densities = np.maximum(sizing.patch_integrals, sizing.target.floor * sizing.areas)
    patches = np.concatenate([_spread(x, PLACES // 2) for x in (sizing.areas, densities)])
    places = _inside(sizing, patches, _in_triangle(len(patches)))
    rows = places.as_samples()
    regular = np.any(rows[:, 3:6], axis=1)
    return places[regular], rows[regular]


def _in_triangle(count: int) -> Array:
    """Return places (count, 2), all over the triangle (0, 0), (1, 0), (0, 1)."""
    square = np.arange(count)[:, None] * SEQUENCE % 1.0
    return np.where(square.sum(axis=1, keepdims=True) < 1.0, square, 1.0 - square)


def _inside(sizing: SizingFunction, patches: Indices, places: Array) -> Triangles:
    """Return those of places (M, 2) of patches (M,) that are inside the trim."""
    triangles = Triangles(sizing, patches, np.repeat(places[:, None], 3, axis=1), places)
    trim = sizing.spline.trim
    if trim is None:
        return triangles
    return triangles[trim.contains(parameters_of(sizing.spline, patches, places), sizing.threads)]


def _spread(weights: Array, count: int) -> Indices:
    """Return the numbers of `count` patches, in proportion to weights."""
    sums = np.cumsum(weights)
    found = np.searchsorted(sums, (np.arange(count) + 0.5) * (sums[-1] / count))
    return np.minimum(found, len(weights) - 1)


def _first_of_largest(values: Array, number: int) -> Indices:
    """Return the places of the largest of values, in order, `number` at most."""
    least = -np.inf
    if len(values) > number:
        least = np.partition(values, len(values) - number)[len(values) - number]
    places = np.flatnonzero(values >= least)
    return places[np.argsort(-values[places], kind="stable")[:number]]


def _around(places: Triangles, chosen: Indices, each: int, part: float) -> Triangles:
    """Return `each` places around some others, in a part of the patch."""
    centres = np.repeat(places.uv[chosen], each, axis=0)
    moved = centres + part * (_in_triangle(len(centres)) - centres)
    return _inside(places.sizing, np.repeat(places.patches[chosen], each), moved)


def _in_normal(rows: Array, cover: Cover, angle: float, nearest: Indices, chords: Array) -> float:
    """Return the largest chord between normals of rows and those of samples of the same sign.

    `nearest` are the samples nearest in space. Where their sign is the same, chords to their
    normals are bounds, and the rows with the largest bounds decide.
    """
    flat = FLAT * np.abs(rows[:, 7]).max(initial=0.0)
    negative, of_samples = rows[:, 7] < -flat, cover.curvatures < -flat
    bounds = np.where(negative == of_samples[nearest], chords, np.inf)
    samples = NearestSamples(_distinct(cover.points[:, 3:], of_samples), cover.sizing.threads)
    largest, left = 0.0, np.arange(len(rows))
    while len(left):
        number = min(AT_A_TIME, len(left) - 1)
        part = left[np.argpartition(-bounds[left], number)[: number + 1]]
        at_places = _in_normal_space(rows[part, 3:6], negative[part])
        found = samples.nearest(at_places, FARTHEST * angle)[0]
        largest = max(largest, float(found.max()))
        bounds[part] = 0.0
        left = left[bounds[left] > largest]
    return largest


def _distinct(normals: Array, negative: NDArray[np.bool_]) -> Array:
    """Return normals without repetitions as samples (k, 6), see `_in_normal_space`."""
    keys = np.rint(normals / SAME_NORMAL).astype(np.int64)
    key = ((keys[:, 0] << 20) + keys[:, 1] << 20) + 2 * keys[:, 2] + negative
    once = np.unique(key, return_index=True)[1]
    return _in_normal_space(normals[once], negative[once])[:, :6]


def _in_normal_space(normals: Array, negative: NDArray[np.bool_]) -> Array:
    """Return normals as points of rows (k, 8); signs of K are opposite sides."""
    rows = np.zeros((len(normals), 8))
    rows[:, :3], rows[:, 3] = normals, np.where(negative, -1.0, 1.0)
    return rows
