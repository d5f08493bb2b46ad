"""The hits of a search, which are pairs of a normal and a patch, and the samples at these hits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.aliases import Array, Indices
from ..base.threads import over_ranges
from ..samples.fields import ARRAY_NAMES, FLOAT_NAMES, INDEX_NAMES, Component, new_field, regular
from ..spline.nets import AnySpline, NetSpline
from ..spline.spline import Spline
from .in_nets import fields_in_nets
from .kernels.hits import fill_known, fill_samples, new_tile
from .kernels.lists import NUMBER

SAMPLES_AT_A_TIME = 1 << 16
# Columns of `Hits.local`: the sign of K, or the index of a component, and its kind.
SIGN, KIND = 2, 5


@dataclass(frozen=True, eq=False)
class Hits:
    """Pairs of a normal and a patch that has it, sorted by normal and then by patch.

    `keys` (N,) are (index of the normal) << 32 | index of the patch. `exact` (k,) are the positions
    in `keys` of the hits that were decided by exact arithmetic, and `local` (k, 6) are the columns
    of `Decision` for these hits. `developable` is the number of all patches of the spline that are
    developable up to the rounding of their coordinates.
    """

    keys: Indices
    exact: Indices
    local: Array
    developable: int

    @classmethod
    def none(cls, developable: int) -> Hits:
        """Return an empty set of hits."""
        return cls(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 6)), developable)

    @classmethod
    def joined(cls, parts: Sequence[Hits]) -> Hits:
        """Return the hits of all parts, which belong to consecutive ranges of normals."""
        if len(parts) == 1:
            return parts[0]
        starts = np.cumsum([0, *(len(part) for part in parts[:-1])])
        return cls(
            np.concatenate([part.keys for part in parts]),
            np.concatenate([x.exact + start for x, start in zip(parts, starts, strict=True)]),
            np.concatenate([part.local for part in parts]),
            parts[0].developable,
        )

    def __len__(self) -> int:
        """Return the number of hits."""
        return len(self.keys)

    @cached_property
    def patch_index(self) -> Indices:
        """The index of the patch of each hit."""
        return self.keys & NUMBER

    @cached_property
    def normal_index(self) -> Indices:
        """The index of the normal of each hit."""
        return self.keys >> 32

    @property
    def special(self) -> Indices:
        """The indices of hits that stand for other components than regular points."""
        return self.exact[self.local[:, KIND] != Component.REGULAR]

    def __getitem__(self, key: slice) -> Hits:
        """Return the hits with the indices of a slice with step 1."""
        first, last, _ = key.indices(len(self))
        low, high = np.searchsorted(self.exact, (first, last))
        exact = self.exact[low:high] - first
        return Hits(self.keys[first:last], exact, self.local[low:high], self.developable)

    def rows(self, rows: Indices) -> Hits:
        """Return the hits with the given increasing indices."""
        place = np.searchsorted(rows, self.exact)
        kept = np.flatnonzero(place < len(rows))
        kept = kept[rows[place[kept]] == self.exact[kept]]
        return Hits(self.keys[rows], place[kept], self.local[kept], self.developable)

    def merged(self, others: Hits) -> Hits:
        """Return these hits together with others; no pair is in both."""
        order = np.argsort(np.concatenate([self.keys, others.keys]), kind="stable")
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        exact = place[np.concatenate([self.exact, len(self) + others.exact])]
        in_turn = np.argsort(exact)
        local = np.concatenate([self.local, others.local])[in_turn]
        keys = np.concatenate([self.keys, others.keys])[order]
        return Hits(keys, exact[in_turn], local, self.developable)

    def whole_normals(self, size: int) -> Iterator[Hits]:
        """Yield groups of at most `size` hits; all hits of a normal are in the same group.

        A normal with more than `size` hits is a group. Without hits, one empty group is yielded.
        """
        first = 0
        while True:
            last = len(self)
            if last - first > size:
                number = max(self.keys[first + size] >> 32, (self.keys[first] >> 32) + 1)
                last = int(np.searchsorted(self.keys, number << 32))
            yield self[first:last]
            if last == len(self):
                return
            first = last


def fill(
    spline: AnySpline,
    normals: Array,
    hits: Hits,
    threads: int | None = None,
    fields: Sequence[str] = ARRAY_NAMES,
    dtype: DTypeLike = np.float64,
    memory: Mapping[str, NDArray[Any]] = MappingProxyType({}),
) -> dict[str, NDArray[Any]]:
    """Return the requested fields of the samples at hits; `normals` (S, 3) are those of the search.

    Floating-point fields have the type `dtype`. A field of a spline on a grid is written into the
    array of the same name in `memory` if that array fits; other fields are new arrays.
    """
    if isinstance(spline, NetSpline):
        known = {"normal_index": hits.normal_index, "patch_index": hits.patch_index}
        patches, asked = hits.patch_index, normals[hits.normal_index]
        found = fields_in_nets(spline, patches, asked, hits.exact, hits.local, fields, dtype)
        found |= {name: x for name, x in known.items() if name in fields}
        return without_curvature(found, hits)
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
    return without_curvature(filled, hits)


def kinds_of(
    hits: Hits,
    fields: Sequence[str],
    memory: Mapping[str, NDArray[Any]] = MappingProxyType({}),
) -> dict[str, NDArray[Any]]:
    """Return {"component": the kinds of components of hits}, or {} if it is not in `fields`."""
    found = regular(len(hits), fields, memory)
    for kinds in found.values():
        kinds[hits.exact] = hits.local[:, KIND]
    return found


def without_curvature(fields: dict[str, NDArray[Any]], hits: Hits) -> dict[str, NDArray[Any]]:
    """Return the fields with K set to ±0, its sign kept, where components are not regular points.

    The arrays of `fields` are changed.
    """
    if "gaussian_curvature" in fields:
        fields["gaussian_curvature"][hits.special] *= 0.0
    return fields


def fill_hits(
    spline: Spline,
    normals: Array,
    keys: NDArray[np.int64],
    first: int,
    last: int,
    arrays: Sequence[NDArray[Any]],
) -> None:
    """Write the samples at the hits keys[first:last] to the rows [first, last) of `arrays`.

    There is an array for each of FLOAT_NAMES, then for each of INDEX_NAMES; that of a field that
    was not requested is empty.
    """
    fill_samples(
        spline.coefficients, spline.scale, normals, spline.frame, keys, first, last,
        *new_tile(), *arrays,
    )  # fmt: skip
