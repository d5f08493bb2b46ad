"""Processes that do what may hang or crash: they end with the one that waits, within limits."""

from __future__ import annotations

import os
import signal
from contextlib import suppress

__all__ = ["end_with_parent", "limit"]

# Of Linux: the signal that a process gets when its parent ends.
PR_SET_PDEATHSIG = 1


def end_with_parent(by: str, parent: int | None = None) -> None:
    """Let the system end this process by a signal when its parent is killed, if it can.

    With the number of the parent, it ends at once if that is gone already.
    """
    with suppress(AttributeError, OSError, TypeError):
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, getattr(signal, by))
        if parent is not None and os.getppid() != parent:
            os._exit(1)


def limit(**most: int) -> None:
    """Set limits of the system, such as RLIMIT_CPU, where it has them; there are no core files."""
    with suppress(ImportError):  # some systems have none
        import resource

        for name, wanted in {**most, "RLIMIT_CORE": 0}.items():
            with suppress(AttributeError, OSError, ValueError):
                kind = getattr(resource, name)
                _, hard = resource.getrlimit(kind)
                low = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
                resource.setrlimit(kind, (low, hard))
