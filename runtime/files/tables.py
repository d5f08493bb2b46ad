"""Text with a line for each sample: .csv and .xyz."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from ..fields import columns_of
from ..samples import Samples

__all__ = ["write_csv", "write_rows", "write_xyz"]

# As many digits as it takes to read the same numbers again.
_DIGITS = {"i8": "%d", "u1": "%d", "f4": "%.9g", "f8": "%.17g"}
_ROWS = 4096


def write_csv(samples: Samples, path: Path) -> None:
    """Write a line of names, and one for each sample."""
    columns = columns_of(samples.arrays())
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(",".join(columns) + "\n")
        write_rows(file, ",".join(["{}"] * len(columns)) + "\n", list(columns.values()))


def write_xyz(samples: Samples, path: Path) -> None:
    """Write lines `x y z nx ny nz`."""
    with open(path, "w", encoding="ascii", newline="\n") as file:
        write_rows(file, "{} {} {} {} {} {}\n", [*samples.points.T, *samples.normals.T])


def write_rows(file: TextIO, line: str, columns: Sequence[NDArray[Any]]) -> None:
    """Write columns as lines, in which their numbers take the places of the braces."""
    columns = [column.view(np.uint8) if column.dtype == np.bool_ else column for column in columns]
    pattern = line.format(*(_DIGITS[column.dtype.str[1:]] for column in columns))
    for start in range(0, len(columns[0]), _ROWS):
        block = [column[start : start + _ROWS].tolist() for column in columns]
        numbers = tuple(chain.from_iterable(zip(*block, strict=True)))
        file.write(pattern * len(block[0]) % numbers)
