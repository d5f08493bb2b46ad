"""Whatever is handed over, the answer is a result or one sentence of a GaussmapError."""

from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

TORUS = gm.surfaces.torus()


def deep_list() -> list[Any]:
    deep: list[Any] = []
    for _ in range(2000):
        deep = [deep]
    return deep


class Unprintable:
    """An object whose repr raises."""

    def __repr__(self) -> str:
        raise OSError("no")


HOSTILE: list[Any] = [
    None, True, 0, -1, 3.0, float("nan"), float("inf"), 10**5000, -(10**5000), 1j, "a", "", b"x",
    "\udc80", Fraction(1, 3), [], [[]], [1], [[1, 2], [3]], [[1, 2, 3]], [[float("nan")] * 3],
    [[float("inf")] * 3], np.array([1, None], object), np.array([[1, 2, 3]], object),
    np.array([1j]), np.zeros((0, 3)), np.zeros((3, 3, 3)), np.array(["a"]), np.array(3),
    np.datetime64("2020-01-01"), np.ma.masked_equal([1, 2, 3], 2), {}, {"a": 1}, object(),
    Unprintable(), len, slice(0, 2), range(3), deep_list(), TORUS,
]  # fmt: skip


NAMES = [f"{type(x).__name__}-{k}" for k, x in enumerate(HOSTILE)]

# Warnings are answers, too.
pytestmark = pytest.mark.filterwarnings("ignore::gaussmap.GaussmapWarning")


@pytest.fixture(scope="module")
def samples() -> gm.Samples:
    return gm.sample(TORUS, count=100, cells=(8, 8))


def answered(call: Any, *arguments: Any, **named: Any) -> None:
    """Check that a call returns, or raises a GaussmapError of one line that is not too long."""
    try:
        call(*arguments, **named)
    except gm.GaussmapError as error:
        message = str(error)
        assert "\n" not in message
        assert len(message) < 500


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
def test_arguments_of_samples(value: Any, samples: gm.Samples) -> None:
    answered(lambda: samples[value])
    answered(gm.Samples.concatenate, value)
    answered(gm.Samples.concatenate, [samples, value])
    answered(samples.mesh, angle=value)
    answered(samples.mesh, value)
    answered(samples.weights, angle=value)
    answered(samples.offset, value)
    answered(samples.write, value if not isinstance(value, str) else f"{value}.nothing")


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
@pytest.mark.parametrize("name", ["cells", "fields", "dtype", "density", "relax", "threads"])
def test_arguments_of_sample(name: str, value: Any) -> None:
    answered(
        gm.sample, TORUS, **({"count": 50, "cells": (8, 8), "density": "gauss"} | {name: value})
    )


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
@pytest.mark.parametrize("name", ["count", "angle", "coverage", "normals"])
def test_amounts_of_sample(name: str, value: Any) -> None:
    answered(gm.sample, TORUS, cells=(8, 8), **{name: value})


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
def test_makers_of_surfaces_and_curves(value: Any) -> None:
    square = ((0, 1), (0, 1))
    answered(gm.fit, value, (8, 8))
    answered(gm.fit, TORUS, value)
    answered(gm.fit, TORUS, (8, value))
    answered(gm.Surface.from_callable, lambda u, v: value, square)
    answered(gm.Surface.from_callable, len, value)
    answered(gm.Surface.from_callable, len, square, value)
    answered(gm.Surface.from_callable, len, square, (value, value))
    answered(gm.Surface.from_grid, value)
    answered(gm.Surface.from_grid, np.eye(5), value)
    answered(gm.Surface.from_sympy, value, "uv", square)
    answered(gm.Surface.from_sympy, ("u", "v", value), "uv", square)
    answered(gm.Surface.from_sympy, ("u", "v", "u"), value, square)
    answered(gm.Surface.from_sympy, ("u", "v", "u"), ("u", value), square)
    answered(gm.Surface.from_sympy, ("u", "v", "u"), "uv", value)
    answered(gm.Surface.from_sympy, ("u", "v", "u"), "uv", ((0, value), (0, 1)))
    answered(gm.curves.Curve.from_callable, len, value)
    answered(gm.curves.Curve.from_callable, len, (0, value))
    answered(gm.curves.Curve.from_points, value)
    answered(gm.curves.Curve.from_points, np.eye(3), value)
    answered(gm.curves.Curve.from_sympy, ("t", value), "t", (0, 1))
    answered(gm.curves.Curve.from_sympy, ("t", "t"), value, (0, 1))
    answered(gm.curves.fit, value)
    answered(gm.curves.sample, value, count=10)
    answered(gm.surfaces.torus, major=value)
    answered(TORUS.evaluate, value, value)


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
def test_support_functions(value: Any) -> None:
    answered(gm.SupportFunction.from_sympy, value)
    answered(gm.SupportFunction.from_sympy, "1", value)
    answered(gm.SupportFunction.from_sympy, "1", ("x", "y", value))
    answered(gm.SupportFunction.from_sympy, "1", domain=value)
    answered(gm.SupportFunction.of_patch, value)
    answered(gm.SupportFunction.of_spline, value)
    sphere = gm.SupportFunction.from_sympy("1")
    for call in (sphere.offset, sphere.scaled, sphere.translated, sphere.rotated, sphere.branches):
        answered(call, value)


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
def test_directions_and_the_rest(value: Any, samples: gm.Samples) -> None:
    calls = (
        gm.icosphere, gm.fibonacci, gm.directions.random, gm.directions.circle,
        gm.directions.covering_radius,
        gm.read_samples, gm.gauss_map.GaussianImage, gm.gauss_map.classify_patches,
        gm.gauss_map.parabolic_points, gm.gauss_map.split_patch, gm.gauss_map.parabolic_lines,
    )  # fmt: skip
    for call in calls:
        answered(call, value)
    answered(gm.directions.cap, value, 10.0, 10)
    answered(gm.directions.cap, (0, 0, 1), value, 10)
    answered(gm.directions.cap, (0, 0, 1), 10.0, value)
    answered(gm.directions.random, 5, seed=value)
    answered(gm.directions.polygon, value, 10)
    answered(gm.directions.polygon, np.eye(3), value)
    answered(gm.silhouette, samples.spline, direction=value, count=10)
    answered(gm.convolve, samples.spline, value, normals=gm.icosphere(1))
    answered(gm.curves.polygon_distance, value, np.eye(3)[:, :2])
    with suppress(OSError, RecursionError, ValueError):  # of what cannot be printed
        answered(gm.read_samples, f"{' '.join(repr(value).split())[:60]}.ply")


