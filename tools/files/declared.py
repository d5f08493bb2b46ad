"""Values of JSON, checked against the types that classes declare for their entries.

A type is int, float, str, bool, a tuple, a union of these, or dict with `Entries`; `Annotated` adds
rules. Errors are ValueErrors with a sentence that names the entry.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection
from dataclasses import MISSING, fields
from functools import cache
from math import inf
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    NamedTuple,
    Union,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

from ...runtime.base.errors import shown

__all__ = ["POSITIVE", "Entries", "Rule", "check_entries", "names_among", "one_of", "within"]

# The types of JSON that each type takes, and what a message calls it.
PLAIN: dict[Any, tuple[tuple[type, ...], str]] = {
    int: ((int,), "a whole number"),
    float: ((int, float), "a number"),
    str: ((str,), "a text"),
    bool: ((bool,), "true or false"),
    NoneType: ((NoneType,), "null"),
}


class Rule(NamedTuple):
    """What holds of a value beyond its type, as in ``Annotated[int, within(1, 5)]``."""

    holds: Callable[[Any], bool]
    text: str


class Entries(NamedTuple):
    """The classes that declare the entries of a dictionary: dataclasses or typed dictionaries.

    Entries of a dataclass that have a default may be left out; a later class goes before others.
    """

    kinds: tuple[type, ...]


POSITIVE = Rule(lambda x: 0 < x < inf, "positive")


def within(least: float, most: float = inf) -> Rule:
    """Return the rule of numbers within bounds."""
    to = "" if most == inf else f" and at most {most:g}"
    return Rule(lambda x: least <= x <= most, f"at least {least:g}{to}")


def one_of(known: Collection[str]) -> Rule:
    """Return the rule of texts that are known."""
    return Rule(lambda x: x in known, f"one of {', '.join(known)}")


def names_among(known: Collection[str]) -> Rule:
    """Return the rule of lists of known names: at least one, and none twice."""
    return Rule(lambda x: 0 < len(x) == len({*x} & {*known}), f"some of {', '.join(known)}")


def check_entries(value: object, *kinds: type) -> None:
    """Check the entries of a dictionary; `kinds` are those of `Entries`."""
    if not isinstance(value, dict):
        raise ValueError(f"{shown(value)} is no dictionary of entries")
    types, needed = _declared(kinds)
    for name in value:
        if name not in types:
            near = difflib.get_close_matches(str(name), types, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise ValueError(f"there is no entry {shown(name)}{hint}")
    for name in needed:
        if name not in value:
            raise ValueError(f"the entry {name} is missing")
    for name, entry in value.items():
        _check(entry, types[name], name)


@cache
def _declared(kinds: tuple[type, ...]) -> tuple[dict[str, Any], list[str]]:
    """Return the types of entries, and which must not be missing."""
    types: dict[str, Any] = {}
    needed: list[str] = []
    for kind in kinds:
        types |= get_type_hints(kind, include_extras=True)
        needed += (
            kind.__required_keys__
            if is_typeddict(kind)
            else [x.name for x in fields(kind) if x.default is MISSING]
        )
    return types, needed


def _check(value: Any, kind: Any, name: str) -> None:  # noqa: ANN401
    """Raise ValueError unless a value is of a type."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        _check(value, inner[0], name)
        for rule in inner[1:]:
            if isinstance(rule, Entries):
                check_entries(value, *rule.kinds)
            elif not rule.holds(value):
                raise ValueError(f"{name} must be {rule.text}, not {shown(value)}")
    elif origin in (Union, UnionType):
        _check_union(value, inner, name)
    elif origin is tuple:
        _check_tuple(value, inner, name)
    elif origin is dict:
        return  # `Entries` has the types
    elif type(value) not in PLAIN[kind][0]:
        raise ValueError(f"{name} must be {PLAIN[kind][1]}, not {shown(value)}")


def _check_union(value: object, kinds: tuple[Any, ...], name: str) -> None:
    errors: list[ValueError] = []
    for kind in kinds:
        try:
            return _check(value, kind, name)
        except ValueError as error:
            errors.append(error)
    raise errors[0]


def _check_tuple(value: object, kinds: tuple[Any, ...], name: str) -> None:
    if not isinstance(value, list | tuple):
        raise ValueError(f"{name} must be a list, not {shown(value)}")
    if kinds[-1] is Ellipsis:
        kinds = (kinds[0],) * len(value)
    if len(value) != len(kinds):
        raise ValueError(f"{name} must have {len(kinds)} entries, not {len(value)}")
    for k, (one, kind) in enumerate(zip(value, kinds, strict=True)):
        _check(one, kind, f"{name}[{k}]")
