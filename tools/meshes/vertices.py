"""The vertices of a mesh: samples, and points added on open sides of the domain and at poles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...generated.mesh import border_spacing
from ...runtime.base.formula_calls import python_function
from ...runtime.base.trees import tree_of
from ...runtime.domain.domain import Boundary, BoundaryPair
from ...runtime.samples.fields import GRID_NAMES, missing_fields
from ...runtime.spline.spline import Spline

if TYPE_CHECKING:
    from scipy.spatial import KDTree

    from ...runtime.samples.samples import Samples

__all__ = [
    "CLOSE",
    "Vertices",
    "before_offset",
    "boundary_of",
    "check_fields",
    "points_at",
    "spacings_at",
]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# The spacing of points on a side follows from the distance of the k-th nearest sample, with this k.
NEAREST = 4
# A side is measured in at least this number of steps per cell, and per sample along it.
STEPS_A_CELL, STEPS_A_SAMPLE = 16, 4
# A sample closer to a side than this part of the spacing there gets a point of the side opposite to
# it: no triangle of a sample and two points of the side must be flat. At a pole, a sample that
# close stands for the pole.
CLOSE = 0.25
# Such samples are searched in this part of the domain.
DEEPEST = 0.125
# A sample closer to a side than this part of the domain lies on it.
ON_BORDER = 1e-9
# Of samples that are closer than this part of their mean distance in the domain, only the first one
# is a vertex: triangulations displace points by a tenth of it.
NEARLY_EQUAL = 1e-5
NEEDED = ("points", "normals", "uv")


@dataclass(frozen=True, eq=False)
class Vertices:
    """Vertices of a mesh, by positions (k, 2) in the unit square, the domain scaled to it.

    `sample` (k,) are the numbers of their samples, or −1; `is_free` (k,) says which of them lie
    neither on an open side nor at a pole.
    """

    positions: Array
    sample: Indices
    is_free: NDArray[np.bool_]

    @classmethod
    def of(cls, samples: Samples, spline: Spline, boundary: Boundary) -> Vertices:
        """Take the samples, the first one of those at one place; add open sides and poles."""
        positions = np.clip(spline.in_cells(samples.uv.astype(np.float64)) / spline.cells, 0.0, 1.0)
        pairs = _unique(positions, boundary).view(np.complex128)[:, 0]
        sample = np.sort(np.unique(pairs, return_index=True)[1])
        inner = cls(positions[sample], sample, np.ones(len(sample), dtype=bool))
        if all(end in ("periodic", "mirrored") for end, _ in boundary):
            return inner.apart(boundary)
        points = before_offset(samples) * spline.scale
        tree = tree_of(points[sample])
        fixed = [
            *_poles(inner, tree, spline, boundary),
            *_sides(inner, points, tree, spline, boundary),
        ]
        for part in fixed:
            inner = inner.without(part.sample)
        return cls.joined([inner, *fixed]).apart(boundary)

    @classmethod
    def fixed(cls, positions: Array, sample: Indices) -> Vertices:
        """Return vertices on open sides or at poles."""
        return cls(positions, sample, np.zeros(len(positions), dtype=bool))

    @classmethod
    def joined(cls, parts: list[Vertices]) -> Vertices:
        """Return the vertices of all parts."""
        names = ("positions", "sample", "is_free")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    def without(self, sample: Indices) -> Vertices:
        """Return these vertices without some samples."""
        kept = ~np.isin(self.sample, sample)
        return Vertices(self.positions[kept], self.sample[kept], self.is_free[kept])

    def apart(self, boundary: Boundary) -> Vertices:
        """Return these vertices without the free ones that nearly coincide with others."""
        periods = np.array([float(kinds[0] == "periodic") for kinds in boundary])
        places = _unique(self.positions, boundary)
        places = np.where(periods, places % 1.0, places)
        distance = NEARLY_EQUAL / math.sqrt(len(places))
        pairs = tree_of(places, periods).query_pairs(distance, output_type="ndarray")
        pairs = np.sort(pairs, axis=1)
        later = np.where(self.is_free[pairs[:, 1]], pairs[:, 1], pairs[:, 0])
        kept = np.ones(len(self.positions), dtype=bool)
        kept[later[self.is_free[later]]] = False
        return Vertices(self.positions[kept], self.sample[kept], self.is_free[kept])

    def is_node(self, samples: Samples) -> NDArray[np.bool_]:
        """Say which vertices (k,) are samples on a graded grid, whole or not."""
        if samples.row is None:
            return np.zeros(len(self.sample), dtype=bool)
        return (self.sample >= 0) & (samples.row[self.sample] >= 0)

    def uv(self, spline: Spline) -> Array:
        """Return the parameters (k, 2) of the vertices."""
        low, high = np.array(spline.domain).T
        return np.where(self.positions == 1.0, high, low + self.positions * (high - low))


def check_fields(samples: Samples) -> None:
    """Raise MissingFieldError unless samples have the fields that a mesh needs.

    Those on a graded grid need its lines: its cells may be long, and samples that are close to
    others in one direction are not superfluous.
    """
    needed = NEEDED + (GRID_NAMES if samples.report.density == "aligned" else ())
    if lacking := [name for name in needed if name not in samples.fields]:
        raise missing_fields(samples.fields, lacking, "a mesh")


def before_offset(samples: Samples) -> Array:
    """Return the points (N, 3) of samples in float64; for those of an offset, of the surface."""
    points = samples.points.astype(np.float64)
    if samples.offset_of is None:
        return points
    return points - samples.offset_of.distance * samples.normals.astype(np.float64)


def boundary_of(spline: Spline, apexes: bool = False) -> Boundary:
    """Return the boundary conditions of a spline; an end that is a single point is a pole.

    That is the end of a surface that closes around it, and with `apexes` any other one.
    """
    size = float(np.ptp(spline.coefficients, axis=(0, 1)).max()) * spline.scale
    found: list[BoundaryPair] = []
    for axis, ends in enumerate(spline.boundary):
        kinds = list(ends)
        for place, end in enumerate(ends):
            if end == "open" and (apexes or spline.boundary[1 - axis][0] == "periodic"):
                t = np.linspace(0.0, 1.0, spline.cells[1 - axis] + 1)
                side = points_at(spline, _on_side(axis, place, t))
                kinds[place] = "pole" if np.ptp(side, axis=0).max() <= ON_BORDER * size else end
        found.append((kinds[0], kinds[1]))
    return found[0], found[1]


def _unique(positions: Array, boundary: Boundary) -> Array:
    """Return positions that are equal where points of the surface are: on seams and at poles."""
    unique = np.ascontiguousarray(positions).copy()
    for axis in (0, 1):
        for place, end in enumerate(boundary[axis]):
            if end == "pole":
                unique[np.abs(unique[:, axis] - place) <= ON_BORDER] = float(place)
        on_seam = unique[:, axis] == 1.0
        if boundary[axis][0] in ("periodic", "mirrored"):
            unique[on_seam, axis] = 0.0
            if boundary[axis][0] == "mirrored":
                unique[on_seam, 1 - axis] = 1.0 - unique[on_seam, 1 - axis]
    return unique


def _on_side(axis: int, place: int, t: Array) -> Array:
    """Return positions (k, 2) with u (axis 0) or v (axis 1) at an end and the other at t (k,)."""
    fixed = np.full_like(t, float(place))
    return np.stack([fixed, t] if axis == 0 else [t, fixed], axis=1)


def points_at(spline: Spline, positions: Array) -> Array:
    """Return the points (k, 3) of a spline at positions, times its scale."""
    vertices = Vertices.fixed(positions, np.empty(0, dtype=np.int64))
    return spline.evaluate(*vertices.uv(spline).T) * spline.scale


def _poles(inner: Vertices, tree: KDTree, spline: Spline, boundary: Boundary) -> Iterator[Vertices]:
    """Yield the poles: a sample that is there, or a new vertex if no sample is close."""
    for axis, kinds in enumerate(boundary):
        for place, end in enumerate(kinds):
            if end == "pole":
                there = np.abs(inner.positions[:, axis] - place) <= ON_BORDER
                at = _on_side(axis, place, np.zeros(1))
                point = points_at(spline, at)
                if there.any():
                    yield Vertices.fixed(at, inner.sample[there])
                elif tree.query(point)[0][0] >= CLOSE * spacings_at(tree, point)[0]:
                    yield Vertices.fixed(at, np.array([-1]))


def spacings_at(tree: KDTree, points: Array) -> Array:
    """Return spacings (k,) of vertices at points (k, 3), from the distances of samples there."""
    nearest = min(NEAREST, tree.n)
    distances = tree.query(points, k=nearest, workers=-1)[0].reshape(len(points), -1)[:, -1]
    return distances * python_function(border_spacing)(1.0, nearest)


# --- open sides -----------------------------------------------------------------------------------


def _sides(
    inner: Vertices, points: Array, tree: KDTree, spline: Spline, boundary: Boundary
) -> Iterator[Vertices]:
    """Yield the vertices of each open side: samples on it, and added points between them.

    A corner of the domain belongs to the side that begins there, counterclockwise.
    """
    for axis in (0, 1):
        for place, end in enumerate(boundary[axis]):
            if end == "open":
                yield _Side(spline, axis, place, tree).vertices(inner, points)


class _Side:
    """An open side of the domain, where u (axis 0) or v (axis 1) is at its low or high end."""

    def __init__(self, spline: Spline, axis: int, place: int, tree: KDTree) -> None:
        """Measure the side by its length relative to the spacing of its points."""
        self.spline, self.axis, self.place = spline, axis, place
        self.closes = spline.boundary[1 - axis][0] != "open"
        steps = STEPS_A_CELL * spline.cells[1 - axis]
        steps = max(steps, STEPS_A_SAMPLE * math.isqrt(tree.n))
        self.t = np.linspace(0.0, 1.0, steps + 1)
        line = points_at(spline, _on_side(axis, place, self.t))
        self.spacings = spacings_at(tree, line)
        lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
        shortest = float(lengths.sum()) / steps or 1.0
        middle = np.maximum((self.spacings[1:] + self.spacings[:-1]) / 2.0, shortest)
        self.measure = np.concatenate([[0.0], np.cumsum(lengths / middle)])

    def vertices(self, inner: Vertices, points: Array) -> Vertices:
        """Return the vertices of the side: the samples on it, and added points between them."""
        total = float(self.measure[-1])
        count = max(round(total), 3 if self.closes else 1) if total > 0.0 else 1
        t = np.interp(total * (np.arange(count + 1) / count), self.measure, self.t)
        t[[0, -1]] = 0.0, 1.0
        is_added = self._owned(t)
        is_added[-1] &= not self.closes
        near, along, is_on = self._near(inner, points)
        slots = np.rint(np.interp(along, self.t, self.measure) / (total or 1.0) * count)
        slots = slots.astype(np.int64) % (count if self.closes else count + 1)
        is_inside = self.closes | ((slots > 0) & (slots < count))
        t[slots[is_inside]] = along[is_inside]  # of two, the last one stays
        is_added[slots[is_on & (is_inside | (along == t[slots]))]] = False
        is_on &= self._owned(along)
        added = Vertices.fixed(
            _on_side(self.axis, self.place, t[is_added]), np.full(int(is_added.sum()), -1)
        )
        own = Vertices.fixed(
            _on_side(self.axis, self.place, along[is_on]), inner.sample[near[is_on]]
        )
        return Vertices.joined([added, own])

    def _owned(self, t: Array) -> NDArray[np.bool_]:
        """Say which parameters t belong to this side: one of its ends belongs to the next one."""
        if self.closes:
            return np.ones(len(t), dtype=bool)
        return t < 1.0 if self.axis + self.place == 1 else t > 0.0

    def _near(self, inner: Vertices, points: Array) -> tuple[Indices, Array, NDArray[np.bool_]]:
        """Return the samples close to the side, their parameters t, and which lie on it.

        The closest one comes last. For a sample at a corner, t is exactly 0 or 1.
        """
        depth = np.abs(inner.positions[:, self.axis] - self.place)
        near = np.flatnonzero(depth < DEEPEST)
        along = inner.positions[near, 1 - self.axis]
        feet = points_at(self.spline, _on_side(self.axis, self.place, along))
        gaps = np.linalg.norm(points[inner.sample[near]] - feet, axis=1)
        is_on = depth[near] <= ON_BORDER
        chosen = is_on | (gaps < CLOSE * np.interp(along, self.t, self.spacings))
        order = np.flatnonzero(chosen)[np.argsort(-depth[near[chosen]], kind="stable")]
        ends = np.rint(along)
        along = np.where(np.abs(along - ends) <= ON_BORDER, ends, along)
        return near[order], along[order], is_on[order]
