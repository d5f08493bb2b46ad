"""The catalogue: `gaussmap.surfaces.torus(major=1, minor=0.35)`, and so on for every name."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..generated.surfaces import CATALOGUE as _GENERATED
from . import compiling  # noqa: F401 - it tells that kernels are compiled
from .errors import InputError, UnknownNameError, shown
from .kernels.surfaces import positions
from .surface import Domain, Ends, Surface

__all__ = ["describe", "names", "surface"]

CATALOGUE = cast(dict[str, dict[str, Any]], _GENERATED)


def names() -> tuple[str, ...]:
    """Return the names of all surfaces."""
    return tuple(CATALOGUE)


def describe(name: str) -> str:
    """Return what a surface is and what its parameters mean; UnknownNameError if there is none."""
    entry = _entry(name)
    lines = [f"{name}: {entry['sentence']}"]
    lines += [
        f"    {parameter} = {default:g}: {sentence}"
        for parameter, (default, _, sentence) in entry["parameters"].items()
    ]
    return "\n".join(lines)


def surface(name: str, /, **parameters: float) -> Surface:
    """Return a surface of the catalogue by its name.

    Raises UnknownNameError for an unknown name, InputError for a parameter that the surface does
    not have, that is not finite, or that must be positive and is not.
    """
    entry = _entry(name)
    known = entry["parameters"]
    for parameter in parameters:
        if parameter not in known:
            raise InputError(
                f"{name} has no parameter {shown(parameter)}; it has {', '.join(known) or 'none'}."
            )
    values = [
        _checked(name, parameter, parameters.get(parameter, default), positive)
        for parameter, (default, positive, _) in known.items()
    ]
    write = positions(name)

    def evaluate(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        points = np.empty((u.size, 3))
        write(*values, u.ravel(), v.ravel(), points)
        return points.reshape(*u.shape, 3)

    domain = tuple((float(low), float(high)) for low, high in entry["domain"])
    return Surface(name, evaluate, cast(Domain, domain), cast(Ends, entry["ends"]))


def __getattr__(name: str) -> Callable[..., Surface]:
    """Return the maker of a surface: `torus(minor=0.2)` is `surface("torus", minor=0.2)`."""
    if name not in CATALOGUE:
        raise AttributeError(
            f"gaussmap.surfaces has no {shown(name)}; it has {', '.join(CATALOGUE)}"
        )

    def make(**parameters: float) -> Surface:
        return surface(name, **parameters)

    make.__name__ = make.__qualname__ = name
    make.__doc__ = describe(name)
    return make


def __dir__() -> list[str]:
    return [*__all__, *CATALOGUE]


def _entry(name: str) -> dict[str, Any]:
    if not isinstance(name, str) or name not in CATALOGUE:
        raise UnknownNameError(
            f"there is no surface {shown(name)}; there are {', '.join(CATALOGUE)}."
        )
    return CATALOGUE[name]


def _checked(name: str, parameter: str, value: object, positive: bool) -> float:
    try:
        number = float(cast(float, value))
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{parameter} of {name} must be a number, not {shown(value)}.") from None
    if not math.isfinite(number) or (positive and number <= 0.0):
        wanted = "a positive number" if positive else "a finite number"
        raise InputError(f"{parameter} of {name} must be {wanted}, not {shown(value)}.")
    return number
