"""What users do today: the |K| recipe in NumPy, on a torus whose formulas are known in closed form.

The recipe knows the curvature and gives random points; gaussmap knows the positions alone.
"""

from __future__ import annotations

import gaussmap as gm
import numpy as np
import pytest

MAJOR, MINOR = 1.0, 0.35


def recipe(count, grid=512):
    """Draw (u, v) with the density |K| by an inverse CDF over a fine grid; closed forms there."""
    rng = np.random.default_rng(1)
    step = 2.0 * np.pi / grid
    middle = step * (np.arange(grid) + 0.5)
    ring = MAJOR + MINOR * np.cos(middle)
    K = np.cos(middle) / (MINOR * ring)
    weight = np.broadcast_to(np.abs(K) * MINOR * ring, (grid, grid))
    cumulated = np.cumsum(weight.ravel())
    cell = np.searchsorted(cumulated, rng.random(count) * cumulated[-1])
    cell = np.minimum(cell, grid * grid - 1)
    u = step * (cell // grid + rng.random(count))
    v = step * (cell % grid + rng.random(count))
    cos_u, sin_u, cos_v, sin_v = np.cos(u), np.sin(u), np.cos(v), np.sin(v)
    normals = np.column_stack([cos_u * cos_v, sin_u * cos_v, sin_v])
    ring = MAJOR + MINOR * cos_v
    points = np.column_stack([ring * cos_u, ring * sin_u, MINOR * sin_v])
    return np.column_stack([u, v]), points, normals, cos_v / (MINOR * ring)


@pytest.mark.parametrize("threads", [1, None], ids=["one-thread", "all-threads"])
@pytest.mark.parametrize("count", [100_000, 1_000_000])
def test_sample_count(compare, count, threads):
    """From the surface to the samples, fit included; NumPy has one thread in either case."""
    torus = gm.surfaces.torus(major=MAJOR, minor=MINOR)
    compare(
        lambda: gm.sample(torus, count=count, threads=threads),
        baselines={"numpy_recipe": lambda: recipe(count)},
        units={"samples": count},
        rounds=5,
    )
