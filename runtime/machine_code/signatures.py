"""The list of signatures of kernels, `signatures.json`.

`building` compiles these kernels into the file of machine code that comes with the package.
`usual.json` names the kernels that usual calls need: `pip install .` compiles these.

A type is a text, as "float64", "int64 2 C" (an array: item, dimensions, layout) or "int64 2 C
readonly", a list of types (a tuple), {"module.Class": a list of types} (a named tuple), or "none".
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from numba import types

SIGNATURES = Path(__file__).with_suffix(".json")
USUAL = SIGNATURES.with_name("usual.json")
# For the qualified name of each kernel, the list of its signatures. A signature is the list of the
# types of all arguments.
Listing = Mapping[str, Sequence[Any]]


def read() -> Listing:
    """Return the signatures of all kernels, with types as in the file."""
    return json.loads(SIGNATURES.read_text(encoding="utf-8"))


def usual() -> list[str]:
    """Return the names of the kernels that usual calls need."""
    return json.loads(USUAL.read_text(encoding="utf-8"))


def write(listing: Listing) -> None:
    """Write the list of signatures, one line for each signature."""
    blocks = []
    for name in sorted(listing):
        lines = ",\n  ".join(sorted(map(json.dumps, listing[name])))
        blocks.append(f" {json.dumps(name)}: [\n  {lines}\n ]")
    SIGNATURES.write_text("{\n" + ",\n".join(blocks) + "\n}\n", encoding="utf-8")


def write_usual(names: Iterable[str]) -> None:
    """Write the list of the kernels that usual calls need."""
    USUAL.write_text(json.dumps(sorted(names), indent=1) + "\n", encoding="utf-8")


def as_json(kind: Any) -> Any:
    """Return a type of Numba as JSON; TypeError for one that no kernel takes."""
    if isinstance(kind, types.Array):
        readonly = "" if kind.mutable else " readonly"
        return f"{kind.dtype} {kind.ndim} {kind.layout}{readonly}"
    if isinstance(kind, types.BaseTuple):
        items = [as_json(x) for x in kind]  # pyright: ignore[reportGeneralTypeIssues]
        made = getattr(kind, "instance_class", None)
        if made is None:
            return items
        return {f"{made.__module__}.{made.__qualname__}": items}
    if isinstance(kind, types.Number | types.Boolean | types.NoneType):
        return str(kind)
    raise TypeError(f"{kind} in a signature of a kernel")


def as_types(kind: Any) -> Any:
    """Return the type of Numba for a type in JSON."""
    if isinstance(kind, list):
        return types.BaseTuple.from_types([as_types(x) for x in kind])
    if isinstance(kind, dict):
        ((name, items),) = kind.items()
        return types.BaseTuple.from_types([as_types(x) for x in items], named(name))
    item, *array = kind.split()
    if not array:
        return getattr(types, "boolean" if item == "bool" else item)
    dimensions, layout, *readonly = array
    return types.Array(as_types(item), int(dimensions), layout, readonly=bool(readonly))


def named(name: str) -> Any:
    """Return the object with a name such as "gaussmap.runtime.tape.kernels.points.Tape"."""
    module, _, name = name.rpartition(".")
    return getattr(import_module(module), name)