def test_a_patch_is_picked_by_a_number(samples: gm.Samples) -> None:
    images = gm.gauss_map.GaussianImages(samples.spline)  # pyright: ignore
    for value in ([1], 1.0, None, "1"):
        with pytest.raises(gm.errors.InputError, match="a patch is picked by its number"):
            images[value]  # pyright: ignore


def test_angles_that_leave_no_triangle(samples: gm.Samples) -> None:
    for call in (samples.mesh, samples.weights):
        with pytest.raises(
            gm.errors.InputError, match="every triangle deviates by more than 1e-06"
        ):
            call(angle=1e-6)


@pytest.mark.parametrize("name", ["\ud800.ply", "\udfff/x.npz"])
def test_paths_with_lone_surrogates(name: str, samples: gm.Samples) -> None:
    for call in (samples.write, gm.read_samples, samples.mesh().write):
        with pytest.raises(
            gm.GaussmapError, match=r"lone surrogates|cannot be read|no file"
        ) as caught:
            call(name)
        str(caught.value).encode(errors="backslashreplace")


def consumed(call: Any, *arguments: Any, **named: Any) -> None:
    """Go through what a call yields."""
    for _ in call(*arguments, **named):
        pass


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
@pytest.mark.quick_for("bool", "float", "str", "object")
def test_progress(value: Any, samples: gm.Samples) -> None:
    spline = samples.spline
    assert spline is not None
    answered(gm.sample, spline, 50, progress=value)
    answered(gm.silhouette, spline, (0, 0, 1), count=10, progress=value)
    answered(consumed, gm.sample_many, [spline], 50, progress=value)
    answered(consumed, gm.sample_stream, spline, 50, progress=value)


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
def test_many_surfaces_and_streams(value: Any, samples: gm.Samples) -> None:
    spline = samples.spline
    assert spline is not None
    answered(consumed, gm.sample_many, value, 10, progress=False)
    answered(consumed, gm.sample_many, [value], 10, progress=False)
    answered(consumed, gm.sample_stream, value, 10)
    for name in ("count", "normals", "fields", "dtype", "threads"):
        arguments = {"count": None if name == "normals" else 10, name: value}
        answered(consumed, gm.sample_many, [spline], **arguments, progress=False)
        answered(consumed, gm.sample_stream, spline, **arguments)
    answered(consumed, gm.sample_stream, spline, 10, chunk=value)
    answered(consumed, gm.sample_stream, TORUS, 10, cells=value)


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
def test_methods_of_splines(value: Any, samples: gm.Samples) -> None:
    spline = samples.spline
    assert spline is not None
    for call in (spline.evaluate, spline.normals):
        answered(call, value, 0.5)
        answered(call, 0.5, value)
    answered(samples.mesh, value)
    answered(samples.coverage, value)
    answered(samples.coverage, threads=value)


@pytest.mark.parametrize("value", HOSTILE, ids=NAMES)
def test_healpix(value: Any) -> None:
    pytest.importorskip("astropy_healpix")
    answered(gm.directions.healpix, value)


LONE = "\udc80"


@pytest.mark.parametrize(
    "arguments",
    [
        [LONE], ["sample", LONE], ["sample", LONE, "-o", "x.npz"], ["sample", "torus", "-o", LONE],
        ["sample", "torus", f"--{LONE}"], ["sample", "torus", "--set", f"minor={LONE}"],
        ["sample", "torus", "--count", LONE, "-o", "x.npz"], ["surfaces", LONE],
        ["sample", f"{LONE}.npy", "-o", "x.npz"], ["formulas", LONE], ["mesh", f"{LONE}.npz"],
        ["sample", "torus", "-o", f"nowhere/{LONE}.ply"],
    ],
    ids=lambda x: ascii(" ".join(x)),
)  # fmt: skip
def test_lone_surrogates_on_the_command_line(
    arguments: list[str], capsys: pytest.CaptureFixture[str], main: Callable[..., int]
) -> None:
    """A byte that is no UTF-8 arrives as a lone surrogate."""
    assert main(arguments) == 2
    message = capsys.readouterr().err
    assert message.startswith("gaussmap: error: ")
    assert message.count("\n") == 1
    assert message.encode()
