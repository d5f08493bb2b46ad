"""Which surfaces have tapes, and that these compute them."""

from collections.abc import Callable
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.tape.tapes import jets_of, values_of

from .made import graph

SQUARE = ((-1.0, 1.0), (0.5, 2.0))
generator = np.random.default_rng(0)
TURN = np.array([[0.6, -0.8, 0.0, 3.0], [0.8, 0.6, 0.0, -2.0], [0.0, 0.0, 1.5, 7.0], [0, 0, 0, 1]])
MIRROR = np.diag([1.0, 1.0, -1.0])


def places(surface: gm.Surface, count: int = 70) -> tuple[np.ndarray, np.ndarray]:
    (u0, u1), (v0, v1) = surface.domain
    return generator.uniform(u0, u1, count), generator.uniform(v0, v1, count)


def assert_is_computed(surface: gm.Surface, tolerance: float = 1e-12) -> None:
    """Assert that the tape has the derivatives of the surface, relative to their sizes."""
    assert surface.tape is not None
    u, v = places(surface)
    jets, own = jets_of(surface.tape, u, v), surface.jets(u, v)
    sizes = np.abs(own).max(axis=(0, 2)) + 1.0
    assert (np.abs(jets - own).max(axis=(0, 2)) <= tolerance * sizes).all()
    points, errors = values_of(surface.tape, u, v)
    assert (points == jets[:, 0]).all()
    assert (np.abs(points - surface.evaluate(u, v)) <= 16.0 * errors).all()


# --- surfaces of the library ----------------------------------------------------------------------


@pytest.mark.parametrize("name", gm.surfaces.names())
def test_the_catalogue_has_tapes(name):
    assert_is_computed(gm.surfaces.surface(name), 1e-14)


@pytest.mark.parametrize("moved", [
    gm.surfaces.torus().transformed(TURN),
    gm.surfaces.torus().flipped(),
    gm.surfaces.helicoid().transformed(MIRROR),
    gm.surfaces.helicoid().transformed(MIRROR).transformed(TURN).flipped(),
    gm.surfaces.torus().trimmed(within=lambda u, _: u > 1.0),
])  # fmt: skip
def test_moved_and_trimmed_surfaces_have_tapes(moved):
    assert_is_computed(moved)


def test_surfaces_of_points_have_none():
    assert gm.Surface.from_grid(generator.random((5, 6)), spacing=(1.0, 1.0)).tape is None


# --- expressions ----------------------------------------------------------------------------------


@pytest.mark.compiled  # 1/0 is inf in kernels, and an exception of Python without compilation
def test_expressions_have_tapes():
    position = (
        "u**1.5 + 2**u",
        "v**-2.5 + acos(u/9)",
        "u**7 + tan(v/9) + u**0.3*v**(u/3) + atan(u*v) + erf(u - v)*sinc(u - v)"
        " + sinc(u*v)*Abs(u - 4)*sign(v)",
    )
    assert_is_computed(gm.Surface.from_sympy(position, ("u", "v"), ((1, 2), (1, 3))), 1e-11)


@pytest.mark.parametrize("text", ["Max(u, v)", "Piecewise((u, u < v), (v, True))"])
def test_expressions_with_kinks_have_none_and_keep_their_derivatives(text):
    surface = gm.Surface.from_sympy(("u", "v", text), ("u", "v"), SQUARE)
    assert surface.tape is None
    assert np.isfinite(surface.jets(*places(surface))).all()
    assert surface.differences is None


def test_a_first_expression_is_not_differentiated(monkeypatch):
    import sympy as sp

    def refuse(*_: object) -> None:
        raise AssertionError("a derivative")

    monkeypatch.setattr(sp, "diff", refuse)
    surface = gm.Surface.from_sympy(("u*cos(v)", "u*sin(v)", "u**2"), ("u", "v"), SQUARE)
    assert np.isfinite(surface.jets(*places(surface))).all()


# --- callables ------------------------------------------------------------------------------------


def in_place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    u = u.copy()
    u += 1.0
    return np.stack([u, v, u * v], axis=-1)


