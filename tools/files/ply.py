"""PLY: binary files of vertices with named columns, and of triangles.

This module exists because no maintained library with a permissive licence keeps all numbers:
trimesh and VTK write coordinates in single precision, and VTK leaves most columns out.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from io import BufferedReader
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from ...runtime.samples.fields import (
    ARRAY_NAMES,
    COLUMNS,
    REAL_NAMES,
    columns_of,
    dtype_of,
    new_field,
)
from ...runtime.samples.report import SamplingReport
from ...runtime.samples.samples import Samples
from .content import known_fields, lacks, report_from_json, report_to_json
from .reading import UnusableError

if TYPE_CHECKING:
    from ..meshes.mesh import Mesh

# NumPy's type for each name of a type: the names of the standard, newer names that some programs
# write, and names of 64-bit integers, which are in neither group.
_TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
    **{"int64": "i8", "uint64": "u8"},
}
# If a type has several names, the name in the standard is written; some readers know no other name.
_NAMES = {kind: name for name, kind in reversed(_TYPES.items())}

_REPORT = "gaussmap report "
# The beginning of the comment that lists the fields, in a file without some of the fields.
_FIELDS = "gaussmap fields "
# The largest length of a comment, since some readers have a buffer of 256 or 1,024 bytes for a line
# of the header.
_CHUNK = 200
_LARGEST_HEADER = 1 << 20
_LARGEST_INTEGER = 2**31 - 1
# The number of rows that are packed or unpacked at once, so small that they fit into the cache.
ROWS = 4096


class _Element(NamedTuple):
    name: str
    rows: int
    columns: dict[str, np.dtype[Any]]  # without lists


class _Header(NamedTuple):
    size: int  # of the header itself, in bytes
    comments: list[str]
    elements: list[_Element]


def write_ply(samples: Samples, path: Path) -> None:
    """Write all fields as columns of vertices, and the report as comments."""
    text = report_to_json(samples.report)
    comments = [_REPORT + text[k : k + _CHUNK] for k in range(0, len(text), _CHUNK)]
    if samples.fields != ARRAY_NAMES:
        comments.append(_FIELDS + " ".join(samples.fields))
    columns = columns_of(samples.arrays())
    for name, column in columns.items():
        _check_narrow(name, column)
    with open(path, "wb") as file:
        file.writelines(_header(comments, columns))
        _write_rows(file, samples.arrays())


def write_mesh_ply(mesh: Mesh, path: Path) -> None:
    """Write vertices with normals, u and v, and triangles."""
    if len(mesh.vertices) > _LARGEST_INTEGER:
        raise InputError("a .ply file numbers vertices by 32 bits; write a .vtu file instead.")
    arrays = {"points": mesh.vertices, "normals": mesh.normals, "uv": mesh.uv}
    counts = np.full(len(mesh.triangles), 3, np.uint8)
    with open(path, "wb") as file:
        file.writelines(_header([], columns_of(arrays), len(mesh.triangles)))
        _write_rows(file, arrays)
        _write_rows(file, {"count": counts, "corners": mesh.triangles})


def read_ply(file: BufferedReader) -> Samples:
    """Read a file of `write_ply`, possibly rewritten by another program."""
    header = _read_header(file)
    vertices, *others = header.elements
    said = [line for line in header.comments if line.startswith(_FIELDS)]
    fields = known_fields(said[-1].removeprefix(_FIELDS).split() if said else ARRAY_NAMES)
    row = np.dtype(list(vertices.columns.items()))
    size, end = file.seek(0, os.SEEK_END), header.size + vertices.rows * row.itemsize
    if size < end:  # checked before memory is allocated for the rows
        raise UnusableError("ends early; write it again.")
    arrays: dict[str, Any] = _empty_arrays(fields, vertices)
    if size > end and not others:
        raise UnusableError(f"has {size:,} bytes instead of {end:,}; write it again.")
    file.seek(header.size)
    _fill(file, row, arrays)
    report = "".join(x.removeprefix(_REPORT) for x in header.comments if x.startswith(_REPORT))
    return Samples(**arrays, report=_report(report, vertices.rows))


# ── Writing ──────────────────────────────────────────────────────────────────────────────────────


def _header(
    comments: Sequence[str], columns: Mapping[str, NDArray[Any]], triangles: int | None = None
) -> Iterator[bytes]:
    yield f"ply\nformat binary_{sys.byteorder}_endian 1.0\n".encode()
    for comment in ("written by gaussmap", *comments):
        yield f"comment {comment}\n".encode()
    yield f"element vertex {len(columns['x'])}\n".encode()
    for name, column in columns.items():
        yield f"property {_NAMES[_kept(column)]} {name}\n".encode()
    if triangles is not None:
        yield f"element face {triangles}\nproperty list uchar int vertex_indices\n".encode()
    yield b"end_header\n"


def _check_narrow(name: str, column: NDArray[Any]) -> None:
    if column.dtype != np.int64 or not len(column):
        return
    largest = max(-int(column.min()) - 1, int(column.max()))
    if largest > _LARGEST_INTEGER:
        raise InputError(
            f"{name} goes up to {np.max(np.abs(column)):,}, but a .ply file holds 32-bit "
            "integers; write a .npz file instead."
        )


# ── Reading ──────────────────────────────────────────────────────────────────────────────────────


def _read_header(file: BufferedReader) -> _Header:
    """Read the header, whose first element must be the vertices."""
    start = file.read(_LARGEST_HEADER)
    if not re.match(rb"ply\r?\n", start):
        raise UnusableError("is no .ply file; read one that gaussmap wrote.")
    end = re.search(rb"^end_header\r?\n", start, re.MULTILINE)
    if end is None:
        raise UnusableError("ends within its header; write it again.")
    header = _Header(end.end(), [], [])
    order, columns = "", {}
    for line in start[: end.start()].decode().split("\n")[1:]:
        match line.split():
            case ["comment", *_]:
                header.comments.append(line.rstrip("\r").removeprefix("comment "))
            case ["format", "ascii", _]:
                raise UnusableError(
                    "is a text .ply file, and gaussmap reads binary ones; convert it."
                )
            case ["format", "binary_little_endian" | "binary_big_endian" as name, "1.0"]:
                order = "<" if "little" in name else ">"
            case ["element", name, count] if count.isdecimal():
                columns: dict[str, np.dtype[Any]] = {}
                header.elements.append(_Element(name, int(count), columns))
            case ["property", "list", _, _, _] if len(header.elements) > 1:
                pass
            case ["property", kind, name] if order and kind in _TYPES and name not in columns:
                columns[name] = np.dtype(order + _TYPES[kind])
            case ["obj_info", *_] | []:
                pass
            case _:
                raise UnusableError(f"has {line[:50]!r} in its header; write it again.")
    if not order or not header.elements or header.elements[0].name != "vertex":
        raise UnusableError("does not begin with vertices; read a file that gaussmap wrote.")
    return header


def _empty_arrays(fields: Sequence[str], vertices: _Element) -> dict[str, NDArray[Any]]:
    """Return arrays for the fields; real numbers are float32 if all columns of real numbers are."""
    kinds = vertices.columns
    missing = [column for name in fields for column in COLUMNS[name] if column not in kinds]
    if missing:
        raise lacks("columns", missing)
    floats = {kinds[column] for name in fields if name in REAL_NAMES for column in COLUMNS[name]}
    single = bool(floats) and all(kind.str[1:] == "f4" for kind in floats)
    arrays = {}
    for name in fields:
        dtype = dtype_of(name, np.float32 if single else np.float64)
        for kind in (kinds[column] for column in COLUMNS[name]):
            if not np.can_cast(kind, np.int64 if dtype.itemsize == 1 else dtype, "safe"):
                raise UnusableError(f"has {kind.name} numbers as {name}; write it again.")
        arrays[name] = new_field(name, vertices.rows, dtype)
    return arrays


def _fill(file: BufferedReader, row: np.dtype[Any], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Read the rows of vertices from a file into the arrays of fields."""
    columns = columns_of(arrays)
    count = len(next(iter(columns.values())))
    block = np.empty(min(ROWS, count), row)
    for start in range(0, count, ROWS):
        part = block[: count - start]
        if file.readinto(part.view(np.uint8).data) != part.nbytes:
            raise UnusableError("ends early; write it again.")
        for name, column in columns.items():
            column[start : start + len(part)] = part[name]


def _report(text: str, samples: int) -> SamplingReport:
    if text:
        return report_from_json(text)
    return SamplingReport("an unknown surface", None, samples, None, None, None)


def _kept(array: NDArray[Any]) -> str:
    """Return the type of numbers in a file, which has no booleans and no 64-bit integers.

    All other types of arrays are kept.
    """
    return {"i8": "i4", "b1": "u1"}.get(array.dtype.str[1:], array.dtype.str[1:])


def _write_rows(file: BinaryIO, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write row k of every array, (N,) or (N, d), for all k."""
    count = len(next(iter(arrays.values())))
    row = np.dtype([(name, _kept(array), array.shape[1:]) for name, array in arrays.items()])
    packed = np.empty(min(ROWS, count), row)
    for start in range(0, count, ROWS):
        part = packed[: count - start]
        for name, array in arrays.items():
            part[name] = array[start : start + len(part)]
        file.write(part.data)
