"""The domain of a surface, a rectangle, and the boundary conditions on its four sides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, cast

import numpy as np

from ..base.checks import as_float
from ..base.errors import InputError, shown

__all__ = [
    "Assumed",
    "Boundary",
    "BoundaryCondition",
    "BoundaryPair",
    "Domain",
    "Interval",
    "Periodicity",
    "assumed_ends",
    "checked_boundary",
    "checked_domain",
]

# The boundary condition of a side: open, periodic, mirrored (periodic, with the other parameter
# reversed) or pole.
BoundaryCondition = Literal["open", "periodic", "mirrored", "pole"]
BoundaryPair = tuple[BoundaryCondition, BoundaryCondition]  # at the low and at the high end
Boundary = tuple[BoundaryPair, BoundaryPair]  # for u and for v
Assumed = tuple[bool, bool]  # for u and for v, whether open ends were assumed, not declared
Interval = tuple[float, float]
Domain = tuple[Interval, Interval]
Periodicity = bool | BoundaryCondition | BoundaryPair


def checked_domain(domain: Sequence[Sequence[float]]) -> Domain:
    """Return a domain as floats; InputError unless it is a bounded rectangle with an inside."""
    try:
        (u0, u1), (v0, v1) = ((as_float(low), as_float(high)) for low, high in domain)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"domain must be ((u0, u1), (v0, v1)), not {shown(domain)}.") from None
    for name, low, high in (("u", u0, u1), ("v", v0, v1)):
        if not 0.0 < high - low < np.inf:
            raise InputError(f"the domain of {name} is empty or infinite: ({low}, {high}).")
    return (u0, u1), (v0, v1)


def checked_boundary(periodic: Sequence[Periodicity]) -> Boundary:
    """Return the boundary conditions from their short forms; InputError on a clash."""
    try:
        along_u, along_v = periodic
    except (TypeError, ValueError):
        raise InputError(
            f"periodic must be a pair, one entry for u and one for v, not {shown(periodic)}."
        ) from None
    boundary = _pair(along_u, "u"), _pair(along_v, "v")
    for name, other, ends, around in (("u", "v", *boundary), ("v", "u", *boundary[::-1])):
        if "pole" in ends and around != ("periodic", "periodic"):
            raise InputError(f'a "pole" of {name} needs {other} to be periodic ("periodic").')
    return boundary


def assumed_ends(periodic: Sequence[Periodicity]) -> Assumed:
    """Return for u and v whether `periodic`, which was checked, has False and not "open"."""
    along_u, along_v = (isinstance(x, bool | np.bool_) and not x for x in periodic)
    return along_u, along_v


def _pair(entry: Periodicity, name: str) -> BoundaryPair:
    if isinstance(entry, bool | np.bool_):
        return ("periodic", "periodic") if entry else ("open", "open")
    pair = (entry, entry) if isinstance(entry, str) else entry
    known = ("open", "periodic", "mirrored", "pole")
    if not isinstance(pair, tuple | list) or len(pair) != 2 or any(x not in known for x in pair):
        raise InputError(
            f"periodic for {name} must be True, False, one of {', '.join(known)}, or a pair of "
            f"these, not {shown(entry)}."
        )
    low, high = pair
    if low != high and not {low, high} <= {"open", "pole"}:
        raise InputError(
            f'"periodic" and "mirrored" must stand at both ends of {name}, not {shown(entry)}.'
        )
    return cast(BoundaryPair, (low, high))
