"""The hits of a search: a normal and one of its patches each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.aliases import Array, Indices
from .kernels.lists import NUMBER

__all__ = ["Hits"]


@dataclass(frozen=True, eq=False)
class Hits:
    """The hits, a normal and one of its patches each, sorted by normal and then by patch.

    `keys` (N,) are number of the normal << 32 | patch. `exact` (k,) are the numbers of the hits
    that were decided exactly, `local` (k, 5) that of `Decision`. `developable` is the number of
    patches that are developable up to the rounding of their coordinates.
    """

    keys: Indices
    exact: Indices
    local: Array
    developable: int

    @classmethod
    def none(cls, developable: int) -> Hits:
        """Return no hits."""
        return cls(np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 5)), developable)

    @classmethod
    def joined(cls, parts: Sequence[Hits]) -> Hits:
        """Return the hits of consecutive ranges of normals."""
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
        """The patch number of each hit."""
        return self.keys & NUMBER

    @cached_property
    def normal_index(self) -> Indices:
        """The number of the normal of each hit."""
        return self.keys >> 32

    def __getitem__(self, key: slice) -> Hits:
        """Return consecutive hits."""
        first, last, _ = key.indices(len(self))
        low, high = np.searchsorted(self.exact, (first, last))
        exact = self.exact[low:high] - first
        return Hits(self.keys[first:last], exact, self.local[low:high], self.developable)

    def rows(self, rows: Indices) -> Hits:
        """Return the hits with increasing indices."""
        place = np.searchsorted(rows, self.exact)
        kept = np.flatnonzero(place < len(rows))
        kept = kept[rows[place[kept]] == self.exact[kept]]
        return Hits(self.keys[rows], place[kept], self.local[kept], self.developable)

    def whole_normals(self, size: int) -> Iterator[Hits]:
        """Yield the hits in groups, at least one, of at most `size` hits or of one normal."""
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
