"""What is made of an object once, and kept as long as the object lives."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import fields
from typing import Any, TypeVar

__all__ = ["Immutable", "kept"]

Value = TypeVar("Value")


class Immutable:
    """A frozen dataclass that is pickled as its fields, without what is made of them."""

    def __getstate__(self) -> dict[str, Any]:
        """Return what is pickled."""
        return {x.name: getattr(self, x.name) for x in fields(self)}  # type: ignore[arg-type]


def kept(owner: object, key: Hashable, make: Callable[[], Value]) -> Value:
    """Return what was made of an object under a key, or make it and keep it.

    Two threads at once may make it twice, and both get the same one.
    """
    values = vars(owner).setdefault("_kept", {})
    if key not in values:
        values.setdefault(key, make())
    return values[key]