def of_powers(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    z = np.power(u + 5.0, 1.3) + 2.0**u + np.square(v) + np.reciprocal(v) + (u + 2) ** v
    return np.stack([u**3, v**-2.5, z + np.float64(2.0) * u - 1 / v], axis=-1)


def of_functions(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    x = np.tan(u / 9) + np.arccos(v / 9) + np.arctan(u) / np.tanh(v) + np.arcsin(u / 2)
    y = np.exp(-(u**2)) + np.sinh(u) * np.cosh(v) + np.log(v) - np.hypot(u, 3.0)
    return np.stack([x, y, np.sqrt(u * u + v * v)], axis=-1)


def that_fills(u: np.ndarray, v: np.ndarray, factor: float = 2.0, *, power: int = 3) -> np.ndarray:
    points = np.empty((*u.shape, 3), dtype=float)
    points[..., 0], points[..., 1] = u, factor * v
    points[..., 2] = points[..., 0] ** power
    points[..., 2] += np.sin(points[..., 1])
    return points


def that_fills_zeros(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    points = np.zeros(u.shape + (3,))  # noqa: RUF005
    points[:, :2] = np.stack([u, v], axis=-1)
    return points


TRACED: list[Callable[..., Any]] = [
    in_place,
    that_fills,
    that_fills_zeros,
    of_powers,
    of_functions,
    lambda u, v: np.stack([u, v, np.sin(3 * u) * np.cos(3 * v)], axis=-1),
    lambda u, v: np.moveaxis(np.array([u, v, +u * v]), 0, -1),
    lambda u, v: np.stack([u, v, np.arctan2(v, u + 2.0) + np.arctan2(u, 3.0)], axis=-1),
    lambda u, v: np.stack([u, v, np.zeros_like(u)], axis=-1),
    lambda u, v: np.stack([u, v, np.full(u.shape, 3.0)], axis=-1),
    lambda u, v: np.stack([u, v, u * v], axis=-1) @ np.array([[1, 2, 3], [0, 1, 0], [1, 0, 2]]),
    lambda u, v: np.stack([np.abs(u - 9.0) ** 1.5, v, abs(v + 9.0) * u], axis=-1),
    lambda u, v: np.stack([u, np.sinc(v - 0.2), np.sinc(u) * v + np.sinc(0.3)], axis=-1),
    lambda u, v: np.stack([u, v, np.polyval([1.0, 2.0, 3.0], u)], axis=-1),
]


@pytest.mark.compiled
@pytest.mark.parametrize("function", TRACED)
def test_callables_of_numpy_functions_have_tapes(function):
    assert_is_computed(gm.Surface.from_callable(function, SQUARE), 1e-5)  # numerical derivatives


calls = 0


def with_a_state(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    global calls
    calls += 1
    return np.stack([u, v, calls * u], axis=-1)


def that_fills_and_counts(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    global calls
    calls += 1
    points = np.empty((*u.shape, 3))
    points[..., 0], points[..., 1], points[..., 2] = u, v, calls * u
    return points


def that_fills_in_single_precision(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    points = np.empty((*u.shape, 3), np.float32)
    points[..., 0], points[..., 1], points[..., 2] = u, v, u
    return points.astype(np.float64)


def that_clips(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    points = np.zeros((*u.shape, 3))
    points[..., 0], points[..., 1] = u, v
    points[points[..., 0] < -0.9999, 2] = 1.0
    return points


UNTRACED: list[Callable[..., Any]] = [
    with_a_state,
    that_fills_and_counts,
    that_fills_in_single_precision,
    that_clips,
    lambda u, v: np.stack([u, v, np.where(u < 0, u, v)], axis=-1),
    lambda u, v: np.stack([u, v, np.where(u == 0.5, u, v)], axis=-1),
    lambda u, v: np.stack([u, v, np.where(u != 0.5, u, v)], axis=-1),
    lambda u, v: np.stack([u, v, u if u.all() else v], axis=-1),
    lambda u, v: np.stack([u, v, np.sign(u)], axis=-1),
    lambda u, v: np.stack([u, v, np.maximum(u, v)], axis=-1),
    lambda u, v: np.stack([u, v, np.floor(u)], axis=-1),
    lambda u, v: np.stack([u, v, (u * v).astype(np.float32)], axis=-1),
    lambda u, v: np.stack([u, v, u * generator.random()], axis=-1),
    lambda u, v: np.stack([u, v], axis=-1),
    lambda u, v: np.stack([u, v, u * np.inf], axis=-1),
    lambda u, v: gm.surfaces.torus().function(u, v),
    lambda u, v: np.stack([u, v, np.sqrt(u - 2.0)], axis=-1),
]


@pytest.mark.parametrize("function", UNTRACED)
def test_other_callables_have_none(function):
    assert gm.Surface.from_callable(function, SQUARE).tape is None


def test_values_that_differ_from_the_tape_are_noticed():
    """A callable that takes arrays of objects for something else."""

    def f(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        factor = 2.0 if u.dtype == object else 2.0 * (1.0 + 1e-12)
        return np.stack([u, v, factor * u], axis=-1)

    assert gm.Surface.from_callable(f, SQUARE).tape is None


# --- NURBS ----------------------------------------------------------------------------------------


def nurbs(degrees: tuple[int, int], knots: int, rational: bool) -> gm.Surface:
    return graph(degrees, tuple(np.sort(np.random.default_rng(1).uniform(0, 2, knots))), rational)


@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize(("degrees", "knots"), [((3, 3), 4), ((2, 3), 0), ((1, 4), 2), ((7, 5), 1)])
def test_nurbs_have_tapes(degrees, knots, rational):
    surface = nurbs(degrees, knots, rational)
    for each in surface.pieces():
        assert_is_computed(each, 1e-10)
        assert_is_computed(each.transformed(TURN), 1e-10)
        assert_is_computed(each.flipped(), 1e-10)


def test_large_degrees_and_nets_have_none():
    assert nurbs((15, 15), 0, False).tape is None
    assert nurbs((3, 3), 300, False).tape is None
