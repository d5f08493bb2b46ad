"""The Python function behind a compiled formula: it runs on integers of any size, and on arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["plain"]


def plain(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the uncompiled function; under NUMBA_DISABLE_JIT it is that already."""
    return getattr(function, "py_func", function)
