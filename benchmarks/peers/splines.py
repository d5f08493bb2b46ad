"""Points on a bicubic B-spline with a 61 × 61 net, by Splipy and geomdl."""

# Only `make bench-peers` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from functools import cache
from typing import Any

import gaussmap as gm
import numpy as np

from .forms import Array, ClosedForm
from .meshes import unit
from .peer import Points, Work

NET = 61
GRID = 512
AT_A_TIME = 10_000  # Splipy makes a full matrix of all places and all coefficients


@cache
def net(form: ClosedForm) -> Any:
    """Return Splipy's cubic spline that interpolates the surface at 61 × 61 points."""
    from splipy.basis import BSplineBasis
    from splipy.surface_factory import interpolate

    bases = [
        BSplineBasis(4, np.concatenate([[low] * 3, np.linspace(low, high, NET - 2), [high] * 3]))
        for low, high in form.surface.domain
    ]
    u, v = (np.asarray(x.greville()) for x in bases)
    return interpolate(form.evaluate(u[:, None], v[None, :])[0], bases, [u, v])


def surface_of_net(form: ClosedForm) -> gm.Surface:
    """Return the B-spline for gaussmap."""
    return gm.Surface.from_nurbs(
        net(form), periodic=form.surface.boundary, name=f"B-spline of {form.name}"
    )


def splipy_by_grid(form: ClosedForm, count: int) -> Work:
    """Prepare a grid of parameters."""
    spline = net(form)
    u, v = (x.ravel() for x in form.lattice(count))

    def work() -> Points:
        return spline(u, v).reshape(-1, 3), spline.normal(u, v).reshape(-1, 3)

    return work


def splipy_by_curvature(form: ClosedForm, count: int) -> Work:
    """Prepare random points of the density |K|, by an inverse CDF over a fine grid of (u, v)."""
    spline = net(form)
    (u0, u1), (v0, v1) = form.surface.domain
    step_u, step_v = (u1 - u0) / GRID, (v1 - v0) / GRID
    middle = np.arange(GRID) + 0.5
    cumulated = np.cumsum(bending(spline, u0 + step_u * middle, v0 + step_v * middle))
    rng = np.random.default_rng(1)

    def work() -> Points:
        cell = np.searchsorted(cumulated, rng.random(count) * cumulated[-1])
        row, column = np.divmod(np.minimum(cell, GRID * GRID - 1), GRID)
        u = u0 + step_u * (row + rng.random(count))
        v = v0 + step_v * (column + rng.random(count))
        parts = [
            (spline(u[k], v[k], tensor=False), spline.normal(u[k], v[k], tensor=False))
            for k in np.split(np.arange(count), np.arange(AT_A_TIME, count, AT_A_TIME))
        ]
        return np.concatenate([x for x, _ in parts]), np.concatenate([n for _, n in parts])

    return work


def bending(spline: Any, u: Array, v: Array) -> Array:
    """Return |K| times the area element on a lattice, row by row."""
    x_u, x_v, x_uu, x_uv, x_vv = (
        spline.derivative(u, v, d=d) for d in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    )
    normal = np.cross(x_u, x_v)
    L, M, N = (np.einsum("...x,...x->...", x, normal) for x in (x_uu, x_uv, x_vv))
    area = np.linalg.norm(normal, axis=-1)
    return (np.abs(L * N - M * M) / area**3).ravel()


def geomdl_by_grid(form: ClosedForm, count: int) -> Work:
    """Prepare a grid of parameters."""
    from geomdl import BSpline

    spline = net(form)
    surface = BSpline.Surface()
    surface.degree_u = surface.degree_v = 3
    surface.ctrlpts2d = spline.controlpoints.tolist()
    surface.knotvector_u, surface.knotvector_v = (x.knots.tolist() for x in spline.bases)
    sides = [
        (x.ravel() - low) / (high - low)  # geomdl brings every domain to 0 … 1
        for x, (low, high) in zip(form.lattice(count), form.surface.domain, strict=True)
    ]

    def work() -> Points:
        found = [surface.derivatives(u, v, 1) for u in sides[0].tolist() for v in sides[1].tolist()]
        points, x_u, x_v = (np.array([x[i][j] for x in found]) for i, j in ((0, 0), (1, 0), (0, 1)))
        return points, unit(np.cross(x_u, x_v))

    return work
