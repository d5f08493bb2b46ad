"""A smooth piece of the sampled surface: derivatives, boundary, and boxes of its parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.aliases import Array, Flags
from ...runtime.base.repeats import repeated
from ...runtime.domain.domain import Domain, brought_inside
from ...runtime.domain.trim import Trim
from ...runtime.onto_surface.on_spline import OnSpline
from ...runtime.samples.samples import Samples
from .borders import Border


@dataclass(frozen=True, eq=False, kw_only=True)
class Piece(ABC):
    """A smooth surface on a rectangle of parameters, or its part inside a trim, such as a face.

    `label` is its name in messages, `trim` the part of the domain that belongs to it, None for the
    whole domain. `indices` are the names and values of fields that are constant on the piece, such
    as `face_index`, and the index of the first patch, `patch_index`. `distance` is the largest
    measured distance between the surface and points of `jets`, in the unit L of the surface.
    Curvature at scales below `finest` (2,), lengths in u and v, is noise.
    """

    label: str
    domain: Domain
    trim: Trim | None
    indices: Mapping[str, int]
    distance: float = 0.0
    finest: Array = field(default_factory=lambda: np.zeros(2))

    @property
    def polygons(self) -> Sequence[Array]:
        """The closed polygons (k, 2) that bound the piece, if they are known.

        Samples are placed along them if the piece has a trim. The first point of a polygon is not
        repeated at its end.
        """
        return ()

    @cached_property
    @abstractmethod
    def size(self) -> float:
        """The square root of the area inside the trim, in the unit L of the surface."""

    @property
    @abstractmethod
    def boxes(self) -> Array:
        """Boxes (M, 4) that partition the domain; the surface is smooth in each."""

    @abstractmethod
    def jets(self, u: Array, v: Array) -> Array:
        """Return the 2-jets (k, 6, 3) at parameters (k,), from which candidates are evaluated."""

    @abstractmethod
    def geometries(self, threads: int | None) -> list[OnSpline]:
        """Return the geometries that are searched for points with given normals.

        Raises GaussmapError if there is no spline.
        """

    def proved_at(self, normals: Array, threads: int | None) -> list[Samples] | None:
        """Return all points with unit normals (S, 3), with a proof; None without a proof.

        The returned list is empty if there are no points and no undecided normals.
        """
        return None

    @abstractmethod
    def fields_at(
        self, uv: Array, rows: Array, fields: Sequence[str], dtype: DTypeLike
    ) -> dict[str, NDArray[Any]]:
        """Return fields of samples at parameters (k, 2) in cells; `rows` (k, 8) describe these."""

    def solid_angle(self, density: float) -> float | None:
        """Return the solid angle of the Gaussian image, as far as a lattice can sample it.

        `density` is the number of normals of the lattice per steradian.

        Return None if the solid angle is to be computed from K.
        """
        return None

    @property
    def exact(self) -> Piece:
        """The piece with derivatives of the sampled surface itself, which may take longer."""
        return self

    @cached_property
    def sizes(self) -> Array:
        """The lengths (2,) of the domain."""
        low, high = np.array(self.domain).T
        return high - low

    @property
    def middle(self) -> Array:
        """The parameters (2, 1) of the middle of the domain."""
        return np.array(self.domain).mean(axis=1, keepdims=True)

    def border(self, n: int) -> Border | None:
        """Return the boundary on a raster of n × n pixels; None without a trim."""
        if self.trim is None:
            return None
        if n not in self._borders:
            self._borders[n] = Border(self.trim, self.domain, n)
        return self._borders[n]

    @cached_property
    def _borders(self) -> dict[int, Border]:
        return {}

    def contains(self, places: Array) -> Flags:
        """Return whether parameters (k, 2) are inside the trim."""
        return (
            np.ones(len(places), np.bool_) if self.trim is None else self.trim.contains(places, 1)
        )

    def wrapped(self, places: Array) -> Array:
        """Return parameters (k, 2) moved into the domain by its periods.

        The piece has to have a trim.
        """
        assert self.trim is not None
        u, v = places.T
        return np.stack(brought_inside(u, v, self.domain, self.trim.boundary), axis=1)

    def border_lines(self, step: float) -> Iterator[Array]:
        """Yield the closed polygons, refined to steps of at most `step` times `sizes`."""
        for polygon in self.polygons:
            steps = np.diff(polygon, axis=0, append=polygon[:1])
            parts = np.maximum(np.ceil(np.abs(steps / self.sizes).max(axis=1) / step), 1.0)
            owner, number = repeated(parts.astype(np.int64))
            inner = polygon[owner] + (number / parts[owner])[:, None] * steps[owner]
            yield np.concatenate([inner, polygon[:1]])


def boxes_between(u: Array, v: Array) -> Array:
    """Return the boxes (M, 4) between neighbouring lines u = const and v = const."""
    boxes = np.empty((len(u) - 1, len(v) - 1, 4))
    boxes[:, :, 0], boxes[:, :, 2] = u[:-1, None], u[1:, None]
    boxes[:, :, 1], boxes[:, :, 3] = v[:-1], v[1:]
    return boxes.reshape(-1, 4)
