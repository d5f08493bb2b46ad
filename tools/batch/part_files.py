"""The files of a data set: a Parquet file for each part, with its manifest row, and the manifest.

The row is in the metadata of the file's schema, so that the samples of a part and its row appear in
one step, and the manifest can be made from the files at any time. A part that failed has a file
without samples.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from itertools import islice
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
from .folder import MANIFEST, Settings, part_path, replaced
from .manifest import ManifestRow, manifest_schema, manifest_table

if TYPE_CHECKING:  # imports Numba, which reading a data set does not need
    from ...runtime.samples.samples import Samples

LONGEST_REASON, CODEC = 100, "zstd"
REMEDY = "remove it, and run the same sampling again"
# The fields that both samples of surfaces and samples of CAD parts have if they are requested.
ALWAYS = tuple(name for name in ARRAY_NAMES if name in ARRAY_NAMES_OF_PART)
ROW, SETTINGS = b"row", b"settings"  # in the metadata of a part's schema
ROWS_AT_ONCE = 1 << 16  # of the manifest


def points_schema(settings: Settings) -> Any:  # noqa: ANN401
    """Return the Arrow schema of a part: its index, and a column for each component of a field.

    A column may be null only if some parts lack its field: the index of a face, for example.
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
    about = {"gaussmap": settings.gaussmap, "formulas": settings.formulas, SETTINGS: _key(settings)}
    return arrow.schema([part, *columns], metadata=about)


def _key(settings: Settings) -> str:
    """Return a text that all files of one data set share, and files of other data sets do not."""
    return hashlib.sha256(settings.to_json().encode()).hexdigest()


def points_table(samples: Samples, part: int, schema: Any) -> Any:  # noqa: ANN401
    """Return the samples of a part as an Arrow table; columns of missing fields are null."""
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


def write_part(
    folder: Path, settings: Settings, row: ManifestRow, samples: Samples | None = None
) -> None:
    """Write the file of a part, with its samples and its row, replacing an existing file."""
    schema = points_schema(settings)
    table = schema.empty_table() if samples is None else points_table(samples, row.part, schema)
    table = table.replace_schema_metadata({**schema.metadata, ROW: json.dumps(asdict(row))})
    with replaced(folder, part_path(folder, row.part)) as temporary:
        _parquet().write_table(
            table, temporary, compression=CODEC, write_page_checksum=True,
            use_dictionary=["part"],
        )  # fmt: skip


def write_manifest(folder: Path, settings: Settings, parts: Iterable[int]) -> None:
    """Write the manifest of the given parts, all of which have files."""
    rows = rows_of(folder, settings, parts)
    with (
        replaced(folder, folder / MANIFEST) as temporary,
        _parquet().ParquetWriter(
            temporary, manifest_schema(), compression=CODEC, write_page_checksum=True
        ) as file,
    ):
        while some := list(islice(rows, ROWS_AT_ONCE)):
            file.write_table(manifest_table(some))


def rows_of(folder: Path, settings: Settings, parts: Iterable[int]) -> Iterator[ManifestRow]:
    """Yield the rows of the manifest of parts, all of which have files."""
    for part in parts:
        with opened_part(folder, settings, part) as (_, row):
            yield row


def row_of(folder: Path, settings: Settings, part: int) -> ManifestRow | None:
    """Return the row of a part if its file exists, is complete, and belongs to this data set."""
    if not part_path(folder, part).exists():
        return None
    try:
        with opened_part(folder, settings, part) as (_, row):
            return row
    except FileError:
        return None


@contextmanager
def opened_part(folder: Path, settings: Settings, part: int) -> Iterator[tuple[Any, ManifestRow]]:
    """Yield the open file of a part, and its row; FileError if damaged or of another data set."""
    schema = points_schema(settings)
    with _opened(part_path(folder, part), schema) as file:
        about = file.schema_arrow.metadata
        if about.get(SETTINGS) != schema.metadata[SETTINGS]:
            raise ValueError("it is of another data set")
        row = ManifestRow(**json.loads(about[ROW]))
        if row.part != part:
            raise ValueError(f"it holds part {row.part}")
        if row.samples != file.metadata.num_rows:
            raise ValueError(f"it has {file.metadata.num_rows} samples of {row.samples}")
        yield file, row


@contextmanager
def opened_manifest(folder: Path) -> Iterator[Any]:
    """Yield the open manifest; FileError if it is damaged."""
    with _opened(folder / MANIFEST, manifest_schema()) as file:
        yield file


@contextmanager
def _opened(path: Path, schema: Any) -> Iterator[Any]:  # noqa: ANN401
    """Yield an open Parquet file; FileError if it is damaged, which may show only on reading."""
    parquet = _parquet()
    try:
        with parquet.ParquetFile(path, page_checksum_verification=True) as file:
            if not file.schema_arrow.equals(schema):
                kind = "the manifest" if path.name == MANIFEST else "points"
                raise ValueError(f"it does not have the columns of {kind}")
            yield file
    except (FileError, MemoryError):
        raise
    except Exception as error:  # Arrow raises a dozen types of exceptions on bad bytes
        reason = " ".join(str(error).split())[:LONGEST_REASON] or type(error).__name__
        raise FileError(f"'{path}' cannot be read: {reason}; {REMEDY}.") from error


def _parquet() -> Any:  # noqa: ANN401
    return from_extra("pyarrow.parquet", "batch", "a data set")


def arrays_in(table: Any, names: Sequence[str]) -> dict[str, list[NDArray[Any]]]:  # noqa: ANN401
    """Return the columns of each field as arrays; nulls become NaN, −1, False or 0."""
    return {name: [_filled(table[column]) for column in COLUMNS[name]] for name in names}


def _filled(column: Any) -> NDArray[Any]:  # noqa: ANN401
    arrow = from_extra("pyarrow", "batch", "a data set")
    if column.null_count:
        empty = np.nan if arrow.types.is_floating(column.type) else -1
        if column.type.bit_width <= 8:
            empty = column.type.to_pandas_dtype()(0)
        column = column.fill_null(empty)
    return column.to_numpy()


def stacked(columns: Sequence[NDArray[Any]], name: str) -> NDArray[Any]:
    """Return the array of a field, made of its columns; it is writable and has its own memory."""
    if row_shape(name):
        return np.stack(columns, axis=1)
    return np.array(columns[0])
