"""The folder of a data set: what is in it, its settings, and that one run at a time writes to it.

    dataset.json                  the settings
    points/shard-000000.parquet   the samples of consecutive parts
    manifest/shard-000000.parquet a row for each of these parts
    partial/shard-000000.arrow    the same of a shard that is not finished; see partial.py
    files/                        a file for each part, if wanted
    normals.npy                   the prescribed normals, if there are any

A shard is finished when its manifest is there. No file is about all parts, so that a run over a
million parts has nothing that all its processes write to.
"""

from __future__ import annotations

import json
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import IO, Any

from ... import __version__
from ...runtime.base.errors import FileError, GaussmapError, InputError
from ..files.paths import PathLike, atomic_path, checked_path, reason_of

__all__ = [
    "FILES",
    "LOCK",
    "MANIFEST",
    "NORMALS",
    "PARTIAL",
    "POINTS",
    "SETTINGS",
    "Settings",
    "create",
    "opened",
    "parts_per_shard",
    "read_settings",
    "remove_files",
    "remove_shards",
    "shard_path",
    "shards_in",
    "temporary_path",
]

SETTINGS, LOCK, NORMALS = "dataset.json", ".lock", "normals.npy"
POINTS, MANIFEST, PARTIAL, FILES = "points", "manifest", "partial", "files"
FORMAT = 1
TEMPORARY = ".tmp"
# A shard has at most this many parts, and about this many samples. There are at least so many
# shards, if there are so many parts, so that all processes have work to the end.
MOST_PARTS, MOST_SAMPLES, LEAST_SHARDS = 256, 1 << 22, 64
# If nobody knows how many parts there will be.
PARTS_OF_A_STREAM = 64


@dataclass(frozen=True, slots=True)
class Settings:
    """What all parts of a data set have in common; `dataset.json` holds it.

    Attributes
    ----------
    asked : dict
        What was asked for of each part, as `sample` takes it: count, density, cells …
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
    dtype: str = "float64"
    compression: str = "zstd"
    parts_per_shard: int = PARTS_OF_A_STREAM
    files: str | None = None
    gaussmap: str = __version__
    formulas: str = ""
    format: int = FORMAT

    @classmethod
    def of_this_version(cls, **known: Any) -> Settings:  # noqa: ANN401
        """Return settings for samples that this version of the package computes."""
        from ...runtime.kernels.jit import digest  # Numba, which reading a data set does without

        # As they are read again: tuples become lists.
        return cls.from_json(cls(**known, formulas=digest()).to_json())

    def to_json(self) -> str:
        """Return the text of `dataset.json`."""
        return json.dumps(asdict(self), indent=2) + "\n"

    @classmethod
    def from_json(cls, text: str) -> Settings:
        """Return the settings that `to_json` has written; ValueError if the text has none."""
        known = json.loads(text)
        if not isinstance(known, dict) or known.get("format") != FORMAT:
            raise ValueError("it is of another version of gaussmap")
        if set(known) != {field.name for field in fields(cls)} or not isinstance(
            known["asked"], dict
        ):
            raise ValueError("it lacks entries, or has unknown ones")
        settings = cls(**known)
        return replace(settings, fields=tuple(settings.fields))


def parts_per_shard(parts: int | None, count: int | None) -> int:
    """Return how many parts a shard has, of a data set of `parts` with `count` samples each.

    It depends on nothing else: the files are the same for any number of processes.
    """
    by_samples = max(1, MOST_SAMPLES // max(count or 1, 1))
    by_parts = PARTS_OF_A_STREAM if parts is None else max(1, parts // LEAST_SHARDS)
    return min(MOST_PARTS, by_parts, by_samples)


def shard_path(folder: Path, kind: str, number: int) -> Path:
    """Return the path of a shard's points, manifest or partial."""
    return folder / kind / f"shard-{number:06d}{'.arrow' if kind == PARTIAL else '.parquet'}"


def temporary_path(folder: Path) -> Path:
    """Return a new path for a file that is being written.

    It is not where finished files are: Polars and DuckDB would take it for one of them.
    """
    return folder / PARTIAL / f"{secrets.token_hex(8)}{TEMPORARY}"


