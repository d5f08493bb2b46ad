"""Processes whose work may hang or crash: they get limits, and end when their parent ends."""

import os
import signal
from contextlib import suppress

# The option of Linux's prctl that sets the signal sent when the parent ends.
PR_SET_PDEATHSIG = 1


def end_with_parent(by: str, parent: int | None = None) -> None:
    """Let the system send this process the signal named `by` when its parent ends (Linux only).

    If `parent`, the process id of the parent, is given and the parent has already ended, end at
    once.
    """
    with suppress(AttributeError, OSError, TypeError):
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, getattr(signal, by))
        if parent is not None and os.getppid() != parent:
            os._exit(1)


def limit(**most: int) -> None:
    """Set limits of this process, such as RLIMIT_CPU, where they exist; forbid core files."""
    with suppress(ImportError):  # some systems have no limits
        import resource

        for name, wanted in {**most, "RLIMIT_CORE": 0}.items():
            with suppress(AttributeError, OSError, ValueError):
                kind = getattr(resource, name)
                _, hard = resource.getrlimit(kind)
                low = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
                resource.setrlimit(kind, (low, hard))
