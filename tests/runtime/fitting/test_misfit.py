"""The misfit of a spline beside independent measurements, on smooth and hard surfaces."""

import gaussmap as gm
import numpy as np
import pytest

from ...products import covering
from ...shapes import Array, egg_surface, unit
from .test_fitting import fillet as profile
from .test_fitting import graph

GENERATOR = np.random.default_rng(3)


def torus(scale: float = 1.0, shift: float = 0.0, calls: list[int] | None = None) -> gm.Surface:
    exact = gm.surfaces.torus()

    def f(u: Array, v: Array) -> Array:
        if calls is not None:
            calls.append(u.size)
        return scale * np.asarray(exact.function(u, v)) + shift

    return gm.Surface.from_callable(f, exact.domain, (True, True), name="torus")


def angles(first: Array, second: Array) -> Array:
    """Return angles in degrees between unit vectors."""
    return np.degrees(2.0 * np.arcsin(np.linalg.norm(first - second, axis=-1) / 2.0))


def fillet(along: int) -> gm.Surface:
    """Return two planes at 60° with a fillet over 1 % of the domain between them."""
    return graph(profile if along == 0 else lambda u, v: profile(v, u), name="fillet")


@pytest.mark.parametrize("cells", [(16, 16), (64, 64), (150, 37)])
def test_misfit_is_what_many_random_places_show(cells) -> None:
    spline = gm.fit("torus", cells)
    u, v = GENERATOR.random((2, 50_000)) * 2.0 * np.pi
    distances = np.linalg.norm(spline.evaluate(u, v) - gm.surfaces.torus().evaluate(u, v), axis=1)
    largest = angles(spline.normals(u, v), gm.surfaces.torus().normals(u, v)).max()
    misfit = spline.misfit
    assert misfit.distance == pytest.approx(distances.max(), rel=0.05)
    assert misfit.rms == pytest.approx(np.sqrt((distances**2).mean()), rel=0.05)
    assert misfit.angle == pytest.approx(largest, rel=0.12)


@covering(along=[0, 1], cells=[(8, 8), (64, 64), (50, 43)])
def test_fillet_of_one_percent_is_seen(along: int, cells) -> None:
    spline = gm.fit(fillet(along), cells)
    places = np.linspace(0.0, 1.0, 20_001), np.full(20_001, 0.37)
    u, v = places if along == 0 else places[::-1]
    exact = fillet(along).evaluate(u, v)
    distances = np.linalg.norm(spline.evaluate(u, v) - exact, axis=1)
    assert spline.misfit.distance > 0.8 * distances.max() > 2e-4
    assert spline.misfit.angle > 10.0


def test_normals_next_to_poles_count_and_those_at_poles_do_not() -> None:
    assert gm.fit("sphere", (64, 64)).misfit.angle < 0.04
    spline = gm.fit(egg_surface(), (32, 32))
    u, v = np.meshgrid(np.linspace(0.0, 6.0, 100), np.pi / 2 - np.linspace(1e-3, 0.2, 50))
    h = 1e-6
    x_u, x_v = [
        egg_surface().evaluate(u + du, v + dv) - egg_surface().evaluate(u - du, v - dv)
        for du, dv in ((h, 0.0), (0.0, h))
    ]
    largest = angles(spline.normals(u, v), unit(np.cross(x_u, x_v))).max()
    assert spline.misfit.angle > 0.5 * largest > 0.3


@pytest.mark.parametrize(
    ("scale", "shift"),
    [*((x, 0.0) for x in (1e-300, 1e-9, 1e9, 1e300)), *((1.0, x) for x in (1e3, 1e6))],
)
def test_misfit_scales_and_is_that_far_from_the_origin(scale: float, shift: float) -> None:
    unit = gm.fit(torus(), (16, 16)).misfit
    moved = gm.fit(torus(scale, shift), (16, 16)).misfit
    assert moved.distance / scale == pytest.approx(unit.distance, rel=1e-9, abs=8e-16 * shift)
    # With a shift, the error of normals is 1e-4 rad.
    assert moved.angle == pytest.approx(unit.angle, abs=0.01 if shift else 1e-6)
    if not shift:
        assert moved.rms / scale == pytest.approx(unit.rms, rel=1e-9)


def test_angles_are_measured_as_long_as_coordinates_tell_normals() -> None:
    """Normals of differences are known up to 1e-4 radians where the shift is 1e8, not beyond."""
    unit = gm.fit(torus(), (16, 16)).misfit
    known, unknown = (gm.fit(torus(1.0, x), (16, 16)).misfit.angle for x in (1e8, 2e8))
    assert known == pytest.approx(unit.angle, rel=0.2)
    assert unknown is None


def test_surface_without_normals_has_no_angle() -> None:
    line = gm.Surface.from_callable(
        lambda u, v: np.stack([u, u, u + 0 * v], axis=-1), ((0, 1), (0, 1)), name="line"
    )
    assert gm.fit(line, (8, 8)).misfit.angle is None


def test_surface_is_evaluated_in_proportion_to_the_fit() -> None:
    for cells, most in (((8, 8), 8_000), ((64, 64), 18_000), ((300, 300), 18_000)):
        calls: list[int] = []
        gm.fit(torus(calls=calls), cells)
        of_fit = 2 * cells[0] * cells[1] + 3 * sum(cells) + 1
        assert sum(calls) - of_fit < min(most, 2.2 * of_fit + 8_000)


def test_misfit_is_reported_and_kept_in_files(tmp_path) -> None:
    spline = gm.fit("torus", (16, 16))
    samples = gm.sample(spline, 50)
    report = samples.report
    reported = report.fit_distance, report.fit_rms, report.fit_angle
    assert reported == (spline.misfit.distance, spline.misfit.rms, spline.misfit.angle)
    samples.write(tmp_path / "torus.ply")
    assert gm.read_samples(tmp_path / "torus.ply").report == report
    assert samples.offset(0.1).report.fit_distance is None


# --- data -----------------------------------------------------------------------------------------


def waves(m: int, n: int) -> Array:
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, m))
    return 0.3 * np.sin(5 * x) * np.cos(4 * y) + 0.01 * np.sin(40 * x)


@pytest.mark.parametrize("cells", [None, (10, 12)])
def test_misfit_to_elevations_is_that_at_all_of_them(cells) -> None:
    heights = waves(40, 30)
    spline = gm.fit(gm.Surface.from_grid(heights, spacing=(0.1, 0.2)), cells)
    x, y = np.meshgrid(0.1 * np.arange(30), 0.2 * np.arange(40))
    data = np.stack([x, y, heights], axis=-1)
    distances = np.linalg.norm(spline.evaluate(x, y) - data, axis=-1)
    assert spline.misfit.distance == pytest.approx(distances.max(), rel=1e-9)
    assert spline.misfit.rms == pytest.approx(np.sqrt((distances**2).mean()), rel=1e-9)
    assert spline.misfit.angle is None


# --- a part of the domain -------------------------------------------------------------------------


def test_what_is_trimmed_does_not_count() -> None:
    whole = fillet(0)
    part = whole.trimmed(within=lambda u, v: np.abs(u - 0.437) > 0.05)
    assert gm.fit(whole, (64, 64)).misfit.angle > 10.0
    misfit = gm.fit(part, (64, 64)).misfit
    assert misfit.distance < 1e-15
    assert misfit.angle < 1e-6
    assert gm.fit(part).cells == (64, 64)


def test_tiny_part() -> None:
    part = fillet(0).trimmed(within=lambda u, v: np.hypot(u - 0.437, v - 0.3) < 1e-4)
    assert gm.fit(part, (16, 16)).misfit.distance > 0.0
