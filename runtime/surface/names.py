"""Names of surfaces whose user gave none: those of their callables, numbered where they repeat."""

from __future__ import annotations

import threading
from collections import Counter

from ..base.checks import text

__all__ = ["label"]

_used: Counter[str] = Counter()
_lock = threading.Lock()


def label(name: str | None, kind: str, function: object = None) -> str:
    """Return a name that was given, or else that of a function or a kind of surface.

    In one process these are distinct: "waves", then "waves 2". InputError unless a name is a text.
    """
    if name is not None:
        return text(name, "name")
    own = getattr(function, "__name__", "")
    base = own if isinstance(own, str) and own.isidentifier() else kind  # "<lambda>" is none
    with _lock:
        _used[base] += 1
        return base if _used[base] == 1 else f"{base} {_used[base]}"
