"""What users may hand over by mistake, and too much of it: one sentence of a GaussmapError."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ..refusals import refused
from ..shapes import TORUS


@pytest.fixture(scope="module")
def samples() -> gm.Samples:
    return gm.sample(TORUS, count=100, cells=(8, 8))


def test_a_patch_is_picked_by_a_number(samples: gm.Samples) -> None:
    images = gm.gauss_map.GaussianImages(samples.spline)  # pyright: ignore
    for value in ([1], 1.0, None, "1"):
        with pytest.raises(gm.errors.InputError, match="a patch is picked by its number"):
            images[value]  # pyright: ignore


def test_what_was_made_of_the_wrong_thing_is_refused_at_once() -> None:
    """It was taken, and failed by an AttributeError when it was used."""
    spline = gm.fit(TORUS, (8, 8))
    net: Any = spline.control_nets
    for make, message in (
        (lambda: gm.SupportFunction(net), "make a SupportFunction by of_spline, of_patch or"),
        (lambda: gm.gauss_map.GaussianImages(net), "takes a Spline, not ndarray; .*of_spline"),
        (lambda: gm.gauss_map.GaussianImage(net), "control_points must be six points"),
        (lambda: replace(TORUS, name=3), "name must be a text, not 3"),
        (lambda: replace(TORUS, trim=[]), "trim must be a Trim or None"),
        (lambda: replace(spline, coefficients=net[0]), r"shape \(m \+ 2, n \+ 2, 3\)"),
    ):
        refused(message, make)


def test_samples_in_the_place_of_normals(samples: gm.Samples) -> None:
    """As an array they are points."""
    for call in (lambda x: gm.sample(TORUS, normals=x), gm.directions.covering_radius):
        refused(r"not Samples; give its \.normals", call, samples)


NEEDED = {
    "mesh": ("points", "normals", "uv"), "weights": ("points", "normals", "uv"),
    "coverage": ("points",), "normal_deviation": ("normals",), "plot": (),
}  # fmt: skip


@pytest.mark.parametrize("method", NEEDED)
def test_what_samples_need(method: str, tmp_path: Path) -> None:
    """Those of a file know no spline: it is given; and some fields are used."""
    on_spline = gm.sample(gm.fit(TORUS, (8, 8)), 100)
    on_spline.write(tmp_path / "a.npz")
    read = gm.read_samples(tmp_path / "a.npz")
    refused("do not hold the(ir surface| spline)", getattr(read, method))
    if method != "weights":  # which are those of a mesh
        found, own = (getattr(x, method)(on_spline.spline) for x in (read, on_spline))
        if method != "plot":
            np.testing.assert_array_equal(*(getattr(x, "triangles", x) for x in (found, own)))
    for name in NEEDED[method]:
        fields = tuple(x for x in ("points", "normals", "uv") if x != name)
        few = getattr(gm.sample(TORUS, 100, cells=(8, 8), fields=fields), method)
        refused(f"'{name}'", few, error=gm.errors.MissingFieldError)


def test_long_messages_keep_their_beginning_and_their_end() -> None:
    for kind in (gm.errors.InputError, gm.errors.FileError, gm.errors.MissingExtraError):
        message = str(kind(f"'{'x' * 1000}' is missing; look elsewhere."))
        assert len(message) == 300
        assert message.startswith("'xxx")
        assert message.endswith("xxx' is missing; look elsewhere.")


def test_angles_that_leave_no_triangle(samples: gm.Samples) -> None:
    for call in (samples.mesh, samples.weights):
        refused("every triangle deviates by more than 1e-06", call, angle=1e-6)


@pytest.mark.parametrize("name", ["\ud800.ply", "\udfff/x.npz"])
def test_paths_with_lone_surrogates(name: str, samples: gm.Samples) -> None:
    for call in (samples.write, gm.read_samples, samples.mesh().write):
        said = refused(
            r"lone surrogates|cannot be read|no file", call, name, error=gm.GaussmapError
        )
        said.encode(errors="backslashreplace")
