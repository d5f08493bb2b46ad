"""The cells that a tolerance, or the default, chooses: along u and v apart, and verified."""

import warnings
from collections.abc import Callable
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from numpy.typing import NDArray

from ...products import covering
from ...refusals import refused
from ...shapes import SQUARE, TURN, egg_surface, unit

Array = NDArray[Any]


def graph(z: Callable[[Array, Array], Array], scale: float = 1.0, name="graph") -> gm.Surface:
    return gm.Surface.from_callable(
        lambda u, v: scale * np.stack([u, v, z(u, v)], axis=-1), SQUARE, name=name
    )


def fillet(u: Any, v: Any) -> Any:
    """Two planes at 60° with a circular fillet over 1 % of the domain between them."""
    t, width = u - 0.437, 0.01
    inside = np.clip(t + width / 2, 0.0, width)
    return np.tan(np.radians(60.0)) * (inside**2 / (2 * width) + np.maximum(t - width / 2, 0.0))


def bump(u: Array, v: Array) -> Array:
    return 0.02 * np.exp(-(((u - 0.437) / 0.02) ** 2) - ((v - 0.713) / 0.02) ** 2)


def largest_distance(surface: gm.Surface, spline: gm.Spline) -> float:
    """Return the largest of a hundred thousand random places."""
    u, v = np.random.default_rng(2).random((2, 100_000))
    return float(np.linalg.norm(surface.evaluate(u, v) - spline.evaluate(u, v), axis=1).max())


# --- tolerances -----------------------------------------------------------------------------------


@covering(tolerance=[1e-2, 1e-4, 1e-6], z=[fillet, bump, lambda u, v: fillet(v, u)])
def test_tolerance_holds_everywhere(tolerance: float, z) -> None:
    surface = graph(z)
    spline = gm.fit(surface, tolerance=tolerance)
    assert spline.misfit.distance <= tolerance
    assert largest_distance(surface, spline) <= 1.1 * tolerance


@pytest.mark.parametrize(("ratio", "cells"), [(3.0, (16, 16)), (6.0, (16, 8))])
def test_cells_are_halved_along_both_unless_one_error_is_much_larger(
    ratio: float, cells: tuple[int, int]
) -> None:
    surface = graph(lambda u, v: 0.05 * (ratio * np.sin(5 * u) + np.sin(5 * v)))
    assert gm.fit(surface, tolerance=5e-4).cells == cells


def test_cells_are_chosen_along_u_and_v_apart() -> None:
    m, n = gm.fit(graph(fillet), tolerance=1e-5).cells
    assert m >= 32 * n
    m, n = gm.fit(graph(lambda u, v: fillet(v, u)), tolerance=1e-5).cells
    assert n >= 32 * m
    assert gm.fit("cylinder", tolerance=1e-4).cells == (32, 8)


def test_fewer_cells_are_enough_for_a_larger_tolerance() -> None:
    cells = [gm.fit("torus", tolerance=x).cells[0] for x in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)]
    assert cells == sorted(cells)
    assert cells[0] <= 16  # order 3: an eighth for twice the cells
    assert cells[-1] == 256


def test_normal_tolerance() -> None:
    spline = gm.fit(graph(bump), normal_tolerance=0.5)
    assert spline.misfit.angle <= 0.5
    assert gm.fit("torus", normal_tolerance=20.0).misfit.distance < 1e-4 * 3.9  # the diagonal
    both = gm.fit(graph(bump), tolerance=1e-2, normal_tolerance=0.5)
    assert both.misfit.angle <= 0.5
    assert both.misfit.distance <= 1e-2


def test_what_a_coarse_spline_does_not_see_is_found() -> None:
    groove = graph(lambda u, v: -0.02 * np.exp(-(((u - 0.4371) / 0.003) ** 2)) + 0 * v)
    spline = gm.fit(groove, tolerance=1e-4)
    assert largest_distance(groove, spline) < 1.1e-4
    assert spline.cells[1] == 8


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"tolerance": 1e-17}, "a tolerance of 1e-17 is below the rounding of coordinates as "),
        ({"relative_tolerance": 1e-16}, "is below the rounding"),
        ({"tolerance": 0.0}, "tolerance must be a positive number, not 0.0"),
        ({"tolerance": np.nan}, "tolerance must be a positive number, not nan"),
        ({"tolerance": "fine"}, "tolerance must be a positive number, not 'fine'"),
        ({"relative_tolerance": 2.0}, "relative_tolerance must be a positive number of at most 1"),
        ({"normal_tolerance": 1e-9}, "normal_tolerance must be at least 0.0001 degrees"),
        ({"normal_tolerance": 91}, "normal_tolerance must be a positive number of at most 90"),
        ({"tolerance": 1e-3, "relative_tolerance": 1e-3}, "do not go together"),
        ({"tolerance": 1e-3, "cells": (8, 8)}, "do not go together"),
    ],
)
def test_unusable_tolerances(arguments, said: str) -> None:
    refused(said, gm.fit, "torus", **arguments)


def test_what_cannot_be_reached_is_said() -> None:
    step = graph(lambda u, v: (u > 0.4371) * 0.1, name="step")
    with pytest.warns(
        gm.GaussmapWarning, match="'step': the tolerance is not reached; .* within 0.0"
    ):
        spline = gm.fit(step, tolerance=1e-3)
    assert spline.cells[0] <= 4096
    assert spline.patches <= 2**22


# --- the default ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["torus", "sphere", "enneper", "cone", "plane", "helicoid"])
def test_default_of_smooth_surfaces_is_64_by_64(name: str) -> None:
    spline, fixed = gm.fit(name), gm.fit(name, (64, 64))
    assert spline.cells == (64, 64)
    assert np.array_equal(spline.coefficients, fixed.coefficients)


