"""The catalogue: `gaussmap.surfaces.torus(major=1, minor=0.35)`, and so on for every name."""

from __future__ import annotations

import inspect
import math
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from ...generated.surface_tapes import TAPES
from ...generated.surfaces import CATALOGUE as _GENERATED
from ..base.advice import file_advice
from ..base.checks import as_float, known_name
from ..base.errors import InputError, UnknownNameError, shown
from ..domain.domain import Boundary, Domain
from ..tape.kernels.points import Tape
from ..tape.tapes import tape_of_steps
from .derivatives import Differentiable
from .kernels.surfaces import jets, positions
from .surface import Surface

if TYPE_CHECKING:
    from ...generated.surfaces_signatures import *  # noqa: F403  # pyright: ignore[reportMissingModuleSource]

__all__ = ["describe", "names", "surface"]

T = TypeVar("T")

CATALOGUE = cast(dict[str, dict[str, Any]], _GENERATED)


@dataclass(frozen=True)
class CatalogueFunction(Differentiable):
    """Position and derivatives of a surface of the catalogue; pickled as its name and values."""

    name: str
    values: tuple[float, ...]

    def __call__(self, u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the points (..., 3)."""
        points = np.empty((u.size, 3))
        positions(self.name)(*self.values, u.ravel(), v.ravel(), points)
        return points.reshape(*u.shape, 3)

    def jets(self, u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return positions and derivatives (k, 6, 3)."""
        result = np.empty((u.size, 6, 3))
        jets(self.name)(*self.values, u, v, result)
        return result

    def tape(self) -> Tape | None:
        """Return the tape of the surface."""
        values = dict(zip(CATALOGUE[self.name]["parameters"], self.values, strict=True))
        return tape_of_steps(*TAPES[self.name], values)


def names() -> tuple[str, ...]:
    """Return the names of all surfaces.

    Returns
    -------
    tuple of str
        The names, each of which is a function of this module.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.surfaces.names()[:2]
    ('torus', 'ellipsoid')

    """
    return tuple(CATALOGUE)


def describe(name: str) -> str:
    """Return the description of a surface and of its parameters.

    Parameters
    ----------
    name : str
        The name of a surface.

    Returns
    -------
    str
        A line for the surface, and one for each parameter with its default.

    Raises
    ------
    UnknownNameError
        If there is no surface of that name.

    Examples
    --------
    >>> import gaussmap as gm
    >>> print(gm.surfaces.describe("sphere").splitlines()[1])
        radius = 1: The radius.

    """
    entry = _entry(name)
    lines = [f"{name}: {entry['sentence']}"]
    lines += [
        f"    {parameter} = {default:g}: {sentence}"
        for parameter, (default, _, sentence) in entry["parameters"].items()
    ]
    return "\n".join(lines)


def surface(name: str, /, **parameters: float) -> Surface:
    """Return a surface of the catalogue by its name.

    Parameters
    ----------
    name : str
        The name of a surface, see `names`.
    **parameters : float
        Values of its parameters; the others have their defaults.

    Returns
    -------
    Surface
        The result of ``gm.surfaces.NAME(**parameters)``.

    Raises
    ------
    UnknownNameError
        If there is no surface of that name.
    InputError
        For a parameter that the surface does not have, or a value that is not finite, or not
        positive if it has to be.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.surfaces.surface("torus", minor=0.2).name
    'torus'

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
    function = CatalogueFunction(name, tuple(values))
    domain = tuple((float(low), float(high)) for low, high in entry["domain"])
    return Surface(name, function, cast(Domain, domain), cast(Boundary, entry["boundary"]))


def named(value: T | str) -> T | Surface:
    """Return the surface of the catalogue for a name, and any other value unchanged.

    Every function that takes a surface calls this first. It raises UnknownNameError for unknown
    names, with advice if the name is that of a file.
    """
    if isinstance(value, str) and value not in CATALOGUE and (advice := file_advice(value)):
        raise UnknownNameError(f"there is no surface {shown(value)}; {advice}.")
    return _default(value) if isinstance(value, str) else value


@cache
def _default(name: str) -> Surface:
    """Return the surface of the catalogue with default parameters, always the same object."""
    return surface(name)


def _maker(name: str) -> Callable[..., Surface]:
    """Return the function `gaussmap.surfaces.NAME`; the catalogue gives its parameters."""
    known = CATALOGUE[name]["parameters"]

    def make(*values: float, **named: float) -> Surface:
        first = dict(zip(known, values, strict=False))
        if len(values) > len(known) or first.keys() & named:
            raise InputError(f"{name} takes one number for each of {', '.join(known) or 'none'}.")
        return surface(name, **first, **named)

    arguments = [
        inspect.Parameter(
            x, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=default, annotation="float"
        )
        for x, (default, *_) in known.items()
    ]
    make.__name__ = make.__qualname__ = name
    make.__signature__ = inspect.Signature(arguments, return_annotation="Surface")  # pyright: ignore[reportFunctionMemberAccess]
    make.__doc__ = _docstring(name)
    return make


def _docstring(name: str) -> str:
    """Return the docstring of the function `gaussmap.surfaces.NAME`, in the form of numpydoc."""
    entry = CATALOGUE[name]
    lines = [textwrap.fill(entry["sentence"], 88), "", "Parameters", "----------"]
    for parameter, (default, positive, sentence) in entry["parameters"].items():
        lines.append(f"{parameter} : float, default {default:g}")
        text = sentence + (" Positive." if positive else "")
        lines.append(textwrap.fill(text, 84, initial_indent="    ", subsequent_indent="    "))
    example = f"gm.surfaces.{name}({', '.join(f'{x[0]:g}' for x in entry['parameters'].values())})"
    lines += ["", "Returns", "-------", "Surface", f"    A surface with the name {name!r}."]
    lines += ["", "Examples", "--------", ">>> import gaussmap as gm", f">>> {example}.name"]
    return "\n".join([*lines, repr(name)])


globals().update({name: _maker(name) for name in CATALOGUE})

if not TYPE_CHECKING:  # type checkers know the names from generated/surfaces_signatures.pyi

    def __getattr__(name: str) -> None:
        raise AttributeError(
            f"gaussmap.surfaces has no {shown(name)}; it has {', '.join(CATALOGUE)}"
        )


def __dir__() -> list[str]:
    return [*__all__, *CATALOGUE]


def _entry(name: str) -> dict[str, Any]:
    return CATALOGUE[known_name(name, names(), "surface")]


def _checked(name: str, parameter: str, value: object, positive: bool) -> float:
    try:
        number = as_float(cast(float, value))
    except TypeError:
        raise InputError(f"{parameter} of {name} must be a number, not {shown(value)}.") from None
    if not math.isfinite(number) or (positive and number <= 0.0):
        wanted = "a positive number" if positive else "a finite number"
        raise InputError(f"{parameter} of {name} must be {wanted}, not {shown(value)}.")
    return number
