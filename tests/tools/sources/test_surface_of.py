"""What texts name: the same surfaces as in Python, and options that are not for them."""

from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.sources.named import Named
from gaussmap.tools.sources.surface_of import surface_of, with_tolerance

from ...refusals import refused

HEIGHTS = np.add.outer(np.arange(6.0) ** 2, np.arange(5.0))
POINTS = np.stack([*np.meshgrid(np.arange(5.0), np.arange(6.0)), HEIGHTS], axis=-1)


@pytest.fixture(autouse=True)
def _files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    np.save("heights.npy", HEIGHTS)
    np.save("cloud.npy", np.zeros((9, 3)))
    np.savez("two.npz", points=POINTS, heights=HEIGHTS, x=np.arange(5.0), y=np.arange(6.0))
    Path("mesh.stl").touch()


@pytest.mark.parametrize(
    ("known", "expected"),
    [
        ({"surface": "torus", "set": (("minor", 0.25),)}, gm.surfaces.torus(minor=0.25)),
        (
            {"surface": "heights.npy", "spacing": (1.0, 1.0)},
            gm.Surface.from_grid(HEIGHTS, spacing=(1.0, 1.0)),
        ),
        (
            {"surface": "heights.npy", "spacing": (2.0, -1.0), "nodata": 7.0},
            gm.Surface.from_grid(HEIGHTS, spacing=(2.0, -1.0), nodata=7.0),
        ),
        ({"surface": "two.npz:points"}, gm.Surface.from_grid(POINTS)),
        (
            {"surface": "two.npz:heights", "x": "x", "y": "y"},
            gm.terrain(HEIGHTS, x=np.arange(5.0), y=np.arange(6.0)),
        ),
        (
            {"formula": ("u", "v", "u*v"), "domain": ("0", "1", "0", "2*pi"), "periodic": "v"},
            gm.Surface.from_sympy(
                ("u", "v", "u*v"), ("u", "v"), ((0, 1), (0, "2*pi")), (False, True)
            ),
        ),
    ],
)
def test_surfaces(known: dict[str, Any], expected: gm.Surface) -> None:
    found = surface_of(Named(**known))
    assert isinstance(found, gm.Surface)
    assert (found.domain, found.boundary) == (expected.domain, expected.boundary)
    u, v = (np.linspace(*ends, 7)[1:-1] for ends in found.domain)
    np.testing.assert_array_equal(found.evaluate(u, v), expected.evaluate(u, v))


@pytest.mark.parametrize(
    ("known", "text"),
    [
        ({"surface": "torsu"}, "did you mean torus"),
        ({"surface": "torus", "spacing": (1, 1)}, "--spacing is for elevations"),
        ({"surface": "torus", "set": (("minor", 0.2), ("minor", 0.3))}, "same parameter twice"),
        ({"surface": "torus", "unit": "mm"}, "--unit is for CAD files, and 'torus' is none"),
        ({"surface": "torus", "crs": "EPSG:32617"}, "--crs is for elevations"),
        ({"surface": "heights.npy"}, r"add --spacing DX DY"),
        ({"surface": "heights.npy", "set": (("a", 1.0),)}, "--set is for surfaces by name"),
        ({"surface": "cloud.npy", "spacing": (1, 1)}, "in no order"),
        ({"surface": "mesh.stl"}, "is a mesh"),
        ({"surface": "missing.txt"}, "does not exist"),
        ({"surface": "missing.step", "cells": (8, 8)}, "--cells is for surfaces"),
        ({"formula": ("u", "v", "u*v")}, "add --domain"),
        ({"domain": ("0", "1", "0", "1"), "surface": "torus"}, "--domain goes with --formula only"),
        ({"surface": "torus", "cells": (8, 8), "tolerance": 0.1}, "do not go together"),
    ],
)
def test_what_names_nothing_and_options_for_something_else(
    known: dict[str, Any], text: str
) -> None:
    refused(text, lambda: surface_of(Named(**known)), error=gm.errors.GaussmapError)


def test_options_that_were_given() -> None:
    assert Named(surface="a.npy", spacing=(1.0, 2.0)).given() == {
        "surface": "a.npy",
        "spacing": (1.0, 2.0),
    }


def test_cells() -> None:
    torus = gm.surfaces.torus()
    assert with_tolerance(torus, Named(cells=(8, 9))) == (torus, (8, 9))
    found, cells = with_tolerance(torus, Named(tolerance=0.1))
    assert found is torus
    assert cells is not None
    misfit = gm.fit(torus, cells).misfit
    assert misfit is not None
    assert misfit.distance <= 0.1
    spline, cells = with_tolerance(gm.Surface.from_grid(POINTS), Named(tolerance=0.1))
    assert isinstance(spline, gm.Spline)
    assert cells is None
