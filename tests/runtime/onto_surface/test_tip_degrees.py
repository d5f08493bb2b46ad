"""Points and tips add up to the degree, at the tips of cones of any shape."""

import gaussmap as gm
import numpy as np
import pytest

from ...products import covering
from ...shapes import Array, unit

# The amplitude and the number of waves round the axis, and how much the ends lean: convex cones,
# and others that have normals twice, or with the other sign.
WAVES = {
    "round": (0.0, 3, 0.0),
    "wavy": (0.08, 3, 0.0),
    "lean": (0.3, 3, 0.2),
    "star": (0.3, 5, 0.1),
}


def lemon(name: str, along_u: bool, turn: tuple[str, str] | None = None) -> gm.Surface:
    """Return a closed surface that ends in two tips, at the ends of v or of u, or a part of it.

    The part is over u in `turn`; its ends are rounded to 13 digits, as those in files.
    """
    wave, number, lean = WAVES[name]
    r = f"(2*cos(v) - 1)*(1 + {wave}*cos({number}*u))"
    texts = f"{r}*cos(u)", f"{r}*sin(u)", f"2*sin(v) + {lean}*(2*cos(v) - 1)*cos(u)"
    if turn is not None:
        ends = ("-1.0471975511965", "1.0471975511965")
        return gm.Surface.from_sympy(texts, ("u", "v"), (turn, ends), (False, False))
    turn, ends = ("0", "2*pi"), ("-pi/3", "pi/3")
    if along_u:  # normals point inwards
        return gm.Surface.from_sympy(texts, ("v", "u"), (ends, turn), (False, True))
    return gm.Surface.from_sympy(texts, ("u", "v"), (turn, ends), (True, False))


def directions() -> Array:
    rng = np.random.default_rng(1)
    return unit(np.concatenate([np.eye(3), -np.eye(3), gm.icosphere(4), rng.normal(size=(150, 3))]))


@covering(name=[*WAVES], on=["spline", "surface", "nets"], along_u=[False, True])
def test_the_degree_of_a_closed_surface_with_tips_is_one(name: str, on: str, along_u: bool) -> None:
    surface, nets = lemon(name, along_u), None
    if on == "nets":
        nets = gm.Spline.from_nets(gm.fit(surface, (24, 24)).control_nets)
    image = gm.GaussMap(nets) if nets else gm.GaussMap(surface, cells=(64, 64), on=on)
    n = directions()
    np.testing.assert_array_equal(image.degree(n), 1)
    points = image.points(n)
    assert points.report.proved == (len(n) if on == "surface" else None)
    regular = points[points.component == gm.Component.REGULAR]
    tips = points[points.component == gm.Component.TIP]
    assert len(regular) + len(tips) == len(points)
    # Where the other points do not add up to 1, there is a tip.
    signs = np.copysign(1, regular.gaussian_curvature)
    missing = np.bincount(regular.normal_index, signs, len(n)) != 1
    assert missing.any()
    assert missing[tips.normal_index].sum() >= missing.sum()
    if name == "round":  # exactly one point for each normal
        np.testing.assert_array_equal(points.normal_index, np.arange(len(n)))
    assert (tips.gaussian_curvature == 0).all()
    assert (tips.normals == n[tips.normal_index]).all()
    np.testing.assert_allclose(np.abs(tips.points), [[0, 0, 3**0.5]] * len(tips), atol=1e-15)
    if nets:
        assert tips.patch_index is not None
        corners = nets._points_in_patches(tips.patch_index, tips.uv)
        np.testing.assert_allclose(corners, tips.points, atol=1e-15)
    else:
        np.testing.assert_array_equal(tips.uv[:, int(along_u)], 0.0)