def test_default_sees_small_features() -> None:
    for z, least in ((fillet, (512, 64)), (bump, (256, 256))):
        spline = gm.fit(graph(z))
        assert spline.cells >= least
        assert spline.misfit.distance < 1e-4


def test_a_cusp_is_fitted_while_that_makes_the_error_smaller() -> None:
    """Half the cells leave 2^-0.3 = 0.81 of the error along u; steps along v less."""
    cusp = graph(lambda u, v: 0.2 * np.abs(u - 0.123) ** 0.3 + 0.01 * np.sin(90 * v))
    with pytest.warns(gm.GaussmapWarning, match="accuracy of the default is not reached"):
        assert gm.fit(cusp).misfit.distance < 0.03


def test_default_wastes_no_cells_on_folds_and_poles() -> None:
    assert gm.fit(egg_surface()).cells == (64, 64)
    roof = gm.fit(graph(lambda u, v: 1e-3 * np.abs(u - 0.4371)))  # flat, with normals 0.1° apart
    assert roof.cells == (64, 64)


def test_default_is_bounded_and_says_when_it_is_far_off() -> None:
    noise = graph(lambda u, v: 0.05 * np.sin(1e5 * np.sin(1e3 * u + 777 * v)), name="noise")
    with pytest.warns(
        gm.GaussmapWarning, match="'noise': the accuracy of the default is not reach"
    ):
        assert gm.fit(noise).cells == (64, 64)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        crease = gm.fit(graph(lambda u, v: np.abs(u - 0.4371)))  # no warning: it is near enough
    assert crease.cells[0] * crease.cells[1] <= 2**16
    assert crease.misfit.distance < 1e-3


# --- data -----------------------------------------------------------------------------------------


def data(m: int = 90, n: int = 70) -> gm.Surface:
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, m))
    heights = 0.3 * np.sin(5 * x) * np.cos(4 * y) + 0.01 * np.sin(40 * x)
    return gm.Surface.from_grid(heights, spacing=(1 / (n - 1), 1 / (m - 1)))


def test_tolerance_for_data() -> None:
    surface = data()
    spline = gm.fit(surface, tolerance=1e-3)
    assert spline.misfit.distance <= 1e-3
    assert spline.patches < gm.fit(surface).patches
    places = surface.grid[..., 0], surface.grid[..., 1]
    distances = np.linalg.norm(spline.evaluate(*places) - surface.grid, axis=-1)
    assert distances.max() <= 1e-3


def test_data_that_are_rougher_than_the_tolerance() -> None:
    surface = data()
    with pytest.warns(gm.GaussmapWarning, match="the tolerance is not reached"):
        spline = gm.fit(surface, tolerance=1e-9)
    assert np.array_equal(spline.coefficients, gm.fit(surface).coefficients)
    refused("data have no normals", gm.fit, surface, normal_tolerance=1.0)


# --- callables ------------------------------------------------------------------------------------


@pytest.mark.parametrize("change", [1e-6, 1.0])
def test_a_callable_that_answers_differently_the_second_time(change: float) -> None:
    calls = []

    def drifting(u: Array, v: Array) -> Array:
        calls.append(change)
        return np.stack([u, v, u * v + len(calls) * change], axis=-1)

    surface = gm.Surface.from_callable(drifting, ((0, 1), (0, 1)))
    refused("must return the same points each time", gm.fit, surface, error=gm.errors.SurfaceError)


def power(x: Array, exponent: float) -> Array:
    return np.sign(x) * np.abs(x) ** exponent


@pytest.mark.parametrize("axis", [0, 1])
def test_ends_that_differ_by_amplified_rounding(axis: int) -> None:
    """sin(2π) is −2e-16, and its root is not small."""

    def rounded(u: Array, v: Array) -> Array:
        angle, height = (u, v) if axis == 0 else (v, u)
        return np.stack([power(np.cos(angle), 0.2), power(np.sin(angle), 0.2), height], axis=-1)

    def reduced(u: Array, v: Array) -> Array:
        return rounded(*(np.where(x == TURN[1], TURN[0], x) for x in (u, v)))

    domain, periodic = (TURN, (7.0, 8.0)), (True, False)
    if axis == 1:
        domain, periodic = domain[::-1], periodic[::-1]
    surface = gm.Surface.from_callable(rounded, domain, periodic)
    text = "as much as its rounding changes the points there: compute them at " + "uv"[axis]
    refused(text, gm.fit, surface, (8, 8), error=gm.errors.SurfaceError)
    gm.fit(gm.Surface.from_callable(reduced, domain, periodic), (8, 8))


# --- the misfit of a spline -----------------------------------------------------------------------

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


def fillet_surface(along: int) -> gm.Surface:
    """Return two planes at 60° with a fillet over 1 % of the domain between them."""
    return graph(fillet if along == 0 else lambda u, v: fillet(v, u), name="fillet")


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
    spline = gm.fit(fillet_surface(along), cells)
    places = np.linspace(0.0, 1.0, 20_001), np.full(20_001, 0.37)
    u, v = places if along == 0 else places[::-1]
    exact = fillet_surface(along).evaluate(u, v)
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
    whole = fillet_surface(0)
    part = whole.trimmed(within=lambda u, v: np.abs(u - 0.437) > 0.05)
    assert gm.fit(whole, (64, 64)).misfit.angle > 10.0
    misfit = gm.fit(part, (64, 64)).misfit
    assert misfit.distance < 1e-15
    assert misfit.angle < 1e-6
    assert gm.fit(part).cells == (64, 64)


def test_tiny_part() -> None:
    part = fillet_surface(0).trimmed(within=lambda u, v: np.hypot(u - 0.437, v - 0.3) < 1e-4)
    assert gm.fit(part, (16, 16)).misfit.distance > 0.0
