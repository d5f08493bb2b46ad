"""The file of a shard that is not finished: a stream of Arrow, with a batch for each part.

The row of the manifest is in the metadata of the batch. A part is done when its batch is there
whole: what follows the last whole batch is left by a process that was killed.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..extras import from_extra
from .manifest import ManifestRow

__all__ = ["PartialFile", "batches_in"]

ROW = b"row"


@contextmanager
def batches_in(path: Path, schema: Any) -> Iterator[dict[int, tuple[ManifestRow, Any]]]:  # noqa: ANN401
    """Yield the row and the batch of each part, the last one if there are several.

    The batches are views of the file, which is mapped into memory inside the block.
    """
    arrow = from_extra("pyarrow", "batch", "a data set")
    found: dict[int, tuple[ManifestRow, Any]] = {}
    try:
        file = arrow.memory_map(str(path))
    except (OSError, ValueError):  # there is none, or it is empty
        yield found
        return
    with file:
        for row, batch in _whole_batches(arrow, file, schema):
            found[row.part] = row, batch
        yield found
        found.clear()


def _whole_batches(arrow: Any, file: Any, schema: Any) -> Iterator[tuple[ManifestRow, Any]]:  # noqa: ANN401
    try:
        reader = arrow.ipc.open_stream(file)
        while reader.schema.equals(schema, check_metadata=True):
            batch, metadata = reader.read_next_batch_with_custom_metadata()
            yield ManifestRow(**json.loads(metadata[ROW])), batch
    except (StopIteration, OSError, KeyError, TypeError, ValueError):
        return  # ArrowInvalid is a ValueError


class PartialFile:
    """Appends parts to the file; what an earlier process has left is written again first.

    Only whole batches of it are, so that the stream goes on after them. That is done in the file
    `temporary`, which then takes the place of the other.
    """

    def __init__(self, path: Path, schema: Any, temporary: Path) -> None:  # noqa: ANN401
        self._arrow = from_extra("pyarrow", "batch", "a data set")
        self._schema = schema
        try:
            with batches_in(path, schema) as older:
                self._file = self._arrow.OSFile(str(temporary), "wb")
                self._writer = self._arrow.ipc.new_stream(self._file, schema)
                for row, batch in older.values():
                    self._write(row, batch)
            temporary.replace(path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise

    def add(self, row: ManifestRow, table: Any) -> None:  # noqa: ANN401
        """Write a part: when this returns, the part is done, even if the process is killed."""
        self._write(row, self._as_batch(table))

    def close(self) -> None:
        """Close the file. The stream gets no end, for which a full disk has no room."""
        self._file.close()

    def _as_batch(self, table: Any) -> Any:  # noqa: ANN401
        if table is None or not len(table):
            return self._arrow.RecordBatch.from_pylist([], schema=self._schema)
        return table.combine_chunks().to_batches()[0]

    def _write(self, row: ManifestRow, batch: Any) -> None:  # noqa: ANN401
        text = json.dumps(asdict(row)).encode()
        self._writer.write_batch(batch, custom_metadata={ROW: text})
        self._file.flush()
