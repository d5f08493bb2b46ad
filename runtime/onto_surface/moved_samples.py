"""Samples at given normals: found on a spline, then moved to its surface."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.aliases import Array, Flags, Indices
from ..base.memory import check_memory
from ..samples.fields import FLAG_NAMES, bytes_of, dtype_of
from ..samples.report import UndecidedNormal
from ..search.hits import fill, kinds_of, without_curvature
from ..search.search import Hits
from ..spline.spline import Spline
from ..surface.surface import Surface
from .kernels.refine import FOUND, Target
from .newton import refine
from .on_spline import Fields, FieldsOfSamples

# The fields that are computed for samples to be moved; other fields are computed from these.
NEEDED = (
    *("points", "normals", "uv", "gaussian_curvature", "mean_curvature"),
    *("normal_index", "patch_index"),
)


def moved_samples(
    surface: Surface, spline: Spline, normals: Array, hits: Hits, threads: int | None
) -> Fields:
    """Return the samples at hits, moved to the surface where Newton's method succeeds.

    The samples have all fields but the support, in float64.
    """
    check_memory("stored", len(hits), bytes_of(NEEDED, np.float64))
    arrays = fill(spline, normals, hits, threads, NEEDED, np.float64)
    signs = np.copysign(1.0, arrays["gaussian_curvature"])
    states = np.empty(len(signs), dtype=np.int8)
    target = Target(
        arrays["normals"], signs, arrays["uv"], arrays["points"],
        arrays["gaussian_curvature"], arrays["mean_curvature"], states,
    )  # fmt: skip
    refine(surface, spline, target, threads)
    arrays = without_curvature(arrays, hits)
    return arrays | kinds_of(hits, ("component",)) | {FLAG_NAMES[0]: states == FOUND}


def unmoved(spline: Spline, numbers: Indices, uv: Array) -> tuple[UndecidedNormal, ...]:
    """Return an undecided box for each normal with points of a spline that could not be moved.

    `uv` (k, 2) are the parameters of these points, `numbers` (k,) the indices of their normals, in
    increasing order. A box contains all these points of its normal, with one cell around each.
    """
    if len(numbers) == 0:
        return ()
    low, high = np.array(spline.domain).T
    starts = np.flatnonzero(np.diff(numbers, prepend=-1))
    least = np.maximum(np.minimum.reduceat(uv, starts) - spline.frame[2:], low)
    most = np.minimum(np.maximum.reduceat(uv, starts) + spline.frame[2:], high)
    open_ = np.array([[x == "open" for x in ends] for ends in spline.boundary])
    at_ends = np.stack([least <= low, most >= high], axis=2) & open_
    border: Flags = np.any(at_ends, axis=(1, 2)) | np.bool_(spline.trim is not None)
    boxes = np.stack([least, most], axis=2).reshape(-1, 4)
    rows = zip(numbers[starts].tolist(), boxes.tolist(), border.tolist(), strict=True)
    return tuple(UndecidedNormal(k, tuple(box), "unmoved", x) for k, box, x in rows)


def part_of(arrays: Fields, kept: NDArray[np.bool_]) -> Fields:
    """Return the fields of the samples for which the mask `kept` is True."""
    return arrays if kept.all() else {name: array[kept] for name, array in arrays.items()}


def as_fields(arrays: Fields, fields: Sequence[str], dtype: DTypeLike) -> FieldsOfSamples:
    """Return the requested fields of samples that have all fields except the support."""
    unrefined = int(np.count_nonzero(~arrays[FLAG_NAMES[0]]))
    if "support" in fields:
        support = np.einsum("ij,ij->i", arrays["points"], arrays["normals"])
        arrays = arrays | {"support": support}
    kept = {x: arrays[x].astype(dtype_of(x, dtype), copy=False) for x in fields}
    return FieldsOfSamples(kept, unrefined)
