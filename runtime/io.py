"""Samples to files and back: .npz and .ply are read again, .csv, .vtp and .xyz are for others.

A file is complete or it is not there: everything is written to a temporary file in the same
folder, which then takes the target's place in one step.
"""

from __future__ import annotations

import errno
import io
import json
import os
import secrets
import shutil
import stat
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import FileError, GaussmapError, InputError, UnknownNameError
from .extras import check_extra, from_extra
from .fields import ARRAY_NAMES, FLOAT_NAMES
from .samples import Samples, SamplingReport

if TYPE_CHECKING:
    import pyvista

__all__ = [
    "READABLE_SUFFIXES",
    "SUFFIXES",
    "atomic_path",
    "check_fields",
    "check_target",
    "columns_of",
    "known_suffix",
    "read_samples",
    "write_polydata",
    "write_samples",
]

PathLike = str | os.PathLike[str]

# Raised when .npz files change such that older versions of gaussmap would misread them.
_NPZ_VERSION = 1

# The fields that a format cannot do without.
_NEEDED: dict[str, tuple[str, ...]] = {
    ".ply": ("points",),
    ".vtp": ("points",),
    ".xyz": ("points", "normals"),
}

# The suffixes of files that can be written, and of those that can be read.
SUFFIXES = (".npz", ".ply", ".csv", ".vtp", ".xyz")
READABLE_SUFFIXES = (".npz", ".ply")

# One column for each number of a sample: what .csv and .ply files call it, and where it is kept.
_COLUMNS: dict[str, tuple[str, int | None]] = {
    "x": ("points", 0),
    "y": ("points", 1),
    "z": ("points", 2),
    "nx": ("normals", 0),
    "ny": ("normals", 1),
    "nz": ("normals", 2),
    "u": ("uv", 0),
    "v": ("uv", 1),
    "support": ("support", None),
    "gaussian_curvature": ("gaussian_curvature", None),
    "mean_curvature": ("mean_curvature", None),
    "normal_index": ("normal_index", None),
    "patch_index": ("patch_index", None),
}

_PLY_REPORT = "comment gaussmap report "
# Only in a file of fewer fields.
_PLY_FIELDS = "comment gaussmap fields "
# Some readers hold a header line in a buffer of 256 or 1,024 bytes.
_PLY_CHUNK = 200

_TEXT_ROWS = 4096


class _UnusableError(Exception):
    """A file's content is not what it should be; the text continues "'path' …"."""


def write_samples(samples: Samples, path: PathLike) -> None:
    """Write samples to a file; its suffix, in any case, chooses the format.

    An existing file is replaced once the new one is complete; if anything fails, it stays as it
    was. Files hold the fields that the samples hold, float32 as float32.

    - `.npz`: everything, the report included; reads back bit for bit.
    - `.ply`: binary, one vertex a sample, all columns and the report (in comments); reads back
      bit for bit. Indices are 32-bit. Needs the field `points`.
    - `.csv`: a header row and one row a sample, 17 significant digits (9 of float32), so that
      floats survive.
    - `.xyz`: rows `x y z nx ny nz`, digits as in `.csv`, no header. Needs `points` and `normals`.
    - `.vtp`: VTK PolyData with all arrays, and the report as field data; needs the extra `vtk` and
      the field `points`.

    Raises UnknownNameError if the suffix is none of `SUFFIXES`, FileError if the file cannot be
    written, InputError if an index does not fit into a `.ply` file or the format needs a field that
    is not there, and MissingExtraError if a `.vtp` file is asked and pyvista is not installed.
    """
    path = _path(path)
    suffix = known_suffix(path, SUFFIXES)
    check_fields(suffix, samples.fields)
    writer = _WRITERS[suffix]
    with atomic_path(path) as temporary:
        writer(samples, temporary)


def check_fields(path: PathLike, fields: Sequence[str]) -> None:
    """Raise InputError if the format of a file, told by its suffix, needs other fields too."""
    suffix = _path(path).suffix.lower() or os.fspath(path)
    lacking = [repr(name) for name in _NEEDED.get(suffix, ()) if name not in fields]
    if lacking:
        raise InputError(
            f"a {suffix} file needs {' and '.join(lacking)}; add that to the fields, or write a "
            ".npz or .csv file."
        )


