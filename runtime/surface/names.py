"""Default names of surfaces: those of their callables, numbered if they repeat."""

from __future__ import annotations

import threading
from collections import Counter

from ..base.checks import text

__all__ = ["label"]

_used: Counter[str] = Counter()
_lock = threading.Lock()


def label(name: str | None, kind: str, function: object = None) -> str:
    """Return a given name, or else the name of a function or of a kind of surface.

    Default names are distinct in a process: "waves", then "waves 2". InputError unless a given name
    is a text.
    """
    if name is not None:
        return text(name, "name")
    own = getattr(function, "__name__", "")
    base = own if isinstance(own, str) and own.isidentifier() else kind  # not "<lambda>"
    with _lock:
        _used[base] += 1
        return base if _used[base] == 1 else f"{base} {_used[base]}"
