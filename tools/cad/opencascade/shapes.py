"""Shapes of Open CASCADE: going through their parts, and tables that have them as keys.

Only names that its versions 7.9 and 8.0 share are used.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Generic, TypeVar

from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location

__all__ = ["Table", "direct_class", "parts_of", "sequence"]

Value = TypeVar("Value")


def parts_of(shape: Any, kind: Any, avoided: Any = None) -> Iterator[Any]:  # noqa: ANN401
    """Yield the parts of one kind of a shape, but for those inside of parts of another kind."""
    explorer = TopExp_Explorer(shape, kind) if avoided is None else TopExp_Explorer(
        shape, kind, avoided
    )  # fmt: skip
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


class Table(Generic[Value]):
    """Values by shape; a shape and its reverse are the same, and placements count or do not."""

    def __init__(self, placed: bool = True) -> None:
        self._placed = placed
        self._rows: dict[int, list[tuple[Any, Value]]] = {}
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def set(self, shape: Any, value: Value) -> None:  # noqa: ANN401
        """Set the value of a shape that has none; the first one stays."""
        key = self._key(shape)
        row = self._rows.setdefault(hash(key), [])
        if not any(key.IsSame(x) for x, _ in row):
            row.append((key, value))
            self._count += 1

    def get(self, shape: Any) -> Value | None:  # noqa: ANN401
        """Return the value of a shape, or None."""
        key = self._key(shape)
        for other, value in self._rows.get(hash(key), ()):
            if key.IsSame(other):
                return value
        return None

    def _key(self, shape: Any) -> Any:  # noqa: ANN401
        return shape if self._placed else shape.Located(TopLoc_Location())


def sequence(old: str, new: str) -> Any:  # noqa: ANN401
    """Return an empty sequence, whose class version 7.9 calls `module.name` and 8.0 `new`."""
    import importlib

    module, name = old.split(".")
    made = getattr(importlib.import_module(f"OCP.{module}"), name, None)
    if made is None:
        made = getattr(importlib.import_module("OCP.collections"), new)
    return made()


def direct_class(thing: Any) -> str:  # noqa: ANN401
    """Return the name of the class of a curve or surface, such as Geom_Plane."""
    return thing.DynamicType().Name()