def shards_in(folder: Path) -> list[int]:
    """Return the numbers of the finished shards, in order."""
    return sorted(
        int(path.stem.removeprefix("shard-"))
        for path in (folder / MANIFEST).glob("shard-" + 6 * "[0-9]" + "*.parquet")
    )


def read_settings(folder: PathLike) -> Settings:
    """Return the settings of a data set; FileError if the folder has none that can be read."""
    path = checked_path(folder) / SETTINGS
    try:
        return Settings.from_json(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise FileError(f"'{folder}' is no data set: it has no {SETTINGS}.") from None
    except OSError as error:
        raise FileError(f"'{path}' cannot be read: {reason_of(error)}.") from error
    except (ValueError, TypeError) as error:
        raise FileError(f"'{path}' cannot be used: {error}.") from error


@contextmanager
def opened(folder: PathLike, settings: Settings, overwrite: bool = False) -> Iterator[Settings]:
    """Make the folder of a data set, or go on with one, as `create` does; no other run may write.

    Yields what `create` returns. Raises what it raises, and FileError if another run writes.
    """
    path = checked_path(folder)
    _usable(path)
    with locked(path):
        known = create(path, settings, overwrite)
        with _writing(path):
            for left in (path / PARTIAL).glob(f"*{TEMPORARY}"):  # by runs that were killed
                left.unlink()
        yield known


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
    """Make a folder; FileError if that fails, or if something else is in it."""
    with _writing(path):
        path.mkdir(parents=True, exist_ok=True)
        if not (path / SETTINGS).exists() and any(
            # Of a run that was killed while it wrote the settings.
            entry.name != LOCK and not entry.name.startswith(".gaussmap-")
            for entry in path.iterdir()
        ):
            raise FileError(
                f"'{path}' holds other files and no {SETTINGS}; name a new or empty folder."
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


def remove_shards(folder: Path, first: int) -> None:
    """Remove the shards from a number on: they are of a list that was longer."""
    with _writing(folder):
        for kind in (MANIFEST, POINTS, PARTIAL):  # without its manifest a shard is not there
            for path in (folder / kind).glob("shard-" + 6 * "[0-9]" + "*"):
                if int(path.name.partition(".")[0].removeprefix("shard-")) >= first:
                    path.unlink()


def remove_files(folder: Path, first: int) -> None:
    """Remove the files of the parts from a number on, if there are any."""
    with _writing(folder):
        for path in (folder / FILES).iterdir():
            number = path.name.partition("-")[0].partition(".")[0]
            if number.isdecimal() and int(number) >= first:
                path.unlink()


def _same(old: Settings, new: Settings, path: Path) -> Settings:
    """Return the settings of an existing data set; InputError where the new ones differ."""
    new = Settings.from_json(new.to_json())
    for field in fields(Settings):
        had, wanted = getattr(old, field.name), getattr(new, field.name)
        if field.name == "parts_per_shard" or had == wanted:
            continue
        if field.name in ("gaussmap", "formulas"):
            what = f"was made by another version of gaussmap ({old.gaussmap})"
        elif field.name == "asked":
            what = f"was made with {_differing(old.asked, new.asked)}"
        else:
            what = f"was made with {field.name}={_text(had)}, not {_text(wanted)}"
        raise InputError(f"the data set '{path}' {what}; name another folder, or overwrite it.")
    return old


def _differing(old: Mapping[str, Any], new: Mapping[str, Any]) -> str:
    name = next(x for x in sorted({*old, *new}) if old.get(x) != new.get(x))
    return f"{name}={_text(old.get(name))}, not {_text(new.get(name))}"


def _text(value: object) -> str:
    text = json.dumps(value)
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
    with _lock_file(folder) as file:
        _lock(file, folder)
        yield


def _lock_file(folder: Path) -> IO[bytes]:
    try:
        return open(folder / LOCK, "ab")
    except OSError as error:
        raise FileError(f"'{folder}' cannot be written to: {reason_of(error)}.") from error


def _lock(file: IO[bytes], folder: Path) -> None:
    try:
        import fcntl
    except ImportError:  # Windows
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise FileError(
            f"another run writes to '{folder}'; wait until it ends, or stop it."
        ) from None
    except OSError:
        return
