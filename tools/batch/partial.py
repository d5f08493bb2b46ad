"""The files of a shard that is not finished: streams of Arrow, with a batch for each part.

The row of the manifest is in the metadata of the batch. A part is done when its batch is there
whole: what follows the last whole batch is left by a process that was killed. So each process has
a file of its own: the first `shard-000007.arrow`, the next `shard-000007.1.arrow`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from itertools import count
from pathlib import Path
from typing import Any

from ...runtime.base.extras import from_extra
from ..files.declared import check_entries
from .manifest import ManifestRow

__all__ = ["PartialFile", "batches_in", "files_of"]

ROW = b"row"


def files_of(first: Path) -> list[Path]:
    """Return the files of a shard that are there, the oldest one first."""
    numbers = {path: path.suffixes[-2][1:] for path in first.parent.glob(f"{first.stem}.*.arrow")}
    later = {int(number): path for path, number in numbers.items() if number.isdecimal()}
    return [first] * first.exists() + [later[k] for k in sorted(later)]


@contextmanager
def batches_in(
    files: Sequence[Path],
    schema: Any,  # noqa: ANN401
) -> Iterator[dict[int, tuple[ManifestRow, Any]]]:
    """Yield the row and the batch of each part, the last one if there are several.

    The batches are views of the files, which are mapped into memory inside the block.
    """
    arrow = from_extra("pyarrow", "batch", "a data set")
    found: dict[int, tuple[ManifestRow, Any]] = {}
    with ExitStack() as mapped:
        for path in files:
            try:
                file = mapped.enter_context(arrow.memory_map(str(path)))
            except (OSError, ValueError):  # it is empty
                continue
            for row, batch in _whole_batches(arrow, file, schema):
                found[row.part] = row, batch
        yield found
        found.clear()


def _whole_batches(arrow: Any, file: Any, schema: Any) -> Iterator[tuple[ManifestRow, Any]]:  # noqa: ANN401
    try:
        reader = arrow.ipc.open_stream(file)
        while reader.schema.equals(schema, check_metadata=True):
            batch, metadata = reader.read_next_batch_with_custom_metadata()
            batch.validate(full=True)
            row = json.loads(metadata[ROW])
            check_entries(row, ManifestRow)
            yield ManifestRow(**row), batch
    except Exception:  # Arrow raises a dozen kinds on bad bytes, and StopIteration at the end
        return


class PartialFile:
    """A new file of a shard, to which parts are appended."""

    def __init__(self, first: Path, schema: Any) -> None:  # noqa: ANN401
        self._arrow = from_extra("pyarrow", "batch", "a data set")
        self._schema = schema
        path = _new(first)
        try:
            self._file = self._arrow.OSFile(str(path), "wb")
            self._writer = self._arrow.ipc.new_stream(self._file, schema)
        except BaseException:
            path.unlink(missing_ok=True)
            raise

    def add(self, row: ManifestRow, table: Any) -> None:  # noqa: ANN401
        """Write a part: when this returns, the part is done, even if the process is killed."""
        text = json.dumps(asdict(row)).encode()
        self._writer.write_batch(self._as_batch(table), custom_metadata={ROW: text})
        self._file.flush()

    def close(self) -> None:
        """Close the file. The stream gets no end, for which a full disk has no room."""
        self._file.close()

    def _as_batch(self, table: Any) -> Any:  # noqa: ANN401
        if table is None or not len(table):
            return self._arrow.RecordBatch.from_pylist([], schema=self._schema)
        return table.combine_chunks().to_batches()[0]


def _new(first: Path) -> Path:
    """Make a new file, which follows those that are there."""
    for number in count():
        path = first.with_suffix(f".{number}.arrow") if number else first
        try:
            path.touch(exist_ok=False)
        except FileExistsError:
            continue
        return path
    raise AssertionError
