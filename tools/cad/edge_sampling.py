"""Samples on the sharp edges of a part, spaced like its other samples nearby."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.repeats import repeated
from ...runtime.base.trees import tree_of
from ...runtime.samples.fields import EDGE_NAMES, INTEGER_NAMES, dtype_of, row_shape
from ..density.filling import spacing
from ..density.space import Space
from .edges import Edges, Sides, edges_of, exact_places, sides_at
from .results import PartSpace

# The sizing function along an edge is measured in at least this many steps.
PLACES = 32
# The least number of steps between two ends. With 2 steps, an edge has a sample of its own even if
# other edges provide the samples at both of its corners.
FEWEST = 2
# Ends of edges within this distance, relative to the size of the part, count as one corner.
SAME_CORNER = 1e-5
# A remainder shorter than this fraction of a step adds no further step.
SLACK = 1e-6


def with_edges(
    space: PartSpace,
    count: int,
    arrays: Mapping[str, NDArray[Any]],
    fields: Sequence[str],
    dtype: DTypeLike,
) -> dict[str, NDArray[Any]]:
    """Append the samples on sharp edges of a part to its `count` other samples; return all fields.

    Samples on edges come in the order of the edges. Each corner, where edges end, has one sample.
    """
    found = {x: y.astype(dtype_of(x, dtype)) for x, y in _on_edges(space, count).items()}
    others = {
        name: np.full((count, *row_shape(name)), -1 if name in INTEGER_NAMES else np.nan)
        for name in EDGE_NAMES
    }
    both = {**others, **arrays}
    return {
        name: np.concatenate([both[name].astype(found[name].dtype, copy=False), found[name]])
        for name in fields
    }


def _on_edges(space: PartSpace, count: int) -> dict[str, NDArray[Any]]:
    """Return all fields of the samples on edges of a part that has `count` other samples.

    If the part has a reach, both normals of each sample are in it.
    """
    edges = edges_of(space)
    owner, places, ends = _spaced(edges, step_of(space, count), max(count, 1))
    sides, rows = exact_places(edges, owner, places)
    size = space.size / space.unit
    solids = np.array([x.face.solid_index for x in space.pieces])[sides.pieces[:, 0]]
    kept = _one_a_corner(sides, solids, ends[rows], SAME_CORNER * size)
    reach = space.pieces[0].reach
    if reach is not None:
        points = sides.points[kept, 0]
        both = [reach._holds(points, sides.normals[kept, side]) for side in (0, 1)]
        kept = kept[both[0] & both[1]]
    return _arrays(space, sides[kept])


def step_of(space: Space, count: int) -> float:
    """Return the distance between neighbouring samples where the target density is 1.

    The space has `count` samples in all.
    """
    integral = space.integral
    if not (count and integral > 0.0):
        return math.inf
    return math.sqrt(3.0) * spacing(count / integral)


def _spaced(edges: Edges, step: float, most: int) -> tuple[Indices, Array, Flags]:
    """Return edge indices (M,) and positions (M,) of samples, and a mask (M,) of the end points.

    End points are the ends of edges, and positions between which an edge is sharp. An edge has at
    most `most` steps between two end points.
    """
    owner, places = _many_places(edges)
    sides = sides_at(edges.space, edges.pieces[owner], edges.at(owner, places))
    sharp = np.flatnonzero(sides.sharp)
    owner, places, costs = owner[sharp], places[sharp], _costs(edges.space, sides[sharp]) / step
    apart = np.flatnonzero((np.diff(owner) != 0) | (np.diff(sharp) != 1)) + 1
    found, lengths = [np.empty(0)], []
    for rows in np.split(np.arange(len(sharp)), apart) if len(sharp) else ():
        found.append(_divided(places[rows], costs[rows[:-1]], most))
        lengths.append(len(found[-1]))
    runs = np.repeat(np.arange(len(lengths)), lengths)
    firsts = np.concatenate([[0], apart])[: len(lengths)]
    ends = np.diff(runs, prepend=-1, append=len(lengths)) != 0
    return owner[firsts][runs], np.concatenate(found), ends[:-1] | ends[1:]


def _many_places(edges: Edges) -> tuple[Indices, Array]:
    """Return edge indices (M,) and positions (M,) that cut edges into at least `PLACES` steps."""
    steps = np.diff(edges.starts) - 1
    parts = -(-PLACES // np.maximum(steps, 1))
    counts = steps * parts + 1
    owner, number = repeated(counts)
    return owner, number / parts[owner]


def _costs(space: PartSpace, sides: Sides) -> Array:
    """Return the distances (M − 1,) of neighbouring positions, divided by the sizing function.

    If the target density depends on the curvature, the distance of two positions counts as at least
    the change of the unit normal between them, on each of the two faces.
    """
    target = space.target
    lengths = np.linalg.norm(np.diff(sides.points[:, 0], axis=0), axis=1) * space.unit
    costs = math.sqrt(space.target.floor) * lengths
    if target.curvature_weight > 0.0:
        turns = np.linalg.norm(np.diff(sides.normals, axis=0), axis=2).max(axis=1)
        costs = np.maximum(costs, turns)
    if target.gauss_weight > 0.0:
        K = np.abs(sides.curvatures[:, :, 0]).max(axis=1) / space.unit**2
        with np.errstate(divide="ignore"):
            K = np.minimum(np.maximum(K[:-1], K[1:]), 1.0 / lengths**2)
        costs = np.maximum(costs, lengths * K ** (target.exponent / 2.0))
    return costs


def _divided(places: Array, costs: Array, most: int) -> Array:
    """Return positions from the first to the last of `places`, with the same cost for each step.

    `costs` belong to the steps between `places`. The new steps cost at most 1 each, unless this
    takes more than `most` steps. There are at least FEWEST steps.
    """
    if not len(costs):
        return places
    if not costs.any():
        costs = np.full(len(costs), SLACK / len(costs))
    total = np.concatenate([[0.0], np.cumsum(costs)])
    parts = max(math.ceil(min(total[-1], most) - SLACK), FEWEST)
    found = np.interp(total[-1] * np.arange(parts + 1) / parts, total, places)
    found[[0, -1]] = places[[0, -1]]
    return found


def _one_a_corner(sides: Sides, solids: Indices, ends: Flags, tolerance: float) -> Indices:
    """Return the indices of the samples to keep.

    Of the samples at a corner, only the one with the largest angle between its normals is kept.
    Coincident corners of different solids count as different corners.
    """
    rows = np.flatnonzero(ends)
    dropped = np.zeros(len(sides), dtype=np.bool_)
    if len(rows):
        points = np.empty((len(rows), 4))
        points[:, :3], points[:, 3] = sides.points[rows, 0], 2.0 * tolerance * solids[rows]
        near = tree_of(points).query_ball_point(points, tolerance)
        for k in np.argsort(-sides.chords[rows].round(9), kind="stable").tolist():
            if not dropped[rows[k]]:
                dropped[rows[near[k]]] = True
                dropped[rows[k]] = False
    return np.flatnonzero(~dropped)


def _arrays(space: PartSpace, sides: Sides) -> dict[str, NDArray[Any]]:
    """Return all fields of samples on edges, by name."""
    count, points, normals = len(sides), sides.points[:, 0], sides.normals[:, 0]
    faces = np.array([x.face.index for x in space.pieces])[sides.pieces]
    solids = np.array([x.face.solid_index for x in space.pieces])[sides.pieces[:, 0]]
    return {
        "points": points,
        "normals": normals,
        "uv": sides.uv[:, :2],
        "support": np.einsum("ij,ij->i", points, normals),
        "gaussian_curvature": sides.curvatures[:, 0, 0],
        "mean_curvature": sides.curvatures[:, 0, 1],
        "normal_index": np.full(count, -1),
        "on_surface": np.ones(count, dtype=np.bool_),
        "face_index": faces[:, 0],
        "solid_index": solids,
        "other_normals": sides.normals[:, 1],
        "other_uv": sides.uv[:, 2:],
        "other_face_index": faces[:, 1],
    }
