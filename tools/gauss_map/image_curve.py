"""Curves whose Gaussian images separate normals with different numbers of points."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.repeats import repeated
from ...runtime.base.trees import tree_of
from ...runtime.base.wording import plural
from ...runtime.domain.domain import brought_inside
from ...runtime.onto_surface.on_spline import OnSpline
from ...runtime.spline.spline import Spline
from ...runtime.surface.derivatives import normals_of_jets
from .polylines import distances, refined

OfPlaces = Callable[[Array], Array]
# Curves whose ends are closer than this, relative to their size, count as closed.
CLOSED = 1e-6
# The point of a curve whose normal is nearest to a given one is searched in ROUNDS rounds of PLACES
# points. The middle of the first round is the nearest of some points on the chords of the image, at
# most APART radians apart; the round extends by one segment to both sides. Each later round lies
# between the two neighbours of the nearest point of the round before. Angles are measured to the
# chords between the points of the last round.
PLACES, ROUNDS, APART = 9, 5, 1e-3


@dataclass(frozen=True, eq=False)
class ImageCurve:
    """A curve on a surface; across its image, the number of points with a normal changes.

    Attributes
    ----------
    uv : (k, 2) float64 array
        Parameters of the vertices. In a periodic direction they continue beyond the end of the
        domain, without jumps.
    points : (k, 3) float64 array
        The vertices in space, in L.
    normals : (k, 3) float64 array
        The unit normals at the vertices: the image; NaN where the surface is singular.
    closed : bool
        Whether the curve is closed; its last vertex then repeats the first.
    cusps : (c,) int64 array
        The indices of vertices that are cusps of the image of a parabolic curve.

    Examples
    --------
    >>> import gaussmap as gm
    >>> fold = gm.GaussMap("wavy_graph").folds()[0]
    >>> len(fold.uv) == len(fold.points) == len(fold.normals), fold.closed, fold.cusps.dtype
    (True, False, dtype('int64'))

    """

    uv: Array
    points: Array
    normals: Array
    closed: bool
    cusps: Indices

    def __repr__(self) -> str:
        kind = "closed" if self.closed else "open"
        return f"ImageCurve({kind}, {len(self.uv):,} vertices, {plural(len(self.cusps), 'cusp')})"


@dataclass(frozen=True, eq=False)
class Traced:
    """A curve, and the functions (`of`) of the surface or spline on which it lies."""

    curve: ImageCurve
    of: Curves

    def angles(self, normals: Array) -> Array:
        """Return the angles (S,), in radians, from unit normals to the image of the curve."""
        uv, image, last = self.curve.uv, self.curve.normals, len(self.curve.uv) - 1
        steps = np.diff(image, axis=0)
        parts = np.ceil(np.nan_to_num(np.linalg.norm(steps, axis=1)) / APART).astype(np.int64) + 1
        owner, number = repeated(parts)
        share = number / parts[owner]
        chords, places = image[owner] + share[:, None] * steps[owner], owner + share
        known = np.isfinite(chords).all(axis=1)
        if not known.any():  # as at the tip of a cone
            return np.full(len(normals), np.inf)
        nearest = places[known][tree_of(chords[known]).query(normals)[1]]
        low, high = np.maximum(nearest - 1.0, 0.0), np.minimum(nearest + 1.0, last)
        image = np.empty((PLACES, len(normals), 3))
        for _ in range(ROUNDS):
            places = np.linspace(low, high, PLACES)
            index = np.minimum(places.astype(np.int64), last - 1)
            chord = uv[index] + (places - index)[..., None] * (uv[index + 1] - uv[index])
            found = _points_and_normals(self.of.jets(self.of.onto(chord.reshape(-1, 2))))[1]
            image = found.reshape(*places.shape, 3)
            apart = np.nan_to_num(np.linalg.norm(image - normals, axis=2), nan=2.0)
            best = apart.argmin(axis=0)
            low, high = (
                np.take_along_axis(places, np.clip(best + x, 0, PLACES - 1)[None], axis=0)[0]
                for x in (-1, 1)
            )
        sides = [distances(normals, *ends) for ends in pairwise(image)]
        return 2.0 * np.arcsin(np.minimum(np.nanmin(sides, axis=0) / 2.0, 1.0))


class Curves:
    """The functions that evaluate and refine curves on a surface or a spline.

    Here the curves are polylines of the parameter plane; a subclass for other curves overrides
    `onto`. `jets` returns 2-jets (k, 6, 3) at parameters (k, 2); `size` is the size of the surface.
    """

    jets: OfPlaces
    size: float

    def onto(self, uv: Array) -> Array:
        """Move parameters (k, 2) near the curves onto the curves."""
        return uv

    def with_cusps(self, uv: Array) -> tuple[Array, Indices]:
        """Return a curve (k, 2) with the cusps of its image as vertices, and their indices."""
        return uv, np.empty(0, dtype=np.int64)

    def traced(self, uv: Array, tolerance: float) -> Traced:
        """Insert vertices into a polyline (k, 2) until it and its image follow the curve closely.

        The tolerance is a distance in space, relative to the size of the surface, and also an angle
        in radians on the sphere.
        """

        def both(uv: Array) -> Array:
            points, normals = _points_and_normals(self.jets(uv))
            return np.hstack([points / self.size if self.size else points, normals])

        uv, cusps = self.with_cusps(refined(uv, both, tolerance, self.onto))
        points, normals = _points_and_normals(self.jets(uv))
        closed = math.dist(points[0], points[-1]) <= CLOSED * float(np.ptp(points, axis=0).max())
        return Traced(ImageCurve(uv, points, normals, closed, cusps), self)


class Zeros(Curves, ABC):
    """The zeros of K of a surface or a spline: the parabolic points.

    `flat` (m, n) are the cells in which K vanishes up to its error, between the parameters `lines`
    along u and along v.
    """

    flat: Flags
    lines: Sequence[Array]

    @abstractmethod
    def polylines(self) -> list[Array]:
        """Return the curves (k, 2) across which K changes its sign."""

    def isolated(self) -> list[tuple[Array, Array]]:
        """Return the points (2,) at which K touches zero, with rectangles (2, 2) around them."""
        return []

    def warn(self, stacklevel: int) -> None:
        """Warn if K is unknown on a part of the domain."""


def jets_of_spline(spline: Spline) -> OfPlaces:
    """Return the function that gives the 2-jets (k, 6, 3) of a spline at parameters (k, 2)."""
    jets = OnSpline(spline).jets

    def of_places(uv: Array) -> Array:
        u, v = uv.T.copy()
        return jets(*brought_inside(u, v, spline.domain, spline.boundary))

    return of_places


def _points_and_normals(jets: Array) -> tuple[Array, Array]:
    """Return points and unit normals (k, 3); NaN at singular points."""
    normals = normals_of_jets(jets)
    return jets[:, 0], np.where(normals.any(axis=1, keepdims=True), normals, np.nan)
