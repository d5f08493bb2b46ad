"""How well a cover represents a surface, measured at places: what "balanced" is chosen by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..splines.inside import parameters_of
from ..trees import tree_of
from .candidates import Candidates
from .cover import Cover
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
AT_A_TIME = 3_000
# Normals closer than this count as one.
SAME_NORMAL = 2.0**-17
# K is 0 below this part of the largest one.
FLAT = 1e-9
# Samples are searched within a distance that is made larger by this factor, up to TIMES times.
LARGER, TIMES = 2.0, 3


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
    def _nearest(self) -> tuple[Array, Indices]:
        """The distances and the numbers of the samples nearest in space."""
        return _nearest_in_space(self.rows, self.cover, self.distance)

    @cached_property
    def _chords(self) -> Array:
        """The chords between the normals of places and those of the samples nearest in space."""
        return np.linalg.norm(self.rows[:, 3:6] - self.cover.points[self._nearest[1], 3:], axis=1)

    @cached_property
    def tangent(self) -> float:
        """The largest distance from the tangent plane at the sample nearest in space."""
        samples = self.cover.points[self._nearest[1]]
        away = np.einsum("ij,ij->i", self.rows[:, :3] - samples[:, :3], samples[:, 3:])
        return float(np.abs(away).max(initial=0.0))

    @cached_property
    def in_space(self) -> float:
        """The largest chord between the normals of a place and of the sample nearest in space."""
        return float(self._chords.max(initial=0.0))

    @cached_property
    def in_normal(self) -> float:
        """The largest chord between the normal of a place and the nearest one of a sample.

        That is among samples with the same sign of K.
        """
        return _in_normal(self.rows, self.cover, self.angle, self._nearest[1], self._chords)

    @cached_property
    def gap(self) -> float:
        """The largest distance from the nearest sample."""
        return _widest_gap(self.cover, self.places, self._nearest[0], self.distance)


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


def _nearest_in_space(rows: Array, cover: Cover, distance: float) -> tuple[Array, Indices]:
    """Return the distances and the numbers of the samples nearest to rows (M, 8)."""
    rows = rows.copy()
    rows[:, 6] = 1.0
    return _nearest(rows, cover.points, distance)


def _widest_gap(cover: Cover, places: Triangles, distances: Array, distance: float) -> float:
    """Return the largest distance at places, and at more of them around the largest ones."""
    sizing, widest = cover.sizing, distances.max(initial=0.0)
    for number, each, part in SEARCHES:
        if len(places) == 0:
            break
        chosen = np.argsort(-distances, kind="stable")[:number]
        centres = np.repeat(places.uv[chosen], each, axis=0)
        patches = np.repeat(places.patches[chosen], each)
        moved = centres + part * (_in_triangle(len(centres)) - centres)
        places = _inside(sizing, patches, moved)
        distances = _nearest_in_space(places.at_places(), cover, distance)[0]
        widest = max(widest, distances.max(initial=0.0))
    return float(widest)


def _in_normal(rows: Array, cover: Cover, angle: float, nearest: Indices, chords: Array) -> float:
    """Return the largest chord between normals of rows and those of samples of the same sign.

    `nearest` are the samples nearest in space. Where their sign is the same, chords to their
    normals are bounds, and the rows with the largest bounds decide.
    """
    flat = FLAT * np.abs(rows[:, 7]).max(initial=0.0)
    negative, of_samples = rows[:, 7] < -flat, cover.curvatures < -flat
    bounds = np.where(negative == of_samples[nearest], chords, np.inf)
    samples = _in_normal_space(cover.points[:, 3:], of_samples)[:, :6]
    order, largest = np.argsort(-bounds, kind="stable"), 0.0
    for first in range(0, len(order), AT_A_TIME):
        part = order[first : first + AT_A_TIME]
        if bounds[part[0]] <= largest:
            break
        at_places = _in_normal_space(rows[part, 3:6], negative[part])
        largest = max(largest, float(_nearest(at_places, samples, angle)[0].max()))
    return largest


def _in_normal_space(normals: Array, negative: NDArray[np.bool_]) -> Array:
    """Return distinct normals as rows (k, 8) of candidates; signs of K are opposite sides."""
    keys = np.rint(normals / SAME_NORMAL).astype(np.int64)
    key = ((keys[:, 0] << 20) + keys[:, 1] << 20) + 2 * keys[:, 2] + negative
    once = np.unique(key, return_index=True)[1]
    rows = np.zeros((len(once), 8))
    rows[:, :3], rows[:, 3] = normals[once], np.where(negative[once], -1.0, 1.0)
    rows[:, 6] = 1.0
    return rows


def _nearest(rows: Array, samples: Array, radius: float) -> tuple[Array, Indices]:
    """Return the distances and the numbers of the samples (N, 6) nearest to rows (M, 8).

    The search is fast where there is one on the same side within the radius, or a few times that.
    """
    distances, numbers = np.full(len(rows), np.inf), np.full(len(rows), -1)
    left = np.arange(len(rows))
    for _ in range(TIMES):
        candidates = Candidates(rows[left], radius)
        candidates.update_distances(samples, radius)
        distances[left], numbers[left] = candidates.distances, candidates.nearest
        left = left[~(distances[left] <= radius)]
        if len(left) == 0:
            return distances, numbers
        radius *= LARGER
    distances[left], numbers[left] = tree_of(samples[:, :3]).query(rows[left, :3])
    return distances, numbers
