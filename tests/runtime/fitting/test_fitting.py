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
from ...shapes import SQUARE, TURN, egg_surface

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
