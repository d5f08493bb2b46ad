"""`sample_many`: the samples of several surfaces, aligned with these, also where some are bad."""

from dataclasses import replace
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused
from ...shapes import BROKEN, TORUS


def many(*arguments: Any, **named: Any) -> list[Any]:
    return list(gm.sample_many(*arguments, progress=False, **named))


@pytest.mark.parametrize("asked", [{"count": 300}, {"normals": gm.icosphere(6)}])
def test_many_is_one_after_the_other(asked: dict[str, Any]):
    surfaces = [TORUS, gm.surfaces.sphere(), gm.fit(gm.surfaces.catenoid(), (16, 16))]
    found = many((x for x in surfaces), **asked)
    for samples, surface in zip(found, surfaces, strict=True):
        alone = gm.sample(surface, **asked)
        assert found[samples.report.index] is samples
        assert replace(samples.report, index=None) == alone.report
        np.testing.assert_array_equal(samples.points, alone.points)


def test_a_bad_surface_does_not_stop_the_others():
    surfaces = [gm.surfaces.sphere(), BROKEN, gm.surfaces.torus(), 3.0, gm.surfaces.catenoid()]
    with pytest.warns(gm.GaussmapWarning) as caught:
        found = many(surfaces, count=100, cells=(16, 16), on_error="skip")
    assert [samples.report.surface for samples in found] == ["sphere", "torus", "catenoid"]
    assert [samples.report.index for samples in found] == [0, 2, 4]
    messages = [str(warning.message) for warning in caught]
    assert len(messages) == 2
    assert messages[0].startswith("surface 1 (broken) is left out: the callable of surface")
    assert "RuntimeError: no such surface" in messages[0]
    assert messages[1].startswith(
        "surface 3 (float) is left out: a Surface or its name is needed, not float; "
    )


def test_an_error_takes_the_place_of_a_bad_surface():
    surfaces = [BROKEN, TORUS, 3.0]
    error, samples, other = many(surfaces, normals=[[1, 1, 1]], cells=(6, 6), on_error="return")
    assert isinstance(other, gm.errors.InputError)
    assert isinstance(error, gm.errors.SurfaceError)
    assert "no such surface" in str(error)
    assert error.__notes__ == ["This is surface 0 (broken) of sample_many."]
    assert samples.report.index == 1


def test_an_error_is_raised_with_the_number_of_the_surface():
    stream = gm.sample_many([TORUS, BROKEN], normals=[[1, 1, 1]], cells=(6, 6), progress=False)
    assert next(stream).report.index == 0
    with pytest.raises(gm.errors.SurfaceError, match="no such surface") as caught:
        next(stream)
    assert caught.value.__notes__ == ["This is surface 1 (broken) of sample_many."]
    error = gm.errors.UnknownNameError
    refused("on_error", many, [TORUS], count=10, on_error="ignore", error=error)


def test_other_errors_go_through():
    def surfaces():
        yield TORUS
        raise RuntimeError("the end of the file")

    stream = gm.sample_many(surfaces(), normals=[[1, 1, 1]], cells=(5, 5), progress=False)
    assert len(next(stream)) > 0
    refused("the end of the file", next, stream, error=RuntimeError)


@pytest.mark.parametrize("surfaces", [TORUS, None, "torus", 5])
def test_what_is_not_several_surfaces(surfaces):
    refused("sample_many takes an iterable of surfaces, not ", many, surfaces, count=10)


def test_many_of_nothing():
    assert many([], count=10) == []
    wrong: list[dict[str, Any]] = [{"count": 0}, {"normals": []}, {"count": 5, "threads": 0}]
    for asked in wrong:
        refused("", many, [], **asked)
