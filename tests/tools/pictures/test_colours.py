"""The ends of the scale of colours."""

from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures.colours import Colours, colours_of


def colours(curvatures: np.ndarray) -> Colours:
    """The colours of samples of given Gaussian curvatures."""
    samples = gm.sample("torus", normals=gm.icosphere(4), cells=(8, 8), on="spline")[
        : len(curvatures)
    ]
    return colours_of(replace(samples, gaussian_curvature=curvatures), "gaussian_curvature")


def test_few_large_curvatures_are_beyond_the_scale() -> None:
    found = colours(np.r_[np.linspace(-0.96, 0.96, 97), 9.0, 90.0, np.inf])
    assert found.clipped
    assert found.norm.vmax == -found.norm.vmin
    assert 0.91 < -found.norm.vmin < 0.95


@pytest.mark.parametrize(("largest", "clipped"), [(1.2, False), (1.3, True)])
def test_a_scale_ends_at_the_largest_curvature_if_that_is_near(largest, clipped) -> None:
    found = colours(np.r_[np.ones(99), -largest])
    assert found.clipped == clipped
    assert found.norm.vmax == (1.0 if clipped else largest)