@pytest.mark.parametrize("along_u", [False, True])
def test_lines_inside_of_the_domain_are_tips(along_u: bool) -> None:
    """A torus that crosses its axis: of normals across it there are two points, and two tips."""
    texts = ("(3/5 + cos(v))*cos(u)", "(3/5 + cos(v))*sin(u)", "sin(v)")
    turn = (0, "2*pi")
    axes = ("v", "u") if along_u else ("u", "v")
    surface, n = gm.Surface.from_sympy(texts, axes, (turn, turn), (True, True)), directions()
    image = gm.GaussMap(surface)
    points = image.points(n)
    assert (points.report.proved, points.report.undecided) == (len(n), ())
    np.testing.assert_array_equal(image.degree(n), 0)
    tips = points[points.component == gm.Component.TIP]
    steep = np.abs(n[:, 2]) > 0.8  # of normals perpendicular to (4, 0, 3)
    np.testing.assert_array_equal(np.bincount(tips.normal_index, minlength=len(n)), 2 * ~steep)
    np.testing.assert_allclose(np.abs(tips.points), [[0, 0, 0.8]] * len(tips), atol=1e-15)
    axis = np.abs(n[:, 2]) == 1.0  # a circle
    np.testing.assert_array_equal(image.count(n), np.where(axis, 1, np.where(steep, 2, 4)))
    half = surface.trimmed(within=lambda u, v: (u if along_u else v) < 3.0)
    trimmed = gm.GaussMap(half).points(n)
    assert (trimmed.component == gm.Component.TIP).sum() == len(tips) / 2


def test_faces_and_trimmed_surfaces_have_tips() -> None:
    surface, n = lemon("star", False), directions()[:50]
    found, halves = [], [lemon("star", False, x) for x in (("0", "pi"), ("pi", "2*pi"))]
    for shape in (surface, gm.Part([surface]), gm.Part(halves)):
        image = gm.GaussMap(shape)
        np.testing.assert_array_equal(image.degree(n), 1)
        points = image.points(n)
        assert (points.report.proved, points.report.undecided) == (len(n), ())
        rows = np.column_stack([
            points.normal_index, np.asarray(points.component), points.points
        ])  # fmt: skip
        found.append(rows[np.lexsort(rows.round(9).T)])
    np.testing.assert_allclose(found[0], found[1], rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(found[0], found[2], rtol=0.0, atol=1e-12)
    for low, high, tips in ((0.0, 2.0 * np.pi, True), (0.1, 6.2, False)):  # with a slit
        cut = surface.trimmed([[(low, 0.5), (high, 0.5), (high, 9.0), (low, 9.0)]])
        components = np.unique(np.asarray(gm.GaussMap(cut).points(n).component))
        assert components.tolist() == [gm.Component.REGULAR, gm.Component.TIP][: 1 + tips]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("slit", "step", "tips"),
    [(4e-7, 0.0, 8), (3e-6, 0.0, 0), (0.0, 1e-6, 8), (0.0, 1e-5, 0)],
)
def test_faces_that_nearly_meet_have_one_tip(slit: float, step: float, tips: int) -> None:
    """Their rays differ by at most 1e-6, and their points by at most 1e-6 of the size."""
    other = lemon("round", False, (f"pi + {slit}", "2*pi"))
    matrix = np.eye(4)
    matrix[2, 3] = step
    faces = [lemon("round", False, ("0", "pi")), other.transformed(matrix)]
    points = gm.GaussMap(gm.Part(faces, tolerance=1e-4)).points(directions()[:50])
    assert (np.asarray(points.component) == gm.Component.TIP).sum() == tips


@pytest.mark.parametrize("name", ["round", "star"])
def test_normals_beside_those_of_a_tip(name: str) -> None:
    """They are nearer to its cone than that through some rays: π²/2048² / 2 is 1.2e-6."""
    surface, u = lemon(name, False), np.linspace(0.0, 6.0, 100)
    image = gm.GaussMap(surface)
    n = surface.normals(u, np.full(100, np.pi / 3 - 2e-7))
    points = image.points(n)
    listed = {x.normal for x in points.report.undecided or ()}
    assert len(listed) <= (0 if name == "round" else 2)
    assert set(np.flatnonzero(image.degree(n) != 1).tolist()) <= listed
    if name == "round":
        np.testing.assert_array_equal(points.component, gm.Component.REGULAR)


