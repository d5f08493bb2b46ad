"""The Gaussian curvature of a smooth surface as a function of u, v: polynomials on panels.

The domain is cut into panels; on each the surface is interpolated at Chebyshev nodes, which lie
inside the panel, and differentiated: the error is that of rounding for a smooth surface. K is then
a polynomial too, which is bounded on smaller rectangles by its coefficients and its values.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from ...generated import gaussian_image as formulas
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.base.scales import scale_to_one
from ...runtime.spline.quasi_interpolant import not_too_large
from ...runtime.surface.surface import Surface

__all__ = ["NODES", "ORDER", "SURE", "CurvatureField"]

Array = NDArray[np.float64]
# Nodes along a side of a panel, for K; and for the finer bounds on a small part of one.
ORDER = 16
# Panels are shifted by this share of one: parabolic curves of symmetric surfaces often lie on lines
# of symmetry, which should not be borders of panels.
OFFSET = 0.2360679774997897
# K is resolved where its error is less than this, relative to its largest value on the panel.
RESOLVED = 1e-2
# K is accurate where its error is less than this, relative to the squared curvature of the surface.
ACCURATE = 1e-8
# Where |p_u × p_v| on a panel falls below this share of its largest value, K has a denominator.
LEAST_AREA = 1e-2
NODES = chebyshev.chebpts1(ORDER)
TO_COEFFICIENTS = np.linalg.inv(chebyshev.chebvander(NODES, ORDER - 1))
# How much more a polynomial can be off at the end of a panel than at its nodes (Lebesgue constant).
LEBESGUE = float(np.abs(chebyshev.chebvander(np.ones(1), ORDER - 1) @ TO_COEFFICIENTS).sum())
# The sign of K is used where |K| exceeds its estimated error by this factor.
SURE = 4.0


def _derivative() -> Array:
    """Return the matrix (ORDER, ORDER) from values at the nodes to derivatives there."""
    each = chebyshev.chebder(np.eye(ORDER))
    return chebyshev.chebvander(NODES, ORDER - 2) @ each @ TO_COEFFICIENTS


DERIVATIVE = _derivative()
SECOND = DERIVATIVE @ DERIVATIVE


@dataclass(frozen=True, eq=False)
class CurvatureField:
    """K on panels: `lines` are their borders along u and v.

    In a periodic direction (`wraps`) the panels make one period that starts inside the domain.

    `coefficients` (m, n, ORDER, ORDER) are those of K in products of Chebyshev polynomials of the
    two coordinates of a panel, −1 … 1; on some panels those of K |p_u × p_v|⁴, scaled, which has
    the same zeros and signs and is closer to a polynomial where the surface is steep. `noise`
    (m, n) bounds the error of K; `curvature_scale` (m, n) is what it is compared with where K is
    small: the square of the normal curvature of the parameter lines, plus that of one over the size
    of the surface. K is that of the surface times a power of two that makes its
    coordinates about 1.
    """

    lines: tuple[Array, Array]
    wraps: tuple[bool, bool]
    coefficients: Array
    noise: Array
    curvature_scale: Array

    @classmethod
    def of_surface(cls, surface: Surface, panels: tuple[int, int]) -> CurvatureField:
        """Interpolate a surface; SurfaceError if it cannot be evaluated."""
        wraps = surface.boundary[0][0] == "periodic", surface.boundary[1][0] == "periodic"
        lines = [
            _lines(low, high, count, periodic)
            for (low, high), count, periodic in zip(surface.domain, panels, wraps, strict=True)
        ]
        inside = [
            low + np.mod(_nodes(x) - low, high - low) if periodic else _nodes(x)
            for x, (low, high), periodic in zip(lines, surface.domain, wraps, strict=True)
        ]
        x = not_too_large(surface.evaluate(inside[0][:, None], inside[1]), surface.name)
        x = x.reshape(panels[0], ORDER, panels[1], ORDER, 3).transpose(0, 2, 1, 3, 4)
        K, rounding, curvature_scale, area = _curvature(x, *(np.diff(line) for line in lines))
        fields = [
            cls((lines[0], lines[1]), wraps, *_polynomials(K * weight, rounding * weight), rest)
            for weight, rest in (
                (np.ones_like(K), curvature_scale),
                _weights(area, curvature_scale),
            )
        ]
        return _better(*fields)

    @cached_property
    def largest(self) -> Array:
        """The sum (m, n) of the moduli of the coefficients: a bound of |K|."""
        return np.abs(self.coefficients).sum(axis=(2, 3))

    @cached_property
    def flat(self) -> NDArray[np.bool_]:
        """Where (m, n) K is zero up to its error, although that is small."""
        bound = 4.0 * ORDER * self.noise
        return (self.largest <= bound) & (bound <= RESOLVED * self.curvature_scale)

    @cached_property
    def unresolved(self) -> NDArray[np.bool_]:
        """Where (m, n) the error of K is large relative to K and to the squared curvature."""
        least = np.maximum(self.largest, RESOLVED * self.curvature_scale)
        return ~self.flat & ~(self.noise <= RESOLVED * least)

    @cached_property
    def rough(self) -> NDArray[np.bool_]:
        """Where (m, n) the error of K is one that smaller panels may lessen."""
        return ~(self.noise <= ACCURATE * self.curvature_scale)

    def share(self, which: NDArray[np.bool_]) -> float:
        """Return the share of the domain that panels (m, n) take."""
        areas = np.outer(*(np.diff(line) for line in self.lines))
        return float(areas[which].sum() / areas.sum())

    def evaluate(self, places: Array, du: int = 0, dv: int = 0) -> Array:
        """Return K or a partial derivative (k,) at places (k, 2), extrapolating beyond the ends."""
        indices, local, sizes = self._located(places)
        basis = [
            chebyshev.chebvander(x, ORDER - 1 - order) @ chebyshev.chebder(np.eye(ORDER), order)
            for x, order in zip(local, (du, dv), strict=True)
        ]
        inner = self.coefficients[indices[0], indices[1]] @ basis[1][..., None]
        values = np.einsum("ka,ka->k", basis[0], inner[..., 0])
        return values * (2.0 / sizes[0]) ** du * (2.0 / sizes[1]) ** dv

    def noise_at(self, places: Array) -> Array:
        """Return the error of K (k,) at places (k, 2)."""
        (i, j), *_ = self._located(places)
        return self.noise[i, j]

    def _located(self, places: Array) -> tuple[list[NDArray[np.int64]], list[Array], list[Array]]:
        """Return panels, coordinates on them (-1 … 1) and sizes of panels, each by u and by v."""
        indices, local, sizes = [], [], []
        for line, x, periodic in zip(self.lines, places.T, self.wraps, strict=True):
            if periodic:
                x = line[0] + np.mod(x - line[0], line[-1] - line[0])
            index = np.clip(np.searchsorted(line, x, side="right") - 1, 0, len(line) - 2)
            size = line[index + 1] - line[index]
            indices.append(index)
            local.append(2.0 * (x - line[index]) / size - 1.0)
            sizes.append(size)
        return indices, local, sizes

    def gradient(self, places: Array) -> Array:
        """Return the derivatives (k, 2) of K by u and v."""
        return np.stack([self.evaluate(places, 1, 0), self.evaluate(places, 0, 1)], axis=1)

    def hessian(self, places: Array) -> Array:
        """Return the second derivatives (k, 2, 2) of K by u and v."""
        uu, uv, vv = (self.evaluate(places, *by) for by in ((2, 0), (1, 1), (0, 2)))
        return np.stack([uu, uv, uv, vv], axis=1).reshape(-1, 2, 2)


def _lines(low: float, high: float, count: int, periodic: bool) -> Array:
    shares = (np.arange(count + 1) + OFFSET) / count
    if not periodic:
        shares[0], shares[-1] = 0.0, 1.0
    return low + (high - low) * shares


def _nodes(lines: Array) -> Array:
    """Return the Chebyshev nodes of all panels along one direction, in one line."""
    middle, half = 0.5 * (lines[1:] + lines[:-1]), 0.5 * np.diff(lines)
    return (middle[:, None] + half[:, None] * NODES).ravel()


def _tail(coefficients: Array) -> Array:
    """Return the largest (m, n, 1, 1) of the last coefficients (m, n, d, ORDER, ORDER)."""
    size = np.abs(coefficients).max(axis=2)
    ends = size[:, :, -4:].max(axis=(2, 3)), size[..., -4:].max(axis=(2, 3))
    return np.maximum(*ends)[..., None, None]


def _curvature(x: Array, sizes_u: Array, sizes_v: Array) -> tuple[Array, Array, Array, Array]:
    """Return K, its rounding error, curvature scale (m, n) and |p_u × p_v| at the nodes of points.

    All but the scale are (m, n, ORDER, ORDER).

    Lengths are relative to the size of the surface, so that nothing overflows.
    """
    x = x * scale_to_one(float(np.abs(x).max()))
    scale = float(np.abs(x - x.mean(axis=(0, 1, 2, 3))).max()) or 1.0
    error = 4.0 * float(np.spacing(np.abs(x).max())) / scale
    x = (x - x.mean(axis=(0, 1, 2, 3))) / scale
    error = error + _tail(TO_COEFFICIENTS @ np.moveaxis(x, -1, 2) @ TO_COEFFICIENTS.T)
    along_u, along_v = 2.0 / sizes_u[:, None, None, None, None], 2.0 / sizes_v[:, None, None, None]
    p_u = np.einsum("ai,mnibx->mnabx", DERIVATIVE, x) * along_u
    p_v = np.einsum("bi,mnaix->mnabx", DERIVATIVE, x) * along_v
    p_uu = np.einsum("ai,mnibx->mnabx", SECOND, x) * along_u**2
    p_uv = np.einsum("bi,mnaix->mnabx", DERIVATIVE, p_u) * along_v
    p_vv = np.einsum("bi,mnaix->mnabx", SECOND, x) * along_v**2
    derivatives = map(vector, (p_u, p_v, p_uu, p_uv, p_vv))
    with np.errstate(all="ignore"):
        K = python_function(formulas.gaussian_curvature_of_derivatives)(*derivatives)
        normal = np.cross(p_u, p_v)
        area = np.linalg.norm(normal, axis=-1)
        along = [
            np.abs(np.einsum("mnabx,mnabx->mnab", normal, second)) / area / (first**2).sum(axis=-1)
            for first, second in ((p_u, p_uu), (p_v, p_vv))
        ]
        first, second = (float(np.linalg.norm(x, axis=1).max()) for x in (DERIVATIVE, SECOND))
        of_uu = error * second * along_u[..., 0] ** 2
        of_vv = error * second * along_v[..., 0] ** 2
        of_uv = error * first**2 * along_u[..., 0] * along_v[..., 0]
        uu, uv, vv = (np.linalg.norm(x, axis=-1) for x in (p_uu, p_uv, p_vv))
        rounding = (uu * of_vv + vv * of_uu + 2.0 * uv * of_uv + of_uu * of_vv) / area**2
    bad = ~np.isfinite(K) | ~np.isfinite(rounding)
    K[bad], rounding[bad] = 0.0, np.inf
    curvature_scale = 1.0 + np.nan_to_num(np.maximum(*along), posinf=0.0).max(axis=(2, 3)) ** 2
    return K / scale**2, rounding / scale**2, curvature_scale / scale**2, area


def _weights(area: Array, curvature_scale: Array) -> tuple[Array, Array]:
    """Return weights (m, n, ORDER, ORDER) that cancel the denominator of K, and the scale then.

    They are at most 1. Near a singular point, where |p_u × p_v| vanishes, the weights are 1 and the
    scale of the curvature 0, so that the panel counts as unresolved.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = (area / area.max(axis=(2, 3), keepdims=True)) ** 4
    singular = ~(weights.min(axis=(2, 3)) >= LEAST_AREA**4)
    weights[singular] = 1.0
    return weights, np.where(singular, 0.0, curvature_scale * weights.min(axis=(2, 3)))


def _polynomials(K: Array, rounding: Array) -> tuple[Array, Array]:
    """Return the coefficients (m, n, ORDER, ORDER) and the error (m, n) of K on each panel."""
    coefficients = TO_COEFFICIENTS @ K @ TO_COEFFICIENTS.T
    tail = _tail(coefficients[:, :, None])[..., 0, 0]
    return coefficients, LEBESGUE**2 / SURE * rounding.max(axis=(2, 3)) + ORDER * tail


def _better(plain: CurvatureField, weighted: CurvatureField) -> CurvatureField:
    """Take K with weights on the panels where K alone is not accurate, but is with them."""
    better = plain.rough & ~weighted.flat & ~weighted.unresolved
    with np.errstate(invalid="ignore"):
        better &= weighted.noise * plain.largest < plain.noise * weighted.largest
    coefficients = np.where(better[..., None, None], weighted.coefficients, plain.coefficients)
    noise = np.where(better, weighted.noise, plain.noise)
    curvature_scale = np.where(better, weighted.curvature_scale, plain.curvature_scale)
    return replace(plain, coefficients=coefficients, noise=noise, curvature_scale=curvature_scale)
