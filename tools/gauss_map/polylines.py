"""Polylines of the parameter plane, refined until they follow a curve in space."""

from collections.abc import Callable, Iterable

import numpy as np

from ...runtime.base.aliases import Array, Flags
from ...runtime.base.repeats import repeated

Evaluation = Callable[[Array], Array]
# A segment whose midpoint is h from the curve is cut into √(h / size) parts, as the arc of a
# parabola requires; other curves need a second or third pass.
PASSES = 3
MOST_PARTS = 1000
BISECTIONS = 40


def different(places: Iterable[Array], same: float | Array) -> Array:
    """Return parameter pairs without the pairs that nearly repeat an earlier pair."""
    kept = np.empty((0, 2))
    for place in places:
        if not (np.abs(kept - place) <= same).all(axis=1).any():
            kept = np.concatenate([kept, place[None]])
    return kept


def refined(uv: Array, evaluate: Evaluation, size: float, onto_curve: Evaluation) -> Array:
    """Insert vertices where a polyline (k, 2) departs from its curve by more than `size` in space.

    `evaluate` returns the points (k, 3) of parameters (k, 2), `onto_curve` the parameters of nearby
    points of the curve; a result farther away than the length of a segment is not used.
    """
    for _ in range(PASSES):
        start, along = uv[:-1], np.diff(uv, axis=0)
        longest = np.abs(along).max(axis=1)
        straight = start + 0.5 * along
        middle = onto_curve(straight)
        height = distances(evaluate(middle), evaluate(start), evaluate(uv[1:]))
        near = np.abs(middle - straight).max(axis=1) <= longest
        cut = near & (height > size) & (size > 0.0)
        if not cut.any():
            break
        parts = np.ones(len(start), dtype=np.int64)
        parts[cut] = np.minimum(np.ceil(np.sqrt(height[cut] / size)), MOST_PARTS)
        owner, number = repeated(parts)
        straight = start[owner] + (number / parts[owner])[:, None] * along[owner]
        moved = np.where(number[:, None] > 0, onto_curve(straight), straight)
        near = np.abs(moved - straight).max(axis=1) <= longest[owner]
        uv = np.concatenate([moved[near], uv[-1:]])
    return uv


def dense(line: Array, steps: Array) -> Array:
    """Return a polyline (k, 2) with its segments cut into parts of at most `steps` (2,)."""
    along = np.diff(line, axis=0)
    parts = np.maximum(np.ceil(np.abs(along / steps).max(axis=1, initial=0.0)), 1).astype(np.int64)
    owner, number = repeated(parts)
    points = line[owner] + (number / parts[owner])[:, None] * along[owner]
    return np.concatenate([points, line[-1:]])


def inside(
    uv: Array, contains: Callable[[Array], Flags], onto_curve: Evaluation | None = None
) -> list[Array]:
    """Return the parts of a polyline (k, 2) inside a region, each of two vertices or more.

    Parts end at the boundary of the region, up to rounding. It is assumed that a segment crosses
    the boundary at most once.
    """
    kept = contains(uv)
    at = np.flatnonzero(kept[1:] != kept[:-1])
    first = kept[at][:, None]
    inner, outer = np.where(first, uv[at], uv[at + 1]), np.where(first, uv[at + 1], uv[at])
    for _ in range(BISECTIONS):
        middle = 0.5 * (inner + outer)
        middle = middle if onto_curve is None else onto_curve(middle)
        is_in = contains(middle)
        inner[is_in], outer[~is_in] = middle[is_in], middle[~is_in]
    uv, kept = np.insert(uv, at + 1, inner, axis=0), np.insert(kept, at + 1, True)
    ends = np.flatnonzero(np.diff(kept, prepend=False, append=False)).reshape(-1, 2)
    return [uv[first:last] for first, last in ends.tolist() if last > first + 1]


def distances(points: Array, start: Array, end: Array) -> Array:
    """Return the distances (k,) of points from segments."""
    along = end - start
    square = np.einsum("kx,kx->k", along, along)
    share = np.einsum("kx,kx->k", points - start, along)
    share = np.clip(np.divide(share, square, out=np.zeros_like(share), where=square > 0.0), 0, 1)
    return np.linalg.norm(points - start - share[:, None] * along, axis=1)
