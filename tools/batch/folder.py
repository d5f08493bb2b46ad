"""The folder of a data set: what is in it, its settings, and that one run at a time writes to it.

    dataset.json                  the settings
    points/shard-000000.parquet   the samples of consecutive parts
    manifest/shard-000000.parquet a row for each of these parts
    partial/000000.arrow          the same of a part, of a shard that is not finished
    files/                        a file for each part, if wanted
    normals.npy                   the prescribed normals, if there are any

A shard is finished when its manifest is there. No file is about all parts, so that a run over a
million parts has nothing that all its processes write to.
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
from ...runtime.base.checks import known_name, listed, text, whole_number
from ...runtime.base.errors import FileError, GaussmapError, InputError, shown
from ...runtime.machine_code.sources import digest
from ...runtime.samples.fields import COLUMNS, EDGE_NAMES
from ..files.paths import BEGUN, PathLike, atomic_path, checked_path, reason_of

__all__ = [
    "CODECS",
    "FILES",
    "LOCK",
    "MANIFEST",
    "NORMALS",
    "PARTIAL",
    "POINTS",
    "SETTINGS",
    "Settings",
    "checked_names",
    "create",
    "opened",
    "parts_per_shard",
    "read_settings",
    "remove_from",
    "replaced",
    "shard_path",
    "shards_in",
]

SETTINGS, LOCK, NORMALS = "dataset.json", ".lock", "normals.npy"
POINTS, MANIFEST, PARTIAL, FILES = "points", "manifest", "partial", "files"
FORMAT = 2
TEMPORARY = ".tmp"
# A shard has at most this many parts, and about this many samples. There are at least so many
# shards, if there are so many parts, so that all processes have work to the end.
MOST_PARTS, MOST_SAMPLES, LEAST_SHARDS = 256, 1 << 22, 64
# If nobody knows how many parts there will be.
PARTS_OF_A_STREAM = 64
CODECS = ("zstd", "snappy", "gzip", "lz4", "none")
FIELDS = tuple(name for name in COLUMNS if name not in EDGE_NAMES)
# The names of files of shards, and of parts.
SHARD, PART = re.compile(r"shard-([0-9]{6,})\.parquet"), re.compile(r"([0-9]{6,})\b.*")


@dataclass(frozen=True, slots=True)
class Settings:
    """What all parts of a data set have in common; `dataset.json` holds it.

    Attributes
    ----------
    asked : dict
        What was asked for of each part, as `sample` takes it: count, density, cells …; and the
        options with which `gaussmap batch` reads files: spacing, crs, unit …
    fields : tuple of str
        The fields of the samples.
    dtype : {"float64", "float32"}
        The type of all numbers but the indices.
    compression : str
        That of the Parquet files.
    parts_per_shard : int
        How many parts a shard has, but the last one.
    files : str or None
        The suffix of the files, one for each part, if there are any.
    gaussmap, formulas : str
        The version of the package, and a digest of the formulas and kernels.
    format : int
        The version of this layout.

    """

    asked: dict[str, Any]
    fields: tuple[str, ...]
    dtype: str
    compression: str
    parts_per_shard: int
    files: str | None
    gaussmap: str
    formulas: str
    format: int

    @classmethod
    def of_this_version(
        cls,
        asked: dict[str, Any],
        fields: tuple[str, ...],
        dtype: str = "float64",
        compression: str = "zstd",
        parts_per_shard: int = PARTS_OF_A_STREAM,
        files: str | None = None,
    ) -> Settings:
        """Return settings for samples that this version of the package computes."""
        how = fields, dtype, compression, parts_per_shard, files
        # As they are read again: tuples become lists.
        return cls.from_json(cls(asked, *how, __version__, digest(), FORMAT).to_json())

    def to_json(self) -> str:
        """Return the text of `dataset.json`."""
        return json.dumps(asdict(self), indent=2) + "\n"

    @classmethod
    def from_json(cls, written: str) -> Settings:
        """Return the settings that `to_json` has written; an error if the text has none."""
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
            compression=known_name(known["compression"], CODECS, "compression"),
            parts_per_shard=whole_number(
                known["parts_per_shard"], "parts_per_shard", 1, MOST_PARTS
            ),
            files=None if known["files"] is None else text(known["files"], "files"),
            gaussmap=text(known["gaussmap"], "gaussmap"),
            formulas=text(known["formulas"], "formulas"),
            format=FORMAT,
        )


def checked_names(names: object, known: Sequence[str], kind: str) -> tuple[str, ...]:
    """Return names, each known: at least one, and none twice."""
    if isinstance(names, str):
        raise InputError(f"{kind}s must be a tuple of names, such as ({shown(names)},).")
    items = listed(names)
    if items is None:
        raise InputError(f"{kind}s must be a tuple of names, not {shown(names)}.")
    wanted = tuple(known_name(name, known, kind) for name in items)
    if not wanted or len(set(wanted)) < len(wanted):
        raise InputError(f"{kind}s must name at least one {kind}, and none twice.")
    return wanted


def parts_per_shard(parts: int | None, count: int | None) -> int:
    """Return how many parts a shard has, of a data set of `parts` with `count` samples each.

    It depends on nothing else: the files are the same for any number of processes.
    """
    by_samples = max(1, MOST_SAMPLES // max(count or 1, 1))
    by_parts = PARTS_OF_A_STREAM if parts is None else max(1, parts // LEAST_SHARDS)
    return min(MOST_PARTS, by_parts, by_samples)


def shard_path(folder: Path, kind: str, number: int) -> Path:
    """Return the path of a shard's points or manifest."""
    return folder / kind / f"shard-{number:06d}.parquet"


