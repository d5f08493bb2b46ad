"""The disk cache of machine code that was compiled here: a folder with a file for each entry.

The folder is named after the digest of all sources of kernels: if a formula changes, all kernels
are compiled again, and if the change is undone, the old machine code is found. (Numba's own cache
checks only the file of a kernel: https://github.com/numba/numba/issues/1833.)
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import IO, Any

from numba.core import config as numba_config

from ..base.errors import GaussmapWarning
from .entries import replace_file
from .processors import changed_options, identity
from .sources import PACKAGE, digest
from .trust import is_private, private_content

config: Any = numba_config  # Numba creates its attributes at run time
# Folders of other sources are removed after this many days without use.
DAYS_KEPT = 30
# In seconds: the longest wait for another process that compiles, and the polling interval.
LONGEST_WAIT, POLL = 120.0, 0.02
SUFFIX = ".kernel"


@cache
def kept_folder() -> Path | None:
    """Return the folder for machine code of these sources, or None if no folder can be used.

    It is in NUMBA_CACHE_DIR if that is set, otherwise next to the sources, or else in the user's
    cache folder. A folder that others can write to is not used: its entries could run anything.
    """
    asked, refused = config.CACHE_DIR, None
    for base in [Path(asked)] if asked else [PACKAGE / "__pycache__", *_of_user()]:
        folder = base / f"kernels-{digest()}"
        try:
            base.mkdir(parents=True, exist_ok=True)
            folder.mkdir(mode=0o700, exist_ok=True)
            if not is_private(folder.lstat()):
                refused = folder
                continue
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        remove_unused(folder)
        return folder
    if refused is not None:
        warnings.warn(
            f"kernels are compiled in each process: others than you may write to '{refused}', "
            "so that what is kept there is not used; remove it, or set NUMBA_CACHE_DIR.",
            GaussmapWarning,
            stacklevel=2,
        )
    return None


def _of_user() -> list[Path]:
    """Return a list with the user's cache folder, empty for a user without a home folder."""
    with suppress(RuntimeError):
        return [Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "gaussmap"]
    return []


def load(folder: Path, key: str, processor: object) -> bytes | None:
    """Return an entry compiled for a processor, possibly damaged, or None."""
    with suppress(OSError):
        return private_content(_path(folder, key, processor))
    return None


def save(folder: Path, key: str, processor: object, entry: bytes) -> None:
    """Write an entry atomically; ignore errors of the disk."""
    with suppress(OSError):
        replace_file(_path(folder, key, processor), entry, 0o600)


def lock_of(folder: Path, key: str, processor: object) -> FileLock:
    """Return the lock that a process takes to compile an entry."""
    return FileLock(_path(folder, key, processor).with_suffix(".lock"))


def entries_in(folder: Path) -> Iterator[bytes]:
    """Yield all entries of a folder, in the order of their file names."""
    for path in sorted(folder.glob(f"*{SUFFIX}")):
        if (content := private_content(path)) is not None:
            yield content


def _path(folder: Path, key: str, processor: object) -> Path:
    """Return the file of an entry: one for each set of versions, options and processor."""
    what = repr((key, processor, identity(), changed_options()))
    return folder / f"{hashlib.sha256(what.encode()).hexdigest()[:32]}{SUFFIX}"


class FileLock:
    """A lock between processes: if many start together, only one of them compiles a kernel.

    The lock is released when its process ends. On systems without file locks, each process
    compiles the kernel.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: IO[bytes] | None = None

    def acquire(self) -> None:
        """Wait for the lock, at most LONGEST_WAIT seconds."""
        with suppress(ImportError, OSError):  # Windows; read-only folders
            import fcntl

            self._file = open(self._path, "ab")  # noqa: SIM115 - it is open as long as it locks
            end = time.monotonic() + LONGEST_WAIT
            while time.monotonic() < end:
                try:
                    fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    return
                except BlockingIOError:
                    time.sleep(POLL)
            self.release()

    def __del__(self) -> None:
        self.release()

    def release(self) -> None:
        """Release the lock."""
        file, self._file = self._file, None
        if file is not None:
            file.close()


def remove_unused(folder: Path) -> None:
    """Mark a folder as used; remove folders of other digests, unused for DAYS_KEPT days."""
    oldest = time.time() - DAYS_KEPT * 24 * 3600
    with suppress(OSError):
        os.utime(folder)
        for other in folder.parent.glob("kernels-" + 16 * "[0-9a-f]"):
            if other.stat().st_mtime < oldest:
                shutil.rmtree(other, ignore_errors=True)
