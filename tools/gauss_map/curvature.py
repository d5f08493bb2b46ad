"""The Gaussian curvature of a smooth surface at its parameters: values, errors and derivatives."""

from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ...generated import gaussian_image as formulas
from ...runtime.base.aliases import Array
from ...runtime.base.errors import SurfaceError
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.base.scales import not_too_large, scale_to_one
from ...runtime.base.tolerances import DERIVATIVE_ERROR
from ...runtime.domain.domain import brought_inside
from ...runtime.surface.derivatives import Function, differences
from ...runtime.surface.surface import Surface
from ...runtime.tape.tapes import jets_of

# The error of a second derivative that a formula gives, relative to the length of this vector.
ROUNDING = 1e-13
# K counts as zero if it is below its estimated error times this.
SURE = 4.0
# The number of parameter pairs in one batch.
AT_A_TIME = 1 << 14
# Steps for derivatives of K, and for its slope in Newton's method, relative to the domain.
STEP, SLOPE_STEP = 1 / 1024, 1e-6
# The number of steps of Newton's method; the lengths of its final and of its largest step, relative
# to the domain.
NEWTON_STEPS, ARRIVED, FARTHEST = 5, 1e-13, 0.1
# The size of a surface is measured on a grid with this number of points along u and along v.
SIZES = 17


class Known(NamedTuple):
    """K (k,), a bound of its error (k,), and n·x_uu, n·x_uv, n·x_vv (k, 3) for n = x_u × x_v.

    Lengths are relative to the size of the surface. NaN where the surface is singular.
    """

    K: Array
    error: Array
    second_form: Array


class Curvature:
    """K of a surface at parameters (k, 2), which may exceed the domain in periodic directions.

    Derivatives of the surface come from its formulas; for a callable, from its tape of NumPy
    operations, or else from differences, whose error is estimated by steps twice as long.
    """

    def __init__(self, surface: Surface) -> None:
        """Raise SurfaceError if the surface cannot be evaluated."""
        self.surface = surface
        self.low, self.high = np.array(surface.domain).T
        self.extent = self.high - self.low
        self.wraps = np.array([ends[0] == "periodic" for ends in surface.boundary])
        ends = np.where(self.wraps, np.inf, self.high)
        self.ends = np.where(self.wraps, -np.inf, self.low), ends
        lines = (np.linspace(*ends, SIZES) for ends in surface.domain)
        places = surface.evaluate(*np.meshgrid(*lines)).reshape(-1, 3)
        places = places[np.isfinite(places).all(axis=1)]
        if not len(places):
            raise SurfaceError(
                f"surface {surface.name!r} is finite at none of {SIZES} x {SIZES} places of its "
                "domain; choose a smaller domain around its trim."
            )
        extent = np.ptp(not_too_large(places, surface.name), axis=0)
        self.scale = scale_to_one(float(extent.max()))
        self.size = float(np.linalg.norm(self.scale * extent)) / self.scale
        tape = None if surface.differences is None else surface.tape
        self._jets: Function = surface.jets if tape is None else partial(jets_of, tape)
        self._coarser, self._rounding = None, 0.0
        if tape is None and surface.differences is not None:
            self._coarser = replace(surface.differences, step=2.0 * surface.differences.step).jets
            rounding = DERIVATIVE_ERROR * np.spacing(self.scale * float(np.abs(places).max()))
            self._rounding = rounding / np.outer(self.extent, self.extent)[[0, 0, 1], [0, 1, 1]]

    def jets(self, places: Array) -> Array:
        """Return x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) of the surface."""
        return self._jets(*self._inside(places))

    def at(self, places: Array) -> Known:
        """Return K at parameter pairs (k, 2), its error, and the second fundamental form."""
        parts = [self._known(x) for x in np.array_split(places, len(places) // AT_A_TIME + 1)]
        return Known(*(np.concatenate(x) for x in zip(*parts, strict=True)))

    def derivatives(self, places: Array) -> tuple[Array, Array, Array]:
        """Return K (k,), its gradient (k, 2) and Hessian (k, 2, 2), u and v scaled to [0, 1]."""
        u, v = places.T.copy()
        steps, (in_u, in_v) = STEP * self.extent, np.stack(self.ends, axis=1).tolist()
        jets, _ = differences(self._thrice, u, v, (steps[0], steps[1]), (in_u, in_v))
        K, u, v, uu, uv, vv = jets[..., 0].T
        gradient = np.stack([u, v], axis=1) * self.extent
        hessian = np.stack([uu, uv, uv, vv], axis=1).reshape(-1, 2, 2)
        return K, gradient, hessian * np.outer(self.extent, self.extent)

    def onto_zeros(self, places: Array) -> Array:
        """Move parameters (k, 2) near curves K = 0 onto them, by Newton steps along the gradient.

        Points on the boundary of the domain move along it. Points without a regular zero nearby, as
        at crossings and singular points, stay.
        """
        low, high = self.ends
        forward = np.where(places < low + 0.5 * self.extent, SLOPE_STEP, -SLOPE_STEP)
        free = (low < places) & (places < high)
        moved, share = places, np.zeros_like(places)
        with np.errstate(all="ignore"):
            for _ in range(NEWTON_STEPS):
                stencil = (
                    moved + forward * np.concatenate([[[0.0, 0.0]], np.diag(self.extent)])[:, None]
                )
                K, in_u, in_v = self.at(stencil.reshape(-1, 2)).K.reshape(3, -1)
                slope = free * (np.stack([in_u, in_v], axis=1) - K[:, None]) / forward
                share = K[:, None] * slope / np.square(slope).sum(axis=1, keepdims=True)
                step = np.clip(np.nan_to_num(share), -FARTHEST, FARTHEST) * self.extent
                moved = np.clip(moved - step, low, high)
                if not (np.abs(share) > ARRIVED).any():
                    break
        near = (np.abs(share) <= SLOPE_STEP).all(axis=1, keepdims=True)
        return np.where(near, moved, places)

    def _known(self, places: Array) -> Known:
        u, v = self._inside(places)
        jets = self.scale * self._jets(u, v)
        p_u, p_v, *second = (jets[:, k] for k in range(1, 6))
        formula = python_function(formulas.gaussian_curvature_of_derivatives)
        with np.errstate(all="ignore"):
            K, *form = formula(*map(vector, (p_u, p_v, *second)))
            area: Array = np.linalg.norm(np.cross(p_u, p_v), axis=1)
            lengths = np.linalg.norm(jets, axis=2)
            condition = lengths[:, 1] * lengths[:, 2] / area
            errors = ROUNDING * (condition * lengths[:, 3:].T).T
            if self._coarser is not None:
                apart = self.scale * self._coarser(u, v)[:, 3:] - jets[:, 3:]
                errors = errors + np.linalg.norm(apart, axis=2) + self._rounding
            (a, b, c), (A, B, C) = errors.T, (np.abs(x) / area for x in form)
            error = (a * C + c * A + 2.0 * b * B + a * c + b * b) / area**2
        return Known(K, SURE * error, np.stack(np.broadcast_arrays(*form), axis=1))

    def _thrice(self, u: Array, v: Array) -> Array:
        """Return K (k, 3) in three equal columns, since `differences` is made for points."""
        return np.repeat(self.at(np.stack([u, v], axis=1)).K[:, None], 3, axis=1)

    def _inside(self, places: Array) -> tuple[Array, Array]:
        u, v = places.T.copy()
        return brought_inside(u, v, self.surface.domain, self.surface.boundary)
