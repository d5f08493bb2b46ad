"""How the functions of this package are compiled, and where their machine code is kept.

Numba's own cache looks at the file of a kernel only, and not at the formulas and helpers that it
calls (https://github.com/numba/numba/issues/1833). Machine code is kept in a folder named after a
digest of all sources that it may be made of instead: a changed formula is compiled again.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core import config

from ...generated.vectors import inline
from .. import compiling  # noqa: F401 - it tells that kernels are compiled

__all__ = ["inline", "jit", "loop"]

Function = TypeVar("Function", bound=Callable[..., Any])

PACKAGE = Path(__file__).parents[2]
SOURCES = ("generated", "runtime/kernels")
# Kernels are called from Python and from one another, and never from C.
OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False, "no_cfunc_wrapper": True}


def loop(function: Function) -> Function:
    """Compile a part of kernels once, as a function of its own.

    It is for what is long or called in several places, and allocates no memory: arrays come from
    its caller. Short functions are `inline`, that is, copied into their callers.
    """
    return numba.njit(_nrt=False, no_cpython_wrapper=True, **OPTIONS)(function)  # pyright: ignore


def jit(function: Function) -> Function:
    """Compile a kernel on its first call from Python; keep its machine code on disk if possible.

    Kernels allocate no memory either: Python hands them the arrays that they need.
    """
    folder = cache_folder()
    if folder is None:
        return numba.njit(_nrt=False, **OPTIONS)(function)  # pyright: ignore
    with _cache_in(folder):
        return numba.njit(_nrt=False, cache=True, **OPTIONS)(function)  # pyright: ignore


@cache
def cache_folder() -> Path | None:
    """Return the folder for machine code made of these sources; None if none can be written.

    That is one in the user's NUMBA_CACHE_DIR if that is set, else beside the sources, or else in
    the user's folder of caches.
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
        return folder
    return None


@cache
def digest() -> str:
    """Return a digest of all sources that kernels are made of."""
    paths = sorted(path for name in SOURCES for path in (PACKAGE / name).glob("*.py"))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in paths)).hexdigest()[:16]


@contextmanager
def _cache_in(folder: Path) -> Iterator[None]:
    """Let Numba keep machine code in a folder; it chooses that when a function is decorated."""
    before = config.CACHE_DIR
    config.CACHE_DIR = str(folder)
    try:
        yield
    finally:
        config.CACHE_DIR = before
