"""Gaussian images: of one patch, and of all patches of a spline (paper, Sect. 3.2)."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import gaussian_image as formulas
from ..checks import real_array, whole_number
from ..errors import InputError
from ..plain import plain
from ..search import NormalBins, fill, find
from ..sphere import as_normals
from ..spline import Spline, spline_of
from ..surface import Surface
from .area import measures_of
from .classes import PatchClass, classes_of
from .membership import has_normals
from .parabolic_lines import Piece, pieces_of
from .patches import Patches, checked_control_points
from .solid_angle import boundary_of

__all__ = ["BoundaryArc", "GaussianImage", "GaussianImages"]

Array = NDArray[np.float64]
NAMES = {
    PatchClass.SINGULAR: "empty",
    PatchClass.PLANAR: "point",
    PatchClass.DEVELOPABLE: "arc",
    PatchClass.MIXED: "bow tie",
}
BY_SIDES = {2: "biangle", 3: "triangle"}


@dataclass(frozen=True, eq=False)
class BoundaryArc:
    """One side of a Gaussian image: a quadratic Bézier curve of normals, projected to the sphere.

    `control_normals` (3, 3) are its control points, three of the control normals of the patch (not
    of unit length). `noise` bounds the error that the rounding of the coordinates leaves in them.
    """

    control_normals: Array
    noise: float

    def points(self, count: int) -> Array:
        """Return `count` unit normals (count, 3) along the arc, both ends included.

        At a singular end, where the normal vanishes, it is the limit; NaN if the whole arc has no
        normals, and at a `singular_point`, where the arc jumps to the opposite normal. Raises
        InputError unless `count` is a whole number of at least 2.
        """
        t = np.linspace(0.0, 1.0, whole_number(count, "count", 2))
        normals = np.stack(formulas_of_arc(self.control_normals, t), axis=1)
        nonzero = self.control_normals[self.control_normals.any(axis=1)]
        if len(nonzero):
            for end, limit in ((0, nonzero[0]), (-1, nonzero[-1])):
                normals[end] = normals[end] if normals[end].any() else limit
        with np.errstate(invalid="ignore"):
            if self.singular_point is not None:
                normals[np.linalg.norm(normals, axis=1) <= 4.0 * self.noise] = np.nan
            normals /= np.abs(normals).max(axis=1, keepdims=True)
            return normals / np.linalg.norm(normals, axis=1, keepdims=True)

    @cached_property
    def singular_point(self) -> float | None:
        """The parameter, between 0 and 1, at which the normal vanishes up to rounding, or None.

        The arc is then two parts of one great circle. Unless they are one point, the image is
        closed between them by half a great circle, whose plane depends on the rest of the patch.
        """
        first, middle, last = self.control_normals
        limit = 4.0 * self.noise
        if min(np.linalg.norm(first), np.linalg.norm(last)) <= limit:
            return None
        quadratics = np.stack([first - 2.0 * middle + last, 2.0 * (middle - first), first], axis=1)
        # What rounding leaves of a coefficient would only give roots far away.
        quadratics[np.abs(quadratics) <= np.finfo(float).eps * np.abs(quadratics).max()] = 0.0
        roots = np.concatenate([np.roots(x).real for x in quadratics]).astype(np.float64)
        zeros: Array = roots[(roots > 0.0) & (roots < 1.0)]
        if not len(zeros):
            return None
        lengths = np.linalg.norm(np.stack(formulas_of_arc(self.control_normals, zeros)), axis=0)
        best = int(lengths.argmin())
        return float(zeros[best]) if lengths[best] <= limit else None

    @property
    def sides(self) -> int:
        """How many sides it gives the image: 0 for one point, more if it is cut inside."""
        parts = 0 if self.is_point else 1
        if self.singular_point is None:
            return parts
        jumps = float(self.control_normals[0] @ self.control_normals[2]) < 0.0
        return 2 * parts + (1 if parts or jumps else 0)

    @property
    def is_point(self) -> bool:
        """Whether all its normals are parallel, up to rounding (the edge is a parabolic line)."""
        lengths = np.linalg.norm(self.control_normals, axis=1)
        longest = self.control_normals[int(lengths.argmax())]
        across = np.linalg.norm(np.cross(self.control_normals, longest), axis=1).max()
        return bool(across <= 4.0 * self.noise * lengths.max())

    @property
    def is_great_circle(self) -> bool:
        """Whether it lies on a great circle, up to rounding: its normals are coplanar.

        Its cone is then a pair of planes. So it is for an edge in a plane of symmetry.
        """
        longest = float(np.linalg.norm(self.control_normals, axis=1).max())
        volume = abs(float(np.linalg.det(self.control_normals)))
        return volume <= 4.0 * self.noise * longest**2


@dataclass(frozen=True, eq=False)
class GaussianImage:
    """The Gaussian image of one quadratic patch: the region of the sphere that its normals fill.

    Make one with `of_patch`, or take one from a `GaussianImages`. `control_points` (6, 3) are in
    the order b200, b020, b002, b110, b101, b011. What depends on whether something vanishes
    (`kind`, `patch_class`, `is_great_circle`) is decided up to the rounding of the coordinates.
    """

    control_points: Array

    def __repr__(self) -> str:
        return f"GaussianImage({self.kind})"

    @classmethod
    def of_patch(cls, control_points: ArrayLike) -> GaussianImage:
        """Return the Gaussian image of six control points (6, 3).

        Raises InputError for another shape, NaN, infinity, or numbers too large to compute with.
        """
        return cls(checked_control_points(control_points))

    @cached_property
    def kind(self) -> str:
        """What the image is.

        "triangle": bounded by three arcs. "biangle": by two, because the third is one point (its
        edge is a parabolic line). "polygon": by more, because a corner is a singular point and adds
        a great-circle arc, or one lies inside an edge. "bow tie": a parabolic line inside, pinched
        to one point. "arc": of a developable patch. "point": of a plane (two opposite ones if it is
        folded). "empty": no point of the patch has a normal.
        """
        if self.patch_class in NAMES:
            return NAMES[self.patch_class]
        if len(self.pieces) > 1:
            return "bow tie"
        sides = (BoundaryArc(arc[0], self._noise) for arc in boundary_of(self._patch.normals))
        return BY_SIDES.get(sum(side.sides for side in sides), "polygon")

    @cached_property
    def patch_class(self) -> PatchClass:
        """The class of the patch, see `classify_patches`."""
        return PatchClass(int(classes_of(self._patch)[0]))

    @cached_property
    def cones(self) -> Array:
        """The symmetric matrices M (3, 3, 3) of the cones nᵀ M n = 0 on which the sides lie.

        They are U, V, W: those of the edges u = 0, v = 0 and w = 1 − u − v = 0, up to a positive
        factor that the three have in common. The normals n of the patch, and their opposites, are
        where the three forms have one sign.
        """
        rows = self._patch.apply(formulas.boundary_cones)
        return np.array([x[0] for x in rows]).reshape(3, 3, 3)

    @cached_property
    def arcs(self) -> tuple[BoundaryArc, BoundaryArc, BoundaryArc]:
        """The sides along the edges u = 0, v = 0 and w = 0, counter-clockwise in (u, v).

        They run from v = 1 to w = 1, from w = 1 to u = 1 and from u = 1 to v = 1. An edge that has
        no normals, because it is one point, has the limit of the normals near it.
        """
        w, u, v = (BoundaryArc(arc[0], self._noise) for arc in boundary_of(self._patch.normals)[:3])
        return u, v, w

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The pieces of one sign of the Gaussian curvature, see `split_patch`."""
        return pieces_of(self._patch)

    @cached_property
    def solid_angle(self) -> float:
        """The integral of the Gaussian curvature over the patch, negative where hyperbolic."""
        return float(self._measures[0][0])

    @cached_property
    def area(self) -> float:
        """The area of the image in steradians: the integral of |K| over the patch."""
        return float(self._measures[1][0])

    def contains(self, normals: ArrayLike) -> NDArray[np.bool_]:
        """Say which of the directions (S, 3), of any length, are oriented normals of the patch.

        The border belongs to the image. The answer is exact for the control points and directions
        as they are: what rounding leaves open is decided on integers. So an image without inside
        ("arc", "point") holds only the few directions that lie on it exactly. A singular point has
        no normal. Raises InputError for another shape, NaN, infinity or a zero vector.
        """
        as_normals(normals)
        return has_normals(self.control_points, real_array(normals, "normals"))

    @cached_property
    def _patch(self) -> Patches:
        return Patches.of_control_points(self.control_points[None])

    @cached_property
    def _measures(self) -> tuple[Array, Array]:
        return measures_of(self._patch, np.array([self.patch_class], dtype=np.int8))

    @property
    def _noise(self) -> float:
        return float(self._patch.normal_noise[0])


