"""A surface or a spline as a piece that is sampled."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.errors import SurfaceError
from ..domain.domain import Domain
from ..domain.trim import Trim
from ..kernels.sizing import TargetDensity
from ..place.on_spline import OnSpline
from ..spline.developable import curved_solid_angle
from .piece import Piece, boxes_between
from .space import Space

__all__ = ["SurfacePiece", "space_of"]

Array = NDArray[np.float64]

# About this number of boxes along u and along v; their sides are lines between cells.
BOXES = 32
# A piece that is smaller than this part of the largest is no surface, and gets no samples.
NO_SIZE = 1e-6


@dataclass(frozen=True, eq=False)
class SurfacePiece(Piece):
    """What is sampled, with its spline; patches are numbered from `first_patch` on.

    Candidates follow from the derivatives of the surface where it knows them, otherwise from those
    of the spline; with `exactly`, from differences of the surface.
    """

    geometry: OnSpline
    first_patch: int = 0
    exactly: bool = False

    @property
    def label(self) -> str:
        """What it is called in messages."""
        return f"surface {self.geometry.name!r}"

    @property
    def domain(self) -> Domain:
        """The rectangle of the parameters."""
        return self.geometry.spline.domain

    @property
    def trim(self) -> Trim | None:
        """The part of the domain that belongs to it."""
        return self.geometry.spline.trim

    @cached_property
    def size(self) -> float:
        """The root of the area inside the trim, in L; 0 if that is rounding."""
        spline = self.geometry.spline
        extents = np.ptp(spline.coefficients[1:-1, 1:-1].reshape(-1, 3) * spline.scale, axis=0)
        diagonal, area = float(np.linalg.norm(extents)), float(spline.measure[0].sum())
        return diagonal * math.sqrt(area) / spline.scale if area * diagonal > spline.noise else 0.0

    @cached_property
    def boxes(self) -> Array:
        """Boxes (M, 4) between lines of cells."""
        u0, v0, du, dv = self.geometry.spline.frame
        return boxes_between(*(
            low + step * np.unique(np.linspace(0, cells, BOXES + 1).round())
            for low, step, cells in zip((u0, v0), (du, dv), self.geometry.cells, strict=True)
        ))  # fmt: skip

    @property
    def polygons(self) -> Sequence[Array]:
        """No polygons: samples beside borders would be in the way of the vertices of meshes."""
        return ()

    def jets(self, u: Array, v: Array) -> Array:
        """Return 2-jets (k, 6, 3) at parameters."""
        if self._is_exact:
            return self.geometry.jets(u, v)
        return self.geometry.jets_of_spline(u, v)

    def geometries(self, threads: int | None) -> list[OnSpline]:
        """Return what is searched for points with a normal."""
        return [self.geometry]

    def fields_at(
        self, uv: Array, rows: Array, fields: Sequence[str], dtype: DTypeLike
    ) -> dict[str, NDArray[Any]]:
        """Return fields of samples at parameters (k, 2); rows (k, 8) are those of candidates."""
        return self.geometry.at_parameters(uv, rows[:, 3:6], rows[:, 7], fields, dtype)

    @property
    def indices(self) -> Mapping[str, int]:
        """The number of its first patch."""
        return {"patch_index": self.first_patch}

    def solid_angle(self, density: float) -> float:
        """Return the solid angle of the normals of what `density` normals per steradian sample."""
        return curved_solid_angle(self.geometry, density)

    @property
    def distance(self) -> float:
        """How far points of what is sampled are from those of `jets`, at most."""
        return 0.0 if self._is_exact else self.geometry.distance

    @property
    def exact(self) -> Piece:
        """The piece with the derivatives of what is sampled."""
        return self if self._is_exact else replace(self, exactly=True)

    @property
    def finest(self) -> Array:
        """The lengths (2,) of the cells of the spline."""
        return self.geometry.spline.frame[2:]

    @property
    def _is_exact(self) -> bool:
        # At poles the curvature of splines is far from that of the surface.
        has_pole = any("pole" in ends for ends in self.geometry.spline.boundary)
        return self.exactly or self.geometry.knows_jets or has_pole


def space_of(
    geometries: Sequence[OnSpline],
    threads: int | None,
    target: TargetDensity = TargetDensity(floor=1.0),  # noqa: B008 - it does not change
) -> Space:
    """Return what is sampled: those of the pieces of a surface that have an area.

    Raises SurfaceError if none has.
    """
    firsts = np.cumsum([0, *(x.patches for x in geometries)]).tolist()
    pieces = [SurfacePiece(x, first) for x, first in zip(geometries, firsts[:-1], strict=True)]
    label, sizes = pieces[0].label, np.array([_size_of(x, len(pieces) > 1) for x in pieces])
    real = sizes > NO_SIZE * sizes.max()
    if not real.any():
        raise SurfaceError(
            f"{label} has no area beyond rounding: all its points lie on one curve or are one "
            'point; only density="gauss" takes it.'
            if len(pieces) == 1
            else f"{label} and the other pieces have no area beyond rounding, or their trim leaves "
            "nothing of them."
        )
    kept = tuple(piece for piece, is_real in zip(pieces, real, strict=True) if is_real)
    return Space(label, kept, target, threads)


def _size_of(piece: SurfacePiece, is_one_of_many: bool) -> float:
    """Return the size of a piece; 0 if the trim leaves nothing of one of many."""
    try:
        return piece.size
    except SurfaceError:
        if is_one_of_many:
            return 0.0
        raise