def read_samples(path: PathLike) -> Samples:
    """Read samples from a `.npz` or `.ply` file that `write_samples` wrote.

    A `.ply` file that another program rewrote is read as long as it is binary and has all the
    columns; if it has lost the comments that hold the report, the report's numbers are None. A file
    of fewer fields says in a comment which these are.

    Raises UnknownNameError if the suffix is none of `READABLE_SUFFIXES`, and FileError if the file
    is missing, unreadable, damaged, or not from gaussmap. Nothing is ever unpickled.
    """
    path = _path(path)
    suffix = known_suffix(path, READABLE_SUFFIXES)
    try:
        file = open(path, "rb")  # noqa: SIM115 - an error here differs from one in the content
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {_reason(error)}.") from error
    with file:
        try:
            return _READERS[suffix](file)
        except _UnusableError as error:
            raise FileError(f"'{path}' {error}") from error
        except InputError as error:
            raise FileError(f"'{path}' holds unusable samples: {error}") from error
        except Exception as error:  # NumPy, zipfile and meshio raise a dozen kinds on bad bytes
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise FileError(
                f"'{path}' is damaged or is no {suffix} file of gaussmap ({reason}); "
                "write it again."
            ) from error


def check_target(path: PathLike, suffixes: Sequence[str] = SUFFIXES) -> None:
    """Raise now what writing `path` would raise later; for use ahead of long work.

    The suffix must be one of `suffixes`, which are in lower case with their dots. To know that the
    folder can be written to, an empty file is created in it and removed.

    Raises UnknownNameError if the suffix is none of `suffixes`, FileError if the folder is missing
    or read-only or `path` is a folder or protected, and MissingExtraError if a `.vtp` file is
    asked and pyvista is not installed.
    """
    path = _path(path)
    if known_suffix(path, suffixes) == ".vtp":
        check_extra("pyvista", "vtk", "writing .vtp files")
    probe = _temporary(_target(path))
    try:
        probe.touch(exist_ok=False)
    except OSError as error:
        raise _not_written(path, error) from error
    finally:
        with suppress(OSError):
            probe.unlink()


@contextmanager
def atomic_path(path: PathLike) -> Iterator[Path]:
    """Yield a temporary path to write to; it takes the place of `path` when the block succeeds.

    The temporary file lies in the same folder and has the same suffix. If the block raises,
    KeyboardInterrupt included, the temporary file is removed and an existing file at `path` stays
    as it was. A new file gets the permissions that the umask gives; one that replaces another
    keeps that one's. A symbolic link is followed, not replaced.

    Raises FileError if the folder is missing, if `path` is a folder, protected or not a regular
    file, or if the block raises an OSError, for example because the disk is full.
    """
    path = _path(path)
    target = _target(path)
    temporary = _temporary(target)
    try:
        yield temporary
        # There may be no older file, and some file systems know no permissions.
        with suppress(OSError):
            temporary.chmod(stat.S_IMODE(target.stat().st_mode))
        os.replace(temporary, target)
    except GaussmapError:
        raise
    except OSError as error:
        raise _not_written(path, error) from error
    finally:
        with suppress(OSError):
            temporary.unlink()


# ── Paths ────────────────────────────────────────────────────────────────────────────────────────


def _path(path: PathLike) -> Path:
    try:
        result = Path(path)
    except TypeError:
        raise InputError(f"a path must be a string or a Path, not {path!r}.") from None
    if not os.fspath(path):
        raise InputError("the name of the file is empty.")
    if "\0" in str(result):
        raise InputError(f"a path cannot hold a null character, as {str(result)!r} does.")
    return result


def known_suffix(path: PathLike, known: Sequence[str]) -> str:
    """Return the suffix of a path in lower case; UnknownNameError if it is none of the known."""
    path = _path(path)
    suffix = path.suffix.lower()
    if suffix not in known:
        what = f"the suffix '{path.suffix}'" if suffix else "no suffix"
        raise UnknownNameError(f"'{path}' has {what}; use one of {', '.join(known)}.")
    return suffix


