"""The vectors of many quadratic patches, their normal fields, and bounds of the errors."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import patch as formulas
from ...generated.spline import NEIGHBOURS, SCALE, TRIANGLE_NEIGHBOURS, triangle
from ...generated.vectors import Vector
from ...runtime.base.checks import real_array
from ...runtime.base.errors import InputError
from ...runtime.base.formula_calls import patch, python_function, vector
from ...runtime.base.scales import LARGEST_EXPONENT, scales_to_one
from ...runtime.base.tolerances import CUBIC_ERROR, DATA_ERROR
from ...runtime.spline.nets import AnySpline, NetSpline

Array = NDArray[np.float64]
# The control normals N200, N110, N101, N020, N011, N002 as pairs of corners of the triangle.
INDEX_PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
ORDER = "in the order b200, b020, b002, b110, b101, b011"


@dataclass(frozen=True, eq=False)
class Patches:
    """The vectors a, b, c, d, e of eq. (8) of k patches, (k, 5, 3), in a unit near their size.

    `noise` (k,) bounds the error of a component due to the rounding of the coordinates. The unit
    may differ from patch to patch; Gaussian images do not depend on it.
    """

    vectors: Array
    noise: Array

    @classmethod
    def of_control_points(cls, nets: Array) -> Patches:
        """Return the patches of Bézier nets (k, 6, 3)."""
        differences = nets - nets[:, 2:3]
        scale = scales_to_one(np.abs(differences).max(axis=(1, 2)))
        net = np.moveaxis(differences * scale[:, None, None], 1, 0)
        vectors = python_function(formulas.power_form)(*map(vector, net))
        noise = DATA_ERROR * np.abs(nets).max(axis=(1, 2)) * scale
        return cls(_stacked(vectors[:5], len(nets)), noise)

    @classmethod
    def of_spline(cls, spline: AnySpline) -> Patches:
        """Return all patches of a spline, from differences of its coefficients."""
        if isinstance(spline, NetSpline):
            return cls.of_control_points(spline.control_nets)
        cell, turn = np.divmod(np.arange(spline.patches), 4)
        i, j = np.divmod(cell, spline.cells[1])
        steps = NEIGHBOURS[turn][:, TRIANGLE_NEIGHBOURS]
        around = spline.coefficients[i[:, None] + 1 + steps[..., 0], j[:, None] + 1 + steps[..., 1]]
        centre = spline.coefficients[i + 1, j + 1][:, None]
        differences = np.moveaxis(spline.scale * (around - centre), 1, 0)
        vectors = python_function(triangle)(*map(vector, differences))
        largest = float(np.abs(spline.coefficients * spline.scale).max())
        noise = SCALE * DATA_ERROR * largest
        return cls(_stacked(vectors[:5], spline.patches), np.full(spline.patches, noise))

    def __len__(self) -> int:
        """Return the number of patches."""
        return len(self.vectors)

    def __getitem__(self, rows: NDArray[Any] | slice) -> Patches:
        """Return a selection of the patches."""
        return Patches(self.vectors[rows], self.noise[rows])

    def apply(self, formula: Callable[..., Any], *more: ArrayLike | Vector) -> Any:  # noqa: ANN401
        """Return the outputs of a formula for all patches: arrays (k,) in place of numbers."""
        return python_function(formula)(patch(self.vectors), *more)

    @cached_property
    def normals(self) -> Array:
        """The polar form (k, 3, 3, 3) of N(u,v): [i, j] is the control normal of corners i and j.

        Vectors that are zero up to noise are set to zero: singular points.
        """
        net = _stacked(self.apply(formulas.control_normals), len(self))
        net[np.linalg.norm(net, axis=2) <= self.normal_noise[:, None]] = 0.0
        polar = np.empty((len(self), 3, 3, 3))
        for k, (i, j) in enumerate(INDEX_PAIRS):
            polar[:, i, j] = polar[:, j, i] = net[:, k]
        return polar

    @cached_property
    def cubic(self) -> Array:
        """The Bézier net (k, 10) of the cubic whose sign is that of K: D300, D210, D201, …."""
        return np.stack(np.broadcast_arrays(*self.apply(formulas.parabolic_cubic)), axis=1)

    @cached_property
    def second(self) -> Array:
        """The largest length (k,) of a, b, c."""
        return np.linalg.norm(self.vectors[:, :3], axis=2).max(axis=1)

    @cached_property
    def tangent(self) -> Array:
        """A bound (k,) of the lengths of p_u and p_v."""
        return 2.0 * self.second + np.linalg.norm(self.vectors[:, 3:], axis=2).max(axis=1)

    @cached_property
    def normal_noise(self) -> Array:
        """A bound (k,) of the errors of the control normals."""
        return 8.0 * self.tangent * (self.noise + np.spacing(self.tangent))

    @cached_property
    def cubic_rounding(self) -> Array:
        """A bound (k,) of the rounding errors of the coefficients of the cubic."""
        return CUBIC_ERROR * self.second**2 * self.tangent**4

    @cached_property
    def flat(self) -> NDArray[np.bool_]:
        """A mask of the patches (k,) that are flat or developable, up to noise: D(N) vanishes."""
        longest = np.linalg.norm(self.normals, axis=3).max(axis=(1, 2))
        error = 4.0 * self.noise * self.second * longest * (longest + self.tangent * self.second)
        return np.abs(self.cubic).max(axis=1) <= error + self.cubic_rounding


def checked_control_points(control_points: ArrayLike) -> Array:
    """Return the control points of one patch as (6, 3) floats; InputError if invalid."""
    array = real_array(control_points, "control_points")
    if array.shape != (6, 3):
        raise InputError(
            f"control_points must be six points of three coordinates, {ORDER}, and not of shape "
            f"{array.shape}."
        )
    return _computable(array, "control_points")


def checked_nets(nets: ArrayLike) -> Array:
    """Return the control points of k >= 1 patches as (k, 6, 3) floats; InputError if invalid."""
    array = real_array(nets, "nets")
    if array.ndim != 3 or array.shape[1:] != (6, 3) or len(array) == 0:
        raise InputError(
            f"nets must have the shape (k, 6, 3) with k >= 1, {ORDER}, and not {array.shape}."
        )
    return _computable(array, "nets")


def _computable(array: Array, name: str) -> Array:
    """Return the array itself; InputError if it holds NaN, infinity or numbers too large."""
    rows = np.abs(array).reshape(len(array), -1)
    if not np.isfinite(rows).all():
        row = int(np.argmin(np.isfinite(rows).all(axis=1)))
        raise InputError(f"{name}[{row}] holds NaN or infinity.")
    if rows.max() > 2.0**LARGEST_EXPONENT:
        raise InputError(f"{name} are too large to compute with.")
    return array


def _stacked(vectors: Iterable[Vector], count: int) -> Array:
    """Stack m vectors, whose components are numbers or arrays (count,), as (count, m, 3)."""
    rows = [np.broadcast_to(x, count) for vector in vectors for x in vector]
    return np.stack(rows, axis=1).reshape(count, -1, 3).copy()
