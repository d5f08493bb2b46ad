"""The catalogue at runtime: its compiled surfaces are those of symbolic/, by name and by number."""

import ast
import inspect
import math
from itertools import product
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.symbolic.surfaces import CATALOGUE

from ...exact import Exact
from ...products import covering
from ...refusals import refused

NAMES = list(CATALOGUE)


def changed(name: str) -> dict[str, float]:
    """Return other parameters than the defaults, in the same proportions."""
    return {p.symbol.name: 1.25 * float(p.default) for p in CATALOGUE[name].parameters}


def test_names():
    assert list(gm.surfaces.names()) == NAMES
    assert set(NAMES) <= set(dir(gm.surfaces))


@covering(name=NAMES, with_defaults=[True, False])
def test_positions_are_those_of_the_derivation(name, with_defaults):
    chosen = {} if with_defaults else changed(name)
    surface = gm.surfaces.surface(name, **chosen)
    u, v = (x.ravel() for x in np.meshgrid(*(np.linspace(*x, 9) for x in surface.domain)))
    expected = Exact(name, chosen).points(np.stack([u, v], axis=1))
    points = surface.evaluate(u, v)
    np.testing.assert_allclose(points, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


@pytest.mark.parametrize("name", NAMES)
def test_domain_and_ends_are_those_of_the_derivation(name):
    surface, exact = gm.surfaces.surface(name), CATALOGUE[name]
    assert surface.name == name
    assert surface.grid is None
    assert surface.boundary == exact.boundary
    exact_domain = [[float(end) for end in interval] for interval in exact.domain]
    np.testing.assert_allclose(surface.domain, exact_domain, rtol=3e-16)


@pytest.mark.parametrize("name", NAMES)
def test_descriptions(name):
    exact = CATALOGUE[name]
    first, *others = gm.surfaces.describe(name).splitlines()
    assert first == f"{name}: {exact.sentence}"
    assert len(others) == len(exact.parameters)
    for line, parameter in zip(others, exact.parameters, strict=True):
        assert line.strip().startswith(f"{parameter.symbol.name} = {float(parameter.default):g}: ")
        assert line.endswith(parameter.sentence)


UNKNOWN = r"^there is no surface .*(; did you mean torus\?|; there is torus, ellipsoid, .*\.)$"
TAKERS = [
    gm.surfaces.surface,
    gm.surfaces.describe,
    gm.fit,
    lambda name: gm.sample(name, 10),
    lambda name: gm.sample_stream(name, 10),
    lambda name: gm.silhouette(name, (0, 0, 1)),
    lambda name: gm.convolve("sphere", name, [[0, 0, 1]]),
    gm.SupportFunction.of_spline,
    gm.gauss_map.GaussianImages.of_spline,
    gm.gauss_map.parabolic_points,
]


@pytest.mark.parametrize("name", ["Torus", "", "toruS", " torus", "torsu"])
def test_unknown_surfaces(name):
    for call in TAKERS:
        refused(UNKNOWN, call, name, error=gm.errors.UnknownNameError)
    for call, other in product(TAKERS[:2], (None, 3, ["torus"], ("torus",))):
        refused(UNKNOWN, call, other, error=gm.errors.UnknownNameError)
    with pytest.warns(
        gm.GaussmapWarning, match=r"^surface 0 \(.*\) is left out: there is no surface "
    ):
        assert list(gm.sample_many([name], 10, progress=False, on_error="skip")) == []


@pytest.mark.parametrize("name", NAMES)
def test_makers_are_those_of_the_catalogue(name):
    """Their signatures at run time, and in the file that type checkers read."""
    expected = {p.symbol.name: float(p.default) for p in CATALOGUE[name].parameters}
    maker = getattr(gm.surfaces, name)
    assert maker.__name__ == name
    assert CATALOGUE[name].sentence in " ".join(maker.__doc__.split())
    found = inspect.signature(maker).parameters
    assert {x: p.default for x, p in found.items()} == expected
    assert {p.kind for p in found.values()} == {inspect.Parameter.POSITIONAL_OR_KEYWORD}
    path = Path(str(gm.__file__)).parent / "generated" / "surfaces_signatures.pyi"
    stub = ast.parse(path.read_text("utf-8"))
    (function,) = (x for x in ast.walk(stub) if isinstance(x, ast.FunctionDef) and x.name == name)
    assert [x.arg for x in function.args.args] == list(expected)
    assert [ast.literal_eval(x) for x in function.args.defaults] == list(expected.values())
    values = changed(name)
    made = maker(*values.values()), maker(**values), gm.surfaces.surface(name, **values)
    assert len({x.evaluate(0.5, 0.25).tobytes() for x in made}) == 1


def test_values_that_are_too_many():
    refused("torus takes one number for each of major, minor", gm.surfaces.torus, 1.0, 0.5, 0.25)
    refused("torus takes one number for each of major, minor", gm.surfaces.torus, 1.0, major=2.0)


def test_unknown_attributes():
    assert not hasattr(gm.surfaces, "donut")
    with pytest.raises(AttributeError, match="has no 'donut'; it has torus, ellipsoid"):
        _ = gm.surfaces.donut  # pyright: ignore[reportAttributeAccessIssue]


@pytest.mark.parametrize(
    ("parameters", "complaint"),
    [
        ({"size": 1}, "torus has no parameter 'size'; it has major, minor."),
        ({"name": "x"}, "torus has no parameter 'name'; it has major, minor."),
        *(({"minor": x}, f"minor of torus must be a positive number, not {x}.")
          for x in (0, -0.1, math.nan, math.inf)),
        *(({"minor": x}, "minor of torus must be a number, not ") for x in ("x", [0.1], 10**400)),
    ],
)  # fmt: skip
def test_unusable_parameters(parameters, complaint):
    for call in (gm.surfaces.torus, lambda **named: gm.surfaces.surface("torus", **named)):
        refused(complaint, call, **parameters)


def test_parameters_that_may_be_negative_or_zero():
    surface = gm.surfaces.plane(slope_u=-2.0, slope_v=0)
    assert surface.evaluate(0.5, 0.25).tolist() == [0.5, 0.25, -1.0]
    refused(
        "slope_u of plane must be a finite number, not nan", gm.surfaces.plane, slope_u=float("nan")
    )


@pytest.mark.parametrize("call", [gm.fit, lambda surface: gm.sample(surface, count=10)])
def test_parameters_that_make_no_surface(call):
    with pytest.raises(gm.errors.SurfaceError, match="'dupin_cyclide' is not finite at u = "):
        call(gm.surfaces.dupin_cyclide(a=0.5, b=0.96))
    with pytest.raises(gm.errors.SurfaceError, match="'torus' is not finite at u = "):
        call(gm.surfaces.torus(major=1e308, minor=1e308))


def test_numpy_numbers_are_parameters_too():
    reference = gm.surfaces.torus(minor=0.25).evaluate(1.0, 2.0)
    for minor in (np.float32(0.25), np.float64(0.25), np.array(0.25), sp.Rational(1, 4)):
        maker: Any = gm.surfaces.torus
        assert (maker(minor=minor).evaluate(1.0, 2.0) == reference).all()
