"""A shard: consecutive parts of a data set, which one process samples and writes.

What is done is in `partial/`, until all parts are. Then the Parquet files of the points and of the
manifest are written, in this order.

A part that is done is a file of Arrow, with its row of the manifest in the metadata of the schema;
the process that samples it writes it at once.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ...runtime.base.errors import FileError
from ...runtime.base.extras import from_extra
from .data_files import opened, points_schema, rows_of_parts
from .folder import MANIFEST, PARTIAL, POINTS, Settings, replaced, shard_path
from .manifest import ManifestRow, manifest_table, rows_of

__all__ = ["Shard", "part_path", "read_part", "write_part"]

# Row groups of the Parquet file have at most so many samples, or one part.
ROWS_OF_A_GROUP = 1 << 17
ROW = b"row"


def part_path(folder: Path, part: int) -> Path:
    """Return the path of a part that is done, of a shard that is not finished."""
    return folder / PARTIAL / f"{part:06d}.arrow"


def write_part(folder: Path, row: ManifestRow, table: Any, schema: Any) -> None:  # noqa: ANN401
    """Write a part and its row, in place of what is there of it; without a table, no samples."""
    arrow = from_extra("pyarrow", "batch", "a data set")
    table = schema.empty_table() if table is None else table
    about = {**schema.metadata, ROW: json.dumps(asdict(row))}
    table = table.replace_schema_metadata(about)
    with (
        replaced(folder, part_path(folder, row.part)) as temporary,
        arrow.OSFile(str(temporary), "wb") as file,
        arrow.ipc.new_file(file, table.schema) as writer,
    ):
        writer.write_table(table)


def read_part(folder: Path, part: int, schema: Any) -> tuple[ManifestRow, Any] | None:  # noqa: ANN401
    """Return the row and the table of a part; None if it is not done, or its file is damaged.

    The table is a view of the file, which is mapped into memory.
    """
    arrow = from_extra("pyarrow", "batch", "a data set")
    try:
        with arrow.memory_map(str(part_path(folder, part))) as file:
            table = arrow.ipc.open_file(file).read_all()
        table.validate(full=True)
        about = dict(table.schema.metadata)
        (row,) = rows_of(manifest_table([ManifestRow(**json.loads(about.pop(ROW)))]))
        table = table.replace_schema_metadata(about)
        known = table.schema.equals(schema, check_metadata=True) and row.part == part
        return (row, table) if known else None
    except Exception:  # Arrow raises a dozen kinds on bad bytes
        return None


class Shard:
    """The parts of a shard that are done, and those that are added.

    Attributes
    ----------
    rows : dict of int to ManifestRow
        What is done, by the number of the part.
    folder : Path
        That of the data set.
    settings : Settings
        Those of the data set.
    schema : pyarrow.Schema
        That of the tables of points.

    Raises
    ------
    FileError
        If files cannot be written, when the disk is full for example.

    """

    def __init__(self, folder: Path, number: int, settings: Settings) -> None:
        self.schema = points_schema(settings)
        self.folder, self.settings = folder, settings
        self._number = number
        first = number * settings.parts_per_shard
        self._parts = range(first, first + settings.parts_per_shard)
        self._finished = self._rows_of_finished()
        begun = (read_part(folder, part, self.schema) for part in self._parts)
        self.rows = self._finished | {row.part: row for row, _ in filter(None, begun)}

    def add(self, row: ManifestRow, table: Any = None) -> None:  # noqa: ANN401
        """Write a part and its row, in place of what is there of that part."""
        write_part(self.folder, row, table, self.schema)
        self.rows[row.part] = row

    def commit(self, parts: Sequence[int]) -> None:
        """Finish the shard with these parts, in this order; all of them must be done.

        Nothing is written if the finished shard has exactly these.
        """
        paths = (part_path(self.folder, part) for part in self._parts)
        begun = [path for path in paths if path.exists()]
        if not begun and list(self._finished) == list(parts):
            return
        self.rows = {part: self.rows[part] for part in parts}
        compression = self.settings.compression
        with replaced(self.folder, self._path(POINTS)) as temporary:
            self._write_points(temporary, compression)
        with replaced(self.folder, self._path(MANIFEST)) as temporary:
            table = manifest_table(self.rows.values())
            _parquet().write_table(table, temporary, compression=compression)
        for path in begun:
            path.unlink()
        self._finished = self.rows

    def _path(self, kind: str) -> Path:
        return shard_path(self.folder, kind, self._number)

    def _rows_of_finished(self) -> dict[int, ManifestRow]:
        """Return the rows of the manifest; none if a file is missing or damaged."""
        try:
            with opened(self.folder, self.settings, MANIFEST, self._number) as manifest:
                rows = rows_of(manifest.read(use_threads=False))
            with opened(self.folder, self.settings, POINTS, self._number) as points:
                same = points.schema_arrow.equals(self.schema, check_metadata=True)
                whole = points.metadata.num_rows == sum(row.samples for row in rows)
        except FileError:
            return {}
        return {row.part: row for row in rows} if same and whole else {}

    def _write_points(self, path: Path, compression: str) -> None:
        arrow = from_extra("pyarrow", "batch", "a data set")
        with _parquet().ParquetWriter(
            path, self.schema, compression=compression, use_dictionary=["part"]
        ) as file:
            for group in _row_groups(self.rows):
                found = {part: read_part(self.folder, part, self.schema) for part in group}
                old = self._old([part for part, known in found.items() if known is None])
                tables = [known[1] if known else old[part] for part, known in found.items()]
                # One chunk: where chunks begin would decide where the pages of the file do.
                table = arrow.concat_tables(tables).combine_chunks()
                file.write_table(table, row_group_size=max(len(table), 1))

    def _old(self, parts: Sequence[int]) -> dict[int, Any]:
        """Return the tables of parts of the finished shard."""
        if not parts:
            return {}
        with opened(self.folder, self.settings, POINTS, self._number) as file:
            table = rows_of_parts(file, parts).cast(self.schema)
        field = from_extra("pyarrow.compute", "batch", "a data set").field("part")
        return {part: table.filter(field == part) for part in parts}


def _row_groups(rows: Mapping[int, ManifestRow]) -> Iterator[list[int]]:
    """Yield consecutive parts that make up a row group."""
    group: list[int] = []
    count = 0
    for part, row in rows.items():
        if group and count + row.samples > ROWS_OF_A_GROUP:
            yield group
            group, count = [], 0
        group.append(part)
        count += row.samples
    if group:
        yield group


def _parquet() -> Any:  # noqa: ANN401
    return from_extra("pyarrow.parquet", "batch", "a data set")
