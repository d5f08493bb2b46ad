"""Parabolic samples: K is zero up to rounding, whatever its sign bit says."""

import warnings
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ...shapes import moved


@pytest.mark.parametrize("factor", [1.0, 1e-9, 1e9, 1e-100])
def test_curved_surfaces_are_not(factor):
    scaled = moved(gm.surfaces.torus(), factor)
    samples = gm.sample(gm.fit(scaled, (16, 16)), 200)
    assert not samples.parabolic.any()
    assert "flat" not in samples.summary()


@pytest.mark.parametrize("height", [1e-3, 1e-6])
def test_gentle_waves_are_curved(height):
    waves = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, height * np.sin(u) * np.cos(v)], axis=-1), ((0, 6), (0, 6))
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        assert gm.sample(gm.fit(waves, (32, 32)), 300).parabolic.sum() <= 3


def test_samples_with_few_fields():
    cylinder = gm.fit("cylinder", (16, 16))
    alone = gm.sample(cylinder, 50, fields=("gaussian_curvature",))
    assert alone.parabolic.all()
    with pytest.raises(gm.errors.MissingFieldError, match="parabolic needs gaussian_curvature"):
        gm.sample(cylinder, 50, fields=("points",)).parabolic  # noqa: B018
    rows: dict[str, Any] = {x: y[:0] for x, y in gm.sample(cylinder, 50).arrays().items()}
    assert gm.Samples(**rows, report=alone.report).parabolic.shape == (0,)
