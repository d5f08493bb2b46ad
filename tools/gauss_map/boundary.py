"""The boundary of a Gaussian image: arcs of normals along the edges, cut at singular points."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from ...generated import gaussian_image as formulas
from ...runtime.base.checks import whole_number
from ...runtime.base.formula_calls import python_function, vector
from .solid_angle import EDGES, boundary_of, first_directions

Array = NDArray[np.float64]
CORNERS = np.eye(3)


@dataclass(frozen=True, eq=False)
class BoundaryArc:
    """An arc of a Gaussian image: a quadratic Bézier curve of normals, projected to the sphere.

    Attributes
    ----------
    control_normals : (3, 3) float64 array
        The control points, not of unit length; for an edge of a patch, they are three of the
        control normals of the patch.
    noise : float
        A bound of the error of the control normals due to the rounding of the coordinates.

    Examples
    --------
    >>> import gaussmap as gm
    >>> net = gm.fit("torus", (16, 16)).control_nets[0]
    >>> arc = gm.gauss_map.GaussianImage.of_patch(net).arcs[0]
    >>> arc.points(5).shape, arc.control_normals.shape, arc.noise < 1e-12
    ((5, 3), (3, 3), True)
    >>> arc.singular_points, len(arc.parts), arc.is_point, arc.is_great_circle
    ((), 1, False, False)

    """

    control_normals: Array = field(repr=False)
    noise: float

    def points(self, count: int) -> Array:
        """Return unit normals along the arc, both ends included.

        Parameters
        ----------
        count : int
            The number of normals, at least 2.

        Returns
        -------
        (count, 3) float64 array
            The normals. At a singular end, their limit is returned. The result is NaN if the whole
            arc has no normals, and at a singular point inside the arc, where its `parts` end.

        Raises
        ------
        InputError
            Unless `count` is a whole number of at least 2.

        Examples
        --------
        >>> import gaussmap as gm
        >>> net = gm.fit("torus", (16, 16)).control_nets[0]
        >>> gm.gauss_map.GaussianImage.of_patch(net).boundary[0].points(3).shape
        (3, 3)

        """
        t = np.linspace(0.0, 1.0, whole_number(count, "count", 2))
        normals = self._at(t)
        nonzero = self.control_normals[self.control_normals.any(axis=1)]
        if len(nonzero):
            for end, limit in ((0, nonzero[0]), (-1, nonzero[-1])):
                normals[end] = normals[end] if normals[end].any() else limit
        with np.errstate(invalid="ignore"):
            if self.singular_points:
                normals[np.linalg.norm(normals, axis=1) <= self._limit] = np.nan
            normals /= np.abs(normals).max(axis=1, keepdims=True)
            return normals / np.linalg.norm(normals, axis=1, keepdims=True)

    @cached_property
    def singular_points(self) -> tuple[float, ...]:
        """The parameters, between 0 and 1, at which the normal vanishes up to rounding.

        There is at most one, or two if all normals of the arc are parallel.
        """
        if np.linalg.norm(self.control_normals, axis=1).max() <= self._limit:
            return ()
        with np.errstate(all="ignore"):
            zeros = [
                python_function(formulas.boundary_arc_zeros)(
                    *map(vector, self.control_normals), vector(axis), sign
                )
                for axis, sign in product(CORNERS, (-1.0, 1.0))
            ]
        inside = np.ravel(zeros)
        inside = np.sort(inside[(inside > 0.0) & (inside < 1.0)])
        found = [0.0, *inside[self._lengths(inside) <= self._limit].tolist(), 1.0]
        groups: list[list[float]] = [[]]
        for before, t in pairwise(found):
            groups[-1].append(before)
            if self._lengths(np.array([before, 0.5 * (before + t)])).max() > self._limit:
                groups.append([])
        groups[-1].append(1.0)
        # The zeros in the first and in the last group belong to the ends of the arc, which are
        # corners of the patch.
        return tuple(min(x, key=lambda t: self._lengths(np.array([t]))[0]) for x in groups[1:-1])

    @cached_property
    def parts(self) -> tuple[BoundaryArc, ...]:
        """The parts of the arc between its singular points; the arc itself if there are none.

        At a singular point, a part ends with the limit of its normals.
        """
        if not self.singular_points:
            return (self,)
        bounds = [0.0, *self.singular_points, 1.0]
        return tuple(replace(self, control_normals=self._between(*x)) for x in pairwise(bounds))

    @property
    def is_point(self) -> bool:
        """Whether all normals are parallel, up to rounding (the edge is a parabolic line)."""
        lengths = np.linalg.norm(self.control_normals, axis=1)
        longest = self.control_normals[int(lengths.argmax())]
        across = np.linalg.norm(np.cross(self.control_normals, longest), axis=1).max()
        return bool(across <= self._limit * lengths.max())

    @property
    def is_great_circle(self) -> bool:
        """Whether the arc lies on a great circle, up to rounding: its normals are coplanar.

        The cone through the arc is then a pair of planes, as for an edge in a plane of symmetry.
        """
        longest = float(np.linalg.norm(self.control_normals, axis=1).max())
        volume = abs(float(np.linalg.det(self.control_normals)))
        return volume <= self._limit * longest**2

    @property
    def _limit(self) -> float:
        return 4.0 * self.noise

    def _at(self, t: Array) -> Array:
        """Return the normals (k, 3), of any length, at parameters (k,)."""
        columns, _ = python_function(formulas.boundary_arc)(*map(vector, self.control_normals), t)
        return np.stack([column + 0.0 * t for column in columns], axis=1)

    def _lengths(self, t: Array) -> Array:
        return np.linalg.norm(self._at(t), axis=1)

    def _between(self, start: float, end: float) -> Array:
        """Return the control normals between two parameters, zero where they nearly vanish."""
        places = np.array([[1.0 - start, start], [1.0 - end, end]])
        polar = np.stack([self.control_normals[:2], self.control_normals[1:]])
        net = np.einsum("ai,bj,ijx->abx", places, places, polar)
        net = np.stack([net[0, 0], net[0, 1], net[1, 1]])
        net[np.linalg.norm(net, axis=1) <= self._limit] = 0.0
        return net


def edge_arcs(normals: Array, noise: float) -> tuple[BoundaryArc, BoundaryArc, BoundaryArc]:
    """Return the arcs of the edges u = 0, v = 0, w = 0, given the polar form (3, 3, 3) of N."""
    w, u, v = (BoundaryArc(arc[0], noise) for arc in boundary_of(normals[None])[:3])
    return u, v, w


def boundary_arcs(normals: Array, noise: float) -> tuple[BoundaryArc, ...]:
    """Return the arcs around a Gaussian image that are not single points, in order.

    See `GaussianImage.boundary`.
    """
    arcs: list[BoundaryArc] = []
    places: list[tuple[Array, Array, Array]] = []  # the end of each arc; steps to two corners
    for edge, (i, j, k) in zip(edge_arcs(normals, noise), (*EDGES[1:], EDGES[0]), strict=True):
        arcs += edge.parts
        first, last, opposite = CORNERS[[i, j, k]]
        for t in edge.singular_points:
            place = (1.0 - t) * first + t * last
            places.append((place, first - place, opposite - place))
        places.append((last, first - last, opposite - last))
    chain = []
    for arc, after, place in zip(arcs, arcs[1:] + arcs[:1], places, strict=True):
        chain += [arc, _turn(normals, arc, after, place)]
    return tuple(arc for arc in chain if not arc.is_point)


def _turn(
    normals: Array, arc: BoundaryArc, after: BoundaryArc, where: tuple[Array, Array, Array]
) -> BoundaryArc:
    """Return the arc of the limits of the normals at a singular point, from one arc to the next.

    It is an arc of a great circle: half of the circle if it joins opposite normals, a single point
    if the surface is regular there. `where` holds the point and two directions from it, in
    barycentric coordinates: back along the edge, and into the triangle.
    """
    start, end = first_directions(np.stack([arc.control_normals[::-1], after.control_normals]))
    middle = 0.5 * (start + end)
    size = min(float(np.linalg.norm(x[x.any(axis=1)], axis=1).min(initial=np.inf))
               for x in (arc.control_normals, after.control_normals))  # fmt: skip
    noise = arc.noise / size
    if np.linalg.norm(middle) <= 4.0 * noise:
        middle = _inner_limit(normals, start, arc.noise, *where)
    return BoundaryArc(np.stack([start, middle, end]), noise)


def _inner_limit(
    normals: Array, start: Array, noise: float, place: Array, back: Array, inwards: Array
) -> Array:
    """Return a unit vector orthogonal to `start`, in the half-plane of the limits of the normals.

    Returns zero if N is parallel to `start` up to the third order. In polar form,
    N(place + x) = 2 N(place, x) + N(x, x). If the first term is parallel to `start` for all x, the
    second term decides, for the inward direction x in which the first term vanishes. If the second
    term is parallel to `start` as well, the third order decides, on the curve tangent to x along
    which the component of N along `start` vanishes.
    """

    def polar(x: Array, y: Array) -> Array:
        return np.einsum("i,j,ijx->x", x, y, normals)

    behind, inner = float(polar(place, back) @ start), polar(place, inwards)
    share = float(inner @ start) / behind if abs(behind) > noise else 0.0
    still = inwards - share * back
    second = polar(still, still)
    curvature = float(second @ start) / behind if abs(behind) > noise else 0.0
    size = float(np.abs(still).sum()) ** 2
    candidates = [
        (inner, 1.0),
        (second, size),
        (-curvature * polar(back, still), size * abs(curvature)),
    ]
    for candidate, errors in candidates:
        across = candidate - (candidate @ start) * start
        length = float(np.linalg.norm(across))
        if length > 4.0 * errors * noise:
            return across / length
    return np.zeros(3)
