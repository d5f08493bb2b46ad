"""The domain of a surface, a rectangle, and the boundary conditions on its four sides."""

from collections.abc import Sequence
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from ..base.checks import as_float
from ..base.errors import InputError, shown
from ..base.scales import apart

# The boundary condition of a side: open, periodic, mirrored (periodic, with the other parameter
# reversed) or pole.
BoundaryCondition = Literal["open", "periodic", "mirrored", "pole"]
BoundaryPair = tuple[BoundaryCondition, BoundaryCondition]  # at the lower and at the upper bound
Boundary = tuple[BoundaryPair, BoundaryPair]  # for u and for v
Assumed = tuple[bool, bool]  # for u and for v: whether open sides were assumed, not declared
Interval = tuple[float, float]
Domain = tuple[Interval, Interval]
Periodicity = bool | BoundaryCondition | BoundaryPair  # of one parameter
Periodic = bool | Sequence[Periodicity]  # of both, or of u and of v


def checked_domain(domain: Sequence[Sequence[float]]) -> Domain:
    """Return a domain as floats; InputError unless it is a bounded rectangle of positive area."""
    u, v = _checked(domain, "uv", "((u0, u1), (v0, v1))")
    return u, v


def checked_interval(domain: Sequence[float]) -> Interval:
    """Return the domain of a curve as floats; InputError unless it is bounded and not empty."""
    return _checked((domain,), "t", "(t0, t1)")[0]


def _checked(domain: Sequence[Sequence[float]], names: str, form: str) -> list[Interval]:
    try:
        named = [
            (name, (as_float(low), as_float(high)))
            for name, (low, high) in zip(names, domain, strict=True)
        ]
    except Exception:  # `float` may raise anything
        given = domain if len(names) > 1 else domain[0]
        raise InputError(f"domain must be {form}, not {shown(given)}.") from None
    for name, (low, high) in named:
        if not 0.0 < high - low < np.inf:
            raise InputError(f"the domain of {name} is empty or infinite: ({low}, {high}).")
    return [ends for _, ends in named]


def checked_boundary(periodic: Periodic) -> tuple[Boundary, Assumed]:
    """Return the boundary conditions that `periodic` means, and whether open sides are assumed.

    The open sides of a parameter are assumed if its entry in `periodic` is False; they are declared
    if the entry is "open". Raises InputError if the conditions are unknown or contradict each
    other.
    """
    boundary = checked_sides(periodic)
    for name, other, ends, around in (("u", "v", *boundary), ("v", "u", *boundary[::-1])):
        if "pole" in ends and around != ("periodic", "periodic"):
            raise InputError(f'a "pole" of {name} needs {other} to be periodic ("periodic").')
    assumed_u, assumed_v = (isinstance(x, bool | np.bool_) and not x for x in _entries(periodic))
    return boundary, (assumed_u, assumed_v)


def checked_sides(periodic: Periodic) -> Boundary:
    """Return the boundary conditions that `periodic` means; InputError if they are unusable.

    Unlike `checked_boundary`, this allows a pole although the other parameter is not periodic.
    """
    along_u, along_v = _entries(periodic)
    return _pair(along_u, "u"), _pair(along_v, "v")


def _entries(periodic: Periodic) -> tuple[Periodicity, Periodicity]:
    """Return the entries of `periodic` for u and for v."""
    if isinstance(periodic, bool | np.bool_):
        return bool(periodic), bool(periodic)
    try:
        along_u, along_v = periodic
    except Exception:  # iteration may raise anything
        raise InputError(
            "periodic must be a pair, one entry for u and one for v, or True or False for both, "
            f"not {shown(periodic)}."
        ) from None
    return along_u, along_v


def closes(ends: Sequence[str]) -> bool:
    """Return whether a parameter is periodic or mirrored, by its boundary conditions."""
    return ends[0] in ("periodic", "mirrored")


