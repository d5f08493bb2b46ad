"""The coordinates of heights: from the transform of a raster, a spacing, or arrays x and y."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.checks import real_array
from ...runtime.base.errors import InputError
from ...runtime.spline.point_grid import checked_spacing

Array = NDArray[np.float64]

# Distances count as equal up to this relative difference, since coordinates may be in single
# precision.
EQUAL = 1e-3
# x and y look like degrees if heights vary by more than this multiple of the extents of x and y.
TOO_STEEP = 10.0


def of_transform(transform: Sequence[float], shape: tuple[int, int]) -> tuple[Array, Array]:
    """Return x and y at the centres of pixels: (n,) and (m,) if rows run along x, else (m, n)."""
    a, b, c, d, e, f = transform
    rows, columns = (np.arange(count, dtype=np.float64) + 0.5 for count in shape)
    if b == 0.0 and d == 0.0:
        return a * columns + c, e * rows + f
    rows = rows[:, None]
    return a * columns + b * rows + c, d * columns + e * rows + f


def of_spacing(spacing: Sequence[float], shape: tuple[int, int]) -> tuple[Array, Array]:
    """Return x (n,) and y (m,), starting at 0, for spacings dx > 0 and dy.

    dy is negative if rows run from north to south.
    """
    dx, dy = checked_spacing(spacing, max(shape))
    rows, columns = (np.arange(count, dtype=np.float64) for count in shape)
    return dx * columns, dy * rows + 0.0


def of_arrays(x: ArrayLike, y: ArrayLike, shape: tuple[int, int]) -> tuple[Array, Array]:
    """Return x (n,) and y (m,), or both (m, n); InputError for other shapes, NaN or infinity."""
    found = []
    for name, values, count, axis in (("x", x, shape[1], 1), ("y", y, shape[0], 0)):
        array = real_array(values, name)
        if array.shape not in ((count,), shape):
            word = "columns" if axis else "rows"
            raise InputError(
                f"{name} must have the shape ({count},), a number for each of the {word} of the "
                f"heights {shape}, or the shape of these, not {array.shape}; are the heights "
                "transposed, or x and y exchanged?"
            )
        if not np.isfinite(array).all():
            raise InputError(f"{name} holds NaN or infinity; only heights may be missing.")
        if array.ndim == 2 and (array == array.take([0], axis=1 - axis)).all():
            array = array.take(0, axis=1 - axis)  # all its rows, or columns, are equal
        found.append(array)
    if found[0].ndim == found[1].ndim:
        return found[0], found[1]
    along_x = found[0] if found[0].ndim == 2 else np.broadcast_to(found[0], shape)
    along_y = found[1] if found[1].ndim == 2 else np.broadcast_to(found[1][:, None], shape)
    return along_x, along_y


def grid_of(x: Array, y: Array) -> tuple[Array, Array]:
    """Return x and y as arrays (m, n)."""
    if x.ndim == 2:
        return x, y
    shape = len(y), len(x)
    return np.broadcast_to(x, shape), np.broadcast_to(y[:, None], shape)


def is_even(values: Array) -> bool:
    """Return whether numbers (k,) are equally spaced, up to a relative difference of EQUAL."""
    mean = (values[-1] - values[0]) / (len(values) - 1)
    return bool(mean != 0.0 and np.abs(np.diff(values) / mean - 1.0).max() <= EQUAL)


def check_degrees(x: Array, y: Array, heights: Array, name: str) -> None:
    """Raise InputError if coordinates without a CRS look like degrees, and heights like metres."""
    ranges = [float(np.nanmax(q) - np.nanmin(q)) for q in (x, y, heights)]
    if (
        np.abs(x).max() <= 360.0
        and np.abs(y).max() <= 90.0
        and ranges[2] > TOO_STEEP * max(ranges[:2])
    ):
        raise InputError(
            f"{name} has x from {x.min():.6g} to {x.max():.6g} and y from {y.min():.6g} to "
            f"{y.max():.6g}, which look like degrees, and heights that vary by {ranges[2]:.6g}: "
            "normals need one unit; give their CRS, EPSG:4326, as that of the source, and they are "
            "projected."
        )
