"""The usual method: the |K| recipe in NumPy, on a torus with formulas in closed form.

The recipe uses the curvature and draws random points; gaussmap uses positions only.
"""

from __future__ import annotations

import gaussmap as gm
import pytest
from gaussmap.benchmarks.peers.forms import Torus
from gaussmap.benchmarks.peers.recipe import by_curvature


@pytest.mark.parametrize("count", [100_000, 1_000_000])
def test_sample_count(compare, count):
    """From the surface to the samples, fit included; NumPy has one thread."""
    torus = Torus()
    surface = torus.surface
    compare(
        lambda: gm.sample(surface, count=count, density="gauss"),
        baselines={"numpy_recipe": lambda: by_curvature(torus, count)},
        units={"samples": count},
        rounds=5,
    )