def cells_between(shape: Sequence[int], boundary: Boundary) -> tuple[int, int]:
    """Return the numbers of cells, along u and along v, between points of the shape (m, n, …)."""
    m, n = (
        count if closes(ends) else count - 1 for count, ends in zip(shape, boundary, strict=False)
    )
    return m, n


def widened(values: NDArray[Any], mode: Literal["edge", "wrap"] = "wrap") -> NDArray[Any]:
    """Return, for each cell of a grid, the largest of its value and those of its 8 neighbours.

    `values` and the result are (m, n). Beyond the boundary, neighbours are the cells at the
    opposite side ("wrap"), or there are no neighbours ("edge").
    """
    for axis in (0, 1):
        padded = np.pad(values, [(1, 1) if k == axis else (0, 0) for k in (0, 1)], mode=mode)
        parts = [np.take(padded, np.arange(k, k + values.shape[axis]), axis) for k in range(3)]
        values = np.maximum.reduce(parts)
    return values


def less_periods(
    values: NDArray[np.float64], low: NDArray[np.float64] | float, high: NDArray[np.float64] | float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return values (k,) after subtracting whole periods, so that they are in the domain.

    The second result (k,) has the number of periods subtracted from each value.
    """
    periods = np.floor((values - low) / (high - low))
    return np.clip(values - periods * (high - low), low, high), periods


def places_in(domain: Domain, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return parameters u, v (count,) that are spread over a domain.

    Relative to the domain they are i/√2 and i/√3, modulo 1, for i = 1, …, `count`.
    """
    steps = np.arange(1, count + 1)
    u, v = (
        low + (high - low) * (np.sqrt(x) * steps % 1.0)
        for x, (low, high) in zip((0.5, 1 / 3), domain, strict=True)
    )
    return u, v


def places_in_cells(domain: Domain, cells: tuple[int, int], shift: float) -> NDArray[np.float64]:
    """Return a grid of parameters in m × n cells.

    If `shift` is 0, these are all corners (m + 1, n + 1, 2) of cells. Else there is one point for
    each cell, (m, n, 2): its distance from the lower corner is `shift`, in cells, along u and v.
    """
    u, v = (
        low + (high - low) * ((np.arange(count + (shift == 0.0)) + shift) / count)
        for (low, high), count in zip(domain, cells, strict=True)
    )
    return np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)


def brought_inside(
    u: NDArray[np.float64], v: NDArray[np.float64], domain: Domain, boundary: Boundary
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return u and v (k,), in which periodic parameters are reduced to the domain.

    A shift by an odd number of periods of a mirrored parameter reverses the other parameter.
    """
    places = u.copy(), v.copy()
    for axis, (low, high) in enumerate(domain):
        if not closes(boundary[axis]):
            continue
        values, others = places[axis], places[1 - axis]
        out = np.flatnonzero((values < low) | (values > high))
        if len(out):
            values[out], periods = less_periods(values[out], low, high)
            if boundary[axis][0] == "mirrored":
                odd = out[periods % 2.0 == 1.0]
                others[odd] = sum(domain[1 - axis]) - others[odd]
    return places


def domain_text(domain: Domain, boundary: Boundary) -> str:
    """Return a domain and its boundary conditions in words: "u 0 to 1 open, v 0 to 6.28319 …"."""
    sides = zip("uv", domain, boundary, strict=True)
    return ", ".join(f"{x} {a:g} to {b:g} {'/'.join(dict.fromkeys(y))}" for x, (a, b), y in sides)


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


def broken_poles(points: NDArray[np.float64], boundary: Boundary, axis: int) -> list[int]:
    """Return the ends, 0 or 1, of u (axis 0) or v that are declared poles, but not collapsed."""
    rows, found = np.swapaxes(points, 0, axis), list[int]()
    for end in (0, 1):
        row = rows[-end][~np.isnan(rows[-end]).any(axis=1)]
        if boundary[axis][end] == "pole" and len(row) and apart(row, row[:1], points):
            found.append(end)
    return found