def _target(path: Path) -> Path:
    """Return the real path of a file that may be written, without symbolic links."""
    target = Path(os.path.realpath(path))
    try:
        folder, mode = _mode(target.parent), _mode(target)
    except OSError as error:
        raise _not_written(path, error) from error
    if folder is None or not stat.S_ISDIR(folder):
        problem = "does not exist" if folder is None else "is not a folder"
        raise FileError(
            f"'{path}' cannot be written: '{target.parent}' {problem}; "
            "create the folder first or choose another."
        )
    if mode is None:
        return target
    if stat.S_ISDIR(mode):
        raise FileError(f"'{path}' is a folder; give the name of a file in it.")
    if not stat.S_ISREG(mode):
        raise FileError(f"'{path}' is a device or a pipe; give the name of a file.")
    if not os.access(target, os.W_OK):
        raise FileError(f"'{path}' is write-protected; unprotect it or choose another name.")
    return target


def _mode(path: Path) -> int | None:
    """Return the type and permissions of what is at `path`, or None if nothing is there."""
    try:
        return path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None


def _temporary(target: Path) -> Path:
    # Not tempfile: its files are private to the user (mode 0600) whatever the umask says. Not the
    # target's stem: with an addition it could become too long.
    return target.with_name(f".gaussmap-{secrets.token_hex(8)}{target.suffix}")


def _reason(error: OSError) -> str:
    return error.strerror or str(error) or type(error).__name__


def _not_written(path: Path, error: OSError) -> FileError:
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        hint = "make room or choose another disk"
    elif error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        hint = "choose a folder that you may write to"
    else:
        hint = "choose another place"
    return FileError(f"'{path}' cannot be written: {_reason(error)}; {hint}.")


# ── The report as text ───────────────────────────────────────────────────────────────────────────


def _report_to_json(report: SamplingReport) -> str:
    return json.dumps(asdict(report))  # ASCII: json escapes all else


def _report_from_json(text: str) -> SamplingReport:
    return SamplingReport(**json.loads(text))


# ── .npz ─────────────────────────────────────────────────────────────────────────────────────────


def _write_npz(samples: Samples, path: Path) -> None:
    arrays = {name: getattr(samples, name) for name in samples.fields}
    if samples.fields != ARRAY_NAMES:
        arrays["fields"] = np.array(samples.fields)
    # Given a path, savez appends .npz to names that end in .NPZ. Not savez_compressed: it takes
    # forty times as long, and saves a sixth.
    with open(path, "wb") as file:
        np.savez(
            file,
            format_version=np.int64(_NPZ_VERSION),
            report=np.array(_report_to_json(samples.report)),
            **arrays,
        )


def _read_npz(file: BinaryIO) -> Samples:
    # np.load would take anything that is no zip archive for a pickle.
    if not zipfile.is_zipfile(file):
        raise _UnusableError("is damaged or is no .npz file; write it again.")
    file.seek(0)
    with np.load(file, allow_pickle=False) as archive:
        if "format_version" in archive and int(archive["format_version"]) > _NPZ_VERSION:
            raise _UnusableError("comes from a newer version of gaussmap; update gaussmap.")
        fields = _known_fields(archive["fields"].tolist() if "fields" in archive else ARRAY_NAMES)
        missing = [n for n in ("format_version", "report", *fields) if n not in archive]
        if missing:
            raise _lacks("arrays", missing)
        arrays: dict[str, Any] = {name: _native(archive[name]) for name in fields}
        return Samples(**arrays, report=_report_from_json(str(archive["report"])))


def _known_fields(names: Iterable[str]) -> tuple[str, ...]:
    """Return the fields that a file says to hold, in the order of `ARRAY_NAMES`."""
    held = set(names)
    if not held or not held <= set(ARRAY_NAMES):
        raise _UnusableError("holds fields that gaussmap does not know; update gaussmap.")
    return tuple(name for name in ARRAY_NAMES if name in held)


def _lacks(what: str, missing: Sequence[str]) -> _UnusableError:
    return _UnusableError(
        f"lacks the {what} {', '.join(missing)}; read a file that gaussmap wrote."
    )


