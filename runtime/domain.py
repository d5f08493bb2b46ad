"""The domain of a surface, a rectangle, and the boundary conditions on its four sides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, cast

import numpy as np

from .checks import as_float
from .errors import InputError, shown

__all__ = ["Domain", "End", "Ends", "Interval", "Periodicity", "checked_domain", "checked_ends"]

# The boundary condition of a side: open, periodic, mirrored (periodic, with the other parameter
# reversed) or pole.
End = Literal["none", "wrap", "flip", "pole"]
Ends = tuple[tuple[End, End], tuple[End, End]]
Interval = tuple[float, float]
Domain = tuple[Interval, Interval]
Periodicity = bool | End | tuple[End, End]


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


def checked_ends(periodic: Sequence[Periodicity]) -> Ends:
    """Return what lies beyond the ends, from the short forms of a user; InputError on a clash."""
    try:
        along_u, along_v = periodic
    except (TypeError, ValueError):
        raise InputError(
            f"periodic must be a pair, one entry for u and one for v, not {shown(periodic)}."
        ) from None
    ends = _pair(along_u, "u"), _pair(along_v, "v")
    if "pole" in ends[0]:
        raise InputError('only v can end in a "pole": exchange the parameters u and v.')
    if "pole" in ends[1] and ends[0] != ("wrap", "wrap"):
        raise InputError('a "pole" of v needs u to be periodic ("wrap").')
    return ends


def _pair(entry: Periodicity, name: str) -> tuple[End, End]:
    if isinstance(entry, bool | np.bool_):
        return ("wrap", "wrap") if entry else ("none", "none")
    pair = (entry, entry) if isinstance(entry, str) else entry
    known = ("none", "wrap", "flip", "pole")
    if not isinstance(pair, tuple | list) or len(pair) != 2 or any(x not in known for x in pair):
        raise InputError(
            f"periodic for {name} must be True, False, one of {', '.join(known)}, or a pair of "
            f"these, not {shown(entry)}."
        )
    low, high = pair
    if low != high and not {low, high} <= {"none", "pole"}:
        raise InputError(
            f'"wrap" and "flip" must stand at both ends of {name}, not {shown(entry)}.'
        )
    return cast(tuple[End, End], (low, high))
