"""The compilation of the functions of this package, and the cache of their machine code.

Numba's own cache looks at the file of a kernel only, and not at the formulas and helpers that it
calls (https://github.com/numba/numba/issues/1833). Here machine code is cached in a
folder named after a digest of all sources of kernels: after a change of a formula the kernels are
compiled again, and after its reversal they are found again. Damaged files are compiled again, too.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import shutil
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import IO, Any, TypeVar

import numba
from numba import types
from numba.core import config as numba_config
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.extending import intrinsic

from ...generated.vectors import inline
from ..base import compiling  # noqa: F401 - installs the notice of compilation

__all__ = ["inline", "jit", "long_vectors", "loop"]

Function = TypeVar("Function", bound=Callable[..., Any])

config: Any = numba_config  # Numba makes its attributes at run time
PACKAGE = Path(__file__).parents[2]
SOURCES = (
    "generated/*.py",
    "runtime/kernels/*.py",
    "tools/kernels/*.py",
    "runtime/base/tolerances.py",
)
# Folders of other sources are removed after this many days without use.
DAYS_KEPT = 30
# Kernels of the catalogue are made when they are first used, perhaps by several threads.
LOCK = threading.Lock()
# In seconds: how long a process waits for another one that compiles, and how often it looks.
LONGEST_WAIT, POLL = 120.0, 0.02
# Kernels are called from Python and from one another, and never from C.
OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False, "no_cfunc_wrapper": True}


def loop(function: Function) -> Function:
    """Compile a part of kernels once, as a function of its own.

    This is for functions that are long or called in several places. They allocate no memory: arrays
    come from the caller. Short functions are `inline`, that is, copied into their callers.
    """
    return numba.njit(_nrt=False, no_cpython_wrapper=True, **OPTIONS)(function)  # pyright: ignore


def jit(function: Function) -> Function:
    """Compile a kernel on its first call from Python; keep its machine code on disk if possible.

    Kernels allocate no memory either: all arrays are arguments.
    """
    kernel = numba.njit(_nrt=False, **OPTIONS)(function)  # pyright: ignore
    folder = cache_folder()
    if folder is not None and not config.DISABLE_JIT:
        kernel._cache = KernelCache(function, folder)
    return kernel


def _long_vectors(_: object) -> tuple[Any, Callable[..., Any]]:
    """Ask for the longest vectors of the processor in the function that calls this first.

    LLVM uses half of their length unless it is told to. The results are the same.
    """

    def lowered(context: Any, builder: Any, *_: object) -> Any:
        # llvmlite's own `add` knows no attributes with values.
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.void(), lowered


long_vectors: Any = (lambda: None) if config.DISABLE_JIT else intrinsic(_long_vectors)


class KernelCache(FunctionCache):
    """The machine code of one kernel, in the folder of the digest."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        """Let Numba choose names inside the folder; files of the same digest are never stale."""
        with LOCK:
            before = config.CACHE_DIR
            config.CACHE_DIR = str(folder)
            try:
                super().__init__(function)
            finally:
                config.CACHE_DIR = before
        self._cache_file = CheckedFile(self.cache_path, self._impl.filename_base, "")
        self._lock = FileLock(folder / f"{self._impl.filename_base}.lock")

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return machine code; wait for a process that compiles it now. None: this one has to."""
        found = super().load_overload(sig, target_context)
        if found is None:
            self._lock.acquire()
            found = super().load_overload(sig, target_context)
            if found is not None:
                self._lock.release()
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save machine code, and let waiting processes load it."""
        super().save_overload(sig, data)
        self._lock.release()


class FileLock:
    """A lock between processes: many that start at a time compile each kernel once, not each.

    It ends with its process. Where there are no locks, each process compiles.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: IO[bytes] | None = None

    def acquire(self) -> None:
        """Wait for the lock."""
        self.release()  # an earlier compilation may have failed
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
        self.release()  # compilation has failed

    def release(self) -> None:
        """Let others have it."""
        file, self._file = self._file, None
        if file is not None:
            file.close()


class CheckedFile(IndexDataCacheFile):
    """Machine code on disk with a checksum: damaged files count as missing."""

    def _load_index(self) -> dict[Any, str]:
        try:
            return super()._load_index()
        except Exception:  # damaged pickles raise anything
            return {}

    def _load_data(self, name: str) -> object:
        stored = Path(self._data_path(name)).read_bytes()
        checksum, data = stored[:32], stored[32:]
        if hashlib.sha256(data).digest() != checksum:
            raise OSError(f"{name} is damaged")  # which `load` takes as missing
        return pickle.loads(data)

    def _save_data(self, name: str, data: object) -> None:
        dumped = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(hashlib.sha256(dumped).digest() + dumped)

    def save(self, key: object, data: object) -> None:
        """Save machine code; ignore errors of the disk."""
        with suppress(OSError):
            super().save(key, data)


@cache
def cache_folder() -> Path | None:
    """Return the folder for machine code made of these sources; None if none can be written.

    It is in NUMBA_CACHE_DIR if that is set, else next to the sources, or else in the user's cache
    folder.
    """
    asked = config.CACHE_DIR
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    for base in [Path(asked)] if asked else [PACKAGE / "__pycache__", home / "gaussmap"]:
        folder = base / f"kernels-{digest()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        remove_unused(folder)
        return folder
    return None


@cache
def digest() -> str:
    """Return a digest of all sources that kernels are made of."""
    paths = sorted(path for name in SOURCES for path in PACKAGE.glob(name))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in paths)).hexdigest()[:16]


def remove_unused(folder: Path) -> None:
    """Mark a folder as used; remove the folders of other digests that are long unused."""
    oldest = time.time() - DAYS_KEPT * 24 * 3600
    with suppress(OSError):
        os.utime(folder)
        for other in folder.parent.glob("kernels-" + 16 * "[0-9a-f]"):
            if other.stat().st_mtime < oldest:
                shutil.rmtree(other, ignore_errors=True)
