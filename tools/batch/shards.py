"""A shard: consecutive parts of a data set, which one process samples and writes.

What is done is in the file `partial/…`, until all parts are. Then the Parquet files of the points
and of the manifest are written, in this order.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Self

from ...runtime.base.errors import FileError
from ...runtime.base.extras import from_extra
from ..files.paths import reason_of
from .arrow_tables import points_schema
from .data_files import opened, rows_of_parts
from .folder import MANIFEST, PARTIAL, POINTS, Settings, shard_path, temporary_path
from .manifest import ManifestRow, manifest_table, rows_of
from .partial import PartialFile, batches_in, files_of

__all__ = ["Shard"]

# Row groups of the Parquet file have at most so many samples, or one part.
ROWS_OF_A_GROUP = 1 << 17


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
        self._points = shard_path(folder, POINTS, number)
        self._manifest = shard_path(folder, MANIFEST, number)
        self._partial = shard_path(folder, PARTIAL, number)
        self._file: PartialFile | None = None
        finished = self._finished()
        partial = files_of(self._partial)
        with batches_in(partial, self.schema) as batches:
            begun = {part: row for part, (row, _) in batches.items()}
        self.rows: dict[int, ManifestRow] = finished | begun
        # The parts of the finished shard, if nothing is to be changed.
        self._unchanged = None if partial else list(finished)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._close()

    def add(self, row: ManifestRow, table: Any = None) -> None:  # noqa: ANN401
        """Write a part and its row, in place of what is there of that part."""
        self._unchanged = None
        with self._writing():
            if self._file is None:
                self._file = PartialFile(self._partial, self.schema)
            self._file.add(row, table)
        self.rows[row.part] = row

    def commit(self, parts: Sequence[int]) -> None:
        """Finish the shard with these parts, in this order; all of them must be done.

        Nothing is written if the finished shard has exactly these.
        """
        if self._unchanged == list(parts):
            return
        with self._writing():
            self._close()
        rows = {part: self.rows[part] for part in parts}
        with self._replaced(self._points) as temporary:
            self._write_points(temporary, rows)
        with self._replaced(self._manifest) as temporary:
            _parquet().write_table(
                manifest_table(rows.values()), temporary, compression=self.settings.compression
            )
        with self._writing():
            for path in files_of(self._partial):
                path.unlink()
        self.rows, self._unchanged = rows, list(parts)

    def _finished(self) -> dict[int, ManifestRow]:
        """Return the rows of the manifest; none if a file is missing or damaged."""
        try:
            with opened(self, MANIFEST, self._number) as manifest:
                rows = rows_of(manifest.read(use_threads=False))
            with opened(self, POINTS, self._number) as points:
                same = points.schema_arrow.equals(self.schema, check_metadata=True)
                whole = points.metadata.num_rows == sum(row.samples for row in rows)
        except FileError:
            return {}
        return {row.part: row for row in rows} if same and whole else {}

    def _write_points(self, path: Path, rows: Mapping[int, ManifestRow]) -> None:
        arrow = from_extra("pyarrow", "batch", "a data set")
        with (
            batches_in(files_of(self._partial), self.schema) as added,
            _parquet().ParquetWriter(
                path, self.schema, compression=self.settings.compression, use_dictionary=["part"]
            ) as file,
        ):
            for group in _row_groups(rows):
                old = self._old([part for part in group if part not in added])
                batches = [b for p in group for b in (old[p] if p in old else [added[p][1]])]
                # One chunk: where chunks begin would decide where the pages of the file do.
                table = arrow.Table.from_batches(batches, schema=self.schema).combine_chunks()
                file.write_table(table, row_group_size=max(len(table), 1))

    def _old(self, parts: Sequence[int]) -> dict[int, list[Any]]:
        """Return the batches of parts of the finished shard."""
        if not parts:
            return {}
        with opened(self, POINTS, self._number) as file:
            table = rows_of_parts(file, parts).cast(self.schema)
        field = from_extra("pyarrow.compute", "batch", "a data set").field("part")
        return {part: table.filter(field == part).to_batches() for part in parts}

    def _close(self) -> None:
        file, self._file = self._file, None
        if file is not None:
            file.close()

    @contextmanager
    def _replaced(self, path: Path) -> Iterator[Path]:
        """Yield a path to write to; the file takes the place of `path` when it is complete."""
        temporary = temporary_path(self.folder)
        try:
            with self._writing(path):
                yield temporary
                os.replace(temporary, path)
        finally:
            with suppress(OSError):
                temporary.unlink()

    @contextmanager
    def _writing(self, path: Path | None = None) -> Iterator[None]:
        try:
            yield
        except BaseException as error:
            self._close()  # what follows a broken batch would be lost
            if not isinstance(error, OSError):
                raise
            raise FileError(
                f"'{path or self._partial}' cannot be written: {reason_of(error)}; "
                "what is done is kept, run the same again when that is mended."
            ) from error


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
