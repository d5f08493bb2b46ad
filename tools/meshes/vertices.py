"""The vertices of a mesh: samples, and points added on boundaries and at poles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.trees import tree_of
from ...runtime.domain.domain import Boundary, closes
from ...runtime.samples.fields import GRID_NAMES, missing_fields
from ...runtime.spline.spline import Spline
from ...runtime.spline.tips import collapsed_sides
from .measured_line import CLOSE, MeasuredLine
from .places import ON_SIDE, on_side, points_at, spacings_at, wrapped

if TYPE_CHECKING:
    from scipy.spatial import KDTree

    from ...runtime.samples.samples import Samples

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# The least number of steps per cell in which an open side is measured.
STEPS_A_CELL = 16
# A sample closer to an open side than this, relative to the spacing, counts as a sample on the
# side.
ON_LINE = 1e-6
# Of samples closer to each other than this, relative to their mean distance in the domain, only the
# first one is a vertex: triangulations first displace points by a tenth of this distance.
NEARLY_EQUAL = 1e-5
NEEDED = ("points", "normals", "uv")


@dataclass(frozen=True, eq=False)
class Vertices:
    """Vertices of a mesh, by positions (k, 2) in the unit square, the scaled domain.

    `sample` (k,) are the indices of their samples, or −1; `is_free` (k,) marks vertices that lie
    neither on an open side nor at a pole nor, after trimming, on the boundary of the trim.
    """

    positions: Array
    sample: Indices
    is_free: NDArray[np.bool_]

    @classmethod
    def of(cls, samples: Samples, spline: Spline, boundary: Boundary) -> Vertices:
        """Return the samples, one for each position, with vertices on open sides and at poles.

        Tips, and other samples that are not regular, are left out.
        """
        positions = np.clip(spline.in_cells(samples.uv.astype(np.float64)) / spline.cells, 0.0, 1.0)
        for axis, place in collapsed_sides(spline):
            positions[np.abs(positions[:, axis] - place) <= ON_SIDE, 1 - axis] = 0.0
        pairs = _unique(positions, boundary).view(np.complex128)[:, 0]
        sample = np.flatnonzero(samples._regular)
        sample = sample[np.sort(np.unique(pairs[sample], return_index=True)[1])]
        inner = cls(positions[sample], sample, np.ones(len(sample), dtype=bool))
        if all(closes(ends) for ends in boundary):
            return inner.apart(boundary)
        tree = tree_of(before_offset(samples)[sample] * spline.scale)
        fixed = [*_poles(inner, tree, spline, boundary), *_sides(inner, tree, spline, boundary)]
        for part in fixed:
            inner = inner.chosen(~np.isin(inner.sample, part.sample))
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

    def chosen(self, kept: NDArray[np.bool_]) -> Vertices:
        """Return a selection of the vertices."""
        return Vertices(self.positions[kept], self.sample[kept], self.is_free[kept])

    def apart(self, boundary: Boundary) -> Vertices:
        """Return the vertices without the later, free one of two that nearly coincide."""
        periods = np.array([float(kinds[0] == "periodic") for kinds in boundary])
        places = _unique(self.positions, boundary)
        places = np.where(periods, places % 1.0, places)
        distance = NEARLY_EQUAL / math.sqrt(len(places))
        pairs = tree_of(places, periods).query_pairs(distance, output_type="ndarray")
        pairs = np.sort(pairs, axis=1)
        later = np.where(self.is_free[pairs[:, 1]], pairs[:, 1], pairs[:, 0])
        kept = np.ones(len(self.positions), dtype=bool)
        kept[later[self.is_free[later]]] = False
        return self.chosen(kept)

    def is_node(self, samples: Samples) -> NDArray[np.bool_]:
        """Return a mask of the vertices (k,) that are samples on a graded grid."""
        if samples.row is None:
            return np.zeros(len(self.sample), dtype=bool)
        return (self.sample >= 0) & (samples.row[self.sample] >= 0)


def check_fields(samples: Samples) -> None:
    """Raise MissingFieldError unless samples have the fields that a mesh needs.

    Samples on a graded grid also need the indices of grid lines: the cells of the grid may be long,
    and samples must not be left out for being close to others in one direction.
    """
    needed = NEEDED + (GRID_NAMES if samples.report.density == "aligned" else ())
    if lacking := [name for name in needed if name not in samples.fields]:
        raise missing_fields(samples.fields, lacking, "a mesh")


def before_offset(samples: Samples) -> Array:
    """Return the points (N, 3) of samples in float64; for an offset, before they were moved."""
    points = samples.points.astype(np.float64)
    if samples.offset_of is None:
        return points
    return points - samples.offset_of.distance * samples.normals.astype(np.float64)


def _unique(positions: Array, boundary: Boundary) -> Array:
    """Return positions, made equal where points of the surface are equal: on seams and at poles."""
    unique = np.ascontiguousarray(positions).copy()
    for axis, place in np.ndindex(2, 2):
        if boundary[axis][place] == "pole":
            unique[np.abs(unique[:, axis] - place) <= ON_SIDE] = float(place)
    return wrapped(unique, boundary)


def _poles(inner: Vertices, tree: KDTree, spline: Spline, boundary: Boundary) -> Iterator[Vertices]:
    """Yield the vertices at poles: a sample at the pole, or a new vertex if no sample is close."""
    for axis, kinds in enumerate(boundary):
        for place, end in enumerate(kinds):
            if end == "pole":
                there = np.abs(inner.positions[:, axis] - place) <= ON_SIDE
                at = on_side(axis, place, np.zeros(1))
                point = points_at(spline, at)
                if there.any():
                    yield Vertices.fixed(at, inner.sample[there])
                elif tree.query(point)[0][0] >= CLOSE * spacings_at(tree, point)[0]:
                    yield Vertices.fixed(at, np.array([-1]))


def _sides(inner: Vertices, tree: KDTree, spline: Spline, boundary: Boundary) -> Iterator[Vertices]:
    """Yield the vertices of each open side: samples on it, and added points between them.

    A corner of the domain belongs to the side that begins there, counterclockwise.
    """
    for axis, place in np.ndindex(2, 2):
        if boundary[axis][place] == "open":
            t = np.linspace(0.0, 1.0, STEPS_A_CELL * spline.cells[1 - axis] + 1)
            if axis == place and boundary[1 - axis][0] == "open":
                t = t[::-1]
            line = MeasuredLine.of(on_side(axis, place, t), spline, tree)
            line.to_samples(
                tree, (inner.positions, inner.sample), spline.boundary, np.ones(2), ON_LINE
            )
            yield Vertices.fixed(line.at_vertices()[:-1], line.sample[:-1])
