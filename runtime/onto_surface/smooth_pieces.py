"""Surfaces of several smooth pieces: their samples at normals, and their common report."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array
from ..base.checks import pair_of_cells
from ..base.errors import InputError, SurfaceError
from ..samples.fields import FLAG_NAMES, dtype_of, new_field
from ..samples.report import SamplingReport, count_unrefined, joined_proof
from ..samples.samples import Samples
from ..search.search import developable_patches
from ..spline.nets import AnySpline
from ..surface.surface import Surface
from .at_tips import samples_at
from .on_spline import OnPatches, OnSpline, on_grids
from .on_surface import geometry_of, place_of_samples
from .proved import ProvedSurface

# The largest number of pieces: each takes 20 ms to be fitted and searched.
MOST_PIECES = 2000
FEWEST_CELLS = 4
# A piece counts as degenerate, and gets no samples, if its size is less than this times the largest
# size.
NO_SIZE = 1e-6
# Without a proof, pieces whose Gaussian images have at most this solid angle get no samples at
# prescribed normals.
LEAST_IMAGE = 1e-9
SUMS = ("patches", "apexes")
LARGEST = ("fit_distance", "fit_angle")


def pieces_to_sample(surface: object) -> tuple[Surface, ...]:
    """Return the smooth pieces of a surface; () if it has only one.

    Raises InputError for more than MOST_PIECES pieces.
    """
    pieces = surface.pieces() if isinstance(surface, Surface) else ()
    if len(pieces) > MOST_PIECES and isinstance(surface, Surface):
        raise InputError(
            f"surface {surface.name!r} has {len(pieces):,} smooth pieces between creases, "
            f"and at most {MOST_PIECES:,} are sampled as one; samples on its spline, "
            "which rounds the creases, are not limited."
        )
    return pieces if len(pieces) > 1 else ()


def geometries_of(
    surface: Surface | AnySpline, cells: Sequence[int] | None, on: str | None
) -> tuple[OnPatches, ...]:
    """Return a geometry for each piece of a surface; see `geometry_of`."""
    place_of_samples(surface, on)
    return tuple(geometry_of(x, y, on) for x, y in _with_cells(surface, cells))


def proved_or_fitted(
    surface: Surface | AnySpline, cells: Sequence[int] | None, on: str | None
) -> tuple[OnPatches | ProvedSurface, ...]:
    """Return a geometry for each piece: a `ProvedSurface` if possible, else one with its spline."""
    if place_of_samples(surface, on) == "spline":
        return geometries_of(surface, cells, on)
    return tuple(
        (ProvedSurface.of(x, y) if isinstance(x, Surface) else None) or geometry_of(x, y, on)
        for x, y in _with_cells(surface, cells)
    )


def _with_cells(
    surface: Surface | AnySpline, cells: Sequence[int] | None
) -> list[tuple[Surface | AnySpline, tuple[int, int] | None]]:
    """Return each piece of a surface with the numbers of cells of its spline, None if not given."""
    if isinstance(surface, Surface) and (pieces := pieces_to_sample(surface)):
        return [(x, cells_of_piece(surface, x, cells)) for x in pieces]
    return [(surface, None if cells is None else pair_of_cells(cells))]


def cells_of_piece(
    surface: Surface, piece: Surface, cells: Sequence[int] | None
) -> tuple[int, int] | None:
    """Return the numbers of cells (m, n) of a piece.

    They are the numbers of `cells` of the whole surface, times the share of the domain that the
    piece has along u and along v, rounded up; they are at least FEWEST_CELLS.
    """
    if cells is None:
        return None
    m, n = (
        max(math.ceil(count * (part[1] - part[0]) / (whole[1] - whole[0])), FEWEST_CELLS)
        for count, part, whole in zip(
            pair_of_cells(cells), piece.domain, surface.domain, strict=True
        )
    )
    return m, n


def with_area(geometries: Sequence[OnSpline]) -> list[tuple[int, OnSpline]]:
    """Return the geometries that have an area, with the index of the first patch of each.

    Raises SurfaceError if none has.
    """
    firsts = np.cumsum([0, *(x.spline.patches for x in geometries[:-1])]).tolist()
    sizes = np.array([_size_of(x, len(geometries) > 1) for x in geometries])
    real = sizes > NO_SIZE * sizes.max()
    if not real.any():
        label, reach = f"surface {geometries[0].spline.name!r}", geometries[0].reach
        if len(geometries) > 1 and reach is not None:
            raise SurfaceError(
                f"{label} and the other pieces have no point in reach: {reach._said()}."
            )
        raise SurfaceError(
            f"{label} has no area beyond rounding: all its points lie on one curve or are one "
            'point; only the density "gauss" takes it.'
            if len(geometries) == 1
            else f"{label} and the other pieces have no area beyond rounding, or their trim leaves "
            "nothing of them."
        )
    return [(first, x) for first, x, kept in zip(firsts, geometries, real, strict=True) if kept]


def _size_of(geometry: OnSpline, is_one_of_many: bool) -> float:
    """Return the size of a piece.

    If the trim leaves nothing of it, the size of one of several pieces is 0; for a single piece,
    SurfaceError is raised.
    """
    try:
        return geometry.size
    except SurfaceError:
        if is_one_of_many:
            return 0.0
        raise


def samples_of_pieces(
    name: str,
    surface: Surface | None,
    geometries: Sequence[OnPatches | ProvedSurface],
    normals: Array,
    fields: Sequence[str],
    dtype: np.dtype[np.floating],
    progress: bool,
) -> Samples:
    """Return all points of a surface of several pieces that have one of the unit normals (S, 3).

    `name` is the name in the report, and `surface` the attribute of the samples: None if they lie
    on splines. A piece without a proof gets no samples if the area of its Gaussian image is
    rounding error.
    """
    fitted = on_grids([x.fitted for x in geometries])
    searched: dict[OnSpline, OnPatches | ProvedSurface] = dict(zip(fitted, geometries, strict=True))
    on_surface, kept = geometries[0].on == "surface", with_area(fitted)
    reports: list[SamplingReport] = []
    wanted = list(dict.fromkeys([*fields, *(FLAG_NAMES if on_surface else ())]))
    parts, developable = [{x: new_field(x, 0, dtype_of(x, dtype)) for x in wanted}], None
    for first, geometry in kept:
        asked = searched[geometry]
        if isinstance(asked, ProvedSurface):
            own = [x for x in wanted if x != "patch_index"]
            found = samples_at(asked, normals, own, dtype, progress)
            parts.append({"patch_index": np.full(len(found), -1), **found.arrays()})
            more = developable_patches(geometry.spline, geometry.threads)
        elif float(np.abs(geometry.measure[1]).sum()) > LEAST_IMAGE:
            found = samples_at(asked, normals, wanted, dtype, progress)
            parts.append(found.arrays())
            if "patch_index" in wanted:
                parts[-1]["patch_index"] = parts[-1]["patch_index"] + first
            more = found.report.developable_patches or 0
        else:
            continue
        developable = (developable or 0) + more
        reports.append(found.report)
    arrays: dict[str, Any] = {x: np.concatenate([part[x] for part in parts]) for x in wanted}
    report = report_of(name, [x for _, x in kept], len(normals), None, developable, arrays)
    if all(isinstance(searched[x], ProvedSurface) for _, x in kept):
        report = replace(report, **joined_proof(len(normals), reports))
    elif on_surface:
        report = replace(report, undecided=tuple(y for x in reports for y in x.undecided or ()))
    return Samples(**{x: arrays[x] for x in fields}, report=report, surface=surface)


def report_of(
    name: str,
    pieces: Sequence[OnSpline],
    normals: int,
    density: float | None,
    developable: int | None,
    arrays: Mapping[str, NDArray[Any]],
) -> SamplingReport:
    """Return the report of all pieces: sums, the largest errors, and means over the area."""
    reports = [x.report(normals, density, developable, dict(arrays)) for x in pieces]
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
        on=pieces[0].on,
        unrefined=count_unrefined(arrays),
        developable_share=mean("developable_share", 1.0),
        fit_rms=mean("fit_rms", 2.0),
        **{x: sum(values(x)) for x in SUMS},
        **{x: None if None in values(x) else max(values(x)) for x in LARGEST},
    )
