"""Calling formulas on NumPy arrays, exact numbers or single floats, without compilation."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...generated.vectors import Patch, PlaneVector, Vector


def python_function(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the uncompiled function of a kernel; under NUMBA_DISABLE_JIT, the argument itself."""
    return getattr(function, "py_func", function)


def vector(array: ArrayLike) -> Vector:
    """Return an array (..., 3) as a vector whose components are arrays (...)."""
    return Vector(*np.moveaxis(np.asarray(array), -1, 0))


def plane_vector(array: ArrayLike) -> PlaneVector:
    """Return an array (..., 2) as a plane vector whose components are arrays (...)."""
    return PlaneVector(*np.moveaxis(np.asarray(array), -1, 0))


def patch(array: ArrayLike) -> Patch:
    """Return the patch with the vectors a, b, c, d, e in an array (..., 5, 3); its p₀ is zero."""
    a, b, c, d, e = np.moveaxis(np.asarray(array), -2, 0)
    return Patch(vector(a), vector(b), vector(c), vector(d), vector(e), Vector(0.0, 0.0, 0.0))
