"""The labels of parts: a number for each of them, from a mapping or from the manifest."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ...runtime.base.checks import known_name
from ...runtime.base.errors import InputError, shown
from .manifest import COLUMNS

__all__ = ["checked_labels"]

NUMBERS = tuple(name for name, (kind, *_) in COLUMNS.items() if kind != "string")


def checked_labels(
    labels: str | Mapping[Any, float] | None, manifest: Callable[[Sequence[str]], Any]
) -> tuple[dict[int, Any] | None, np.dtype[Any] | None]:
    """Return the labels by the numbers of the parts, and their type: int64 or float64.

    `manifest` returns the columns of the manifest that it is given.
    """
    if labels is None:
        return None, None
    if isinstance(labels, str):
        known_name(labels, NUMBERS, "column of numbers in the manifest")
        table = manifest(("part", labels) if labels != "part" else ("part",))
        known = dict(zip(table["part"].to_pylist(), table[labels].to_pylist(), strict=True))
    elif isinstance(labels, Mapping):
        known = dict(labels)
    else:
        raise InputError(f"labels must be a mapping or the name of a column, not {shown(labels)}.")
    if any(isinstance(key, str) for key in known):
        table = manifest(("part", "name"))
        named = zip(table["part"].to_pylist(), table["name"].to_pylist(), strict=True)
        known = {part: known[name] for part, name in named if name in known}
    return known, _type_of(known)


def _type_of(labels: Mapping[int, Any]) -> np.dtype[Any]:
    """Return the type of labels; null, as of parts that failed, makes it float64."""
    floating = False
    for value in labels.values():
        if value is None or isinstance(value, float | np.floating):
            floating = True
        elif not isinstance(value, int | np.integer | np.bool_):
            raise InputError(f"a label must be a number, not {shown(value)}.")
    return np.dtype(np.float64 if floating else np.int64)
