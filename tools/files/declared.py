"""Values of JSON, checked against the types that a dataclass declares for its entries.

A type is int, float, str, bool, dict, a tuple of one of these, or a union; `Annotated` adds rules.
Errors are ValueErrors with a sentence that names the entry.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection
from dataclasses import MISSING, fields
from types import NoneType, UnionType
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

from ...runtime.base.errors import shown

__all__ = ["Rule", "check_entries", "names_among", "one_of", "within"]

# The types of JSON that each type takes, and what a message calls it.
PLAIN: dict[Any, tuple[tuple[type, ...], str]] = {
    int: ((int,), "a whole number"),
    float: ((int, float), "a number"),
    str: ((str,), "a text"),
    bool: ((bool,), "true or false"),
    dict: ((dict,), "a dictionary of entries"),
    tuple: ((list, tuple), "a list"),
    NoneType: ((NoneType,), "null"),
}


class Rule(NamedTuple):
    """What holds of a value beyond its type, as in ``Annotated[int, within(1, 5)]``."""

    holds: Callable[[Any], bool]
    text: str


def within(least: float, most: float) -> Rule:
    """Return the rule of numbers within bounds."""
    return Rule(lambda x: least <= x <= most, f"at least {least:g} and at most {most:g}")


def one_of(known: Collection[str]) -> Rule:
    """Return the rule of texts that are known."""
    return Rule(lambda x: x in known, f"one of {', '.join(known)}")


def names_among(known: Collection[str]) -> Rule:
    """Return the rule of lists of known names: at least one, and none twice."""
    return Rule(lambda x: 0 < len(x) == len({*x} & {*known}), f"some of {', '.join(known)}")


def check_entries(value: object, kind: type) -> None:
    """Check entries against those of a dataclass, of which some may be missing: with a default."""
    _check(value, dict, "it")
    assert isinstance(value, dict)
    types = get_type_hints(kind, include_extras=True)
    for name in value:
        if name not in types:
            near = difflib.get_close_matches(str(name), types, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise ValueError(f"there is no entry {shown(name)}{hint}")
    for entry in fields(kind):
        if entry.name in value:
            _check(value[entry.name], types[entry.name], entry.name)
        elif entry.default is MISSING:
            raise ValueError(f"the entry {entry.name} is missing")


def _check(value: Any, kind: Any, name: str) -> None:  # noqa: ANN401
    """Raise ValueError unless a value is of a type."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        _check(value, inner[0], name)
        for rule in inner[1:]:
            if not rule.holds(value):
                raise ValueError(f"{name} must be {rule.text}, not {shown(value)}")
        return
    kinds = inner if origin is UnionType else (origin or kind,)
    if not any(type(value) in PLAIN[x][0] for x in kinds):
        raise ValueError(f"{name} must be {PLAIN[kinds[0]][1]}, not {shown(value)}")
    if origin is tuple:
        for k, one in enumerate(value):
            _check(one, inner[0], f"{name}[{k}]")
