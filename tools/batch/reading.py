"""Reading the files of a data set: manifests, and the samples of one part."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import FileError
from ...runtime.base.extras import from_extra
from ...runtime.samples.fields import COLUMNS, row_shape
from .layout import MANIFEST, POINTS, shard_path, shards_in
from .manifest import ManifestRow, manifest_schema, rows_of

__all__ = [
    "arrays_in",
    "count_parts",
    "manifest_of",
    "opened",
    "row_of",
    "rows_of_part",
    "stacked",
]


def manifest_of(folder: Path, columns: Sequence[str] | None) -> Any:  # noqa: ANN401
    """Return the rows of all finished shards as a table of Arrow, in order."""
    arrow = from_extra("pyarrow", "batch", "a data set")
    schema = manifest_schema()
    if columns is not None:
        schema = arrow.schema([schema.field(name) for name in columns])
    tables = [schema.empty_table()]
    for number in shards_in(folder):
        with opened(shard_path(folder, MANIFEST, number)) as file:
            tables.append(file.read(columns=schema.names, use_threads=False).cast(schema))
    return arrow.concat_tables(tables).combine_chunks()


def count_parts(folder: Path) -> int:
    """Return the number of parts of all finished shards."""
    count = 0
    for number in shards_in(folder):
        with opened(shard_path(folder, MANIFEST, number)) as file:
            count += file.metadata.num_rows
    return count


def row_of(folder: Path, number: int, part: int) -> ManifestRow | None:
    """Return the row of a part in a shard; None if there is none."""
    path = shard_path(folder, MANIFEST, number)
    if not path.exists():
        return None
    with opened(path) as file:
        rows = rows_of(file.read(use_threads=False))
    return next((row for row in rows if row.part == part), None)


def rows_of_part(folder: Path, number: int, row: ManifestRow) -> Any:  # noqa: ANN401
    """Return the table of the samples of a part; FileError unless all of them are there."""
    path = shard_path(folder, POINTS, number)
    with opened(path) as file:
        groups = [k for k in range(file.metadata.num_row_groups) if _may_hold(file, k, row.part)]
        table = file.read_row_groups(groups, use_threads=False)
    table = table.filter(np.asarray(table["part"]) == row.part)
    if len(table) != row.samples:
        raise FileError(f"'{path}' does not belong to its manifest; run the same sampling again.")
    return table


def _may_hold(file: Any, group: int, part: int) -> bool:  # noqa: ANN401
    known = file.metadata.row_group(group).column(0).statistics
    return known is None or not known.has_min_max or known.min <= part <= known.max


def arrays_in(table: Any, names: Sequence[str]) -> dict[str, list[NDArray[Any]]]:  # noqa: ANN401
    """Return the columns of fields; what is null is NaN, −1 or False."""
    return {
        name: [_filled(table[column]) for column in COLUMNS[name]]
        for name in names
    }  # fmt: skip


def _filled(column: Any) -> NDArray[Any]:  # noqa: ANN401
    arrow = from_extra("pyarrow", "batch", "a data set")
    if column.null_count:
        kind = column.type.to_pandas_dtype()
        empty = np.nan if arrow.types.is_floating(column.type) else kind(-1)
        if arrow.types.is_boolean(column.type):
            empty = False
        column = column.fill_null(empty)
    return column.to_numpy()


def stacked(columns: Sequence[NDArray[Any]], name: str) -> NDArray[Any]:
    """Return the columns of a field as its array, which is writable and has its own memory."""
    if row_shape(name):
        return np.stack(columns, axis=1)
    return np.array(columns[0])


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Yield an open Parquet file; FileError if it cannot be read."""
    parquet = from_extra("pyarrow.parquet", "batch", "a data set")
    try:
        with parquet.ParquetFile(path) as file:
            yield file
    except FileError:
        raise
    except (OSError, ValueError) as error:  # ArrowInvalid is a ValueError
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileError(
            f"'{path}' cannot be read: {reason}; run the same sampling again, which replaces it."
        ) from error
