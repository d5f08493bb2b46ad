"""The vertices of a mesh: samples, points added along open borders, and poles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..kernels.spacing import border_spacings
from ..spline import Spline
from ..surface import End, Ends
from ..trees import tree_of

if TYPE_CHECKING:
    from scipy.spatial import KDTree

    from ..samples import Samples

__all__ = ["Vertices", "ends_of"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# The spacing of a border follows from the distance of the sample that is the so many nearest.
NEAREST = 4
# A border is looked at in so many steps a cell at least, and so many for each sample along it.
STEPS_A_CELL, STEPS_A_SAMPLE = 16, 4
# A sample that is nearer to the border than this part of the spacing there has a border point
# beside it: the angle of a triangle between a sample and two border points must not be flat.
BESIDE = 0.25
# Such samples are looked for in this part of the domain.
DEEPEST = 0.125
# A sample that is nearer to the border than this part of the domain lies on it.
ON_BORDER = 1e-9


@dataclass(frozen=True, eq=False)
class Vertices:
    """Vertices of a mesh: places (k, 2) in the unit square, and the sample of each, or −1.

    `is_free` says which do not lie on an open side or at a pole.
    """

    places: Array
    sample: Indices
    is_free: NDArray[np.bool_]

    @classmethod
    def of(cls, samples: Samples, spline: Spline, ends: Ends) -> Vertices:
        """Take the samples, of those at one place the first, and add open sides and poles."""
        places = np.clip(spline.in_cells(samples.uv.astype(np.float64)) / spline.cells, 0.0, 1.0)
        pairs = _unique(places, ends).view(np.complex128)[:, 0]
        sample = np.sort(np.unique(pairs, return_index=True)[1])
        inner = cls(places[sample], sample, np.ones(len(sample), dtype=bool))
        if all(end in ("wrap", "flip") for end, _ in ends):
            return inner
        points = samples.points.astype(np.float64)
        tree = tree_of(points[sample])
        fixed = [*_poles(inner, tree, spline, ends), *_sides(inner, points, tree, spline, ends)]
        for part in fixed:
            inner = inner.without(part.sample)
        return cls.joined([inner, *fixed])

    @classmethod
    def fixed(cls, places: Array, sample: Indices) -> Vertices:
        """Return vertices that are not free."""
        return cls(places, sample, np.zeros(len(places), dtype=bool))

    @classmethod
    def joined(cls, parts: list[Vertices]) -> Vertices:
        """Return the vertices of all parts."""
        names = ("places", "sample", "is_free")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    def without(self, sample: Indices) -> Vertices:
        """Return these vertices without some samples."""
        kept = ~np.isin(self.sample, sample)
        return Vertices(self.places[kept], self.sample[kept], self.is_free[kept])

    def uv(self, spline: Spline) -> Array:
        """Return the parameters of the places."""
        low, high = np.array(spline.domain).T
        return np.where(self.places == 1.0, high, low + self.places * (high - low))


def ends_of(spline: Spline) -> Ends:
    """Return what lies beyond the ends of a spline, with a closed side that is one point a pole."""
    size = float(np.ptp(spline.coefficients, axis=(0, 1)).max())
    found: list[tuple[End, End]] = []
    for axis, ends in enumerate(spline.ends):
        kinds = list(ends)
        for place, end in enumerate(ends):
            if end == "none" and spline.ends[1 - axis][0] == "wrap":
                t = np.linspace(0.0, 1.0, spline.cells[1 - axis] + 1)
                side = _points(spline, _on_side(axis, place, t))
                kinds[place] = "pole" if np.ptp(side, axis=0).max() <= ON_BORDER * size else end
        found.append((kinds[0], kinds[1]))
    return found[0], found[1]


def _unique(places: Array, ends: Ends) -> Array:
    """Return places that are equal where the points of the surface are: on seams, at poles."""
    unique = np.ascontiguousarray(places).copy()
    for axis in (0, 1):
        for place, end in enumerate(ends[axis]):
            if end == "pole":
                unique[np.abs(unique[:, axis] - place) <= ON_BORDER] = float(place)
        on_seam = unique[:, axis] == 1.0
        if ends[axis][0] in ("wrap", "flip"):
            unique[on_seam, axis] = 0.0
            if ends[axis][0] == "flip":
                unique[on_seam, 1 - axis] = 1.0 - unique[on_seam, 1 - axis]
    return unique


def _on_side(axis: int, place: int, t: Array) -> Array:
    """Return places (k, 2) where u (axis 0) or v (axis 1) is at an end, and the other one is t."""
    fixed = np.full_like(t, float(place))
    return np.stack([fixed, t] if axis == 0 else [t, fixed], axis=1)


def _points(spline: Spline, places: Array) -> Array:
    """Return the points (k, 3) of a spline at places."""
    vertices = Vertices.fixed(places, np.empty(0, dtype=np.int64))
    return spline.evaluate(*vertices.uv(spline).T)


def _poles(inner: Vertices, tree: KDTree, spline: Spline, ends: Ends) -> Iterator[Vertices]:
    """Yield the poles, each one place: a sample that is there, or one of no sample near by."""
    for axis, kinds in enumerate(ends):
        for place, end in enumerate(kinds):
            if end == "pole":
                there = np.abs(inner.places[:, axis] - place) <= ON_BORDER
                at = _on_side(axis, place, np.zeros(1))
                point = _points(spline, at)
                if there.any():
                    yield Vertices.fixed(at, inner.sample[there])
                elif tree.query(point)[0][0] >= BESIDE * _spacings(tree, point)[0]:
                    yield Vertices.fixed(at, np.array([-1]))


def _spacings(tree: KDTree, points: Array) -> Array:
    """Return how far apart vertices are to be at points (k, 3) where there are no samples."""
    nearest = min(NEAREST, tree.n)
    spacings = np.empty(len(points))
    distances = tree.query(points, k=nearest, workers=-1)[0].reshape(len(points), -1)[:, -1]
    border_spacings(distances, float(nearest), spacings)
    return spacings


# --- open sides -----------------------------------------------------------------------------------


def _sides(
    inner: Vertices, points: Array, tree: KDTree, spline: Spline, ends: Ends
) -> Iterator[Vertices]:
    """Yield the vertices of each open side, where samples lie on it those.

    A corner of the domain belongs to the side that begins there, counterclockwise.
    """
    for axis in (0, 1):
        for place, end in enumerate(ends[axis]):
            if end == "none":
                yield _Side(spline, axis, place, tree).vertices(inner, points)


class _Side:
    """An open side of the domain, where u (axis 0) or v (axis 1) is at its low or high end."""

    def __init__(self, spline: Spline, axis: int, place: int, tree: KDTree) -> None:
        """Measure the side in units of the spacing that its points are to have."""
        self.spline, self.axis, self.place = spline, axis, place
        self.closes = spline.ends[1 - axis][0] != "none"
        steps = STEPS_A_CELL * spline.cells[1 - axis]
        steps = max(steps, STEPS_A_SAMPLE * math.isqrt(tree.n))
        self.t = np.linspace(0.0, 1.0, steps + 1)
        line = _points(spline, _on_side(axis, place, self.t))
        self.spacings = _spacings(tree, line)
        lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
        shortest = float(lengths.sum()) / steps or 1.0
        middle = np.maximum((self.spacings[1:] + self.spacings[:-1]) / 2.0, shortest)
        self.measure = np.concatenate([[0.0], np.cumsum(lengths / middle)])

    def vertices(self, inner: Vertices, points: Array) -> Vertices:
        """Return the vertices of the side: the samples on it, and points between them."""
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
        """Say which positions belong to this side: of an open one but one of its ends."""
        if self.closes:
            return np.ones(len(t), dtype=bool)
        return t < 1.0 if self.axis + self.place == 1 else t > 0.0

    def _near(self, inner: Vertices, points: Array) -> tuple[Indices, Array, NDArray[np.bool_]]:
        """Return the samples near the side, where along it they are, and which lie on it.

        The nearest one comes last. A sample on a corner is exactly there.
        """
        depth = np.abs(inner.places[:, self.axis] - self.place)
        near = np.flatnonzero(depth < DEEPEST)
        along = inner.places[near, 1 - self.axis]
        feet = _points(self.spline, _on_side(self.axis, self.place, along))
        gaps = np.linalg.norm(points[inner.sample[near]] - feet, axis=1)
        is_on = depth[near] <= ON_BORDER
        chosen = is_on | (gaps < BESIDE * np.interp(along, self.t, self.spacings))
        order = np.flatnonzero(chosen)[np.argsort(-depth[near[chosen]], kind="stable")]
        ends = np.rint(along)
        along = np.where(np.abs(along - ends) <= ON_BORDER, ends, along)
        return near[order], along[order], is_on[order]
