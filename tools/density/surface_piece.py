"""A surface or a spline as a piece of a `Space`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.aliases import Array
from ...runtime.onto_surface.on_spline import OnSpline
from ...runtime.onto_surface.smooth_pieces import with_area
from .kernels.sizing import TargetDensity
from .piece import Piece, boxes_between
from .space import Space

# A domain is divided into about this number of boxes along u and along v. Their sides are lines
# between cells of the spline.
BOXES = 32


@dataclass(frozen=True, eq=False, kw_only=True)
class SurfacePiece(Piece):
    """A sampled surface with its spline, as a piece.

    With `exactly`, candidates are evaluated from the derivatives of the surface (finite differences
    if the surface has no others), otherwise from the derivatives of the spline. `polygons` is
    empty: samples beside the boundary would be too close to the boundary vertices of meshes.
    """

    geometry: OnSpline
    exactly: bool

    @classmethod
    def of(cls, geometry: OnSpline, first_patch: int) -> SurfacePiece:
        """Return a geometry as a piece whose patches are numbered from `first_patch` on."""
        spline = geometry.spline
        # At poles the curvature of a spline is far from that of the surface.
        exactly = geometry.knows_jets or any("pole" in ends for ends in spline.boundary)
        return cls(
            label=f"surface {spline.name!r}",
            domain=spline.domain,
            trim=spline.trim,
            indices={"patch_index": first_patch},
            distance=0.0 if exactly else geometry.distance,
            finest=spline.frame[2:],
            geometry=geometry,
            exactly=exactly,
        )

    @cached_property
    def size(self) -> float:
        """The square root of the area inside the trim, in L; 0 if it is rounding error."""
        return self.geometry.size

    @property
    def boxes(self) -> Array:
        """Boxes (M, 4) that partition the domain, along lines between cells of the spline."""
        u0, v0, du, dv = self.geometry.spline.frame
        return boxes_between(*(
            low + step * np.unique(np.linspace(0, cells, BOXES + 1).round())
            for low, step, cells in zip((u0, v0), (du, dv), self.geometry.spline.cells, strict=True)
        ))  # fmt: skip

    def jets(self, u: Array, v: Array) -> Array:
        """Return 2-jets (k, 6, 3) at parameters."""
        return (self.geometry.jets if self.exactly else self.geometry.jets_of_spline)(u, v)

    def geometries(self, threads: int | None) -> list[OnSpline]:
        """Return the geometry that is searched for points with a normal."""
        return [self.geometry]

    def fields_at(
        self, uv: Array, rows: Array, fields: Sequence[str], dtype: DTypeLike
    ) -> dict[str, NDArray[Any]]:
        """Return fields of samples at parameters (k, 2) in cells; `rows` (k, 8) describe these."""
        return self.geometry.at_parameters(uv, rows[:, 3:6], rows[:, 7], fields, dtype)

    def solid_angle(self, density: float) -> float:
        """Return the solid angle of the Gaussian image, as far as a lattice can sample it."""
        return self.geometry.cell_measure.curved_solid_angle(density)

    @property
    def exact(self) -> Piece:
        """The piece with the derivatives of the sampled surface itself."""
        return self if self.exactly else replace(self, exactly=True, distance=0.0)


def space_of(
    geometries: Sequence[OnSpline],
    threads: int | None,
    target: TargetDensity = TargetDensity(floor=1.0),  # noqa: B008 - it does not change
) -> Space:
    """Return the `Space` of the pieces of a surface that have an area.

    Raises SurfaceError if no piece has an area.
    """
    pieces = tuple(SurfacePiece.of(x, first) for first, x in with_area(geometries))
    return Space(f"surface {geometries[0].spline.name!r}", pieces, target, threads)
