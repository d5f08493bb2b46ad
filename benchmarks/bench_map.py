"""Points with given normals of a map that is built once, on the surface and on its spline.

The limit is the writing of the same samples into new arrays, as in `bench_sample`; for few normals
the ratio is that of the fixed costs of a call. The baseline of the surface is the same query to its
spline, without a proof that all points are found.
"""

from __future__ import annotations

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.benchmarks.writing import Writers, new_arrays

SURFACES = {"torus": gm.surfaces.torus(), "wavy-graph": gm.surfaces.wavy_graph()}
# The number of normals, and the number of rounds.
NORMALS = {"1": (1, 25), "100": (100, 25), "10k": (10_000, 9), "1M": (1_000_000, 3)}


@pytest.fixture(scope="module", params=SURFACES.values(), ids=list(SURFACES))
def maps(request):
    return {on: gm.GaussMap(request.param, on=on) for on in ("surface", "spline")}


@pytest.mark.parametrize("on", ["surface", "spline"])
@pytest.mark.parametrize(("count", "rounds"), NORMALS.values(), ids=list(NORMALS))
def test_points(compare, maps, on, count, rounds):
    normals = np.random.default_rng(0).normal(size=(count, 3))
    found = len(maps[on].points(normals))
    others = {"spline": lambda: maps["spline"].points(normals)} if on == "surface" else {}
    with Writers() as write:
        compare(
            lambda: maps[on].points(normals),
            limits={"new_array_limit": lambda: write(new_arrays(found))},
            baselines=others,
            units={"normals": count},
            rounds=rounds,
        )


@pytest.mark.parametrize("name", SURFACES)
def test_map(compare, name):
    """Build the map; the baseline is the spline alone."""
    surface = SURFACES[name]
    compare(lambda: gm.GaussMap(surface), baselines={"fit": lambda: gm.fit(surface)})
