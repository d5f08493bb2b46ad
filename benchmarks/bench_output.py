"""Fewer fields and single precision, each compared with the default of `sample`."""

from __future__ import annotations

from functools import partial

import gaussmap as gm
import numpy as np
import pytest

NORMALS = gm.fibonacci(1_000_000)
# The torus has every normal twice: 2 million samples, 556 per patch.
SPLINE = gm.fit(gm.surfaces.torus(), (30, 30))
OUTPUTS = {
    "points": {"fields": ("points",)},
    "points-normals": {"fields": ("points", "normals")},
    "points-normals-float32": {"fields": ("points", "normals"), "dtype": np.float32},
    "all-float32": {"dtype": np.float32},
}


@pytest.mark.parametrize("output", OUTPUTS.values(), ids=list(OUTPUTS))
def test_output(compare, output):
    sample = partial(gm.sample, SPLINE, normals=NORMALS)
    compare(
        lambda: sample(**output),
        baselines={"all_fields": sample},
        units={"samples": 2_000_000},
    )
