"""Samples of several smooth pieces as of one surface."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.checks import pair_of_cells
from ..base.errors import InputError
from ..base.threads import shown
from ..place.on_spline import OnSpline
from ..samples.fields import GRID_NAMES
from ..samples.report import SamplingReport, count_infinite, count_unrefined
from ..samples.request import Request
from ..samples.samples import Samples
from ..surface.surface import Surface
from .law import Law

__all__ = ["cells_of_piece", "pieces_to_sample", "sample_pieces"]

Array = NDArray[np.float64]
Sampled = tuple[Samples, Array]
# Samples a piece: what it is, its own request, and the floor of the target density of all.
Sampler = Callable[[OnSpline, Request, float], Sampled]

# Each piece is fitted and searched by itself, which takes 20 ms.
MOST_PIECES = 2000
FEWEST_CELLS = 4
SUMS = ("patches", "developable_patches", "apexes")
LARGEST = ("coverage", "angle", "fit_distance", "fit_angle")


def pieces_to_sample(surface: object) -> tuple[Surface, ...]:
    """Return the pieces of a surface that has more than one, and nothing for any other.

    Raises InputError if there are too many.
    """
    pieces = surface.pieces() if isinstance(surface, Surface) else ()
    if len(pieces) > MOST_PIECES and isinstance(surface, Surface):
        raise InputError(
            f"surface {surface.name!r} has {len(pieces):,} pieces between lines where its normal "
            f"turns, and at most {MOST_PIECES:,} are sampled as one; gm.fit(surface) gives one "
            "spline, which rounds these lines."
        )
    return pieces if len(pieces) > 1 else ()


def cells_of_piece(
    surface: Surface, piece: Surface, cells: Sequence[int] | None
) -> tuple[int, int] | None:
    """Return the cells of a piece, of those of the whole: in proportion to its parameters."""
    if cells is None:
        return None
    m, n = (
        max(math.ceil(count * (part[1] - part[0]) / (whole[1] - whole[0])), FEWEST_CELLS)
        for count, part, whole in zip(
            pair_of_cells(cells), piece.domain, surface.domain, strict=True
        )
    )
    return m, n


def sample_pieces(
    surface: Surface, law: Law, sampler: Sampler, progress: bool
) -> tuple[Samples, Array]:
    """Return the samples of all pieces of a surface, in turn, and the normals that were searched.

    Patches are numbered through all pieces. Pieces without an area get no samples.
    """
    amounts = _amounts(law, sampler)
    results = (sampler(law.parts[k], x, law.floor) for k, x in amounts.items())
    parts = list(shown(results, len(amounts), progress))
    places = list(amounts)
    patches = np.cumsum([0, *(x.patches for x in law.parts)])[places]
    same_normals = law.request.normals is not None or law.request.angle is not None
    normals = [x for _, x in parts]
    firsts = np.cumsum([0, *map(len, normals)])[:-1] * (not same_normals)
    lines = _first_lines([samples for samples, _ in parts])
    arrays = _joined(
        _renumbered(samples, int(patch), int(normal), line)
        for (samples, _), patch, normal, line in zip(parts, patches, firsts, lines, strict=True)
    )
    # Pieces that are on a grid have none.
    searched = max(normals, key=len) if same_normals else np.concatenate(normals)
    reports = [samples.report for samples, _ in parts]
    report = _report(surface.name, reports, law.areas[places], len(searched), arrays)
    known = surface if report.on == "surface" else None
    return Samples(**arrays, report=report, spline=None, surface=known, offset_of=None), searched


def _amounts(law: Law, sampler: Sampler) -> dict[int, Request]:
    """Return the requests of the pieces that are to have samples, by their numbers."""
    request, real = law.request, law.areas > 0.0
    if request.count is None:
        return dict.fromkeys(np.flatnonzero(real).tolist(), request)
    least = None
    if request.coverage is not None:
        alone = replace(request, count=None, density="uniform", relax=0)
        least = np.zeros(len(real), dtype=np.int64)
        for k in np.flatnonzero(real).tolist():
            least[k] = len(sampler(law.parts[k], alone, 0.0)[0])
    counts = law.counts(request.count, least)
    return {k: replace(request, count=count) for k, count in enumerate(counts.tolist()) if count}


def _first_lines(parts: Sequence[Samples]) -> list[dict[str, int]]:
    """Return how many lines of grids there are in all pieces before each one."""
    so_far: dict[str, int] = dict.fromkeys(GRID_NAMES, 0)
    found = []
    for samples in parts:
        found.append(so_far)
        last = {name: getattr(samples, name) for name in GRID_NAMES if name in samples.fields}
        so_far = so_far | {
            name: so_far[name] + int(x.max(initial=-1)) + 1 for name, x in last.items()
        }
    return found


def _renumbered(
    samples: Samples, first_patch: int, first_normal: int, first_line: dict[str, int]
) -> dict[str, NDArray[Any]]:
    """Return the fields of a piece, with indices of patches, normals and lines of the whole."""
    found = samples.arrays()
    for name in GRID_NAMES:
        if name in found:
            found[name] = np.where(found[name] < 0, -1, found[name] + first_line[name])
    if "patch_index" in found:
        found["patch_index"] = found["patch_index"] + first_patch
    if "normal_index" in found:
        index = found["normal_index"]
        found["normal_index"] = np.where(index < 0, index, index + first_normal)
    return found


def _joined(parts: Iterable[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    rows = list(parts)
    return {name: np.concatenate([x[name] for x in rows]) for name in rows[0]}


def _report(
    name: str,
    reports: Sequence[SamplingReport],
    areas: Array,
    normals: int,
    arrays: dict[str, NDArray[Any]],
) -> SamplingReport:
    """Return the report of all pieces: sums, the largest error, and means over the area."""

    def values(field: str) -> list[Any]:
        return [getattr(x, field) for x in reports]

    def mean(field: str, power: float) -> float | None:
        if not known[field]:
            return None
        powers = np.array(values(field), dtype=np.float64) ** power
        return float((areas * powers).sum() / areas.sum()) ** (1.0 / power)

    known = {x.name: None not in values(x.name) for x in fields(SamplingReport)}
    return replace(
        reports[0],
        surface=name,
        density="aligned" if "aligned" in values("density") else None,
        normals=normals,
        samples=len(next(iter(arrays.values()))),
        developable_share=mean("developable_share", 1.0),
        fit_rms=mean("fit_rms", 2.0),
        infinite_curvatures=count_infinite(arrays),
        unrefined=count_unrefined(arrays),
        **{x: sum(values(x)) if known[x] else None for x in SUMS},
        **{x: max(values(x)) if known[x] else None for x in LARGEST},
    )
