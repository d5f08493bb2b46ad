"""Samples at prescribed normals, including tips and points of creases that have these normals."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from ..base.aliases import Array, Indices
from ..directions.regions import Reach
from ..samples.fields import COLUMNS, Component, dtype_of
from ..samples.report import UndecidedNormal, count_infinite, joined_proof
from ..samples.samples import Samples
from .at_creases import Creases, OnCreases
from .on_spline import Fields, OnPatches, OnSpline, in_turn
from .proved import ProvedSurface
from .tip_degrees import Pinch, Tip, tips_on

Geometry = OnPatches | ProvedSurface


def samples_at(
    geometry: Geometry,
    normals: Array,
    fields: Sequence[str],
    dtype: DTypeLike,
    progress: bool = False,
    density: float | None = None,
) -> Samples:
    """Return all points that have one of the unit normals (S, 3), sorted by normal.

    A tip counts as a point with each of the normals in its normal cone. For each normal, tips are
    the last samples.
    """
    at_tips = _at_tips(geometry, normals)
    if not at_tips:
        return geometry.samples_at(normals, fields, dtype, progress, density)
    return _with_tips(geometry, at_tips, normals, fields, dtype, progress, density)


def samples_in_turn(
    geometry: Geometry,
    normals: Array,
    fields: Sequence[str],
    dtype: DTypeLike,
    size: int,
    progress: bool,
    density: float,
) -> Iterator[Samples]:
    """Yield the samples of `samples_at` in parts of at most `size` samples."""
    at_tips = _at_tips(geometry, normals)
    if not at_tips:
        return geometry.samples_in_turn(normals, fields, dtype, size, progress, density)
    found = _with_tips(geometry, at_tips, normals, fields, dtype, progress, density)
    return in_turn(geometry.with_fit(found, density), size)


def _with_tips(
    geometry: Geometry, at_tips: Sequence[tuple[Tip | Pinch, Indices]], normals: Array,
    fields: Sequence[str], dtype: DTypeLike, progress: bool, density: float | None,
) -> Samples:  # fmt: skip
    """Return the samples at unit normals (S, 3), including those at the given tips."""
    wanted = list(dict.fromkeys([*fields, "normal_index"]))
    found = geometry.samples_at(normals, wanted, dtype, progress, density)
    more = [_fields(geometry, *x, normals, wanted, dtype) for x in at_tips]
    return _joined(found, more, fields, dtype)


def with_creases(
    found: Samples, creases: Creases, normals: Array, fields: Sequence[str], dtype: DTypeLike,
    reach: Reach | None,
) -> Samples:  # fmt: skip
    """Return the samples `found` and the points of creases that have one of the unit normals.

    For each normal, points of creases are the last samples. The samples `found` must have the
    fields `component`, `points`, `uv_radius` and `normal_index`; the result has `fields`, with the
    given dtype. Corners of creases with an unknown index become undecided boxes of the report.
    """
    at = creases.besides(found, normals)
    if reach is not None:
        at = OnCreases._make(x[reach._holds(at.points, normals[at.numbers])] for x in at)
    open_ = np.isnan(at.degrees)
    left = _corners(OnCreases._make(x[open_] for x in at))
    at = OnCreases._make(x[~open_] for x in at)
    more = {
        "points": at.points, "uv": at.uv, "uv_radius": at.radius, "patch_index": -1,
        "component": Component.CREASE,
    }  # fmt: skip
    rows = _special(more, at.numbers, normals, list(found.arrays()), dtype)
    return _joined(found, [rows], fields, dtype, left)


def _corners(at: OnCreases) -> list[UndecidedNormal]:
    """Return an undecided box for each of the given corners."""
    low, high = (at.uv - at.radius).tolist(), (at.uv + at.radius).tolist()
    return [
        UndecidedNormal(number, (u0, u1, v0, v1), "open", False)
        for number, (u0, v0), (u1, v1) in zip(at.numbers.tolist(), low, high, strict=True)
    ]


def _joined(
    found: Samples, more: Sequence[Fields], fields: Sequence[str], dtype: DTypeLike,
    left: Sequence[UndecidedNormal] = (),
) -> Samples:  # fmt: skip
    """Return the samples `found` and those of `more` together, sorted by normal, with `fields`.

    The boxes `left` are added to the undecided ones of the report.
    """
    parts = [found.arrays(), *more]
    index = np.concatenate([x["normal_index"] for x in parts])
    order = np.argsort(index, kind="stable")
    arrays = {
        x: np.concatenate([y[x] for y in parts])[order].astype(dtype_of(x, dtype), copy=False)
        for x in fields
    }
    report = replace(found.report, samples=len(order), infinite_curvatures=count_infinite(arrays))
    if left:
        report = replace(report, undecided=(*(report.undecided or ()), *left))
        report = replace(report, **joined_proof(report.normals or 0, [report]))
    return Samples(
        **arrays, report=report, spline=found.spline, surface=found.surface, offset_of=None
    )


def _at_tips(geometry: Geometry, normals: Array) -> list[tuple[Tip | Pinch, Indices]]:
    """Return each tip that has some of the normals (S, 3), with the indices of these normals."""
    tips = [(x, x.degrees(normals) != 0) for x in tips_on(geometry)]
    if geometry.reach is not None:
        tips = [
            (x, has & geometry.reach._holds(x.point + 0.0 * normals, normals)) for x, has in tips
        ]
    return [(x, np.flatnonzero(has)) for x, has in tips if has.any()]


def _fields(
    geometry: Geometry, tip: Tip | Pinch, numbers: Indices, normals: Array,
    fields: Sequence[str], dtype: DTypeLike,
) -> Fields:  # fmt: skip
    """Return fields of the samples at a tip: one for each normal with an index in `numbers`."""
    there: Mapping[str, Any] = {"patch_index": tip.patch} if isinstance(tip, Tip) else {}
    if isinstance(geometry, OnSpline):
        there = geometry.at_parameters(
            tip.uv[None], normals[numbers[:1]], np.zeros(1), ("patch_index",), dtype
        )
    known = there | {"points": tip.point, "uv": tip.uv, "component": Component.TIP}
    return _special(known, numbers, normals, fields, dtype)


def _special(
    known: Mapping[str, Any], numbers: Indices, normals: Array, fields: Sequence[str],
    dtype: DTypeLike,
) -> Fields:  # fmt: skip
    """Return fields of samples that are not regular points; those not in `known` are 0.

    There is a sample for each normal with an index in `numbers`.
    """
    given = normals[numbers]
    own = {
        "normals": given,
        "support": np.einsum("...x,...x->...", given, known["points"]),
        "normal_index": numbers,
        "on_surface": True,
        **known,
    }
    shapes = {x: (len(numbers), len(COLUMNS[x]))[: 1 + (len(COLUMNS[x]) > 1)] for x in fields}
    return {
        x: np.broadcast_to(own.get(x, 0.0), shapes[x]).astype(dtype_of(x, dtype)) for x in fields
    }
