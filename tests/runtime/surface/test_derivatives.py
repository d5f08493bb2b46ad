"""Derivatives of surfaces: generated, symbolic, given and numerical ones are the same."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.surface.derivatives import NAMES

from ...refusals import refused
from ...shapes import SQUARE, saddle


def places(domain, count=40, seed=0):
    """Return random places, among them places next to each end and on it."""
    result = []
    for (low, high), turn in zip(domain, (0, 3), strict=True):
        t = np.random.default_rng(seed + turn).random(count)
        t[turn : turn + 6] = [0.0, 1.0, 1e-9, 1.0 - 1e-3, 0.006, 0.994]
        result.append(low + (high - low) * t)
    return result


def relative_errors(found, expected):
    """Return the largest difference of each derivative, relative to the largest of all."""
    return np.abs(found - expected).max(axis=(0, 2)) / np.abs(expected).max()


def test_derivatives_of_numbers_and_arrays():
    surface = gm.surfaces.torus()
    u, v = places(surface.domain)
    found = surface.derivatives(u, v)
    assert found.shape == (len(u), 6, 3)
    assert np.array_equal(found, surface.jets(u, v))
    assert surface.derivatives(u[:, None], v[:7]).shape == (len(u), 7, 6, 3)
    assert surface.derivatives(0.5, 0.25).shape == (6, 3)


@pytest.mark.parametrize(
    "name", ["torus", "sphere", "wavy_graph", "enneper", "moebius_band", "dupin_cyclide"]
)
def test_numerical_derivatives(name):
    """Open, periodic and mirrored ends, and poles; the function is never called outside."""
    surface = gm.surfaces.surface(name)
    (u0, u1), (v0, v1) = surface.domain

    def inside(u, v):
        assert u.min() >= u0
        assert u.max() <= u1
        assert v.min() >= v0
        assert v.max() <= v1
        return surface.evaluate(u, v)

    u, v = places(surface.domain)
    found = gm.Surface(name, inside, surface.domain, surface.boundary).derivatives(u, v)
    errors = relative_errors(found, surface.jets(u, v))
    assert errors[0] < 1e-15
    assert errors[1:3].max() < 2e-12
    assert errors[3:].max() < 1e-9


@pytest.mark.parametrize("waves", [3, 10, 100])
def test_steps_become_smaller_where_the_surface_varies_fast(waves):
    k = 2 * np.pi * waves
    surface = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, np.sin(k * u) * np.cos(k * v)], axis=-1), SQUARE
    )
    u, v = places(SQUARE, 100)
    z = f"sin(2*pi*{waves}*u) * cos(2*pi*{waves}*v)"
    exact = gm.Surface.from_sympy(("u", "v", z), "uv", SQUARE)
    found, expected = surface.jets(u, v)[..., 2], exact.jets(u, v)[..., 2]
    errors = np.abs(found - expected).max(axis=0) / np.abs(expected).max(axis=0)
    assert errors[1:3].max() < 1e-9
    assert errors[3:].max() < 1e-6


def test_derivatives_beside_a_fillet_and_beside_a_hole():
    def filleted(u, v):
        """Return a roof whose ridge is rounded over 1 % of the domain; no roof in a corner."""
        t = np.clip(100 * (u - 0.5), 0.0, 1.0)
        z = 0.01 * (t * t / 2 + np.maximum(100 * (u - 0.51), 0.0))
        return np.stack([u, v, np.where((u > 0.9) & (v > 0.9), np.nan, z)], axis=-1)

    surface = gm.Surface.from_callable(filleted, SQUARE)
    u, v = np.linspace(0.0, 1.0, 1001), np.full(1001, 0.3)
    z_u = surface.jets(u, v)[:, 1, 2]
    inside = np.abs(u - 0.5) * np.abs(u - 0.51) > 1e-8  # and not where the curvature jumps
    np.testing.assert_allclose(z_u[inside], np.clip(100 * (u - 0.5), 0, 1)[inside], atol=1e-9)
    u, v = np.full(100, 0.8999), np.linspace(0.9, 1.0, 100)
    assert np.isfinite(surface.jets(u, v)).all()
    assert np.isnan(surface.jets(u + 0.0002, 0.1 + 0.9 * v)).any()


@pytest.mark.parametrize(
    ("z", "z_u", "z_uu"),
    [
        ("Abs(u - 1/3)*v", lambda u, v: np.sign(u - 1 / 3) * v, 0.0),
        ("sign(u - 1/3)*u", lambda u, v: np.sign(u - 1 / 3), 0.0),
        ("Max(u, v, 1/3)", lambda u, v: u > np.maximum(v, 1 / 3), 0.0),
        ("Piecewise((u**2, u > v), (v, True))", lambda u, v: 2 * u * (u > v), None),
        ("floor(3*u)*u", lambda u, v: np.floor(3 * u), 0.0),
        ("(3*u) % 1", lambda u, v: 3.0, 0.0),
        ("Heaviside(u - 1/3)*u", lambda u, v: u > 1 / 3, 0.0),
        ("2", lambda u, v: 0.0, 0.0),
        ("Sum(u**k, (k, 0, 2))", lambda u, v: 1 + 2 * u, 2.0),
        ("sinc(u)", lambda u, v: np.cos(u) / u - np.sin(u) / u**2, None),
    ],
)
def test_symbolic_derivatives_with_kinks_and_jumps(z, z_u, z_uu):
    u, v = np.random.default_rng(0).random((2, 50))
    surface = gm.Surface.from_sympy(("u", "1", z), "uv", SQUARE)
    jets = surface.derivatives(u, v)
    np.testing.assert_allclose(jets[:, 1, 2], z_u(u, v) + 0 * u, rtol=1e-12, atol=1e-12)
    assert (jets[:, :2, 1] == [1.0, 0.0]).all()
    if z_uu is not None:
        np.testing.assert_allclose(jets[:, 3, 2], z_uu, rtol=0, atol=1e-14)


def test_symbolic_derivatives_are_filled_by_numerical_ones():
    surface = gm.Surface.from_sympy(("u", "v", "sinc(u)"), "uv", ((-1, 1), (-1, 1)))
    np.testing.assert_allclose(
        surface.derivatives(0.0, 0.5)[:, 2], [1, 0, 0, -1 / 3, 0, 0], rtol=0, atol=1e-10
    )


def saddle_derivatives(u, v):
    zero, one = np.zeros_like(u), np.ones_like(u)
    rows = [
        (u, v, u * v + u * u), (one, zero, v + 2 * u), (zero, one, u), (zero, zero, 2 * one),
        (zero, zero, one), (zero, zero, zero),
    ]  # fmt: skip
    return np.stack([np.stack(x, axis=-1) for x in rows], axis=-2)


def test_given_derivatives():
    given = gm.Surface.from_callable(saddle, SQUARE, derivatives=saddle_derivatives)
    u, v = places(SQUARE)
    assert np.array_equal(given.derivatives(u, v), saddle_derivatives(u, v))
    errors = relative_errors(
        gm.Surface.from_callable(saddle, SQUARE).derivatives(u, v), saddle_derivatives(u, v)
    )
    assert errors.max() < 2e-9


def wrong(row, factor=1.0, more=0.0):
    """Return derivatives of which one is wrong."""

    def derivatives(u, v):
        jets = saddle_derivatives(u, v)
        jets[..., row, :] = factor * jets[..., row, :] + more
        return jets

    return derivatives


@pytest.mark.parametrize(
    ("derivatives", "complaint"),
    [
        *((wrong(i, 1.001), f"contradict it: {NAMES[i]} at u = ") for i in range(5)),
        *((wrong(i, more=0.01), f"contradict it: {NAMES[i]} at u = ") for i in range(6)),
        (wrong(4, np.nan), "contradict it: x_uv at u = .* given as .nan nan nan., and differences"),
        (wrong(5, more=np.inf), "contradict it: x_vv"),
        (saddle, r"returned the shape \(48, 3\) .* must return \(48, 6, 3\)"),
        (lambda u, v: None, "array of real numbers"),
        (lambda u, v: 1 / 0, "derivatives of surface 'mine' raised ZeroDivisionError"),
    ],
)
def test_given_derivatives_that_are_wrong(derivatives, complaint):
    surface = gm.Surface.from_callable(saddle, SQUARE, derivatives=derivatives, name="mine")
    assert surface.evaluate(0.5, 0.5).shape == (3,)
    for call in (lambda: surface.derivatives(0.5, 0.5), lambda: surface.jets(*places(SQUARE))):
        refused(complaint, call, error=gm.errors.SurfaceError)


def test_derivatives_that_do_not_exist():
    surface = gm.Surface.from_callable(
        lambda u, v: saddle(np.where(u < 0.5, u, np.nan), v), SQUARE, name="half"
    )
    assert np.isfinite(surface.derivatives(0.4, 0.5)).all()
    with pytest.raises(
        gm.errors.SurfaceError, match=r"x of surface 'half' is not finite at u = 0[.]6"
    ):
        surface.derivatives([0.4, 0.6], 0.5)
    assert np.isnan(surface.jets(np.array([0.6]), np.array([0.5]))).any()
    with pytest.raises(gm.errors.InputError, match="derivatives of a surface must be callable"):
        gm.Surface.from_callable(saddle, SQUARE, derivatives=saddle(0.0, 0.0))  # pyright: ignore
    grid = gm.Surface.from_grid(saddle(*np.indices((5, 6)) * 1.0))
    refused("was given by points and has no derivatives", grid.derivatives, 0.0, 0.0)
    refused("u must be an array of real numbers", gm.surfaces.torus().derivatives, "a", 0.0)
