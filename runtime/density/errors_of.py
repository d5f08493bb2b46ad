"""How well a cover represents a surface, measured at places: what "balanced" is chosen by."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..splines.inside import parameters_of
from ..trees import tree_of
from .candidates import Candidates
from .cover import Cover
from .sizing import SizingFunction
from .triangles import Array, Indices, Triangles

__all__ = ["Errors", "errors_of", "places_on"]

# About this number of places.
PLACES = 20_000
# The widest gaps are searched at more places: around this number of them, at this number each, in
# this part of the patch.
SEARCHES = ((300, 16, 1.0), (60, 16, 0.3), (30, 16, 0.1))
# An even sequence in the square (Martin Roberts, 2018): the root of x³ = x + 1.
SEQUENCE = 1.324717957244746 ** -np.array([1.0, 2.0])
# Normals closer than this count as one.
SAME_NORMAL = 2.0**-17
# K is 0 below this part of the largest one.
FLAT = 1e-9
# Samples are searched within a distance that is made larger by this factor, up to TIMES times.
LARGER, TIMES = 2.0, 3


class Errors(NamedTuple):
    """The largest errors at places; lengths are scaled, angles are chords.

    `tangent`: the distance from the tangent plane at the sample nearest in space; `in_space`:
    between the normals of the place and of that sample; `in_normal`: between the normal of a place
    and the nearest one of a sample with the same sign of K; `gap`: the distance from the nearest
    sample.
    """

    tangent: float
    in_space: float
    in_normal: float
    gap: float


def places_on(sizing: SizingFunction) -> Triangles:
    """Return about PLACES places of a surface.

    One half is even, where gaps may be wide; the other half is dense where the target density is
    large, and so may angles be.
    """
    densities = np.maximum(sizing.patch_integrals, sizing.target.floor * sizing.areas)
    patches = np.concatenate([_spread(x, PLACES // 2) for x in (sizing.areas, densities)])
    return _inside(sizing, patches, _in_triangle(len(patches)))


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


def errors_of(cover: Cover, places: Triangles, distance: float, angle: float) -> Errors:
    """Return the errors at places, if about this distance and this angle are expected."""
    rows = places.as_samples()
    regular = np.any(rows[:, 3:6], axis=1)
    rows, places = rows[regular], places[regular]
    distances, nearest = _nearest_in_space(rows, cover, distance)
    samples = cover.points[nearest]
    tangent = np.abs(np.einsum("ij,ij->i", rows[:, :3] - samples[:, :3], samples[:, 3:]))
    chords = np.linalg.norm(rows[:, 3:6] - samples[:, 3:], axis=1)
    return Errors(
        float(tangent.max(initial=0.0)),
        float(chords.max(initial=0.0)),
        _in_normal(rows, cover, angle),
        _widest_gap(cover, places, distances, distance),
    )


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


def _in_normal(rows: Array, cover: Cover, angle: float) -> float:
    """Return the largest chord between normals of rows and those of samples of the same sign."""
    flat = FLAT * np.abs(rows[:, 7]).max(initial=0.0)
    at_places = _in_normal_space(rows[:, 3:6], rows[:, 7] < -flat)
    of_samples = _in_normal_space(cover.points[:, 3:], cover.curvatures < -flat)
    return float(_nearest(at_places, of_samples[:, :6], angle)[0].max(initial=0.0))


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
