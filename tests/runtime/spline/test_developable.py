"""The developable share of the area, and the solid angle of the Gaussian image of the rest."""

import math

import gaussmap as gm
import numpy as np
import pytest

from ...products import covering
from ...shapes import moved, random_rotation

DENSE = 1e5 / (4 * math.pi)


def developable_share(spline: gm.Spline, density: float) -> float:
    return spline._cell_measure.developable_share(density)


def curved_solid_angle(spline: gm.Spline, density: float) -> float:
    return spline._cell_measure.curved_solid_angle(density)


@pytest.mark.parametrize(
    ("name", "solid_angle"),
    [
        ("torus", 8 * math.pi),  # twice the sphere ("dupin_cyclide", 8 * math.pi),
        ("sphere", 4 * math.pi), ("ellipsoid", 4 * math.pi),
        ("catenoid", 4 * math.pi * math.tanh(1.0)), ("hyperbolic_paraboloid", None),
        ("wavy_graph", None), ("moebius_band", None), ("helicoid", None), ("enneper", None),
    ],
)  # fmt: skip
def test_curved_surfaces_are_curved(name, solid_angle):
    spline = gm.fit(gm.surfaces.surface(name))
    assert developable_share(spline, DENSE) < 0.005
    if solid_angle is not None:
        assert curved_solid_angle(spline, DENSE) == pytest.approx(solid_angle, rel=0.02)


@covering(
    name=["plane", "cylinder", "cone"],
    factor=[1.0, 1e-12, 1e-9, 1e9, 1e12],
    shift=[0.0, 1.0, 1e6],
    rotation=[np.eye(3), random_rotation(1)],
)
def test_developable_surfaces_are_so_entirely(name, factor, shift, rotation):
    spline = gm.fit(moved(gm.surfaces.surface(name), factor, shift * factor, rotation), (32, 32))
    assert developable_share(spline, DENSE) == pytest.approx(1.0)
    assert curved_solid_angle(spline, DENSE) == 0.0
    with pytest.warns(gm.GaussmapWarning, match="flat or developable"):
        samples = gm.sample(spline, normals=gm.icosphere(32))
    assert np.isfinite(samples.points).all()
    assert np.isfinite(samples.gaussian_curvature).all()
    assert samples.report.developable_share == pytest.approx(1.0)
    if name == "cone":  # its spline is slightly elliptic and hyperbolic: pairs of such samples
        is_regular = samples.component == gm.Component.REGULAR
        signs = np.copysign(1, samples.gaussian_curvature[is_regular])
        assert abs(signs.sum()) <= 2
        assert len(samples) <= 0.15 * 10242
        return
    assert (samples.component == gm.Component.CURVE).all()
    assert samples.report.developable_patches == samples.report.patches
    of_area = gm.sample(spline, 100)
    assert of_area.parabolic.all()
    assert (of_area.elliptic ^ of_area.hyperbolic).all()
    assert "(100 with K = 0)" in of_area.summary()


@pytest.mark.kernels
@pytest.mark.parametrize(("name", "share"), [("cylinder", 1.0), ("plane", 1.0), ("torus", 0.0)])
def test_few_patches(name, share):
    spline = gm.fit(gm.surfaces.surface(name), (4, 4))
    assert developable_share(spline, DENSE) == pytest.approx(share)


@pytest.mark.filterwarnings("ignore:surface:gaussmap.GaussmapWarning")
def test_surfaces_may_bend_along_any_axis():
    """The second derivatives have one component; K is the rounding of their products."""

    def developable_patches(axes):
        surface = gm.Surface.from_callable(
            lambda u, v: np.stack([u, v, np.sin(u + 2 * v)], axis=-1)[..., axes], ((-1, 1), (-1, 1))
        )
        samples = gm.sample(surface, normals=gm.fibonacci(10), cells=(8, 8), on="spline")
        return samples.report.developable_patches

    assert (developable_patches([0, 1, 2]) or 0) > 0
    assert developable_patches([2, 0, 1]) == developable_patches([0, 1, 2])
    assert developable_patches([1, 2, 0]) == developable_patches([0, 1, 2])


@covering(share=[0.25, 0.5, 0.75], flat=["flat", "rolled"])
def test_surfaces_that_are_developable_in_part(share, flat):
    """Flat or a cylinder for u < share, then a saddle; a graph: its area is nearly that of uv."""

    def graph(u, v):
        beyond = np.maximum(u - share, 0.0)
        height = 8.0 * beyond**2 * (1 + 4 * v * v) - 8.0 * beyond**2 * v
        return np.stack([u, v, 0.01 * (height + (v * v if flat == "rolled" else 0.0))], axis=-1)

    spline = gm.fit(gm.Surface.from_callable(graph, ((0.0, 1.0), (0.0, 1.0))), (64, 64))
    assert developable_share(spline, DENSE) == pytest.approx(share, abs=0.06)


def test_a_point_and_a_curve_are_developable():
    for f in (lambda u, v: np.zeros((*u.shape, 3)), lambda u, v: np.stack([u, u * u, u], axis=-1)):
        spline = gm.fit(gm.Surface.from_callable(f, ((0, 1), (0, 1))), (4, 4))
        assert developable_share(spline, DENSE) == 1.0
        assert curved_solid_angle(spline, DENSE) == 0.0


def test_few_normals_count_as_ten_thousand():
    spline = gm.fit(gm.surfaces.torus())
    assert (
        developable_share(spline, 1e-6) == developable_share(spline, 10_000 / (4 * math.pi)) == 0.0
    )


def test_slight_curvature_needs_many_normals():
    """A graph whose normals turn by 10⁻⁴ radians covers a solid angle of 10⁻⁸."""
    bowl = gm.fit(gm.surfaces.elliptic_paraboloid(a=100.0, b=100.0), (8, 8))
    assert developable_share(bowl, DENSE * 1e-1) == pytest.approx(1.0)
    assert developable_share(bowl, DENSE * 1e6) == 0.0
    assert curved_solid_angle(bowl, DENSE * 1e6) == pytest.approx((4e-4) ** 2, rel=1e-3)
