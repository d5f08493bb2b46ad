"""Samples on the surface, and not only on the spline that approximates it."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.onto_surface import on_surface
from gaussmap.runtime.onto_surface.on_surface import geometry_of

from ...exact import Exact
from ...products import covering
from ...refusals import refused
from ...shapes import FIELDS, egg, egg_surface, normals_at, same, same_chunks, unit

CELLS = (12, 12)
NORMAL_ERROR = 1e-12  # radians


def sines(normals: np.ndarray, others: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.cross(normals, others), axis=1)


REQUESTS: list[dict[str, Any]] = [
    {"normals": gm.icosphere(6)}, {"count": 300}, {"count": 300, "density": "gauss"},
    {"count": 300, "density": 0.5}, {"angle": 15.0}, {"coverage": 0.2},
]  # fmt: skip


MIXED: list[dict[str, Any]] = [{"normals": gm.icosphere(4)}, {"count": 60}]


@pytest.mark.parametrize("request_", REQUESTS, ids=[*"abcdef"])
def test_samples_are_on_the_surface(request_):
    torus = gm.surfaces.torus()
    samples = gm.sample(torus, **request_, cells=CELLS, on="surface")
    there = samples.on_surface
    # The only normals without an isolated point: along the axis, where K = 0 on circles.
    along = np.abs(samples.normals[:, 2]) > 1.0 - 1e-6
    assert (there | along).all()
    assert samples.report.on == "surface"
    assert samples.report.unrefined == (~there).sum()
    assert samples.surface is torus
    u, v = samples.uv[there].T
    np.testing.assert_allclose(samples.points[there], torus.evaluate(u, v), atol=1e-15)
    normals = samples.normals[there]
    assert sines(normals, normals_at(torus, samples.uv[there])).max() < NORMAL_ERROR + 1e-15
    K = Exact("torus").curvatures(samples.uv[there])[:, 0]
    np.testing.assert_allclose(samples.gaussian_curvature[there], K, rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(
        samples.support[there], np.sum(samples.points[there] * normals, axis=1), atol=1e-15
    )
    if request_.get("density") != "gauss" and "normals" in request_:
        np.testing.assert_array_equal(samples.normals, gm.icosphere(6)[samples.normal_index])


def test_samples_of_the_spline_are_those_of_the_spline_itself():
    torus = gm.surfaces.torus()
    samples = gm.sample(torus, 200, cells=CELLS, on="spline")
    others = gm.sample(gm.fit(torus, CELLS), 200)
    assert samples.report == others.report
    assert samples.report.on == "spline"
    assert samples.report.unrefined is samples.on_surface is samples.surface is None
    assert samples.fields == FIELDS
    for name, array in samples.arrays().items():
        np.testing.assert_array_equal(array, getattr(others, name))


@covering(
    fields=[("points",), ("uv", "on_surface"), ("gaussian_curvature",)],
    dtype=[np.float32, np.float64],
)
def test_chosen_fields_are_those_of_all(fields, dtype):
    for request_ in MIXED:
        every = gm.sample("torus", **request_, cells=CELLS, on="surface")
        some = gm.sample("torus", **request_, cells=CELLS, fields=fields, dtype=dtype, on="surface")
        expected = (*FIELDS, "on_surface")
        if every.report.proved is not None:
            expected = (*expected, "uv_radius", "component")
            expected = tuple(x for x in expected if x != "patch_index")
        assert every.fields == expected
        assert some.fields == fields
        assert some.dtype == dtype or fields == ("on_surface",)
        assert some.report.unrefined == every.report.unrefined
        for name in fields:
            expected = getattr(every, name)
            expected = expected if expected.dtype == np.bool_ else expected.astype(dtype)
            np.testing.assert_array_equal(getattr(some, name), expected)


def test_the_measure_of_an_opaque_function_is_that_of_its_spline():
    """Derivatives of a function of floats are differences of many evaluations."""
    places = []

    def opaque(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        places.append(np.size(u))
        return egg(np.asarray(u, dtype=float), np.asarray(v, dtype=float))

    domain = ((0, 2 * np.pi), (-np.pi / 2, np.pi / 2))
    surface = gm.Surface.from_callable(opaque, domain, periodic=(True, "pole"))
    assert surface.tape is None
    geometry = geometry_of(surface, (32, 16), "surface")
    places.clear()
    for found, expected in zip(geometry.measure, geometry.spline.measure, strict=True):
        np.testing.assert_array_equal(found, expected)
    assert geometry.cell_measure.developable_share(1.0) == 0.0
    assert not places


@pytest.mark.slow
def test_a_coverage_below_the_misfit_is_reached_as_far_as_possible():
    """That is for surfaces that do not know their derivatives; others are covered by these."""
    known = gm.surfaces.torus()
    assert (gm.sample(known, coverage=0.05, cells=(6, 6)).report.coverage or 1.0) <= 0.05
    torus = gm.Surface.from_callable(known.evaluate, known.domain, (True, True))
    with pytest.warns(
        gm.GaussmapWarning, match=r"coverage is 0\.\d+ instead of the requested 0\.05"
    ):
        samples = gm.sample(torus, coverage=0.05, cells=(6, 6))
    report = samples.report
    assert 0.05 < report.coverage <= 1.1 * 0.025 + 2.0 * report.fit_distance


def test_densities_take_the_curvature_of_the_surface():
    """The share of ∫ K² in the outermost cells; from the spline it is more than ten times."""
    surface = egg_surface()
    samples = gm.sample(surface, 3000, density=2, cells=(32, 32), on="surface")
    v = np.pi * ((np.arange(640) + 0.5) / 640 - 0.5)
    u = 2 * np.pi * (np.arange(64) + 0.5) / 64
    jets = surface.derivatives(u[:, None], v)
    x_u, x_v = jets[..., 1, :], jets[..., 2, :]
    N = np.cross(x_u, x_v)
    L, M, P = (np.sum(jets[..., k, :] * N, axis=-1) for k in (3, 4, 5))
    square = np.sum(N * N, axis=-1)
    K = (L * P - M * M) / square**2
    weight = K**2 * np.sqrt(square)
    outermost = np.abs(v) > np.pi / 2 * (1 - 2 / 32)
    share = weight[:, outermost].sum() / weight.sum()
    found = (np.abs(samples.uv[:, 1]) > np.pi / 2 * (1 - 2 / 32)).mean()
    assert share / 1.5 < found < share * 1.5


class TestArguments:
    def test_splines_and_data_have_no_other_surface(self):
        spline = gm.fit("torus", CELLS)
        heights = np.hypot(*np.mgrid[-1:1:8j, -1:1:9j]) ** 3
        grid = gm.Surface.from_grid(heights, spacing=(1, 1), name="hill")
        refused("needs the surface, not its spline", gm.sample, spline, 10, on="surface")
        refused("'hill' was given by points", gm.sample, grid, 10, on="surface")
        assert gm.sample(grid, 50).report.on == gm.sample(spline, 50).report.on == "spline"

    @pytest.mark.parametrize("on", ["surfaces", "", 1])
    def test_other_places_are_refused(self, on):
        for sampler in (gm.sample, gm.sample_stream):
            with pytest.raises(gm.errors.UnknownNameError, match="there is no place of samples"):
                sampler("torus", 10, on=on)

    def test_whether_samples_are_on_the_surface_is_a_field_of_those_only(self):
        with pytest.raises(
            gm.errors.InputError, match="on_surface is a field of samples on the surface"
        ):
            gm.sample("torus", 10, fields=("points", "on_surface"), on="spline")


def test_where_the_surface_is_singular_samples_stay_on_the_spline():
    """A cone: its apex is no place of a sample, and NaN does no harm next to it."""

    def cone(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.stack([v * np.cos(u), v * np.sin(u), v], axis=-1)

    surface = gm.Surface.from_callable(cone, ((0, 2 * np.pi), (0, 1)), (True, False), name="cone")
    samples = gm.sample(surface, 200, cells=CELLS, on="surface")
    assert len(samples) == 200
    assert np.isfinite(samples.points).all()
    assert np.isfinite(samples.normals).all()
    np.testing.assert_allclose(np.linalg.norm(samples.normals, axis=1), 1.0, rtol=1e-12)


@pytest.mark.usefixtures("unproved")
@pytest.mark.filterwarnings("ignore:.*could not be moved")
@pytest.mark.parametrize("name", ["wavy_graph", "sphere"])
def test_chunks_make_the_whole(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Samples that repeat others are left out, and yet chunks are full."""
    monkeypatch.setattr(on_surface, "TOGETHER", 50)
    surface = gm.surfaces.surface(name)
    for asked in ({"count": 700}, {"normals": gm.fibonacci(300)}):
        known: dict[str, Any] = {"cells": (8, 6), **asked}
        whole = gm.sample(surface, density="gauss", threads=1, **known)
        for size in (7, 100, 10**9):
            same_chunks(gm.sample_stream(surface, chunk=size, **known), whole, size)


