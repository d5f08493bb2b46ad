"""Gaussian images: of one patch, and of all patches of a spline (paper, Sect. 3.2)."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import gaussian_image as formulas
from ..bins import NormalBins
from ..checks import real_array
from ..directions.unit import as_normals
from ..errors import InputError, shown
from ..fitting import spline_of
from ..search import fill, find
from ..spline import Spline
from ..surface import Surface
from .area import measures_of
from .boundary import BoundaryArc, boundary_arcs, edge_arcs
from .classes import PatchClass, classes_of
from .membership import PatchNormals
from .parabolic_lines import Piece, pieces_of
from .patches import Patches, checked_control_points

__all__ = ["GaussianImage", "GaussianImages"]

Array = NDArray[np.float64]
NAMES = {
    PatchClass.SINGULAR: "empty",
    PatchClass.PLANAR: "point",
    PatchClass.DEVELOPABLE: "arc",
    PatchClass.MIXED: "bow tie",
}
BY_SIDES = {2: "biangle", 3: "triangle"}


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
        edge is a parabolic line). "polygon": by more, because a corner or a point inside an edge is
        singular, see `boundary`. "bow tie": a parabolic line inside, pinched to one point. "arc":
        of a developable patch. "point": of a plane (two opposite ones if it is folded). "empty": no
        point of the patch has a normal.
        """
        if self.patch_class in NAMES:
            return NAMES[self.patch_class]
        if len(self.pieces) > 1:
            return "bow tie"
        return BY_SIDES.get(len(self.boundary), "polygon")

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
        return np.array([[x[0] for x in row] for row in rows]).reshape(3, 3, 3)

    @cached_property
    def arcs(self) -> tuple[BoundaryArc, BoundaryArc, BoundaryArc]:
        """The normals along the edges u = 0, v = 0 and w = 0, counter-clockwise in (u, v).

        They run from v = 1 to w = 1, from w = 1 to u = 1 and from u = 1 to v = 1. An edge that has
        no normals, because it is one point, has the limit of the normals near it.
        """
        return edge_arcs(self._patch.normals[0], self._noise)

    @cached_property
    def boundary(self) -> tuple[BoundaryArc, ...]:
        """The sides of the image, each from the end of the one before, as the border runs.

        They are `arcs` without those that are one point, and cut where an edge has a singular point
        inside. Round a singular point of the border the normals have all limits along an arc of a
        great circle, which is a side, too: half a great circle where the normals of an edge jump to
        the opposite ones. The chain is closed; it has gaps between opposite normals only if the
        image has no inside, or if a whole curve of singular points ends there. What singular points
        inside the patch add to the border of the image is not in it.
        """
        return boundary_arcs(self._patch.normals[0], self._noise)

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
        return PatchNormals(self.control_points).contain(real_array(normals, "normals"))

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
        cls, spline: Spline | Surface | str, cells: Sequence[int] | None = None
    ) -> GaussianImages:
        """Return the Gaussian images of a spline, or of the spline of a surface (see `fit`).

        Raises InputError for `cells` beside a spline, and what `fit` raises.
        """
        return cls(spline_of(spline, cells))

    def __len__(self) -> int:
        """Return the number of patches."""
        return self.spline.patches

    def __getitem__(self, patch: int) -> GaussianImage:
        """Return the image of one patch; IndexError if there is none, InputError if no number."""
        try:
            number = operator.index(patch)
        except TypeError:
            raise InputError(f"a patch is picked by its number, not by {shown(patch)}.") from None
        return GaussianImage(self.spline.control_nets[number])

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
            raise InputError(f"sign must be 1, -1 or 0 (both), not {shown(sign)}.")
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
