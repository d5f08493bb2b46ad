"""Fewer fields, streams and fewer threads, each compared with `sample` by default."""

from __future__ import annotations

from functools import partial

import gaussmap as gm
import numpy as np
import pytest

NORMALS = gm.fibonacci(1_000_000)
# The torus has every normal twice: 2 million samples, 556 or 5 per patch.
SPLINES = {cells: gm.fit(gm.surfaces.torus(), (cells, cells)) for cells in (30, 320)}
OUTPUTS = {
    "points": {"fields": ("points",)},
    "points-normals": {"fields": ("points", "normals")},
    "points-normals-float32": {"fields": ("points", "normals"), "dtype": np.float32},
    "all-float32": {"dtype": np.float32},
}


@pytest.fixture(params=SPLINES, ids=lambda cells: f"{cells}-cells")
def sample(request):
    """Sample a spline with a million normals."""
    return partial(gm.sample, SPLINES[request.param], normals=NORMALS)


@pytest.mark.parametrize("output", OUTPUTS.values(), ids=list(OUTPUTS))
def test_output(compare, sample, output):
    compare(
        lambda: sample(**output),
        baselines={"all_fields": sample},
        units={"samples": 2_000_000},
        rounds=9,
    )


@pytest.mark.parametrize("chunk", [100_000, 1_000_000])
def test_stream(compare, sample, chunk):
    spline, normals = sample.args

    def stream():
        for _ in gm.sample_stream(spline, normals=normals, chunk=chunk):
            pass

    compare(stream, baselines={"sample": sample}, units={"samples": 2_000_000}, rounds=9)


def test_one_thread(compare, sample):
    compare(
        lambda: sample(threads=1),
        baselines={"two_threads": lambda: sample(threads=2)},
        units={"samples": 2_000_000},
        rounds=9,
    )
