"""The usual methods in NumPy: a grid over (u, v), and random points with a density."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .forms import Array, ClosedForm


def by_grid(form: ClosedForm, count: int) -> tuple[Array, Array]:
    """Return points and normals on a grid of parameters."""
    points, normals = form.evaluate(*form.lattice(count))
    return points.reshape(-1, 3), normals.reshape(-1, 3)


def draw(
    form: ClosedForm,
    count: int,
    density: Callable[[Array, Array], Array],
    grid: int = 512,
    seed: int = 1,
) -> tuple[Array, Array]:
    """Draw u and v with a density over the parameters, by an inverse CDF over a fine grid."""
    rng = np.random.default_rng(seed)
    (u0, u1), (v0, v1) = form.surface.domain
    step_u, step_v = (u1 - u0) / grid, (v1 - v0) / grid
    middle = np.arange(grid) + 0.5
    weight = density(u0 + step_u * middle[:, None], v0 + step_v * middle[None, :])
    cumulated = np.cumsum(np.broadcast_to(weight, (grid, grid)).ravel())
    cell = np.searchsorted(cumulated, rng.random(count) * cumulated[-1])
    row, column = np.divmod(np.minimum(cell, grid * grid - 1), grid)
    return u0 + step_u * (row + rng.random(count)), v0 + step_v * (column + rng.random(count))


def by_curvature(form: ClosedForm, count: int) -> tuple[Array, Array, Array, Array]:
    """Return points, normals, parameters (N, 2) and K of random points of the density |K|."""
    u, v = draw(form, count, form.bending)
    points, normals = form.evaluate(u, v)
    return points, normals, np.column_stack([u, v]), form.curvature(u, v)
