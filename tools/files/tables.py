"""Text with a line for each sample: .csv and .xyz."""

import re
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.extras import if_installed
from ...runtime.samples.fields import columns_of
from ...runtime.samples.samples import Samples
from .lengths import names_with_units
from .of_faces import columns_of_faces, texts_of
from .of_terrain import columns_of_terrain

# The formats of numbers, with enough digits to read the same number again.
_DIGITS = {"i8": "%d", "u1": "%d", "f4": "%.9g", "f8": "%r", "O": "%s"}
_ROWS = 4096
# The least number of rows for which importing Polars saves time, and the number of rows that it
# writes at once.
WORTH_AN_IMPORT, ROWS_OF_POLARS = 20_000, 1 << 18


def write_csv(samples: Samples, path: Path) -> None:
    """Write a line of names, with known units of length, then a line for each sample."""
    columns, names = [*columns_of(samples.arrays()).values()], names_with_units(samples)
    for name, column in columns_of_terrain(samples).items():
        columns.append(column)
        names.append(f"{name} [deg]")
    for x in columns_of_faces(samples):
        columns.append(texts_of(x, samples))
        names.append(f"{x.name} [{x.unit}]" if x.unit else x.name)
    with open(path, "wb") as file:
        file.write((",".join(names) + "\n").encode("ascii"))
        write_rows(file, ",".join(["{}"] * len(columns)) + "\n", columns)


def write_xyz(samples: Samples, path: Path) -> None:
    """Write a line `x y z nx ny nz` for each sample."""
    with open(path, "wb") as file:
        write_rows(file, "{} {} {} {} {} {}\n", [*samples.points.T, *samples.normals.T])


def write_rows(file: BinaryIO, line: str, columns: Sequence[NDArray[Any]]) -> None:
    """Write `line` once for each row, with the row's values of the columns in place of each {}.

    The words of a line are separated by spaces or by commas. If there are many rows and Polars is
    installed, Polars writes them, ten times as fast as Python, with as few digits as are needed to
    read the same numbers again.
    """
    columns = [column.view(np.uint8) if column.dtype == np.bool_ else column for column in columns]
    polars = if_installed("polars") if len(columns[0]) >= WORTH_AN_IMPORT else None
    if polars is None:
        file.writelines(_formatted(line, columns))
        return
    separator = "," if "," in line else " "
    words = line.rstrip("\n").split(separator)
    for start in range(0, len(columns[0]), ROWS_OF_POLARS):
        block = [column[start : start + ROWS_OF_POLARS] for column in columns]
        table = _table(polars, words, block)
        table.write_csv(file, include_header=False, separator=separator, quote_style="never")


def _formatted(line: str, columns: Sequence[NDArray[Any]]) -> Iterator[bytes]:
    pattern = line.format(*(_DIGITS[column.dtype.str[1:]] for column in columns))
    for start in range(0, len(columns[0]), _ROWS):
        block = [column[start : start + _ROWS].tolist() for column in columns]
        numbers = tuple(chain.from_iterable(zip(*block, strict=True)))
        yield (pattern * len(block[0]) % numbers).encode()


def _table(polars: Any, words: Sequence[str], columns: Sequence[NDArray[Any]]) -> Any:  # noqa: ANN401
    """Return a Polars table with a column for each word: a format, filled from `columns`."""
    waiting = iter(f"n{k}" for k in range(len(columns)))
    numbers = {
        f"n{k}": x.tolist() if x.dtype == object else np.ascontiguousarray(x)
        for k, x in enumerate(columns)
    }
    expressions = []
    for k, word in enumerate(words):
        names = [next(waiting) for _ in re.findall(r"{}", word)]
        text = polars.col(names[0]) if word == "{}" else polars.format(word, *names)
        expressions.append(text.alias(f"w{k}"))
    return polars.DataFrame(numbers).select(expressions)
