"""Shapes of Open CASCADE: iteration over subshapes, and shapes as keys of dictionaries.

The code uses only names that versions 7.9 and 8.0 share.
"""

# pyright: reportMissingImports=false

from collections.abc import Iterator
from importlib import import_module
from typing import Any

from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location


def parts_of(shape: Any, kind: Any, avoided: Any = None) -> Iterator[Any]:  # noqa: ANN401
    """Yield the subshapes of one kind, except inside subshapes of the kind `avoided`."""
    explorer = TopExp_Explorer(shape, kind) if avoided is None else TopExp_Explorer(
        shape, kind, avoided
    )  # fmt: skip
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


class Key:
    """A shape as a dictionary key, which is equal for the reversed shape.

    Unless `placed`, it is also equal for copies of the shape in other placements.
    """

    __slots__ = ("_shape",)

    def __init__(self, shape: Any, placed: bool = True) -> None:  # noqa: ANN401
        self._shape = shape if placed else shape.Located(TopLoc_Location())

    def __hash__(self) -> int:
        return hash(self._shape)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Key) and self._shape.IsSame(other._shape)


def sequence(old: str, new: str) -> Any:  # noqa: ANN401
    """Return an empty collection of the class `old` ("module.name") in 7.9, or `new` in 8.0."""
    module, name = old.split(".")
    made = getattr(import_module(f"OCP.{module}"), name, None)
    return (made or getattr(import_module("OCP.collections"), new))()


def indexed_shapes() -> Any:  # noqa: ANN401
    """Return an empty map that numbers shapes from 1; a shape and its reverse share a number."""
    return sequence(
        "TopTools.TopTools_IndexedMapOfShape", "IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher"
    )


def direct_class(thing: Any) -> str:  # noqa: ANN401
    """Return the name of the class of a curve or surface, such as Geom_Plane."""
    return thing.DynamicType().Name()
