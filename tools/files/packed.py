"""Arrays of several types as packed rows of a binary file: a row holds what belongs together."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.threads import over_ranges, thread_count

__all__ = ["append_rows", "kept"]

# Rows that are packed at once: they fit into a cache.
_ROWS = 4096
# Rows for which a thread of its own is worth while. More than four threads wait for the disk.
FOR_A_THREAD, THREADS = 1 << 16, 4


def kept(array: NDArray[Any]) -> str:
    """Return the type that numbers have in a file: there are no booleans, no 64-bit integers."""
    return {"i8": "i4", "b1": "u1"}.get(array.dtype.str[1:], array.dtype.str[1:])


def append_rows(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Append row k of every array, (N,) or (N, d), to a file, for all k.

    Threads write to parts of the file, each packing its next rows while others write.
    """
    count, offset = len(next(iter(arrays.values()))), path.stat().st_size
    blocks = {name: _as_blocks(array) for name, array in arrays.items()}
    workers = min(thread_count(None), THREADS, 1 + count // FOR_A_THREAD)
    work = partial(_write_part, path, offset, blocks)
    for _ in over_ranges(work, count, max(1, -(-count // workers)), workers):
        pass


def _as_blocks(array: NDArray[Any]) -> NDArray[Any]:
    """Return rows whose bytes stay the same as one opaque entry each, which is copied faster."""
    if array.ndim == 1 or kept(array) != array.dtype.str[1:]:
        return array
    array = np.ascontiguousarray(array)
    return array.view(f"V{array.itemsize * array.shape[1]}")[:, 0]


def _write_part(
    path: Path, offset: int, blocks: Mapping[str, NDArray[Any]], first: int, last: int
) -> None:
    """Write the rows from `first` to `last`, of which row 0 is at `offset`."""
    row = np.dtype([(name, kept(array), array.shape[1:]) for name, array in blocks.items()])
    packed = np.empty(min(_ROWS, last - first), row)
    with open(path, "r+b") as file:
        file.seek(offset + first * row.itemsize)
        for start in range(first, last, _ROWS):
            part = packed[: last - start]
            for name, array in blocks.items():
                part[name] = array[start : start + len(part)]
            file.write(part.data)