def _native(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array in this machine's byte order."""
    return array.astype(array.dtype.newbyteorder("="), copy=False)


# ── .ply ─────────────────────────────────────────────────────────────────────────────────────────


class _PlyHeader(NamedTuple):
    size: int  # of the header itself, in bytes
    vertices: int
    columns: list[str]  # names of the vertices' properties
    binary: bool
    faces: bool
    report: str  # the report as JSON; empty if the file holds none
    fields: tuple[str, ...]


def _write_ply(samples: Samples, path: Path) -> None:
    import meshio

    columns = {name: _ply_column(name, column) for name, column in columns_of(samples).items()}
    data: dict[str, ArrayLike] = {
        name: column for name, column in columns.items() if name not in ("x", "y", "z")
    }
    buffer = io.BytesIO()
    meshio.write(buffer, meshio.Mesh(samples.points, [], point_data=data), file_format="ply")
    buffer.seek(0)
    header = [line.decode().rstrip() for line in iter(buffer.readline, b"end_header\n")]
    with open(path, "wb") as file:
        file.writelines(f"{line}\n".encode() for line in _ply_header(header, samples))
        shutil.copyfileobj(buffer, file)


def _ply_column(name: str, column: NDArray[Any]) -> NDArray[Any]:
    """Return the column in a type that the PLY standard has: it knows no 64-bit integers."""
    if column.dtype.kind == "f":
        return column
    narrow = column.astype(np.int32)
    if not np.array_equal(narrow, column):
        raise InputError(
            f"{name} goes up to {np.max(np.abs(column)):,}, but a .ply file holds 32-bit "
            "integers; write a .npz file instead."
        )
    return narrow


def _ply_header(header: Sequence[str], samples: Samples) -> Iterator[str]:
    """Yield meshio's header with the report in place of the time, which differs run by run."""
    text = _report_to_json(samples.report)
    for line in header:
        if line.startswith("comment "):
            yield "comment written by gaussmap with meshio"
            for start in range(0, len(text), _PLY_CHUNK):
                yield _PLY_REPORT + text[start : start + _PLY_CHUNK]
            if samples.fields != ARRAY_NAMES:
                yield _PLY_FIELDS + " ".join(samples.fields)
        else:
            # The standard's own name for the type; not every reader knows the younger int32.
            yield line.replace("property int32 ", "property int ")
    yield "end_header"


def _read_ply(file: BinaryIO) -> Samples:
    import meshio

    header = _parse_ply_header(file)
    if not header.binary:
        raise _UnusableError("is a text .ply file, and gaussmap reads binary ones; convert it.")
    wanted = [column for column, (name, _) in _COLUMNS.items() if name in header.fields]
    missing = [column for column in wanted if column not in header.columns]
    if missing:
        raise _lacks("columns", missing)
    size = file.seek(0, os.SEEK_END)
    if header.vertices > size:  # a vertex takes a byte at the least: do not allocate for these
        raise _UnusableError("ends early; write it again.")
    file.seek(0)
    # Given a path, meshio prints to stdout and ends the process if the file is bad.
    mesh = meshio.read(file, file_format="ply")
    columns = dict(zip("xyz", mesh.points.T, strict=True)) | mesh.point_data
    # meshio takes what is there, be it fewer vertices than the header says, or more bytes.
    end = header.size + header.vertices * sum(columns[n].dtype.itemsize for n in header.columns)
    if size < end or (size > end and not header.faces):
        raise _UnusableError(f"has {size:,} bytes instead of {end:,}; write it again.")
    return _from_columns(columns, header.fields, _ply_report(header))


def _parse_ply_header(file: BinaryIO) -> _PlyHeader:
    """Read the header and stop behind it; meshio would never return if it had no end."""
    lines = _ply_header_lines(file)
    counts: dict[str, int] = {}
    columns: dict[str, list[str]] = {"vertex": []}
    element = ""
    for words in (line.split() for line in lines):
        if words[:1] == ["element"]:
            element = words[1]
            counts[element] = int(words[2])
        elif words[:1] == ["property"]:
            columns.setdefault(element, []).append(words[-1])
    chunks = (line.removeprefix(_PLY_REPORT) for line in lines if line.startswith(_PLY_REPORT))
    fields = [x for line in lines if line.startswith(_PLY_FIELDS) for x in line.split()[3:]]
    return _PlyHeader(
        size=file.tell(),
        vertices=counts.get("vertex", 0),
        columns=columns["vertex"],
        binary=not any(line.startswith("format ascii") for line in lines),
        faces="face" in counts,
        report="".join(chunks),
        fields=_known_fields(fields or ARRAY_NAMES),
    )


def _ply_header_lines(file: BinaryIO) -> list[str]:
    lines: list[str] = []
    for raw in iter(file.readline, b""):
        if not lines and raw.strip() != b"ply":
            raise _UnusableError("is no .ply file; read one that gaussmap wrote.")
        lines.append(raw.decode().rstrip("\r\n"))
        if lines[-1].strip() == "end_header":
            return lines
    raise _UnusableError("ends within its header; write it again.")


def _ply_report(header: _PlyHeader) -> SamplingReport:
    if header.report:
        return _report_from_json(header.report)
    return SamplingReport(
        surface="an unknown surface",
        normals=None,
        samples=header.vertices,
        patches=None,
        invisible_share=None,
        degenerate_patches=None,
    )


# ── Columns, and the text formats ────────────────────────────────────────────────────────────────


def columns_of(samples: Samples) -> dict[str, NDArray[Any]]:
    """Return the columns of `_COLUMNS`, each (N,), as views."""
    return {
        column: getattr(samples, name)[..., slice(None) if part is None else part]
        for column, (name, part) in _COLUMNS.items()
        if name in samples.fields
    }


def _from_columns(
    columns: Mapping[str, NDArray[Any]], fields: Sequence[str], report: SamplingReport
) -> Samples:
    """Undo `_columns`; numbers of narrower types are widened, float32 unless all of them are."""
    arrays = {}
    floats = {
        columns[c].dtype
        for c, (name, _) in _COLUMNS.items()
        if name in FLOAT_NAMES and c in columns
    }
    floating = np.float32 if floats == {np.dtype(np.float32)} else np.float64
    for name in fields:
        parts = [columns[column] for column, (whole, _) in _COLUMNS.items() if whole == name]
        array = parts[0] if len(parts) == 1 else np.stack(parts, axis=1)
        dtype = floating if name in FLOAT_NAMES else np.int64
        if not np.can_cast(array.dtype, dtype, "safe"):
            raise _UnusableError(f"has {array.dtype} numbers as {name}; write it again.")
        arrays[name] = array.astype(dtype)
    return Samples(**arrays, report=report)


def _write_csv(samples: Samples, path: Path) -> None:
    columns = columns_of(samples)
    _write_rows(path, ",".join(columns) + "\n", ",", list(columns.values()))


def _write_xyz(samples: Samples, path: Path) -> None:
    _write_rows(path, "", " ", [*samples.points.T, *samples.normals.T])


def _write_rows(path: Path, header: str, mark: str, columns: Sequence[NDArray[Any]]) -> None:
    digits = {"i8": "%d", "f4": "%.9g", "f8": "%.17g"}
    pattern = mark.join(digits[column.dtype.str[1:]] for column in columns) + "\n"
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(header)
        for start in range(0, len(columns[0]), _TEXT_ROWS):
            block = [column[start : start + _TEXT_ROWS].tolist() for column in columns]
            file.writelines(pattern % row for row in zip(*block, strict=True))


# ── .vtp ─────────────────────────────────────────────────────────────────────────────────────────


def _write_vtp(samples: Samples, path: Path) -> None:
    pv = from_extra("pyvista", "vtk", "writing .vtp files")

    cloud = pv.PolyData(samples.points)
    data = cloud.GetPointData()
    for name in samples.fields:
        if name != "points":
            # By way of VTK: pyvista refuses arrays without elements.
            data.AddArray(pv.convert_array(getattr(samples, name), name=name))
    if "normals" in samples.fields:
        data.SetActiveNormals("normals")
    cloud.field_data["report"] = [_report_to_json(samples.report)]
    write_polydata(cloud, path)


def write_polydata(data: pyvista.PolyData, path: Path) -> None:
    """Write VTK PolyData to a .vtp file."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    # Into memory first: when the disk is full, VTK leaves half a file and pyvista says nothing.
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(data)
    writer.SetDataModeToBinary()
    writer.SetWriteToOutputString(True)
    writer.Write()
    path.write_text(writer.GetOutputString(), encoding="ascii", newline="\n")


_WRITERS: dict[str, Callable[[Samples, Path], None]] = {
    ".npz": _write_npz,
    ".ply": _write_ply,
    ".csv": _write_csv,
    ".vtp": _write_vtp,
    ".xyz": _write_xyz,
}

_READERS: dict[str, Callable[[BinaryIO], Samples]] = {".npz": _read_npz, ".ply": _read_ply}
