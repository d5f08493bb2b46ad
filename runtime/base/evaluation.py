"""Calls of users' callables, and checks of the values that they return."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import real_array
from .errors import GaussmapError, InputError, SurfaceError

Needed = Callable[[NDArray[np.float64]], NDArray[np.bool_]]


def evaluated(
    function: Callable[..., ArrayLike],
    parameters: Mapping[str, NDArray[np.float64]],
    dimension: int,
    label: str,
    needed: Needed | None = None,
) -> NDArray[np.float64]:
    """Return the points (..., dimension) of a callable; `parameters` are arrays of one shape.

    Raises SurfaceError, which names the callable by `label`, if the callable raises, or returns
    another shape, anything but real numbers, or NaN or infinity where values are `needed`. The
    message gives the parameters of a value that is not finite.
    """
    arrays = {name: np.atleast_1d(x) for name, x in parameters.items()}
    points = returned(function, tuple(arrays.values()), (dimension,), f"the callable of {label}")
    check_finite(points, arrays, label, needed)
    return points.reshape(*np.shape(next(iter(parameters.values()))), dimension)


def check_finite(
    values: NDArray[np.float64],
    parameters: Mapping[str, NDArray[np.float64]],
    label: str,
    needed: Needed | None = None,
) -> None:
    """Raise SurfaceError, with the parameters, if values (..., k) are not finite.

    Values at parameters (j, 2) may be NaN or infinite where `needed` returns False.
    """
    bad: NDArray[np.bool_] = np.any(~np.isfinite(values), axis=-1)
    if needed is not None and bad.any():
        bad[bad] = needed(
            np.stack([np.broadcast_to(x, bad.shape)[bad] for x in parameters.values()], axis=-1)
        )
    if bad.any():
        where = np.unravel_index(int(np.argmax(bad)), bad.shape)
        place = ", ".join(f"{name} = {float(array[where])}" for name, array in parameters.items())
        hint = "; choose a domain where it is finite, or a surface that is trimmed to such places"
        untrimmed = needed is None and len(parameters) == 2
        raise SurfaceError(
            f"{label} is not finite at {place}: {values[where]}{hint if untrimmed else ''}."
        )


def returned(
    function: Callable[..., ArrayLike],
    arrays: Sequence[NDArray[np.float64]],
    shape: tuple[int, ...],
    label: str,
) -> NDArray[np.float64]:
    """Return the values of a callable for arrays of one shape: an array of their shape + `shape`.

    Raises SurfaceError, which names the callable by `label`, if the callable raises, or returns
    another shape or anything but real numbers.
    """
    values = called(function, arrays, label)
    if shapes := _shapes_that_differ(values, shape):
        raise SurfaceError(
            f"{label} returned coordinates of the shapes {', '.join(map(str, shapes))} one by one; "
            "join them by numpy.stack(numpy.broadcast_arrays(...), axis=-1)."
        )
    try:
        result = real_array(values, f"what {label} returns")
    except InputError as error:
        raise SurfaceError(str(error)) from None
    expected = (*arrays[0].shape, *shape)
    if result.shape != expected:
        raise SurfaceError(
            f"{label} returned the shape {result.shape} for parameters of shape "
            f"{arrays[0].shape}; it must return {expected}{_hint(values, result.shape, expected)}."
        )
    return result


def _shapes_that_differ(values: object, shape: tuple[int, ...]) -> list[tuple[int, ...]]:
    """Return the shapes of a list of coordinates if they differ; otherwise [].

    For example, a coordinate may be a number where the other coordinates are arrays.
    """
    if not isinstance(values, tuple | list) or shape[1:] or [len(values)] != [*shape]:
        return []
    parts = [np.shape(x) for x in values if isinstance(x, np.ndarray | float | int | np.number)]
    return parts if len(parts) == len(values) and len(set(parts)) > 1 else []


def _hint(values: ArrayLike, found: tuple[int, ...], expected: tuple[int, ...]) -> str:
    """Return a hint on how to join coordinates that were returned one by one."""
    number = expected[-1] if len(expected) else 0
    if number == 3 and found == expected[:-1]:
        return ": of heights z, numpy.stack((u, v, z), axis=-1)"
    if found[1:] != expected[:-1] or not found:
        return ""
    if isinstance(values, tuple | list) and found[0] != number:
        return f": {number} coordinates, not {found[0]}, joined by numpy.stack((...), axis=-1)"
    return ": join the coordinates by numpy.stack((...), axis=-1)" if found[0] == number else ""


def called(
    function: Callable[..., ArrayLike], arrays: Sequence[NDArray[np.float64]], label: str
) -> ArrayLike:
    """Call a callable with copies of arrays; SurfaceError if it raises.

    A GaussmapError or MemoryError is raised unchanged.
    """
    try:
        with np.errstate(all="ignore"):
            return function(*(x.copy() for x in arrays))
    except (GaussmapError, MemoryError):
        raise
    except Exception as error:
        raise SurfaceError(
            f"{label} raised {type(error).__name__}: {' '.join(str(error).split())}{_numpy(error)}"
        ) from error


def _numpy(error: Exception) -> str:
    """Return a hint for callables that take single numbers only."""
    if isinstance(error, TypeError) and "Python scalars" in str(error):
        return "; it gets arrays, for which there are numpy.sin and so on, not math.sin"
    return ""
