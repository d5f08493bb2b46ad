"""The check of requests against free memory, before anything is allocated.

A system that overcommits memory kills the process when the memory is used, without a MemoryError
that could be caught. `COSTS` lists the memory of each kind of request.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from .errors import InputError

GIB = 2.0**30
# Smaller requests are not checked: the query of free memory takes as long as a small sampling.
UNCHECKED = 2.0**24
# The part of the free memory that a request may take: other programs need memory as well, and
# estimates are not exact.
SHARE = 0.75
PROC, CONTROL_GROUPS = Path("/proc"), Path("/sys/fs/cgroup")


class Cost(NamedTuple):
    """The peak memory of a request: for each item, `each` bytes, and `rows` times its stored bytes.

    `things` is the name of the items; `instead` is advice for requests that are too large.
    """

    things: str
    each: float
    rows: float
    instead: str


FEWER = "use fewer; a stream yields samples at normals in chunks"
LARGER = "ask for fewer samples, or a larger angle or coverage"
# Measured values; tests/runtime/base/test_memory.py measures them again.
COSTS: dict[str, Cost] = {
    "icosphere": Cost("normals", 24.0, 0.0, FEWER),
    "normals": Cost("normals", 24.0, 0.0, FEWER),
    "random": Cost("normals", 48.0, 0.0, FEWER),
    "healpix": Cost("normals", 48.0, 0.0, FEWER),
    "circle": Cost("normals", 137.0, 0.0, "use fewer"),
    "cap": Cost("normals", 96.0, 0.0, "use fewer"),
    "polygon": Cost("normals", 24.0, 1.0, "use fewer"),
    "numbers": Cost("numbers", 9.0, 0.0, "use fewer"),
    # "search" is for normals that are sorted into bins, "gauss" for one sample at each normal.
    "search": Cost("normals", 52.0, 0.0, FEWER),
    "stored": Cost("samples", 0.0, 1.0, "use fewer normals, fewer fields or float32"),
    "gauss": Cost("samples", 76.0, 1.0, "use fewer, fewer fields, float32, or a stream"),
    # These densities need more than "gauss": they choose the samples from several candidates each.
    "balanced": Cost("samples", 3700.0, 0.0, FEWER),
    "uniform": Cost("samples", 3600.0, 0.0, FEWER),
    "aligned": Cost("samples", 900.0, 0.0, FEWER),
    "candidates": Cost("candidates for samples", 600.0, 0.0, LARGER),
    "part": Cost("samples", 4.6e3, 0.0, "use fewer"),
    "curve": Cost("samples", 420.0, 0.0, "use fewer"),
    # Of these 600 bytes, 450 are in arrays, and the rest in Qhull.
    "mesh": Cost("vertices of a mesh", 600.0, 0.0, "use fewer samples, or parts of patches"),
    "cells": Cost("cells", 120.0, 0.0, "use fewer, or give a tolerance, which chooses them"),
    "heights": Cost(
        "heights", 250.0, 0.0,
        "crop the file, or coarsen it, as with gdal_translate -outsize 25% 25% -r average",
    ),
}  # fmt: skip


def estimate(request: str, number: float, row: float = 0.0) -> float:
    """Return the memory of a number of items in bytes; `row` are the stored bytes of one item."""
    cost = COSTS[request]
    return number * (cost.each + cost.rows * row)


def check_memory(request: str, number: float, row: float = 0.0) -> None:
    """Raise InputError if a request needs more than `SHARE` of the free memory; see `estimate`."""
    needed = estimate(request, number, row)
    if needed <= UNCHECKED or needed <= SHARE * (free := free_memory()):
        return
    things, *_, instead = COSTS[request]
    raise InputError(
        f"{number:,.0f} {things} need about {needed / GIB:,.1f} GiB of memory; "
        f"{max(free, 0.0) / GIB:,.1f} GiB are free, a quarter of which is left to other programs; "
        f"{instead}."
    )


def memory_limit() -> float:
    """Return the memory limit of this process in bytes; infinity if it is unknown."""
    return min(limit for limit, _ in _limits())


def free_memory() -> float:
    """Return the memory that this process can still allocate, in bytes; infinity if unknown."""
    return min(limit - used for limit, used in _limits())


def _limits() -> Iterator[tuple[float, float]]:
    """Yield the memory limits of the machine and of control groups, and the used part, in bytes."""
    yield float("inf"), 0.0
    with suppress(AttributeError, OSError, ValueError):  # Windows has no sysconf
        total = os.sysconf("SC_PHYS_PAGES") * float(os.sysconf("SC_PAGE_SIZE"))
        yield total, total - _line(PROC / "meminfo", "MemAvailable:", total / 1024.0) * 1024.0
    with suppress(OSError):  # a system without control groups
        for line in (PROC / "self" / "cgroup").read_text(encoding="utf-8").splitlines():
            if line.startswith("0::"):
                yield from _limits_of_group(line.removeprefix("0::"))


def _limits_of_group(path: str) -> Iterator[tuple[float, float]]:
    """Yield limits and used parts of the memory of a control group and of its ancestors.

    `path` is the group of the process, as the system gives it. In a container this may be a path on
    the host, which does not exist here; the root is then the group of the process.
    """
    group = CONTROL_GROUPS / path.lstrip("/")
    for each in (group, *group.parents):
        with suppress(OSError, ValueError):  # "max", or no such group
            most = float(int((each / "memory.max").read_text(encoding="ascii")))
            used = float(int((each / "memory.current").read_text(encoding="ascii")))
            # Cached files do not count as used: the system can drop them.
            yield most, used - _line(each / "memory.stat", "inactive_file", 0.0)
        if each == CONTROL_GROUPS:
            return


def _line(path: Path, name: str, default: float) -> float:
    """Return the number after a name in a file of lines "name number", or the default."""
    with suppress(OSError):
        for line in path.read_text(encoding="ascii").splitlines():
            if line.startswith(f"{name} "):
                return float(line.split()[1])
    return default