@dataclass(frozen=True, eq=False)
class GaussianImages:
    """The Gaussian images of all patches of a spline: together the domain of its support function.

    Made by `of_spline`. images[k] is the image of patch k; patches are numbered as in `Spline`.
    """

    spline: Spline

    def __repr__(self) -> str:
        return f"GaussianImages({len(self):,} patches)"

    @classmethod
    def of_spline(
        cls, spline: Spline | Surface, cells: Sequence[int] | None = None
    ) -> GaussianImages:
        """Return the Gaussian images of a spline, or of the spline of a surface (see `fit`).

        Raises InputError for `cells` beside a spline, and what `fit` raises.
        """
        return cls(spline_of(spline, cells))

    def __len__(self) -> int:
        """Return the number of patches."""
        return self.spline.patches

    def __getitem__(self, patch: int) -> GaussianImage:
        """Return the image of one patch; IndexError if there is none of that number."""
        return GaussianImage(self.spline.control_nets[operator.index(patch)])

    @cached_property
    def patch_classes(self) -> NDArray[np.int8]:
        """The `PatchClass` (k,) of each patch."""
        return classes_of(self._patches)

    @cached_property
    def solid_angles(self) -> Array:
        """The integral (k,) of the Gaussian curvature over each patch.

        On a closed surface they sum to 2π χ: 4π on a sphere-like one, 0 on a torus.
        """
        return self._measures[0]

    @cached_property
    def areas(self) -> Array:
        """The area (k,) in steradians of each image: the integral of |K| over each patch."""
        return self._measures[1]

    def sheets(
        self, normals: ArrayLike, sign: int = 0, threads: int | None = None
    ) -> NDArray[np.int64]:
        """Return how many points (S,) of the spline have each of the directions (S, 3).

        With sign=1 only elliptic points count, with sign=-1 only hyperbolic ones. Raises InputError
        for unusable normals (see `sample`) or another sign.
        """
        is_whole = isinstance(sign, int | np.integer) and not isinstance(sign, bool)
        if not is_whole or sign not in (-1, 0, 1):
            raise InputError(f"sign must be 1, -1 or 0 (both), not {sign!r}.")
        directions = as_normals(normals)
        bins = NormalBins(directions)
        hits = find(self.spline, bins, threads)
        which = hits.normal_index
        if sign:
            curvature = fill(self.spline, bins, hits, threads)["gaussian_curvature"]
            which = which[np.signbit(curvature) == (sign < 0)]
        return np.bincount(which, minlength=len(directions)).astype(np.int64)

    @cached_property
    def _measures(self) -> tuple[Array, Array]:
        return measures_of(self._patches, self.patch_classes)

    @cached_property
    def _patches(self) -> Patches:
        return Patches.of_spline(self.spline)


def formulas_of_arc(control_normals: Array, t: Array) -> list[Array]:
    """Return the three components (k,) of the normals of an arc at parameters (k,)."""
    columns = plain(formulas.boundary_arc)(*control_normals.ravel(), t)[:3]
    return [column + 0.0 * t for column in columns]
