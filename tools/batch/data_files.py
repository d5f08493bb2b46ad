"""The samples of parts as tables of Arrow, and reading the Parquet files of a data set."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import FileError
from ...runtime.base.extras import from_extra
from ...runtime.samples.fields import (
    ARRAY_NAMES,
    ARRAY_NAMES_OF_PART,
    COLUMNS,
    UNITS,
    columns_of,
    dtype_of,
    row_shape,
)
from .folder import MANIFEST, Settings, shard_path
from .manifest import manifest_schema

if TYPE_CHECKING:  # which brings Numba; reading a data set does without
    from ...runtime.samples.samples import Samples

__all__ = [
    "ALWAYS",
    "REMEDY",
    "arrays_in",
    "opened",
    "points_schema",
    "points_table",
    "rows_of_parts",
    "stacked",
]

LONGEST_REASON = 100
REMEDY = "remove it, and run the same sampling again"
# The fields that all samples have if they were asked for, of surfaces and of CAD parts.
ALWAYS = tuple(name for name in ARRAY_NAMES if name in ARRAY_NAMES_OF_PART)


def points_schema(settings: Settings) -> Any:  # noqa: ANN401
    """Return the schema: the number of the part, and a column for each number of a sample.

    Only what some parts have and others have not may be null: the face of a sample, for example.
    """
    arrow = from_extra("pyarrow", "batch", "a data set")
    columns = [
        arrow.field(
            column,
            arrow.from_numpy_dtype(dtype_of(name, settings.dtype)),
            nullable=name not in ALWAYS,
        ).with_metadata({"field": name} | ({"unit": UNITS[name]} if name in UNITS else {}))
        for name in settings.fields
        for column in COLUMNS[name]
    ]
    part = arrow.field("part", arrow.int64(), nullable=False)
    about = {"gaussmap": settings.gaussmap, "formulas": settings.formulas}
    return arrow.schema([part, *columns], metadata=about)


def points_table(samples: Samples, part: int, schema: Any) -> Any:  # noqa: ANN401
    """Return the samples of a part; what they lack is null."""
    arrow = from_extra("pyarrow", "batch", "a data set")
    held = columns_of(samples.arrays())
    count = len(samples)
    arrays = [arrow.array(np.full(count, part, dtype=np.int64))]
    for field in list(schema)[1:]:
        column = held.get(field.name)
        if column is None:
            arrays.append(arrow.nulls(count, field.type))
        else:
            arrays.append(arrow.array(np.ascontiguousarray(column), type=field.type))
    return arrow.table(arrays, schema=schema)


def rows_of_parts(file: Any, parts: Sequence[int]) -> Any:  # noqa: ANN401
    """Return the table of the samples of parts, which lie between the first and the last one."""
    groups = [
        group
        for group in range(file.metadata.num_row_groups)
        if (known := _range_of(file, group)) is None
        or (known[0] <= max(parts) and min(parts) <= known[1])
    ]
    table = file.read_row_groups(groups, use_threads=False)
    return table.filter(np.isin(table["part"], parts))


def _range_of(file: Any, group: int) -> tuple[int, int] | None:  # noqa: ANN401
    """Return the first and the last part of a row group; None if unknown, or if it is empty."""
    known = file.metadata.row_group(group).column(0).statistics
    return (known.min, known.max) if known is not None and known.has_min_max else None


def arrays_in(table: Any, names: Sequence[str]) -> dict[str, list[NDArray[Any]]]:  # noqa: ANN401
    """Return the columns of fields; what is null is NaN, −1 or False."""
    return {name: [_filled(table[column]) for column in COLUMNS[name]] for name in names}


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
def opened(folder: Path, settings: Settings, kind: str, number: int) -> Iterator[Any]:
    """Yield the open Parquet file of a shard; FileError if it cannot be read, or is another one."""
    parquet = from_extra("pyarrow.parquet", "batch", "a data set")
    path = shard_path(folder, kind, number)
    try:
        with parquet.ParquetFile(path) as file:
            _check(file, settings, kind, number)
            yield file
    except (FileError, MemoryError):
        raise
    except Exception as error:  # Arrow raises a dozen kinds on bad bytes
        reason = " ".join(str(error).split())[:LONGEST_REASON] or type(error).__name__
        raise FileError(f"'{path}' cannot be read: {reason}; {REMEDY}.") from error


def _check(file: Any, settings: Settings, kind: str, number: int) -> None:  # noqa: ANN401
    """Raise ValueError unless a file has the columns of its kind, and the parts of its shard."""
    schema = manifest_schema() if kind == MANIFEST else points_schema(settings)
    if not file.schema_arrow.equals(schema):
        raise ValueError(f"it does not have the columns of {kind}")
    first = number * settings.parts_per_shard
    for group in range(file.metadata.num_row_groups):
        least, most = _range_of(file, group) or (first, first)
        if least < first or most >= first + settings.parts_per_shard:
            raise ValueError(f"it has parts of another shard, {least} to {most}")
