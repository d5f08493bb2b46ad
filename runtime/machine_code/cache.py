"""Numba's cache of kernels: machine code of the package, and machine code compiled here."""

import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any

from numba.core.caching import NullCache

from ..base.errors import GaussmapWarning
from . import disk, shipped
from .entries import entry_of, kernel_of, key_of


class KernelCache(NullCache):
    """A cache for Numba with the machine code of one kernel, from the package or compiled here."""

    def __init__(self, function: Callable[..., Any]) -> None:
        """Touch no file before the first call."""
        self._function = function
        self._lock: disk.FileLock | None = None

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return a kernel, waiting for a process that compiles it; None to compile it here."""
        if self._lock is not None:
            self._lock.release()  # the last compilation has failed
        key = key_of(self._function, sig)
        pack = shipped.open_pack()
        found = None if pack is None else _restored(pack.get(key), target_context)
        if found is None:
            found = self._kept(key, target_context)
        if found is None:
            say_why()
        return found

    def _kept(self, key: str, context: Any) -> Any:
        folder = disk.kept_folder()
        if folder is None:
            return None
        place = (folder, key, _processor(context))
        lock = disk.lock_of(*place)
        found = _restored(disk.load(*place), context)
        if found is None:
            lock.acquire()
            found = _restored(disk.load(*place), context)
        if found is None:
            self._lock = lock  # until it is compiled
        else:
            lock.release()
        return found

    def save_overload(self, sig: Any, cres: Any) -> None:
        """Cache a kernel that was compiled here, and let waiting processes load it."""
        folder = disk.kept_folder()
        if folder is not None:
            key, processor = key_of(self._function, sig), _processor(cres.target_context)
            with suppress(TypeError):  # a user's kernel, with types that ours do not have
                disk.save(folder, key, processor, entry_of(cres))
        if self._lock is not None:
            self._lock.release()


def _restored(entry: bytes | None, context: Any) -> Any:
    return None if entry is None else kernel_of(entry, context)


def _processor(context: Any) -> object:
    return context.codegen().magic_tuple()


@cache
def say_why() -> None:
    """Warn, once, if the machine code of the package is for versions that are not installed."""
    if others := shipped.misfit():
        warnings.warn(
            f"the compiled kernels of this installation are for {others}: new ones are compiled "
            "here, once, which takes about a minute; install these versions to avoid it.",
            GaussmapWarning,
            stacklevel=2,
        )
