"""What is done of a shard that is not finished: a file of Arrow for each part.

The row of the manifest is in the metadata of its schema. A part is done when its file is there,
which the process that samples writes at once.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ...runtime.base.extras import from_extra
from .folder import PARTIAL, replaced
from .manifest import ManifestRow, manifest_table, rows_of

__all__ = ["part_path", "read_part", "write_part"]

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
