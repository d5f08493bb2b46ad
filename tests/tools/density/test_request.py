"""What a sampling can be asked for, and what is said of what makes no sense."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused

PLANE = gm.fit(gm.surfaces.plane(), (3, 3))
BAD_NUMBERS = [0, 0.0, -1.0, np.nan, np.inf, "3", True, [1.0]]


def is_refused(match: str, error: type[Exception] = gm.errors.InputError, **asked: Any) -> None:
    def many() -> object:
        return next(gm.sample_many([PLANE], progress=False, **asked))

    refused(match, gm.sample, PLANE, **asked, error=error)
    refused(match, many, error=error)


def use(what: str) -> str:
    return rf"does not go with .*; use {what}\."


COVERAGE, COUNT = use("count or coverage"), use("count")
ANGLE = "angle must be a positive number of at most 90 degrees, not"
POWER = "density, as the power of .K., must be a positive number"
NO_POWERS = [0, -0.5, np.nan, np.inf, True, [1.0], 9.0]


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        *(({"coverage": x}, "coverage must be a positive number, not") for x in BAD_NUMBERS),
        *(({"count": 5, "coverage": x}, "coverage must be a positive") for x in BAD_NUMBERS),
        *(({"angle": x}, ANGLE) for x in BAD_NUMBERS),
        ({"angle": 90.1}, f"{ANGLE} 90.1"),
        *(({"count": 5, "density": x}, POWER) for x in NO_POWERS),
        ({"density": "gauss", "coverage": 0.1}, use("normals or count")),
        ({"density": "gauss", "angle": 4.0}, use("normals or count")),
        ({"density": "gauss", "count": 9, "coverage": 0.1}, use("normals or count")),
        ({"density": "uniform", "angle": 5.0}, COVERAGE),
        ({"density": "uniform", "count": 5, "coverage": 1.0}, COVERAGE),
        ({"density": "uniform", "normals": [[0, 0, 1]]}, COVERAGE),
        ({"density": "aligned", "normals": [[0, 0, 1]]}, use("count or angle or coverage")),
        ({"density": 0.5, "coverage": 0.1}, COUNT),
        ({"density": 0.5, "normals": [[0, 0, 1]]}, COUNT),
    ],
)
def test_what_cannot_be_asked_for(asked: dict[str, Any], said: str):
    is_refused(said, **asked)


def test_densities_that_are_unknown():
    unknown = "no density 'gaus'.* did you mean gauss"
    is_refused(unknown, gm.errors.UnknownNameError, count=5, density="gaus")


@pytest.mark.compiled
def test_defaults():
    """Normals alone give the paper's density, all else is balanced."""
    torus = gm.fit(gm.surfaces.torus(), (8, 8))
    assert set(gm.sample(torus, normals=gm.icosphere(4)).kind) == {"normal"}
    amounts: list[dict[str, Any]] = [{"count": 100}, {"angle": 20.0}, {"coverage": 0.4}]
    for asked in amounts:
        assert set(gm.sample(torus, **asked).kind) == {"normal", "filling"}
