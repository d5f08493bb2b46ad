"""Surfaces of several smooth pieces: the sampled pieces, and their common report."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.checks import pair_of_cells
from ..base.errors import InputError
from ..onto_surface.on_spline import OnSpline
from ..onto_surface.on_surface import geometry_of, place_of_samples
from ..samples.report import SamplingReport, count_unrefined
from ..spline.spline import Spline
from ..surface.surface import Surface
from ..surface.surfaces import named
from .at_normals import Given
from .surface_piece import SurfacePiece

__all__ = ["cells_of_piece", "geometries_of", "kept_geometries", "pieces_to_sample", "report_of"]


# Each piece is fitted and searched by itself, which takes 20 ms.
MOST_PIECES = 2000
FEWEST_CELLS = 4
# The number of surfaces whose splines and indices are cached; these take some MB each.
KEPT = 8
SUMS = ("patches", "apexes")
LARGEST = ("fit_distance", "fit_angle")


def pieces_to_sample(surface: object) -> tuple[Surface, ...]:
    """Return the pieces of a surface that has more than one, and () for any other.

    Raises InputError if there are too many.
    """
    pieces = surface.pieces() if isinstance(surface, Surface) else ()
    if len(pieces) > MOST_PIECES and isinstance(surface, Surface):
        raise InputError(
            f"surface {surface.name!r} has {len(pieces):,} smooth pieces between creases, "
            f"and at most {MOST_PIECES:,} are sampled as one; gm.fit(surface) gives one "
            "spline, which rounds the creases."
        )
    return pieces if len(pieces) > 1 else ()


def geometries_of(
    surface: Surface | Spline | str,
    cells: Sequence[int] | None,
    on: str | None,
    indexed: bool = False,
) -> tuple[OnSpline, ...]:
    """Return a geometry for each piece of a surface; see `geometry_of`."""
    surface = named(surface)
    place_of_samples(surface, on)
    if isinstance(surface, Surface) and (pieces := pieces_to_sample(surface)):
        return tuple(geometry_of(x, cells_of_piece(surface, x, cells), on, indexed) for x in pieces)
    return (geometry_of(surface, cells, on, indexed),)


def kept_geometries(
    surface: Surface | Spline | str, cells: Sequence[int] | None, on: str | None
) -> tuple[OnSpline, ...]:
    """Return the geometries of `geometries_of`, indexed, cached for the last few surfaces."""
    if not isinstance(surface, Surface | Spline | str):
        return geometries_of(surface, cells, on)  # raises
    return _kept(surface, None if cells is None else pair_of_cells(cells), on)


@lru_cache(KEPT)
def _kept(
    surface: Surface | Spline | str, cells: tuple[int, int] | None, on: str | None
) -> tuple[OnSpline, ...]:
    return geometries_of(surface, cells, on, indexed=True)


def cells_of_piece(
    surface: Surface, piece: Surface, cells: Sequence[int] | None
) -> tuple[int, int] | None:
    """Return the cells of a piece, in proportion to its part of the domain of the whole surface."""
    if cells is None:
        return None
    m, n = (
        max(math.ceil(count * (part[1] - part[0]) / (whole[1] - whole[0])), FEWEST_CELLS)
        for count, part, whole in zip(
            pair_of_cells(cells), piece.domain, surface.domain, strict=True
        )
    )
    return m, n


def report_of(
    name: str,
    pieces: Sequence[SurfacePiece],
    given: Given,
    arrays: Mapping[str, NDArray[Any]],
) -> SamplingReport:
    """Return the report of all pieces: sums, the largest errors, and means over the area."""
    known = len(given.normals), given.density, given.developable, dict(arrays)
    reports = [x.geometry.report(*known) for x in pieces]
    sizes = np.array([x.size for x in pieces])
    areas = (sizes / sizes.max()) ** 2

    def values(field: str) -> list[Any]:
        return [getattr(x, field) for x in reports]

    def mean(field: str, power: float) -> float | None:
        if None in values(field):
            return None
        found = np.array(values(field), dtype=np.float64)
        largest = float(found.max()) or 1.0
        powers = areas / areas.sum() * (found / largest) ** power
        return largest * float(powers.sum()) ** (1.0 / power)

    return replace(
        reports[0],
        surface=name,
        on=pieces[0].geometry.on,
        unrefined=count_unrefined(arrays),
        developable_share=mean("developable_share", 1.0),
        fit_rms=mean("fit_rms", 2.0),
        **{x: sum(values(x)) for x in SUMS},
        **{x: None if None in values(x) else max(values(x)) for x in LARGEST},
    )
