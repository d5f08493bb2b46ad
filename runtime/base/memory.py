"""The check of requests against the memory of this machine, before anything is allocated.

A system that overcommits memory kills the process when the memory is used; then there is no
MemoryError to catch.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from .errors import InputError

__all__ = ["check_memory", "memory_limit"]

GIB = 2.0**30
# The memory limit of a Linux container.
CONTAINER = Path("/sys/fs/cgroup/memory.max")


def memory_limit() -> float:
    """Return the most memory of this process in bytes; infinity if it is unknown."""
    limits = [float("inf")]
    with suppress(AttributeError, OSError, ValueError):  # Windows has no sysconf
        limits.append(float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")))
    with suppress(ImportError, OSError, ValueError):
        import resource

        for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA):
            soft, _ = resource.getrlimit(kind)
            if soft != resource.RLIM_INFINITY:
                limits.append(float(soft))
    with suppress(OSError, ValueError):  # "max", or a system without control groups
        limits.append(float(int(CONTAINER.read_text(encoding="ascii"))))
    return min(x for x in limits if x > 0.0)


def check_memory(bytes_needed: float, what: str) -> None:
    """Raise InputError if `bytes_needed` exceed the memory limit; `what` needs them."""
    limit = memory_limit()
    if bytes_needed > limit:
        raise InputError(
            f"{what} need at least {bytes_needed / GIB:,.0f} GiB of memory, and there are "
            f"{limit / GIB:,.1f} GiB; use fewer."
        )
