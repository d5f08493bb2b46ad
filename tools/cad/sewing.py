"""Sewing: boundaries of surfaces become shared edges where they coincide, wholly or partly.

Boundaries are split at their corners, and where corners of other boundaries lie on them. Two pieces
of boundaries between the same two vertices become one edge if their distance is nowhere larger than
a tolerance.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.errors import SurfaceError
from ...runtime.base.trees import tree_of
from ...runtime.surface.surface import Surface
from .records import EdgeRecord, Wire

# A boundary has a corner where it turns by more than this, in degrees.
CORNER = 30.0
# The points of a side are tabulated at the ends of STEPS steps. Newton's method for the nearest
# point of a side starts at the nearest tabulated points, and takes at most ROUNDS iterations.
STEPS, ROUNDS = 64, 8
# Edges nearly coincide if their distance is below this, relative to their length.
NEARLY = 0.01
# The parameters of an edge are tabulated at STEPS_OF_EDGE steps. The number is doubled, at most to
# MOST_STEPS, until cubic interpolation has at most the error EXACT, relative to the length.
STEPS_OF_EDGE, MOST_STEPS, EXACT = 32, 512, 1e-6


@dataclass(frozen=True, eq=False)
class Border:
    """A closed polygon (k, 2) in the domain of the surface of a face, with the face on its left.

    The first point is not repeated. If `is_rectangle`, all points are corners; otherwise, corners
    are the points where the polygon turns by more than `CORNER` on the surface.
    """

    face: int
    surface: Surface
    polygon: Array
    is_rectangle: bool

    @property
    def sides(self) -> list[Side]:
        """The sides between corners, in order; a boundary without corners is one side."""
        corners = np.flatnonzero(self._is_corner)
        first = int(corners[0]) if len(corners) else 0
        places = np.roll(self.polygon, -first, axis=0)
        places = np.concatenate([places, places[:1]])
        ends = [*(corners - first), len(self.polygon)] if len(corners) else [0, len(self.polygon)]
        return [
            Side(self.face, self.surface, places[a : b + 1]) for a, b in itertools.pairwise(ends)
        ]

    @property
    def _is_corner(self) -> Flags:
        if self.is_rectangle:
            return np.ones(len(self.polygon), dtype=np.bool_)
        steps = np.roll(self.polygon, -1, axis=0) - self.polygon
        tangents = self.surface.jets(*self.polygon.T.copy())[:, 1:3]
        after, before = (
            np.einsum("ka,kax->kx", x, tangents) for x in (steps, np.roll(steps, 1, 0))
        )
        lengths = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
        return np.einsum("kx,kx->k", before, after) <= np.cos(np.radians(CORNER)) * lengths


@dataclass(frozen=True, eq=False)
class Side:
    """A part of a boundary between corners: a polyline `uv` (k, 2) with a parameter t in [0, 1]."""

    face: int
    surface: Surface
    uv: Array

    @cached_property
    def t(self) -> Array:
        """The values (k,) of t at the points: arc lengths in the scaled domain, over the total."""
        low, high = np.array(self.surface.domain).T
        lengths = np.hypot(*(np.diff(self.uv, axis=0) / (high - low)).T)
        found = np.concatenate([[0.0], np.cumsum(lengths) / lengths.sum()])
        found[-1] = 1.0
        return found

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return parameters (M, 2) at t (M,), and their derivatives by t."""
        k = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        slopes = np.diff(self.uv, axis=0)[k] / np.diff(self.t)[k, None]
        uv = self.uv[k] + (t - self.t[k])[:, None] * slopes
        uv[t == self.t[k + 1]] = self.uv[k + 1][t == self.t[k + 1]]
        return uv, slopes

    def points(self, t: Array) -> tuple[Array, Array]:
        """Return points (M, 3) at t (M,), and their derivatives by t."""
        uv, slopes = self.at(t)
        jets = self.surface.jets(*uv.T.copy())
        return jets[:, 0], np.einsum("ka,kax->kx", slopes, jets[:, 1:3])

    @cached_property
    def known(self) -> Array:
        """The points (STEPS + 1, 3) at equal steps of t."""
        found = self.points(np.linspace(0.0, 1.0, STEPS + 1))[0]
        if not np.isfinite(found).all():
            raise SurfaceError(f"{self.surface.name} is not finite along its border.")
        return found

    def nearest(self, points: Array, low: float = 0.0, high: float = 1.0) -> tuple[Array, Array]:
        """Return the values (M,) of t in [low, high] nearest to points, and the distances."""
        even = np.linspace(0.0, 1.0, STEPS + 1)
        inside = (even >= low) & (even <= high)
        starts = np.concatenate([even[inside], [low, high]])
        places = np.concatenate([self.known[inside], self.points(np.array([low, high]))[0]])
        squares = ((points[:, None] - places) ** 2).sum(axis=2)
        # Newton's method has two starts: if both ends of the side are the same point, it would
        # search in one direction only from a single start there.
        t = starts[np.argsort(squares, axis=1)[:, :2]].T.ravel()
        points = np.concatenate([points, points])
        best, least = t, np.full(len(points), np.inf)
        for _ in range(ROUNDS):
            places, along = self.points(t)
            apart = points - places
            lengths = np.linalg.norm(apart, axis=1)
            better = lengths < least
            if not better.any():
                break
            best, least = np.where(better, t, best), np.minimum(lengths, least)
            with np.errstate(divide="ignore", invalid="ignore"):
                steps = np.einsum("kx,kx->k", apart, along) / np.einsum("kx,kx->k", along, along)
            t = np.clip(t + np.where(np.isfinite(steps), steps, 0.0), low, high)
        best, least = best.reshape(2, -1), least.reshape(2, -1)
        first = least[0] <= least[1]
        return np.where(first, *best), np.where(first, *least)


