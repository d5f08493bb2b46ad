"""The Gaussian curvature of a smooth surface as a function of u, v: polynomials on panels.

The domain is cut into panels; on each the surface is interpolated at Chebyshev nodes, which lie
inside the panel, and differentiated: the error is that of rounding for a smooth surface. K is then
interpolated too. Its last coefficients tell its error: that of rounding, or of the interpolation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from ...generated import gaussian_image as formulas
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.base.scales import scale_to_one
from ...runtime.spline.quasi_interpolant import not_too_large
from ...runtime.surface.surface import Surface

__all__ = ["ORDER", "SURE", "CurvatureField"]

Array = NDArray[np.float64]
# Nodes along a side of a panel.
ORDER = 16
# Panels are shifted by this share of one: parabolic curves of symmetric surfaces often lie on lines
# of symmetry, which should not be borders of panels.
OFFSET = 0.2360679774997897
# K is resolved where its error is less than this, relative to its largest value on the panel.
RESOLVED = 1e-2
# K is accurate where its error is less than this, relative to the squared curvature of the surface.
ACCURATE = 1e-8
# Where |p_u × p_v| on a panel falls below this share of its largest value, K keeps its denominator.
LEAST_AREA = 1e-2
# The sign of K is used where |K| exceeds its estimated error by this factor.
SURE = 4.0


def _bernstein(degree: int, t: Array) -> Array:
    """Return the Bernstein polynomials (N, degree + 1) at t (N,)."""
    k = np.arange(degree + 1)
    number = np.array([math.comb(degree, x) for x in k])
    return number * t[:, None] ** k * (1.0 - t[:, None]) ** (degree - k)


NODES = chebyshev.chebpts1(ORDER)
TO_COEFFICIENTS = np.linalg.inv(chebyshev.chebvander(NODES, ORDER - 1))
# From coefficients to those of derivatives of the order 0, 1 and 2.
TO_DERIVATIVE = [
    np.pad(chebyshev.chebder(np.eye(ORDER), order), ((0, order), (0, 0))) for order in range(3)
]
# From values at the nodes to those of the Bernstein polynomials, 0 … 1.
TO_BERNSTEIN = np.linalg.inv(_bernstein(ORDER - 1, 0.5 + 0.5 * NODES))
# Bounds are computed to this, relative to the largest coefficient.
ROUNDING = 1e-11
# From values at the nodes to derivatives there.
DERIVATIVE = chebyshev.chebvander(NODES, ORDER - 1) @ TO_DERIVATIVE[1] @ TO_COEFFICIENTS


@dataclass(frozen=True, eq=False)
class CurvatureField:
    """K on panels: `lines` are their borders along u and v.

    In a periodic direction (`wraps`) the panels make one period that starts inside the domain.

    `coefficients` (m, n, ORDER, ORDER) are those of K |p_u × p_v|⁴, scaled, in products of
    Chebyshev polynomials of the two coordinates of a panel, −1 … 1: it has the zeros and signs of
    K, and is closer to a polynomial where the surface is steep. `noise` (m, n) bounds its error;
    `curvature_scale` (m, n) is what it is compared with where K is small: the square of the normal
    curvature of the parameter lines, plus that of one over the size of the surface.
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
        u, v = (
            _lines(low, high, count, periodic)
            for (low, high), count, periodic in zip(surface.domain, panels, wraps, strict=True)
        )
        inside = [
            low + np.mod(_nodes(x) - low, high - low) if periodic else _nodes(x)
            for x, (low, high), periodic in zip((u, v), surface.domain, wraps, strict=True)
        ]
        x = not_too_large(surface.evaluate(inside[0][:, None], inside[1]), surface.name)
        x = x.reshape(panels[0], ORDER, panels[1], ORDER, 3).transpose(0, 2, 1, 3, 4)
        K, curvature_scale = _curvature(x, np.diff(u), np.diff(v))
        known = np.isfinite(K).all(axis=(2, 3))
        K[~known] = 0.0
        coefficients = TO_COEFFICIENTS @ K @ TO_COEFFICIENTS.T
        size = np.abs(coefficients)
        tail = np.maximum(size[:, :, -4:].max(axis=(2, 3)), size[..., -4:].max(axis=(2, 3)))
        noise = np.where(known, ORDER**2 * tail, np.inf)
        return cls((u, v), wraps, coefficients, noise, curvature_scale)

    @cached_property
    def largest(self) -> Array:
        """The sum (m, n) of the moduli of the coefficients: a bound of |K|."""
        return np.abs(self.coefficients).sum(axis=(2, 3))

    @cached_property
    def is_small(self) -> NDArray[np.bool_]:
        """Where (m, n) the error of K is small relative to the squared curvature."""
        return SURE * self.noise <= RESOLVED * self.curvature_scale

    @cached_property
    def flat(self) -> NDArray[np.bool_]:
        """Where (m, n) K is zero up to its error, which is small."""
        return (self.largest <= SURE * self.noise) & self.is_small

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

    def evaluate(self, places: Array) -> Array:
        """Return K (k,) at places (k, 2), extrapolating beyond the ends."""
        return self._derivatives(places, (0, 0))[0]

    def gradient(self, places: Array) -> Array:
        """Return the derivatives (k, 2) of K by u and v."""
        return self._derivatives(places, (1, 0), (0, 1)).T

    def hessian(self, places: Array) -> Array:
        """Return the second derivatives (k, 2, 2) of K by u and v."""
        uu, uv, vv = self._derivatives(places, (2, 0), (1, 1), (0, 2))
        return np.stack([uu, uv, uv, vv], axis=1).reshape(-1, 2, 2)

    def _derivatives(self, places: Array, *orders: tuple[int, int]) -> Array:
        """Return partial derivatives (…, k) of K, of the given orders by u and v."""
        (i, j), local, sizes = self._located(places)
        in_u, in_v = (chebyshev.chebvander(x, ORDER - 1) for x in local)
        coefficients = self.coefficients[i, j]
        by_v = {dv: coefficients @ (in_v @ TO_DERIVATIVE[dv])[..., None] for _, dv in orders}
        return np.array([
            np.einsum("ka,ka->k", in_u @ TO_DERIVATIVE[du], by_v[dv][..., 0])
            * ((2.0 / sizes[0]) ** du * (2.0 / sizes[1]) ** dv)
            for du, dv in orders
        ])  # fmt: skip

    def bounded(self, cells: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return the cells in which K may vanish, and those in which its derivatives may, too.

        A panel has `cells` cells along each side. A polynomial and its derivatives are bounded by
        the coefficients of Bernstein polynomials.
        """
        local = (np.arange(cells)[:, None] + 0.5 + 0.5 * NODES) * (2.0 / cells) - 1.0
        into = (TO_BERNSTEIN @ chebyshev.chebvander(local, ORDER - 1)).reshape(-1, ORDER)
        m, n = self.noise.shape
        zero, critical = (np.zeros((m, cells, n, cells), dtype=bool) for _ in range(2))
        rest = self.largest - 2.0 * np.abs(self.coefficients[..., 0, 0]) + SURE * self.noise
        for i, j in np.argwhere(~self.unresolved & ~self.flat & (rest >= 0.0)):
            error = SURE * self.noise[i, j] + ROUNDING * self.largest[i, j]
            b = (into @ self.coefficients[i, j] @ into.T).reshape(cells, ORDER, cells, ORDER)
            zero[i, :, j] = (b.min(axis=(1, 3)) <= error) & (b.max(axis=(1, 3)) >= -error)
            b = b.swapaxes(1, 2)[zero[i, :, j]]
            slopes = np.diff(np.stack([b, b.swapaxes(1, 2)]))
            flat = (slopes.min(axis=(2, 3)) <= error) & (slopes.max(axis=(2, 3)) >= -error)
            critical[i, :, j][zero[i, :, j]] = flat.all(axis=0)
        return zero.reshape(m * cells, -1), critical.reshape(m * cells, -1)

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


def _lines(low: float, high: float, count: int, periodic: bool) -> Array:
    shares = (np.arange(count + 1) + OFFSET) / count
    if not periodic:
        shares[0], shares[-1] = 0.0, 1.0
    return low + (high - low) * shares


def _nodes(lines: Array) -> Array:
    """Return the Chebyshev nodes of all panels along one direction, in one line."""
    middle, half = 0.5 * (lines[1:] + lines[:-1]), 0.5 * np.diff(lines)
    return (middle[:, None] + half[:, None] * NODES).ravel()


def _curvature(x: Array, sizes_u: Array, sizes_v: Array) -> tuple[Array, Array]:
    """Return K |p_u × p_v|⁴ at the nodes (m, n, ORDER, ORDER) of points, and its scale (m, n).

    The factor is relative to its largest value; it is constant on a panel near a singular point,
    where it vanishes. Lengths are relative to the size of the surface, so that nothing overflows.
    """
    x = x * scale_to_one(float(np.abs(x).max()))
    scale = float(np.abs(x - x.mean(axis=(0, 1, 2, 3))).max()) or 1.0
    x = (x - x.mean(axis=(0, 1, 2, 3))) / scale
    along_u, along_v = 2.0 / sizes_u[:, None, None, None, None], 2.0 / sizes_v[:, None, None, None]

    def by_u(x: Array) -> Array:
        return np.einsum("ai,mnibx->mnabx", DERIVATIVE, x, optimize=True) * along_u

    def by_v(x: Array) -> Array:
        return np.einsum("bi,mnaix->mnabx", DERIVATIVE, x, optimize=True) * along_v

    p_u, p_v = by_u(x), by_v(x)
    p_uu, p_uv, p_vv = by_u(p_u), by_v(p_u), by_v(p_v)
    derivatives = map(vector, (p_u, p_v, p_uu, p_uv, p_vv))
    with np.errstate(all="ignore"):
        K = python_function(formulas.gaussian_curvature_of_derivatives)(*derivatives)
        normal = np.cross(p_u, p_v)
        area = np.linalg.norm(normal, axis=-1)
        along = [
            np.abs(np.einsum("mnabx,mnabx->mnab", normal, second)) / area / (first**2).sum(axis=-1)
            for first, second in ((p_u, p_uu), (p_v, p_vv))
        ]
        weights = (area / np.nanmax(area)) ** 4
    largest = weights.max(axis=(2, 3), keepdims=True)
    singular = weights.min(axis=(2, 3), keepdims=True) < LEAST_AREA**4 * largest
    weights = np.where(singular, largest, weights)
    curvature_scale = 1.0 + np.median(np.nan_to_num(np.maximum(*along)), axis=(2, 3)) ** 2
    return K * weights, curvature_scale * weights.min(axis=(2, 3))
