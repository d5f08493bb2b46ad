"""Calling the callable of a user, and looking at what it returns."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import real_array
from .errors import GaussmapError, InputError, SurfaceError

__all__ = ["evaluated"]


def evaluated(
    function: Callable[..., ArrayLike],
    parameters: Mapping[str, NDArray[np.float64]],
    dimension: int,
    label: str,
) -> NDArray[np.float64]:
    """Return the points (..., dimension) of a callable for parameters of one shape, by their names.

    Raises SurfaceError, which calls it the callable of `label`, if it raises, returns another shape
    or anything but real numbers, or gives NaN or infinity, and says where.
    """
    arrays = [np.atleast_1d(x) for x in parameters.values()]
    shape = np.shape(next(iter(parameters.values())))
    try:
        with np.errstate(all="ignore"):
            returned = function(*(x.copy() for x in arrays))
    except (GaussmapError, MemoryError):
        raise
    except Exception as error:
        raise SurfaceError(
            f"the callable of {label} raised {type(error).__name__}: {' '.join(str(error).split())}"
        ) from error
    try:
        points = real_array(returned, f"what the callable of {label} returns")
    except InputError as error:
        raise SurfaceError(str(error)) from None
    if points.shape != (*arrays[0].shape, dimension):
        raise SurfaceError(
            f"the callable of {label} returned the shape {points.shape} for parameters of shape "
            f"{arrays[0].shape}; it must return {(*arrays[0].shape, dimension)}."
        )
    if not np.isfinite(points).all():
        bad = ~np.isfinite(points).all(axis=-1)
        where = np.unravel_index(int(np.argmax(bad)), bad.shape)
        places = zip(parameters, arrays, strict=True)
        place = ", ".join(f"{name} = {float(array[where])}" for name, array in places)
        raise SurfaceError(f"{label} is not finite at {place}: {points[where]}.")
    return points.reshape(*shape, dimension)
