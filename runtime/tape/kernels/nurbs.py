"""Points of NURBS surfaces and their first and second derivatives, at many parameters.

Basis functions are computed by the recursion of Cox and de Boor: L. Piegl and W. Tiller, The NURBS
Book, 2nd ed., Springer 1997, algorithm A2.2; their derivatives by its eq. (2.7).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.rational import rational_jet
from ...directions.kernels.vectors import row_vector, set_row
from ...machine_code.jit import jit, loop


class Net(NamedTuple):
    """A NURBS surface, as arrays for kernels.

    `points` are (m, n, 3), or (m, n, 4) with w x, w y, w z, w; x, y, z are relative to `centre`
    (3,). `degrees` (2,) has the degrees for u and for v. `spans` (2, 2) has a row for u and a row
    for v: the indices of the first and the last knot span in use; the polynomials of these two are
    continued beyond them. `periods` (2, 2) likewise: the lower end and the length of the period;
    the length is 0 if there is no period.
    """

    degrees: NDArray[np.int64]
    knots_u: NDArray[np.float64]
    knots_v: NDArray[np.float64]
    spans: NDArray[np.int64]
    periods: NDArray[np.float64]
    points: NDArray[np.float64]
    centre: NDArray[np.float64]


class Scratch(NamedTuple):
    """Memory for one call.

    `basis_u` and `basis_v` (3, degree + 1) have rows for the basis functions and their first and
    second derivatives; `sums` (6, 4) has the results of `sum_derivatives`.
    """

    basis_u: NDArray[np.float64]
    basis_v: NDArray[np.float64]
    sums: NDArray[np.float64]


@loop
def in_period(x, low, period):
    """Return a parameter, reduced to the period [low, low + period] if there is one."""
    if period > 0.0 and (x < low or x > low + period):
        return x - period * math.floor((x - low) / period)
    return x


@loop
def span_of(knots, first, last, near, x):
    """Return the knot span from `first` to `last` that contains x, or the one nearest to x.

    A span contains its left knot, but not its right knot. The search begins at the span `near`.
    """
    if knots[near] <= x < knots[near + 1]:
        return near
    if not x >= knots[first + 1]:  # NaN, too
        return first
    if x >= knots[last]:
        return last
    low, high = first, last
    while high - low > 1:
        middle = (low + high) // 2
        if x < knots[middle]:
            high = middle
        else:
            low = middle
    return low


@loop
def basis_functions(knots, degree, span, x, basis):
    """Write the nonzero basis functions, and their first and second derivatives.

    Each step raises the degree by one. The derivatives of functions of one degree are differences
    of functions of the degree below, each divided by the length of its support.
    """
    basis[0, 0], basis[1, 0], basis[2, 0] = 1.0, 0.0, 0.0
    for j in range(1, degree + 1):
        left, slope_left, bend_left = 0.0, 0.0, 0.0
        for r in range(j):
            low, high = knots[span + 1 - j + r], knots[span + 1 + r]
            value, slope = basis[0, r] / (high - low), basis[1, r] / (high - low)
            basis[0, r] = left + (high - x) * value
            basis[1, r] = slope_left - j * value
            basis[2, r] = bend_left - j * slope
            left, slope_left, bend_left = (x - low) * value, j * value, j * slope
        basis[0, j], basis[1, j], basis[2, j] = left, slope_left, bend_left


@loop
def sum_derivatives(net, i, j, scratch):
    """Write the sums over control points that give coordinates and their derivatives.

    The rows of `scratch.sums` are for 1, u, v, uu, uv, vv; i and j are the knot spans.
    """
    p, q = net.degrees[0], net.degrees[1]
    basis_u, basis_v, sums = scratch
    for c in range(net.points.shape[2]):
        x, x_u, x_v, x_uu, x_uv, x_vv = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for r in range(p + 1):
            y, y_v, y_vv = 0.0, 0.0, 0.0
            for s in range(q + 1):
                coordinate = net.points[i - p + r, j - q + s, c]
                y += basis_v[0, s] * coordinate
                y_v += basis_v[1, s] * coordinate
                y_vv += basis_v[2, s] * coordinate
            x += basis_u[0, r] * y
            x_u += basis_u[1, r] * y
            x_v += basis_u[0, r] * y_v
            x_uu += basis_u[2, r] * y
            x_uv += basis_u[1, r] * y_v
            x_vv += basis_u[0, r] * y_vv
        sums[0, c], sums[1, c], sums[2, c] = x, x_u, x_v
        sums[3, c], sums[4, c], sums[5, c] = x_uu, x_uv, x_vv


@jit
def jets(net, u, v, scratch, out):
    """Write x, x_u, x_v, x_uu, x_uv and x_vv (k, 6, 3) at parameters u (k,) and v (k,)."""
    basis_u, basis_v, sums = scratch
    i, j = net.spans[0, 0], net.spans[1, 0]
    for k in range(len(u)):
        x = in_period(u[k], net.periods[0, 0], net.periods[0, 1])
        y = in_period(v[k], net.periods[1, 0], net.periods[1, 1])
        i = span_of(net.knots_u, net.spans[0, 0], net.spans[0, 1], i, x)
        j = span_of(net.knots_v, net.spans[1, 0], net.spans[1, 1], j, y)
        basis_functions(net.knots_u, net.degrees[0], i, x, basis_u)
        basis_functions(net.knots_v, net.degrees[1], j, y, basis_v)
        sum_derivatives(net, i, j, scratch)
        if net.points.shape[2] == 4:
            jet = rational_jet(
                row_vector(sums, 0), row_vector(sums, 1), row_vector(sums, 2),
                row_vector(sums, 3), row_vector(sums, 4), row_vector(sums, 5),
                sums[0, 3], sums[1, 3], sums[2, 3], sums[3, 3], sums[4, 3], sums[5, 3],
            )  # fmt: skip
            for d in range(6):
                set_row(out[k], d, jet[d])
        else:
            for d in range(6):
                set_row(out[k], d, row_vector(sums, d))
        for c in range(3):
            out[k, 0, c] += net.centre[c]


@jit
def positions(net, u, v, scratch, out):
    """Write points (k, 3) at parameters u (k,) and v (k,)."""
    p, q = net.degrees[0], net.degrees[1]
    basis_u, basis_v, sums = scratch
    i, j = net.spans[0, 0], net.spans[1, 0]
    for k in range(len(u)):
        x = in_period(u[k], net.periods[0, 0], net.periods[0, 1])
        y = in_period(v[k], net.periods[1, 0], net.periods[1, 1])
        i = span_of(net.knots_u, net.spans[0, 0], net.spans[0, 1], i, x)
        j = span_of(net.knots_v, net.spans[1, 0], net.spans[1, 1], j, y)
        basis_functions(net.knots_u, p, i, x, basis_u)
        basis_functions(net.knots_v, q, j, y, basis_v)
        sums[0, 3] = 1.0
        for c in range(net.points.shape[2]):
            x = 0.0
            for r in range(p + 1):
                y = 0.0
                for s in range(q + 1):
                    y += basis_v[0, s] * net.points[i - p + r, j - q + s, c]
                x += basis_u[0, r] * y
            sums[0, c] = x
        scale = 1.0 / sums[0, 3]
        for c in range(3):
            out[k, c] = net.centre[c] + sums[0, c] * scale
