"""Default names of surfaces: the names of their callables, with a number if a name repeats."""

from __future__ import annotations

import threading
from collections import Counter

from ..base.checks import text

__all__ = ["label"]

_used: Counter[str] = Counter()
_lock = threading.Lock()


def label(name: str | None, kind: str, function: object = None) -> str:
    """Return `name` if it is given, or else a default: the name of `function`, or `kind`.

    Default names are distinct in a process: "waves", then "waves 2". Raises InputError if `name` is
    neither None nor a text.
    """
    if name is not None:
        return text(name, "name")
    own = getattr(function, "__name__", "")
    base = own if isinstance(own, str) and own.isidentifier() else kind  # not "<lambda>"
    with _lock:
        _used[base] += 1
        return base if _used[base] == 1 else f"{base} {_used[base]}"
