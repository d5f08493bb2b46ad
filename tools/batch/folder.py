"""The folder of a data set: its contents, its settings, and a lock for the run that writes.

    dataset.json           the settings
    points/000000.parquet  the samples of a part, and its row of the manifest
    manifest.parquet       the rows of all parts, when a run has ended
    normals.npy            the prescribed normals, if there are any
    partial/               files that are being written; it exists only during a run
    .lock                  an empty file, which a run locks

A part is done when its file in points/ exists.
"""

from __future__ import annotations

import json
import os
import re
import secrets
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import IO, Any

from ... import __version__
from ...runtime.base.checks import known_name, listed, text
from ...runtime.base.errors import FileError, GaussmapError, InputError, shown
from ...runtime.machine_code.sources import digest
from ...runtime.samples.fields import COLUMNS, EDGE_NAMES
from ..files.paths import BEGUN, PathLike, atomic_path, checked_path, reason_of

SETTINGS, LOCK, NORMALS, MANIFEST = "dataset.json", ".lock", "normals.npy", "manifest.parquet"
POINTS, PARTIAL = FOLDERS = "points", "partial"
FORMAT = 4
FIELDS = tuple(name for name in COLUMNS if name not in EDGE_NAMES)


@dataclass(frozen=True, slots=True)
class Settings:
    """The settings that all parts of a data set have in common; `dataset.json` holds them.

    Attributes
    ----------
    asked : dict
        The requested arguments of `sample`: count, density, cells …; and the options with which
        `gaussmap batch` reads files: spacing, crs, unit …
    fields : tuple of str
        The fields of the samples.
    dtype : {"float64", "float32"}
        The type of all numbers but the indices.
    gaussmap, formulas : str
        The version of the package, and a digest of the formulas and kernels.
    format : int
        The version of this layout.

    """

    asked: dict[str, Any]
    fields: tuple[str, ...]
    dtype: str
    gaussmap: str
    formulas: str
    format: int

    @classmethod
    def of_this_version(
        cls, asked: dict[str, Any], fields: tuple[str, ...], dtype: str = "float64"
    ) -> Settings:
        """Return settings of samples computed by this version of the package."""
        # By way of JSON, since settings that are read from a file have lists in place of tuples.
        return cls.from_json(cls(asked, fields, dtype, __version__, digest(), FORMAT).to_json())

    def to_json(self) -> str:
        """Return the text of `dataset.json`."""
        return json.dumps(asdict(self), indent=2) + "\n"

    @classmethod
    def from_json(cls, written: str) -> Settings:
        """Return the settings that `to_json` has written; InputError if the text holds none."""
        known, names = json.loads(written), [x.name for x in fields(cls)]
        if not isinstance(known, dict):
            raise InputError(f"it must be a dictionary of entries, not {shown(known)}.")
        for name in known:
            known_name(name, names, "entry")
        for name in names:
            if name not in known:
                raise InputError(f"the entry {name} is missing.")
        if known["format"] != FORMAT or isinstance(known["format"], bool):
            raise InputError("it is of another version of gaussmap.")
        if not isinstance(known["asked"], dict):
            raise InputError(f"asked must be a dictionary of entries, not {shown(known['asked'])}.")
        return cls(
            asked=known["asked"],
            fields=checked_names(known["fields"], FIELDS, "field"),
            dtype=known_name(known["dtype"], ("float64", "float32"), "dtype"),
            gaussmap=text(known["gaussmap"], "gaussmap"),
            formulas=text(known["formulas"], "formulas"),
            format=FORMAT,
        )


def checked_names(names: object, known: Sequence[str], kind: str) -> tuple[str, ...]:
    """Return the names as a tuple; InputError if there are none, or unknown or repeated ones."""
    items = None if isinstance(names, str) else listed(names)
    if items is None:
        raise InputError(f"{kind}s must be a tuple of names, not {shown(names)}.")
    wanted = tuple(known_name(name, known, kind) for name in items)
    if not wanted or len(set(wanted)) < len(wanted):
        raise InputError(f"{kind}s must name at least one {kind}, and none twice.")
    return wanted


