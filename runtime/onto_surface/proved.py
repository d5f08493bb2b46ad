"""Points of a surface at given normals, all of them, with a proof."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.memory import check_memory
from ..base.threads import over_ranges
from ..domain.trim import Trim, samples_inside, with_uv
from ..proof.index import CELLS, KINDS, ProvedIndex, ProvedPlaces, Undecided
from ..proof.kernels.samples import CURVATURES, SampleFields, fill_places, order_by_patch
from ..samples.fields import FLAG_NAMES, bytes_of, dtype_of, regular, row_shape
from ..samples.report import UndecidedNormal
from ..samples.samples import Samples
from ..search.search import developable_patches
from ..surface.derivatives import power_of_two
from ..surface.surface import Surface
from .newton import near_poles
from .on_spline import Fields, OnSpline
from .pole_charts import pole_charts

__all__ = ["Proof", "index_of", "proof_of", "proved_samples"]

PLACES_AT_A_TIME = 1 << 14


class Proof(NamedTuple):
    """For how many normals all points are known, and where other normals may have further ones."""

    proved: int
    undecided: tuple[UndecidedNormal, ...]


def index_of(
    surface: Surface, threads: int | None = None, cells: tuple[int, int] = CELLS
) -> ProvedIndex | None:
    """Return the index of a surface; None if its derivatives have no bounds, next to poles, too."""
    if surface.tape is None:
        return None
    index = ProvedIndex.of(surface.tape, surface.domain, surface.boundary, cells, threads)
    return index if index is not None and len(index.unbounded) == 0 else None


def proved_samples(
    geometry: OnSpline,
    index: ProvedIndex,
    normals: NDArray[np.float64],
    fields: Sequence[str],
    dtype: DTypeLike,
    density: float | None,
) -> Samples:
    """Return all points that have unit normals (S, 3), and the proof.

    They come in the order of normals, then of the patches of the spline, then of u and v.
    """
    spline, threads = geometry.spline, geometry.threads
    found = index.query(normals, threads)
    order_by_patch(found.numbers, found.places, spline.frame, spline.cells)
    check_memory("stored", len(found.numbers), bytes_of(fields, dtype))
    arrays = _arrays(geometry, index, normals, found, with_uv(spline.trim, fields))
    arrays = samples_inside(spline.trim, arrays, fields)
    kept = {x: arrays[x].astype(dtype_of(x, dtype), copy=False) for x in fields}
    developable = developable_patches(spline, threads)
    proof = proof_of(normals, found.undecided, spline.trim)._asdict()
    report = geometry.report(len(normals), density, developable, kept, unrefined=0, **proof)
    return geometry.samples(kept, report)


def _arrays(
    geometry: OnSpline,
    index: ProvedIndex,
    normals: NDArray[np.float64],
    found: ProvedPlaces,
    fields: Sequence[str],
) -> Fields:
    """Return the fields that are wanted."""
    surface, spline = geometry.surface, geometry.spline
    assert surface is not None
    numbers, places = found.numbers, found.places
    count = len(numbers)
    rooms = SampleFields(
        *(
            np.empty((count if x in fields else 0, *row_shape(x)), dtype_of(x, np.float64))
            for x in SampleFields._fields
        )
    )
    K, H = rooms.gaussian_curvature, rooms.mean_curvature
    frame, cells = spline.frame, spline.cells
    # Powers of two: then curvatures do not depend on the number of cells by their rounding.
    scales = np.array([spline.scale, power_of_two(frame[2]), power_of_two(frame[3])])
    charts = pole_charts(surface, spline)

    def work(first: int, last: int) -> None:
        with index.room() as memory:
            fill_places(
                index.tape, memory.work, numbers, places, first, last, normals, scales, frame,
                cells, np.empty(CURVATURES), rooms,
            )  # fmt: skip
        for rows, _, gaussian, mean in near_poles(charts, spline, places[first:last, :2]):
            if len(K) > 0:
                K[first + rows] = np.copysign(gaussian, places[first + rows, 4])
            if len(H) > 0:
                H[first + rows] = mean

    list(over_ranges(work, count, PLACES_AT_A_TIME, geometry.threads))
    arrays = {name: x for name, x in rooms._asdict().items() if name in fields}
    flags = {name: np.ones(count, dtype=np.bool_) for name in FLAG_NAMES}
    return arrays | flags | {"normal_index": numbers} | regular(count, fields)


def proof_of(
    normals: NDArray[np.float64], open_: Undecided, trim: Trim | None, face: int | None = None
) -> Proof:
    """Return the proof for unit normals (S, 3), of which some are open; on a face of a part."""
    if len(open_.numbers) == 0:
        return Proof(len(normals), ())
    open_ = _not_outside(trim, open_, normals)
    undecided = tuple(
        UndecidedNormal(
            number, tuple(box), KINDS[kind], border, face, None if isnan(degree) else int(degree)
        )
        for number, box, kind, border, degree, _ in zip(*(x.tolist() for x in open_), strict=True)
    )
    return Proof(len(normals) - len(np.unique(open_.numbers)), undecided)


def _not_outside(trim: Trim | None, open_: Undecided, normals: NDArray[np.float64]) -> Undecided:
    """Return the boxes that may have points inside a trim; they may meet its border, too."""
    if trim is None:
        return open_
    sides = trim.sides(open_.boxes, normals[open_.numbers])
    open_ = open_._replace(border=open_.border | (sides == 0))
    return Undecided._make(x[sides >= 0] for x in open_)
