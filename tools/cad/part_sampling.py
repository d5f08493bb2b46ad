"""Samples of a CAD part: one target density, one greedy cover and one count for all faces."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.errors import GaussmapWarning, InputError
from ...runtime.base.memory import check_memory
from ...runtime.samples.fields import EDGE_NAMES, FLAG_NAMES
from ...runtime.samples.report import SamplingReport, count_unrefined, joined_proof
from ...runtime.samples.samples import Samples
from ..density.cover import Cover
from ..density.filling import fields_of, fill, target_of
from ..density.request import Request
from .edge_sampling import with_edges
from .part import Part
from .reached import reached
from .results import PartSpace
from .smooth_edges import each_once

Array = NDArray[np.float64]

DENSITIES = ("gauss", "balanced", "uniform")


def sample_part(
    part: Part,
    request: Request,
    fields: Sequence[str],
    dtype: DTypeLike,
    threads: int | None,
    progress: bool,
    edges: bool = False,
) -> tuple[Samples, Array]:
    """Return samples of a part, and the requested normals. Raises the exceptions of `sample`."""
    _check(request, edges)
    if request.count is not None:
        check_memory("part", request.count)
    space = reached(part, threads, target_of(request), request.reach)
    cover = fill(space, request, progress, partial(each_once, space))
    on_faces = [x for x in fields if x not in EDGE_NAMES]
    found = fields_of(cover, list(dict.fromkeys([*on_faces, *FLAG_NAMES])), dtype)
    report = _report(part, space, cover, found, request)
    if (reach := space.pieces[0].reach) is not None:
        report = replace(report, **reach._reported)
    arrays: dict[str, Any] = {name: found[name] for name in on_faces}
    if edges:
        assert isinstance(cover.space, PartSpace)
        arrays = with_edges(cover.space, cover.count, arrays, fields, dtype)
        total = len(next(iter(arrays.values())))
        report = replace(report, samples=total, edge_samples=total - cover.count)
    _warn(part, report, len(space.failed), request.angle)
    return Samples(**arrays, report=report, surface=part), cover.at_normals.normals


def samples_at(
    part: Part,
    normals: Array,
    fields: Sequence[str],
    dtype: DTypeLike,
    threads: int | None,
    progress: bool,
) -> Samples:
    """Return all points of a part that have one of the unit normals (S, 3)."""
    request = Request(normals, None, None, None, "gauss")
    return sample_part(part, request, fields, dtype, threads, progress)[0]


def _check(request: Request, edges: bool) -> None:
    """Raise InputError for a request that is not available for parts."""
    if isinstance(request.density, str) and request.density not in DENSITIES:
        raise InputError(
            f'density "{request.density}" is for surfaces; of a part use "balanced" or "uniform".'
        )
    if request.density == "gauss" and request.normals is None:
        raise InputError(
            'density "gauss" of a part goes with normals; with a count use "balanced", or a power '
            "of |K|, such as 1.0."
        )
    if edges and request.reach is not None and request.reach._from_edges is not None:
        raise InputError("samples on edges are not away from edges: leave out edges=True.")


def _report(
    part: Part, space: PartSpace, cover: Cover, arrays: Mapping[str, NDArray[Any]], request: Request
) -> SamplingReport:
    held = np.union1d(cover.added.pieces, cover.at_normals.pieces)
    return SamplingReport(
        surface=part.name,
        normals=len(cover.at_normals.normals),
        samples=cover.count,
        patches=None,
        developable_share=space.developable_share,
        developable_patches=None,
        coverage=cover.coverage,
        angle=cover.angle,
        on="surface",
        unrefined=count_unrefined(arrays),
        faces=len(part),
        empty_faces=len(part) - len(held),
        oriented=part.oriented,
        density=_density(request),
        unit=part.unit or None,
        **_proof(space, cover),
    )


def _density(request: Request) -> str | None:
    """Return the density for the report; None for "balanced"."""
    if not isinstance(request.density, str):
        return "power"
    return None if request.density == "balanced" else request.density


def _proof(space: PartSpace, cover: Cover) -> dict[str, Any]:
    """Return the report of the proof at prescribed normals: proved normals, undecided boxes."""
    given = cover.at_normals
    if not given.same_normals or not len(given.normals):
        return {}
    proof = joined_proof(len(given.normals), (x.samples.report for x in given.found))
    estimated = len(given.estimated) + len(space.failed)
    return proof | {"estimated_faces": estimated} | ({"proved": None} if estimated else {})


def _warn(part: Part, report: SamplingReport, failed: int, angle: float | None) -> None:
    """Warn of faces that failed, and of a requested angle that was not reached."""
    reasons = []
    if failed:
        reasons.append(
            f"{failed} of {len(part):,} faces cannot be sampled, and got no samples; the list of "
            "failed faces says why"
        )
    if angle is not None and report.angle is not None and report.angle > angle:
        reasons.append(
            f"some normals in narrow tips of faces are {report.angle:.3g}° from those of all "
            f"samples instead of the requested {angle:g}°; ask for a smaller angle"
        )
    for reason in reasons:
        warnings.warn(f"part {part.name!r}: {reason}.", GaussmapWarning, stacklevel=7)