def read_settings(folder: PathLike) -> Settings:
    """Return the settings of a data set; FileError if the folder has none that can be read."""
    path = checked_path(folder) / SETTINGS
    if not os.path.isfile(path):
        raise FileError(f"'{folder}' is no data set: it has no {SETTINGS}.")
    try:
        return Settings.from_json(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {reason_of(error)}.") from error
    except (GaussmapError, ValueError, RecursionError) as error:
        raise FileError(f"'{path}' cannot be used: {str(error).rstrip('.')}.") from error


# --- the files of parts ---------------------------------------------------------------------------


def part_path(folder: Path, part: int) -> Path:
    """Return the path of the Parquet file of a part."""
    return folder / POINTS / f"{part:06d}.parquet"


def parts_in(folder: Path) -> list[int]:
    """Return the indices of the parts that are done, in order."""
    with suppress(FileNotFoundError):
        found = (re.fullmatch(r"([0-9]{6,})\.parquet", x) for x in os.listdir(folder / POINTS))
        return sorted(int(match[1]) for match in found if match)
    return []


def remove_from(folder: Path, parts: int) -> None:
    """Remove the files of parts with indices from `parts` on, left by a run with a longer list."""
    with _writing(folder):
        for part in parts_in(folder):
            if part >= parts:
                part_path(folder, part).unlink()


@contextmanager
def replaced(folder: Path, path: Path) -> Iterator[Path]:
    """Yield a temporary path to write to; when it is complete, the file replaces `path`.

    The temporary path is in the folder `partial`, since Polars and DuckDB read all files in
    `points` as parts, even unfinished ones.
    """
    temporary = folder / PARTIAL / secrets.token_hex(8)
    try:
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise FileError(
            f"'{path}' cannot be written: {reason_of(error)}; what is done is kept: correct "
            "this, and run the same again."
        ) from error
    finally:
        with suppress(OSError):
            temporary.unlink()


# --- the folder of a run --------------------------------------------------------------------------


@contextmanager
def opened(folder: PathLike, settings: Settings, overwrite: bool = False) -> Iterator[None]:
    """Make the folder of a data set, or continue with an existing one; lock it for other runs.

    An existing data set must have the same settings; with `overwrite` it is removed first. The
    manifest is removed, and written again when all parts are done.

    Raises
    ------
    InputError
        If the data set has other settings.
    FileError
        If the folder holds other files or cannot be written to, or if another run is writing.

    """
    path = checked_path(folder)
    with _writing(path):
        _refuse_links(path)
        path.mkdir(parents=True, exist_ok=True)
        if not (path / SETTINGS).exists() and any(
            # A file with this beginning was left by a run that was killed while it wrote the
            # settings.
            entry.name != LOCK and not entry.name.startswith(BEGUN)
            for entry in path.iterdir()
        ):
            raise FileError(
                f"'{path}' holds other files and no {SETTINGS}; name a new or empty folder."
            )
        lock = open(path / LOCK, "ab")  # noqa: SIM115 - the block below may raise OSError, too
    with lock:
        _lock(lock, path)
        with _writing(path):
            _begin(path, settings, overwrite)
        try:
            yield
        finally:
            shutil.rmtree(path / PARTIAL, ignore_errors=True)


def _begin(path: Path, settings: Settings, overwrite: bool) -> None:
    """Check or write the settings, and remove the leftovers of killed runs."""
    if (path / SETTINGS).exists() and overwrite:
        _remove(path)
    if (path / SETTINGS).exists():
        _check_same(read_settings(path), settings, path)
    else:  # first of all: without settings the folder would not count as a data set
        with atomic_path(path / SETTINGS) as temporary:
            temporary.write_text(settings.to_json(), encoding="utf-8")
    for left in [*path.glob(f"{BEGUN}*"), path / MANIFEST]:
        left.unlink(missing_ok=True)
    shutil.rmtree(path / PARTIAL, ignore_errors=True)
    for name in FOLDERS:
        (path / name).mkdir(exist_ok=True)


def _refuse_links(path: Path) -> None:
    """Raise FileError if there are symbolic links, as writing would change other folders."""
    for folder in (path, *(path / name for name in FOLDERS)):
        with suppress(FileNotFoundError), os.scandir(folder) as entries:
            for entry in entries:
                if entry.is_symlink():
                    raise FileError(
                        f"'{entry.path}' is a symbolic link; a data set is written to a folder "
                        "without any: remove it, or name another folder."
                    )


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except GaussmapError:
        raise
    except (FileExistsError, NotADirectoryError):
        raise FileError(f"'{path}' is a file, or in one; name a folder for it.") from None
    except OSError as error:
        raise FileError(f"'{path}' cannot be written to: {reason_of(error)}.") from error


def _check_same(old: Settings, new: Settings, path: Path) -> None:
    """Raise InputError if the settings of an existing data set differ from new ones."""
    had, wanted = (json.loads(x.to_json()) for x in (old, new))
    for then, now in ((had | {"asked": 0}, wanted | {"asked": 0}), (had["asked"], wanted["asked"])):
        for name in sorted({*then, *now}):
            # Values are compared as texts, since NaN is not equal to itself.
            before, after = (json.dumps(x.get(name)) for x in (then, now))
            if before == after:
                continue
            what = f"was made with {name} {_short(before)}, not {_short(after)}"
            if name in ("gaussmap", "formulas"):
                what = f"was made by another version of gaussmap ({old.gaussmap})"
            raise InputError(f"the data set '{path}' {what}; name another folder, or overwrite it.")


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "…"


def _remove(path: Path) -> None:
    """Remove the data set in a folder, its settings last, and no other files."""
    if '"gaussmap":' not in (path / SETTINGS).read_text(encoding="utf-8", errors="replace"):
        raise FileError(f"'{path / SETTINGS}' is not of gaussmap; name another folder.")
    for name in FOLDERS:
        with suppress(FileNotFoundError):
            shutil.rmtree(path / name)
    for name in (MANIFEST, NORMALS, SETTINGS):
        (path / name).unlink(missing_ok=True)


def _lock(file: IO[bytes], folder: Path) -> None:
    """Lock the folder of a data set; FileError if another run holds the lock.

    The system releases the lock of a killed run. On a file system without locks, nothing is locked.
    """
    try:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise FileError(
            f"another run writes to '{folder}'; wait until it ends, or stop it."
        ) from None
    except (ImportError, OSError):  # Windows, and file systems without locks
        return
