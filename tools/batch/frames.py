"""What a process that samples says: a line of JSON and a table of Arrow, in one frame.

It is no pickle: nothing that a file makes that process do can run code in the one that reads.
"""

from __future__ import annotations

import json
import struct
from typing import IO, Any

from ...runtime.base.extras import from_extra

__all__ = ["read_frame", "write_frame"]

HEAD = struct.Struct("<QQ")


def write_frame(file: IO[bytes], about: dict[str, Any], table: Any = None) -> None:  # noqa: ANN401
    """Write a frame, and send it."""
    text = json.dumps(about).encode()
    if table is None:
        file.write(HEAD.pack(len(text), 0) + text)
    else:
        arrow = from_extra("pyarrow", "batch", "a data set")
        sink = arrow.BufferOutputStream()
        with arrow.ipc.new_stream(sink, table.schema) as writer:
            writer.write_table(table)
        data = sink.getvalue()
        file.write(HEAD.pack(len(text), data.size) + text)
        file.write(data)
    file.flush()


def read_frame(file: IO[bytes]) -> tuple[dict[str, Any], Any]:
    """Return what `write_frame` was given; EOFError if the other process has ended."""
    text_size, data_size = HEAD.unpack(_read(file, HEAD.size))
    about = json.loads(_read(file, text_size))
    if not data_size:
        return about, None
    arrow = from_extra("pyarrow", "batch", "a data set")
    with arrow.ipc.open_stream(_read(file, data_size)) as reader:
        return about, reader.read_all()


def _read(file: IO[bytes], size: int) -> bytes:
    data = file.read(size)
    if len(data) < size:
        raise EOFError
    return data