@dataclass(frozen=True, eq=False)
class Span:
    """The part of a side from t = `low` to t = `high`, between two vertices, given by index.

    If `is_point`, the span is collapsed to a point.
    """

    side: Side
    low: float
    high: float
    first: int
    last: int
    is_point: bool = False

    def t(self, steps: int) -> Array:
        """Return the values (steps + 1,) of t at the ends of equal steps."""
        return np.linspace(self.low, self.high, steps + 1)

    def inner(self, steps: int) -> Array:
        """Return the points (steps − 1, 3) at the inner ends of equal steps."""
        return self.side.points(self.t(steps)[1:-1])[0]

    def same(self, other: Span, tolerance: float) -> bool | None:
        """Return whether `other` runs in the opposite direction; None if the spans differ."""
        t, apart = self.side.nearest(other.inner(STEPS_OF_EDGE), self.low, self.high)
        if apart.max() > tolerance:
            return None
        back = other.side.nearest(self.inner(STEPS_OF_EDGE), other.low, other.high)[1]
        return None if back.max() > tolerance else bool(t[0] > t[-1])

    def along(self, leader: Span, steps: int, backwards: bool) -> Array:
        """Return the values (steps + 1,) of t of the points nearest to those of another span.

        The other span is `leader`, with points at the ends of equal steps. Both spans coincide.
        """
        if self is leader:
            return self.t(steps)
        t = self.side.nearest(leader.inner(steps), self.low, self.high)[0]
        ends = [self.high, self.low] if backwards else [self.low, self.high]
        t = np.concatenate([ends[:1], t, ends[1:]])
        # Where neighbouring points nearly coincide, values of t may be out of order.
        return np.minimum.accumulate(t) if backwards else np.maximum.accumulate(t)


@dataclass(frozen=True, eq=False)
class Sewn:
    """Edges between vertices (V, 3), and the wire along each boundary; see `EdgeRecord` and `Wire`.

    `apart` is the largest distance between two edges that have one face each and nearly coincide
    (see `NEARLY`); None if there are no such edges.
    """

    vertices: Array
    edges: list[EdgeRecord]
    wires: list[Wire]
    apart: float | None


def sewn(borders: Sequence[Border], tolerance: float) -> Sewn:
    """Return the edges of boundaries, shared where they coincide within a tolerance.

    Raises SurfaceError if a boundary has no side that is larger than the tolerance.
    """
    vertices, spans = _spans([x.sides for x in borders], tolerance)
    for border, own in zip(borders, spans, strict=True):
        if all(x.is_point for x in own):
            raise SurfaceError(
                f"the border of {border.surface.name} is no larger than the tolerance, "
                f"{tolerance:g}."
            )
    lines = _lines([x for own in spans for x in own], tolerance)
    places = {
        span: (edge, side, backwards)
        for edge, line in enumerate(lines)
        for side, (span, backwards) in enumerate(line.items())
    }
    single = [x for line in lines if len(line) == 1 for x in line if not x.is_point]
    return Sewn(
        vertices,
        [_exact_edge(x) for x in lines],
        [[places[x] for x in own] for own in spans],
        _apart(single),
    )


def _spans(sides: Sequence[Sequence[Side]], tolerance: float) -> tuple[Array, list[list[Span]]]:
    """Return the vertices (V, 3), and the spans between them along each boundary, in order."""
    ends = np.concatenate([x.known[[0, -1]] for border in sides for x in border])
    vertices, numbers = _vertices(ends, tolerance)
    own = iter(numbers.reshape(-1, 2))
    found = [
        [span for side in border for span in _cut(side, next(own), ends, numbers, tolerance)]
        for border in sides
    ]
    return vertices, found