@pytest.mark.parametrize("name", ["torus", "ellipsoid", "wavy_graph"])
def test_proved_samples_do_not_depend_on_cells(name: str) -> None:
    """Bit for bit."""
    normals = np.concatenate([gm.fibonacci(200), np.eye(3), -np.eye(3)])
    one, other = (gm.sample(name, normals=normals, cells=x) for x in ((32, 32), (30, 41)))
    same(one, other)


# --- points of the spline that cannot be moved ----------------------------------------------------


def power(x: np.ndarray, exponent: float) -> np.ndarray:
    return np.sign(x) * np.abs(x) ** exponent


def superellipsoid(exponent: float) -> gm.Surface:
    """Each normal has one point; derivatives jump or are infinite on the planes of symmetry."""

    def f(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        ring = power(np.cos(v), exponent)
        x, y = ring * power(np.cos(u), exponent), 1.3 * ring * power(np.sin(u), exponent)
        return np.stack([x, y, 0.8 * power(np.sin(v), exponent)], axis=-1)

    domain = ((0.0, 2.0 * np.pi), (-np.pi / 2, np.pi / 2))
    return gm.Surface.from_callable(f, domain, (True, False))


@pytest.mark.filterwarnings("ignore:.*could not be moved")
@pytest.mark.filterwarnings("ignore:.*accuracy of the default is not reached")
@pytest.mark.parametrize("exponent", [0.5, 1.5])
def test_normals_without_a_sample_are_listed(exponent):
    normals = gm.fibonacci(300)
    samples = gm.sample(superellipsoid(exponent), normals=normals)
    assert samples.on_surface.all()
    assert samples.report.undecided is not None
    found = np.bincount(samples.normal_index, minlength=300)
    listed = [x.normal for x in samples.report.undecided]
    assert len(listed) == len(set(listed)) < 6
    found[listed] = 1
    np.testing.assert_array_equal(found, 1)
    # The points are where a superellipsoid has its normals: differences do not cross the planes of
    # symmetry there, nor do they come near.
    away = np.abs(normals[samples.normal_index]).min(axis=1) > 0.1
    on_axis = np.abs(samples.points / [1.0, 1.3, 0.8]) ** (2.0 / exponent - 1.0) / [1.0, 1.3, 0.8]
    off = np.abs(unit(on_axis * np.sign(samples.points)) - normals[samples.normal_index]).max(
        axis=1
    )
    assert off[away].max() < 1e-6
    assert samples.report.proved is None


@pytest.mark.parametrize("count", [500, pytest.param(5000, marks=pytest.mark.slow)])
def test_a_count_is_that_of_samples_on_the_surface(count):
    """A torus that crosses itself: its spline rounds the tips, where the surface has no normals."""
    position = ("(3/5 + cos(v))*cos(u)", "(3/5 + cos(v))*sin(u)", "sin(v)")
    domain = ((0, "2*pi"), (0, "2*pi"))
    spindle = gm.Surface.from_sympy(position, ("u", "v"), domain, (True, True))
    samples = gm.sample(spindle, count, density="gauss")
    assert samples.on_surface.all()
    assert abs(len(samples) - count) <= 0.02 * count + 5
    assert samples.report.undecided is None
    turned = np.cross(samples.normals, normals_at(spindle, samples.uv))
    assert np.linalg.norm(turned, axis=1).max() < 1e-9
    assert samples.report.on == "surface"
    same_chunks(gm.sample_stream(spindle, count, chunk=100), samples, 100)
