"""What a sampling can be asked for, and what is said of what makes no sense."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest

PLANE = gm.fit(gm.surfaces.plane(), (3, 3))
BAD_NUMBERS = [0, 0.0, -1.0, np.nan, np.inf, "3", True, [1.0], None, 1j, np.array([1.0, 2.0])]


def refused(match: str, error: type[Exception] = gm.errors.InputError, **asked: Any) -> None:
    with pytest.raises(error, match=match):
        gm.sample(PLANE, **asked)
    with pytest.raises(error, match=match):
        next(gm.sample_many([PLANE], progress=False, **asked))


@pytest.mark.parametrize("value", BAD_NUMBERS[:-3])
def test_lengths_and_angles_that_are_none(value):
    refused("coverage must be a positive number, not", coverage=value)
    refused("angle must be a positive number of at most 90 degrees, not", angle=value)
    refused("coverage must be a positive number", count=5, coverage=value)
    refused("at most 90 degrees, not 90.1", angle=90.1)


@pytest.mark.parametrize("value", [0, -0.5, np.nan, np.inf, True, [1.0], 9.0])
def test_powers_that_are_none(value):
    refused("density, as the power of .K., must be a positive number", count=5, density=value)


def test_densities_that_are_unknown():
    unknown = "no density 'gaus'.* did you mean gauss"
    refused(unknown, gm.errors.UnknownNameError, count=5, density="gaus")


@pytest.mark.parametrize(
    ("asked", "use"),
    [
        ({"density": "gauss", "coverage": 0.1}, "normals or count"),
        ({"density": "gauss", "angle": 4.0}, "normals or count"),
        ({"density": "gauss", "count": 9, "coverage": 0.1}, "normals or count"),
        ({"density": "uniform", "angle": 5.0}, "count or coverage"),
        ({"density": "uniform", "count": 5, "coverage": 1.0}, "count or coverage"),
        ({"density": "uniform", "normals": [[0, 0, 1]]}, "count or coverage"),
        ({"density": "aligned", "normals": [[0, 0, 1]]}, "count or angle or coverage"),
        ({"density": 0.5, "coverage": 0.1}, "count"),
        ({"density": 0.5, "normals": [[0, 0, 1]]}, "count"),
    ],
)
def test_what_a_density_cannot_be_asked_for(asked: dict[str, Any], use: str):
    refused(rf"does not go with .*; use {use}\.", **asked)


@pytest.mark.compiled
def test_defaults():
    """Normals alone give the paper's density, all else is balanced."""
    torus = gm.fit(gm.surfaces.torus(), (8, 8))
    assert set(gm.sample(torus, normals=gm.icosphere(4)).kind) == {"normal"}
    amounts: list[dict[str, Any]] = [{"count": 100}, {"angle": 20.0}, {"coverage": 0.4}]
    for asked in amounts:
        assert set(gm.sample(torus, **asked).kind) == {"normal", "filling"}
