"""The fields of samples at hits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.aliases import Array
from ..base.threads import over_ranges
from ..samples.fields import ARRAY_NAMES, FLOAT_NAMES, INDEX_NAMES, new_field
from ..spline.nets import AnySpline, NetSpline
from ..spline.spline import Spline
from .hits import Hits
from .in_nets import fields_in_nets
from .kernels.fill import fill_samples
from .kernels.tile import fill_known, new_tile

__all__ = ["fill", "fill_hits"]

SAMPLES_AT_A_TIME = 1 << 16


def fill(
    spline: AnySpline,
    normals: Array,
    hits: Hits,
    threads: int | None = None,
    fields: Sequence[str] = ARRAY_NAMES,
    dtype: DTypeLike = np.float64,
    memory: Mapping[str, NDArray[Any]] = MappingProxyType({}),
) -> dict[str, NDArray[Any]]:
    """Return fields of samples at hits of normals (S, 3), see `Samples`; floats become `dtype`.

    They are written to the fields in `memory` that are large enough.
    """
    if isinstance(spline, NetSpline):
        known = {"normal_index": hits.normal_index, "patch_index": hits.patch_index}
        patches, asked = hits.patch_index, normals[hits.normal_index]
        found = fields_in_nets(spline, patches, asked, hits.exact, hits.local, fields, dtype)
        return found | {name: x for name, x in known.items() if name in fields}
    types = dict.fromkeys(FLOAT_NAMES, dtype) | dict.fromkeys(INDEX_NAMES, np.int64)
    filled = {x: new_field(x, len(hits), types[x], memory) for x in ARRAY_NAMES if x in fields}
    arrays = [filled[x] if x in filled else new_field(x, 0, types[x]) for x in types]

    def work(first: int, last: int) -> None:
        fill_hits(spline, normals, hits.keys, first, last, arrays)

    list(over_ranges(work, len(hits), SAMPLES_AT_A_TIME, threads))
    if len(hits.exact) and any(name in filled for name in FLOAT_NAMES):
        fill_known(
            spline.coefficients, spline.scale, normals, spline.frame,
            hits.exact, hits.keys[hits.exact], hits.local, *arrays[: len(FLOAT_NAMES)],
        )  # fmt: skip
    return filled


def fill_hits(
    spline: Spline,
    normals: Array,
    keys: NDArray[np.int64],
    first: int,
    last: int,
    arrays: Sequence[NDArray[Any]],
) -> None:
    """Fill the rows first, …, last − 1 of arrays with the samples of keys, see `Hits`.

    The arrays are in the order of FLOAT_NAMES and INDEX_NAMES; absent fields are empty.
    """
    fill_samples(
        spline.coefficients, spline.scale, normals, spline.frame, keys, first, last,
        *new_tile(), *arrays,
    )  # fmt: skip