def _vertices(ends: Array, tolerance: float) -> tuple[Array, Indices]:
    """Return merged vertices (V, 3) for all ends (k, 3), and the vertex index of each end."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = tree_of(ends).query_pairs(tolerance, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), pairs.T), (len(ends), len(ends)))
    numbers = connected_components(links, directed=False)[1].astype(np.int64)
    firsts = np.unique(numbers, return_index=True)[1]
    return ends[firsts], numbers


def _cut(
    side: Side, own: Indices, corners: Array, numbers: Indices, tolerance: float
) -> list[Span]:
    """Return the spans of a side, split at the corners (k, 3) that lie on it."""
    first, last = own.tolist()
    if np.linalg.norm(side.known - side.known[0], axis=1).max() <= tolerance:
        return [Span(side, 0.0, 1.0, first, last, is_point=True)]
    slack = tolerance + np.linalg.norm(np.diff(side.known, axis=0), axis=1).max()
    low, high = side.known.min(axis=0) - slack, side.known.max(axis=0) + slack
    near = np.flatnonzero(
        ((corners >= low) & (corners <= high)).all(axis=1) & ~np.isin(numbers, own)
    )
    cuts = dict[int, tuple[float, float]]()
    if len(near):
        t, apart = side.nearest(corners[near])
        ends = np.linalg.norm(side.points(t)[0][:, None] - side.known[[0, -1]], axis=2).min(axis=1)
        for k in np.flatnonzero((apart <= tolerance) & (ends > tolerance)).tolist():
            number = int(numbers[near[k]])
            cuts[number] = min(cuts.get(number, (np.inf, 0.0)), (float(apart[k]), float(t[k])))
    between = sorted((t, number) for number, (_, t) in cuts.items())
    stops = [(0.0, first), *between, (1.0, last)]
    return [Span(side, a, b, i, j) for (a, i), (b, j) in itertools.pairwise(stops)]


def _lines(spans: Sequence[Span], tolerance: float) -> list[dict[Span, bool]]:
    """Return groups of coincident spans, with True for a span that runs against the first one."""
    lines, between = list[dict[Span, bool]](), defaultdict[Any, list[dict[Span, bool]]](list)
    for span in spans:
        # Spans that are collapsed to points share only vertices.
        known = [] if span.is_point else between[frozenset((span.first, span.last))]
        for line in known:
            backwards = span.same(next(iter(line)), tolerance)
            if backwards is not None:
                line[span] = backwards
                break
        else:
            lines.append({span: False})
            known.append(lines[-1])
    return lines


def _apart(spans: Sequence[Span]) -> float | None:
    """Return the largest distance between spans that nearly coincide; None if there are none."""
    if len(spans) < 2:
        return None
    points = np.stack([x.inner(STEPS_OF_EDGE) for x in spans])
    lengths = np.linalg.norm(np.diff(points, axis=1), axis=2).sum(axis=1)
    middles = points[:, points.shape[1] // 2]
    found = list[float]()
    for k, own in enumerate(points):
        squares = ((points - middles[k]) ** 2).sum(axis=2).min(axis=1)
        squares[k] = np.inf
        other = spans[int(squares.argmin())]
        apart = float(other.side.nearest(own, other.low, other.high)[1].max())
        found += [apart] if apart <= NEARLY * lengths[k] else []
    return max(found, default=None)


def _exact_edge(spans: dict[Span, bool]) -> EdgeRecord:
    """Return the edge along coincident spans, with as many steps as accuracy needs."""
    steps = STEPS_OF_EDGE
    while True:
        edge, error = _edge(spans, steps)
        if error <= EXACT or steps == MOST_STEPS or edge.degenerate:
            return edge
        steps *= 2


def _edge(spans: dict[Span, bool], steps: int) -> tuple[EdgeRecord, float]:
    """Return the edge along coincident spans, and its error of cubic interpolation.

    The error is measured midway in steps, relative to the length of the edge; the distance between
    the spans at the ends of steps is subtracted.
    """
    leader, parameters, slopes, errors = next(iter(spans)), [], [], []
    points, along = leader.side.points(leader.t(steps))
    middles = leader.side.points((leader.t(steps)[1:] + leader.t(steps)[:-1]) / 2.0)[0]
    for span, backwards in spans.items():
        t = span.along(leader, steps, backwards)
        uv, by_t = span.side.at(t)
        there, own = span.side.points(t)
        rates = np.gradient(t) * steps
        with np.errstate(divide="ignore", invalid="ignore"):  # where the derivative by t is 0
            exact = np.einsum("kx,kx->k", along, own) / np.einsum("kx,kx->k", own, own)
        rates = np.where(np.isfinite(exact), exact * (leader.high - leader.low), rates)
        by_edge = rates[:, None] * by_t
        parameters.append(uv)
        slopes.append(by_edge)
        between = (uv[1:] + uv[:-1]) / 2.0 - np.diff(by_edge, axis=0) / (8.0 * steps)
        cubic = span.side.surface.jets(*between.T.copy())[:, 0]
        apart = np.linalg.norm(there - points, axis=1).max()
        errors.append(np.linalg.norm(cubic - middles, axis=1).max() - apart)
    edge = EdgeRecord(
        tuple(x.side.face for x in spans),
        np.concatenate(parameters, axis=1),
        np.concatenate(slopes, axis=1),
        (leader.first, leader.last),
        leader.is_point,
    )
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    return edge, float(max(errors)) / (float(length) or 1.0)