@pytest.mark.parametrize("on", ["spline", "surface"])
def test_tips_are_samples_and_no_area(on: str) -> None:
    """They are in streams, in reach and in sums; meshes and weights are those without them."""
    surface, n, how = lemon("round", False), directions(), {"cells": (64, 64), "on": on}
    points = gm.sample(surface, normals=n, **how)
    is_tip = points.component == gm.Component.TIP
    assert f", {is_tip.sum()} at tips)" in points.summary()
    one = int(np.flatnonzero(is_tip)[0])
    assert repr(points[one]).endswith(": 1 at a tip)")
    chunks = gm.sample_stream(surface, normals=n, chunk=100, **how)
    for name, array in gm.Samples.concatenate(chunks).arrays().items():
        np.testing.assert_array_equal(array, getattr(points, name))
    up = n[:, 2] > np.cos(np.radians(40))
    reached = gm.sample(surface, normals=n, reach=((0, 0, 1), 40), **how)
    np.testing.assert_array_equal(reached.normal_index, np.flatnonzero(up))
    few = gm.GaussMap(surface, **how).points(n, fields=("points",))
    np.testing.assert_array_equal(few.points, points.points)
    assert gm.sample(surface, 100, density="gauss", **how).component is None
    areas = points.weights()
    assert (areas[is_tip] == 0.0).all()
    assert areas.sum() == pytest.approx(points[~is_tip].weights().sum(), rel=1e-14)


def test_the_offset_of_a_tip_is_round() -> None:
    ball = gm.SupportFunction.from_sympy("1/10")
    n, surface = directions(), lemon("round", False)
    moved = gm.convolve(surface, ball, n)
    np.testing.assert_array_equal(moved.normal_index, np.arange(len(n)))
    is_tip = np.abs(n[:, 2]) > np.sin(np.pi / 3)
    centres = np.array([0.0, 0.0, 3**0.5]) * np.sign(n[is_tip, 2:])
    np.testing.assert_allclose(moved.points[is_tip], centres + n[is_tip] / 10, atol=1e-15)
    np.testing.assert_allclose(moved.gaussian_curvature[is_tip], 100, rtol=1e-14)


def test_data_have_tips_as_well() -> None:
    u, v = np.meshgrid(np.arange(60) * 2 * np.pi / 60, np.linspace(-np.pi / 3, np.pi / 3, 41))
    r = (2 * np.cos(v) - 1) * (1 + 0.3 * np.cos(5 * u))
    points = np.stack([r * np.cos(u), r * np.sin(u), 2 * np.sin(v)], axis=-1)
    surface = gm.Surface.from_grid(points, periodic=(False, True))
    for turned in (surface, surface.flipped()):
        np.testing.assert_array_equal(gm.GaussMap(turned).degree(directions()), 1)


def test_open_cones_and_corners() -> None:
    """A cone covers nothing else; the corner of a triangle is on the border and has no degree."""
    cone = gm.Surface.from_sympy(
        ("v*cos(u)", "v*sin(u)", "-v - v**2/9"), ("v", "u"), ((0, 1), (0, "2*pi")), (False, True)
    )
    within = gm.fibonacci(300)
    steep = within[:, 2] > np.hypot(within[:, 0], within[:, 1])
    np.testing.assert_array_equal(gm.GaussMap(cone, on="spline").degree(within)[steep], 1)
    triangle = gm.Surface.from_sympy(("v", "u*v", "u*v**2"), ("u", "v"), ((0, 1), (0, 1)))
    image = gm.GaussMap(triangle, on="spline")
    assert image.spline is not None
    counts = image.count(within)
    np.testing.assert_array_equal(np.abs(image.degree(within)), counts)
