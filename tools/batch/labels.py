"""The labels of parts: a number for each of them, from a mapping or from the manifest."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...runtime.base.checks import known_name, real_values
from ...runtime.base.errors import InputError, shown
from .manifest import COLUMNS

__all__ = ["checked_labels"]

NUMBERS = tuple(name for name, column in COLUMNS.items() if column.type != "str")


def checked_labels(
    labels: str | Mapping[Any, float] | ArrayLike | None, manifest: Callable[[Sequence[str]], Any]
) -> tuple[dict[int, Any] | None, np.dtype[Any] | None]:
    """Return the labels keyed by part index, and their type: int64 or float64.

    `manifest` returns the requested columns of the manifest.
    """
    if labels is None:
        return None, None
    if isinstance(labels, str):
        known_name(labels, NUMBERS, "column of numbers in the manifest")
        table = manifest(("part", labels) if labels != "part" else ("part",))
        known = dict(zip(table["part"].to_pylist(), table[labels].to_pylist(), strict=True))
    elif isinstance(labels, Mapping):
        known = dict(labels)
        if any(isinstance(key, str) for key in known):
            known = _by_part(known, manifest(("part", "name")))
    else:
        known = _of_array(labels, manifest(("part",))["part"].to_pylist())
    return known, _type_of(known)


def _by_part(labels: Mapping[Any, Any], table: Any) -> dict[int, Any]:  # noqa: ANN401
    """Return labels keyed by part index; InputError for a name that several parts have."""
    if not all(isinstance(key, str) for key in labels):
        raise InputError("labels are by the names of parts, or by their numbers, not by both.")
    known: dict[str, int] = {}
    for part, name in zip(table["part"].to_pylist(), table["name"].to_pylist(), strict=True):
        if name in labels and known.setdefault(name, part) != part:
            raise InputError(
                f"parts {known[name]} and {part} have the same name {shown(name)}, so that labels "
                "by name are ambiguous; give an array with one for each part, or label numbers."
            )
    return {part: labels[name] for name, part in known.items()}


def _of_array(labels: ArrayLike, parts: Sequence[int]) -> dict[int, Any]:
    """Return the entries of an array, one for each part, keyed by part index."""
    values = real_values(labels, "labels")
    count = max(parts, default=-1) + 1
    if values.shape != (count,):
        raise InputError(
            f"labels must be an array with one number for each of {count:,} parts, of the shape "
            f"({count},), not {values.shape}; or a mapping, or the name of a column."
        )
    return dict(enumerate(values.tolist()))


def _type_of(labels: Mapping[int, Any]) -> np.dtype[Any]:
    """Return the type of labels; a null, as for a failed part, makes it float64."""
    floating = False
    for value in labels.values():
        if value is None or isinstance(value, float | np.floating):
            floating = True
        elif not isinstance(value, int | np.integer | np.bool_):
            raise InputError(f"a label must be a number, not {shown(value)}.")
    return np.dtype(np.float64 if floating else np.int64)
