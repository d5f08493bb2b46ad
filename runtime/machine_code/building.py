"""Compile kernels of the list of signatures into the file that comes with the package.

    python -m gaussmap.runtime.machine_code.building [--usual] [FOLDER]

compiles all kernels, or with --usual the kernels that usual calls need, without running them. The
code is for the level of processors of this architecture; up to SHARES processes compile it. The
file is in FOLDER/compiled, by default in the package. Entries of an earlier file are reused if it
was built from the same sources and versions. With GAUSSMAP_KERNELS=0 nothing is compiled, and no
file is used.
"""

import gc
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from inspect import getsource
from itertools import accumulate
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from numba.core.caching import NullCache
from numba.core.dispatcher import Dispatcher

from . import signatures, sources
from .entries import entry_of, key_of
from .jit import jit
from .processors import Level, changed_options, identity, level_here
from .shipped import SWITCH, Pack, pack_path, write_pack
from .sources import PACKAGE

# Intel's vector library may exist on the machine that builds, but not on others.
OPTIONS = {"NUMBA_CPU_FEATURES": "", "NUMBA_DISABLE_INTEL_SVML": "1"}
# Numba numbers functions in the order in which a process compiles them, and machine code contains
# these numbers. Each process therefore has one share, and the shares do not depend on the number of
# cores: the same sources, in the same folder, give the same bytes.
SHARES = 3


class _Taken(NullCache):
    """A cache for Numba that collects compiled kernels in a dict of entries by their keys."""

    def __init__(self, function: Callable[..., Any], entries: dict[str, bytes]) -> None:
        self._function, self._entries = function, entries

    def save_overload(self, sig: Any, cres: Any) -> None:
        self._entries[key_of(self._function, sig)] = entry_of(cres)


def build(folder: Path = PACKAGE, usual: bool = False) -> Path | None:
    """Make the file of machine code unless it is complete, and return its path.

    Returns None if this architecture has no level of processors.
    """
    path, level, listing = pack_path(folder), level_here(), signatures.read()
    if usual:
        listing = {name: listing[name] for name in signatures.usual()}
    if path is None or level is None:
        return None
    keys, known = dict(_keys(listing)), _known(path)
    if known.keys() == keys.keys():
        return path
    entries = {key: entry for key, entry in known.items() if key in keys}
    lacking = {name: listing[name] for key, name in keys.items() if key not in known}
    if lacking:
        print(f"compiling the kernels of gaussmap into {path}", file=sys.stderr)
        processes = ProcessPoolExecutor(mp_context=get_context("spawn"), max_tasks_per_child=1)
        with _options(level), processes:
            for compiled in processes.map(_compiled, _shares(lacking)):
                entries.update(compiled)
    write_pack(path, dict(sorted(entries.items())))
    return path


def kernel_named(name: str) -> Any:
    """Return the kernel with a qualified name; a formula with this name becomes a kernel."""
    function = signatures.named(name)
    return function if isinstance(function, Dispatcher) else jit(function)


@contextmanager
def _options(level: Level) -> Iterator[None]:
    """Set Numba's options for a level of processors, in processes that start in this context."""
    before = dict(os.environ)
    for name in changed_options():
        del os.environ[name]
    os.environ.update(OPTIONS, NUMBA_CPU_NAME=level.name)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def _keys(listing: signatures.Listing) -> Iterator[tuple[str, str]]:
    """Yield the key of each entry and the name of its kernel."""
    for name, kinds in listing.items():
        function = kernel_named(name).py_func
        for kind in kinds:
            yield key_of(function, tuple(map(signatures.as_types, kind))), name


def _known(path: Path) -> dict[str, bytes]:
    """Return the entries of a file by key; {} if it was built from other sources or versions."""
    try:
        pack = Pack(path)
    except (OSError, ValueError):
        return {}
    if (pack.identity, pack.digest) != (identity(), sources.digest()):
        return {}
    return {key: entry for key in pack.places if (entry := pack.get(key)) is not None}


def _shares(listing: signatures.Listing) -> list[dict[str, Any]]:
    """Divide the signatures, sorted by name, into SHARES shares with about equally long sources.

    Functions that several shares call are compiled in each of these shares; therefore modules with
    similar names, which are related, stay together.
    """
    names = sorted(listing)
    lengths = {x: len(getsource(import_module(x))) for x in map(_module_of, names)}
    ends = dict(zip(lengths, accumulate(lengths.values()), strict=True))
    size = sum(lengths.values()) / SHARES
    shares: list[dict[str, Any]] = [{} for _ in range(SHARES)]
    for name in names:
        middle = ends[_module_of(name)] - lengths[_module_of(name)] / 2
        shares[int(middle / size)][name] = listing[name]
    return shares


def _module_of(name: str) -> str:
    return name.rpartition(".")[0]


def _compiled(listing: Mapping[str, Any]) -> dict[str, bytes]:
    """Compile each kernel for each of its signatures, and return the entries by key.

    Each share of kernels is compiled in a process of its own.
    """
    gc.disable()  # Numba also numbers types, and renumbers those that were garbage-collected.
    entries: dict[str, bytes] = {}
    for name, kinds in listing.items():
        kernel = kernel_named(name)
        kernel._cache = _Taken(kernel.py_func, entries)
        for kind in kinds:
            kernel.compile(tuple(map(signatures.as_types, kind)))
    return entries


if __name__ == "__main__":
    if os.environ.get(SWITCH) != "0":
        names = [x for x in sys.argv[1:] if x != "--usual"]
        build(*map(Path, names), usual="--usual" in sys.argv)
