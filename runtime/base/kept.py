"""Values that are computed once for an object and cached as long as it lives."""

from collections.abc import Callable, Hashable
from dataclasses import fields
from typing import Any, TypeVar

Value = TypeVar("Value")


class Immutable:
    """Base class of frozen dataclasses that are pickled as their fields, without cached values."""

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields, which are pickled."""
        return {x.name: getattr(self, x.name) for x in fields(self)}  # type: ignore[arg-type]


def kept(owner: object, key: Hashable, make: Callable[[], Value]) -> Value:
    """Return the value cached for an object under a key, computing it if it is missing.

    Two threads may compute it at the same time; both get the same object.
    """
    values = vars(owner).setdefault("_kept", {})
    if key not in values:
        values.setdefault(key, make())
    return values[key]