@contextmanager
def replaced(folder: Path, path: Path) -> Iterator[Path]:
    """Yield a path to write to; the file takes the place of `path` when it is complete.

    It is not where finished files are: Polars and DuckDB would take it for one of them.
    """
    temporary = folder / PARTIAL / f"{secrets.token_hex(8)}{TEMPORARY}"
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


def shards_in(folder: Path) -> list[int]:
    """Return the numbers of the finished shards, in order."""
    return sorted(number for number, _ in _numbered(folder / MANIFEST, SHARD))


def _numbered(folder: Path, names: re.Pattern[str]) -> Iterator[tuple[int, Path]]:
    """Yield the files of shards or of parts in a folder, with the numbers of these."""
    for path in folder.glob("*"):
        if found := names.fullmatch(path.name):
            yield int(found[1]), path


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


@contextmanager
def opened(folder: PathLike, settings: Settings, overwrite: bool = False) -> Iterator[Settings]:
    """Make the folder of a data set, or go on with one, as `create` does; no other run may write.

    Yields what `create` returns. Raises what it raises, and FileError if another run writes.
    """
    path = checked_path(folder)
    _usable(path)
    with locked(path):
        known = create(path, settings, overwrite)
        _remove_temporary(path)  # by runs that were killed
        yield known
        _remove_temporary(path)  # by processes that were


def _remove_temporary(path: Path) -> None:
    with _writing(path):
        for left in [*path.glob(f"{PARTIAL}/*{TEMPORARY}"), *path.glob(f"{FILES}/{BEGUN}*")]:
            left.unlink(missing_ok=True)


def create(folder: PathLike, settings: Settings, overwrite: bool = False) -> Settings:
    """Make the folder of a data set, or go on with one; return its settings.

    One that exists must have the same settings, but for the number of parts in a shard, which
    stays. With `overwrite` what is there of another data set is removed first.

    Raises
    ------
    InputError
        If the data set has other settings.
    FileError
        If the folder holds something else, or cannot be written to.

    """
    path = checked_path(folder)
    _usable(path)
    with _writing(path):
        if (path / SETTINGS).exists() and overwrite:
            _remove(path)
        if (path / SETTINGS).exists():
            settings = _same(read_settings(path), settings, path)
        else:  # first of all: without settings the folder would be of something else
            with atomic_path(path / SETTINGS) as temporary:
                temporary.write_text(settings.to_json(), encoding="utf-8")
        for name in (POINTS, MANIFEST, PARTIAL):
            (path / name).mkdir(exist_ok=True)
    return settings


def _usable(path: Path) -> None:
    """Make a folder; FileError if that fails, or if something else or a link is in it."""
    with _writing(path):
        _refuse_links(path)
        path.mkdir(parents=True, exist_ok=True)
        if not (path / SETTINGS).exists() and any(
            # Of a run that was killed while it wrote the settings.
            entry.name != LOCK and not entry.name.startswith(BEGUN)
            for entry in path.iterdir()
        ):
            raise FileError(
                f"'{path}' holds other files and no {SETTINGS}; name a new or empty folder."
            )


def _refuse_links(path: Path) -> None:
    """Raise FileError for symbolic links: what is written to them would lie elsewhere."""
    for folder in (path, *(path / name for name in (POINTS, MANIFEST, PARTIAL, FILES))):
        if not folder.is_dir():
            continue
        with os.scandir(folder) as entries:
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


def remove_from(folder: Path, shards: int, parts: int) -> None:
    """Remove shards and parts from these numbers on: they are of a list that was longer."""
    of_shards, of_parts = (SHARD, shards), (PART, parts)
    # Without its manifest a shard is not there.
    kinds = {MANIFEST: of_shards, POINTS: of_shards, PARTIAL: of_parts, FILES: of_parts}
    with _writing(folder):
        for kind, (names, first) in kinds.items():
            for number, path in _numbered(folder / kind, names):
                if number >= first:
                    path.unlink()


def _same(old: Settings, new: Settings, path: Path) -> Settings:
    """Return the settings of an existing data set; InputError where the new ones differ."""
    had, wanted = (json.loads(x.to_json()) for x in (old, new))
    asked = had.pop("asked"), wanted.pop("asked")
    for then, now in ((had, wanted), asked):
        for name in sorted({*then, *now} - {"parts_per_shard"}):
            # As texts: NaN is not equal to itself.
            before, after = (json.dumps(x.get(name)) for x in (then, now))
            if before == after:
                continue
            what = f"was made with {name}={_short(before)}, not {_short(after)}"
            if name in ("gaussmap", "formulas"):
                what = f"was made by another version of gaussmap ({old.gaussmap})"
            raise InputError(f"the data set '{path}' {what}; name another folder, or overwrite it.")
    return old


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "…"


def _remove(path: Path) -> None:
    """Remove the data set of a folder, the settings last, and nothing else that lies there."""
    if '"gaussmap":' not in (path / SETTINGS).read_text(encoding="utf-8", errors="replace"):
        raise FileError(f"'{path / SETTINGS}' is not of gaussmap; name another folder.")
    for name in (MANIFEST, POINTS, PARTIAL, FILES):
        with suppress(FileNotFoundError):
            shutil.rmtree(path / name)
    (path / NORMALS).unlink(missing_ok=True)
    (path / SETTINGS).unlink()


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Let no other run write to a data set; FileError if one does.

    The lock is the system's, so that it ends with the process. Where the file system has no locks
    there is none.
    """
    with _writing(folder):
        file = open(folder / LOCK, "ab")  # noqa: SIM115 - what follows may raise OSError, too
    with file:
        _lock(file, folder)
        yield


def _lock(file: IO[bytes], folder: Path) -> None:
    try:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise FileError(
            f"another run writes to '{folder}'; wait until it ends, or stop it."
        ) from None
    except (ImportError, OSError):  # Windows, and file systems without locks
        return
