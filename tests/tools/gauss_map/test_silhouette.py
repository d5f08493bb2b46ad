"""Silhouettes: perpendicular, complete, exact on sphere and torus, aligned directions included."""

import pickle
from collections.abc import Callable
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.gauss_map.silhouette import great_circle
from numpy.typing import NDArray

from ...products import covering
from ...refusals import refused
from ...shapes import EPS, Array, moved

MAJOR, MINOR = 1.0, 0.35
TORUS = gm.surfaces.torus(major=MAJOR, minor=MINOR)
AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, 0, -5]]
DIRECTIONS = [*AXES, [1, 1, 0], [1, -1, 1], [1, 2, 3], [-0.3, 0.1, 1e-9]]


def unit(direction: Any) -> Array:
    return np.asarray(direction, dtype=float) / np.linalg.norm(direction)


# --- the circle -----------------------------------------------------------------------------------


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_great_circle_goes_round_its_axis(direction: Any) -> None:
    axis = unit(direction)
    normals = great_circle(axis, 36)
    assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() <= 2 * EPS
    assert np.abs(normals @ axis).max() <= (0 if np.abs(axis).max() == 1 else 4 * EPS)
    turned = np.cross(normals, np.roll(normals, -1, axis=0))  # anticlockwise, in equal steps
    np.testing.assert_allclose(
        turned, np.sin(np.radians(10)) * axis + 0 * turned, rtol=0, atol=8 * EPS
    )


# --- exact cases ----------------------------------------------------------------------------------


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_silhouette_of_a_sphere_is_a_great_circle(direction: Any) -> None:
    """Support functions of surfaces of size 1 are off by 1e-5 (docs/orders.md)."""
    samples = gm.silhouette(gm.surfaces.sphere(radius=2.0), direction, count=100)
    assert (samples.normal_index == np.arange(100)).all()
    assert (samples.normals == great_circle(unit(direction), 100)).all()
    assert samples.elliptic.all()
    assert np.abs(samples.support - 2.0).max() < 5e-5
    assert np.abs(samples.points @ unit(direction)).max() < 2e-3  # normals are of second order


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_silhouette_of_a_torus(direction: Any) -> None:
    """h = r ± R √(n_x² + n_y²), outside (K > 0) and inside (K < 0)."""
    samples = gm.silhouette(TORUS, direction, count=300)
    assert np.abs(samples.normals @ unit(direction)).max() <= 4 * EPS
    across = MAJOR * np.hypot(samples.normals[:, 0], samples.normals[:, 1])
    exact = MINOR + np.where(samples.elliptic, across, -across)
    assert np.abs(samples.support - exact).max() < 2e-5  # docs/orders.md
    tube = np.hypot(np.hypot(*samples.points[:, :2].T) - MAJOR, samples.points[:, 2])
    assert np.abs(tube - MINOR).max() < 2e-5
    if direction in ([0, 0, 1], [0, 0, -5]):
        radius = np.hypot(*samples.points[:, :2].T)
        expected = np.where(samples.elliptic, MAJOR + MINOR, MAJOR - MINOR)
        assert np.abs(radius - expected).max() < 2e-5
        assert np.abs(samples.points[:, 2]).max() < 2e-4  # normals are of second order


# --- every point once -----------------------------------------------------------------------------


@covering(direction=DIRECTIONS, normals=[1, 2, 10, 90, 97, 180], cells=[(16, 16), (33, 20)])
def test_every_normal_has_its_points_once(direction: Any, normals: int, cells: Any) -> None:
    """Σ sign K = 0 on a torus; 10 and 90 normals contain the axes, where the torus is parabolic."""
    samples = gm.silhouette(gm.fit(TORUS, cells), direction, count=2 * normals)
    assert samples.report.normals == normals
    signs = np.where(samples.elliptic, 1, -1)
    sums, sheets = np.zeros((2, normals), dtype=int)
    np.add.at(sums, samples.normal_index, signs)
    np.add.at(sheets, samples.normal_index, 1)
    assert not sums.any()
    generic = np.abs(great_circle(unit(direction), normals)[:, 2]) < 0.999
    assert (sheets[generic] == 2).all()


def assert_complete(samples: gm.Samples, f: Callable[[Array, Array], Array], most: float) -> None:
    """Check that there is a sample near each place of the waves where f changes sign along u."""
    u, v = np.meshgrid(np.linspace(-1, 1, 100), np.linspace(-1, 1, 41)[1:-1], indexing="ij")
    values = f(u, v)
    i, j = np.nonzero(values[1:] * values[:-1] < 0.0)
    middles = np.stack([(u[i, j] + u[i + 1, j]) / 2.0, v[i, j]], axis=1)
    assert len(middles) > 20
    assert np.linalg.norm(middles[:, None] - samples.uv, axis=2).min(axis=1).max() < most


def test_its_normals_are_those_of_the_spline_there() -> None:
    """N·d = 0 at the parameters; and where N·d changes its sign along u, there is a sample."""
    spline = gm.fit(gm.surfaces.wavy_graph(), (24, 24))
    axis = unit([1.0, 0.3, 0.15])
    samples = gm.silhouette(spline, axis, count=3000)
    assert np.abs(spline.normals(*samples.uv.T) @ axis).max() < 1e-9
    assert_complete(samples, lambda u, v: spline.normals(u, v) @ axis, 0.1)


def test_samples_are_ordered_by_normal_and_then_by_patch() -> None:
    samples = gm.silhouette(TORUS, [1, 2, 3], count=200, cells=(16, 16))
    order = np.lexsort((samples.arrays()["patch_index"], samples.normal_index))
    assert (order == np.arange(len(samples))).all()
    assert isinstance(samples.spline, gm.Spline)
    assert samples.spline.cells == (16, 16)


def test_far_from_the_origin() -> None:
    samples = gm.silhouette(moved(TORUS, shift=1e6), [0, 0, 1], count=100, cells=(24, 24))
    assert (np.bincount(samples.normal_index) == 2).all()
    radius = np.hypot(*(samples.points - 1e6)[:, :2].T)
    expected = np.where(samples.elliptic, MAJOR + MINOR, MAJOR - MINOR)
    assert np.abs(radius - expected).max() < 1e-3


# --- polylines ------------------------------------------------------------------------------------


def open_lines(samples: Any) -> list[NDArray[np.int64]]:
    """Return the polylines, without the last row of closed ones; each sample is in one of them."""
    lines = [x[:-1] if len(x) > 1 and x[0] == x[-1] else x for x in samples.polylines]
    assert sorted(np.concatenate(lines).tolist()) == list(range(len(samples)))
    return lines


def is_closed(line: NDArray[np.int64]) -> bool:
    return len(line) > 1 and line[0] == line[-1]


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_the_polyline_of_a_sphere_goes_round_once(direction: Any) -> None:
    """Over the poles, too: its points have the angles of their normals."""
    samples = gm.silhouette("sphere", direction, count=100)
    (line,) = samples.polylines
    assert is_closed(line)
    (order,) = open_lines(samples)
    steps = np.diff(np.append(order, order[0])) % 100  # normals are in order
    assert (steps == 1).all() or (steps == 99).all()


@covering(direction=[[1, 2, 3], [0.3, -1, 0.5], [0, 0, 1], [0, 1, 4]], cells=[(16, 16), (40, 27)])
def test_polylines_of_a_torus(direction: Any, cells: Any) -> None:
    """Its contour generator tan v = −(d_x cos u + d_y sin u) / d_z is two closed curves."""
    samples = gm.silhouette(TORUS, direction, count=600, cells=cells)
    open_lines(samples)
    assert len(samples.polylines) == 2
    d = unit(direction)
    for line in samples.polylines:
        assert is_closed(line)
        u, v = samples.uv[line].T
        turns = np.diff(u)
        turns -= 2 * np.pi * np.round(turns / (2 * np.pi))
        assert abs(turns.sum()) == pytest.approx(2 * np.pi)
        assert (np.sign(turns) == np.sign(turns.sum())).all()
        # One of two branches, half a turn of v apart.
        side = np.cos(v) * d[2] - np.sin(v) * (d[0] * np.cos(u) + d[1] * np.sin(u))
        assert (side > 0).all() or (side < 0).all()


def test_polylines_end_at_borders_and_pass_parabolic_points() -> None:
    """Those of a graph seen from the side: steps are as the curve in (u, v) is."""
    samples = gm.silhouette(gm.surfaces.wavy_graph(), [1.0, 0.3, 0.15], count=2000, cells=(24, 24))
    lines = open_lines(samples)
    assert len(lines) == 4
    for line in lines:
        uv = samples.uv[line]
        steps = np.linalg.norm(np.diff(uv, axis=0), axis=1)
        # Where a curve is nearly straight points are far apart, but in order: no way back.
        assert (np.einsum("kx,kx->k", np.diff(uv, axis=0)[1:], np.diff(uv, axis=0)[:-1]) > 0).all()
        assert steps.max() < 0.2
        assert (np.abs(uv[[0, -1]]).max(axis=1) > 0.9).all()
    mixed = [len(set(samples.elliptic[x].tolist())) == 2 for x in lines]
    assert any(mixed)


@pytest.mark.parametrize(
    ("name", "closed"), [("ellipsoid", [True]), ("catenoid", [True]), ("moebius_band", [False] * 2)]
)
def test_polylines_of_other_surfaces(name: str, closed: list[bool]) -> None:
    samples = gm.silhouette(gm.surfaces.surface(name), [1, 2, 3], count=400)
    lines = open_lines(samples)
    assert [is_closed(x) for x in samples.polylines] == closed
    for line in lines:
        steps = np.linalg.norm(np.diff(samples.points[line], axis=0), axis=1)
        assert steps.max() < 0.05 * np.ptp(samples.points, axis=0).max()


@covering(first=[-np.pi, 0.0, -2.0], sign=[1.0, -1.0])
def test_polylines_follow_open_borders(first: float, sign: float) -> None:
    """Normals of a helicoid are perpendicular to x on the rulings v = kπ, two of them borders."""

    def f(u: Any, v: Any) -> Any:
        return np.stack([u * np.cos(v), sign * u * np.sin(v), 0.5 * v + 0.0 * u], axis=-1)

    last = np.pi
    surface = gm.Surface.from_callable(f, ((-1.0, 1.0), (first, last)))
    samples = gm.silhouette(surface, [1, 0, 0], count=300)
    rulings = [k * np.pi for k in (-1, 0, 1) if first <= k * np.pi <= last]
    assert len(samples.polylines) == len(rulings)
    for line, v in zip(sorted(open_lines(samples), key=lambda x: samples.uv[x[0], 1]), rulings,
                       strict=True):  # fmt: skip
        assert len(line) == len(samples) // len(rulings)
        np.testing.assert_allclose(samples.uv[line, 1], v, atol=1e-4)
        steps = np.diff(samples.uv[line, 0])
        assert (steps > 0.0).all() or (steps < 0.0).all()


def test_polylines_are_cut_at_a_trim() -> None:
    low, high = 0.1, 2.5
    square = [[low, 0.2], [high, 0.2], [high, 6.0], [low, 6.0]]
    samples = gm.silhouette(TORUS.trimmed([square]), [1, 2, 3], count=400)
    whole = gm.silhouette(TORUS, [1, 2, 3], count=2 * (samples.report.normals or 0))
    u, v = whole.uv.T
    inside = (u > low) & (u < high) & (v > 0.2) & (v < 6.0)
    np.testing.assert_array_equal(samples.points, whole.points[inside])
    assert len(samples) == pytest.approx(400, rel=0.05)
    for line in open_lines(samples):
        steps = np.diff(samples.uv[line, 0])
        assert (steps > 0).all() or (steps < 0).all()
    assert not any(map(is_closed, samples.polylines))


def test_what_is_made_of_a_silhouette() -> None:
    outline = gm.silhouette(TORUS, [1, 2, 3], count=100)
    again = pickle.loads(pickle.dumps(outline))
    for ours, theirs in zip(again.polylines, outline.polylines, strict=True):
        np.testing.assert_array_equal(ours, theirs)
    for part in (outline[:10], gm.Samples.concatenate([outline, outline]), outline.offset(0.1)):
        assert type(part) is gm.Samples
    lean = gm.silhouette(TORUS, [1, 2, 3], count=100, fields=("points",))
    np.testing.assert_array_equal(lean.polylines[0], outline.polylines[0])
    assert lean.fields == ("points",)
    some = gm.silhouette(TORUS, [1, 2, 3], count=100, fields=("points",), dtype=np.float32)
    assert some.fields == ("points",)
    assert (some.points == outline.points.astype(np.float32)).all()
    refused("must be a Mesh", outline.visible, by=TORUS)


# --- count, fields, warnings ----------------------------------------------------------------------


@covering(name=["plane", "cylinder", "cone"], direction=[[0, 0, 1], [1, 2, 3]])
def test_developable_surfaces_warn(name: str, direction: Any) -> None:
    with pytest.warns(gm.GaussmapWarning, match="flat or developable") as said:
        samples = gm.silhouette(gm.surfaces.surface(name), direction, count=50, cells=(16, 16))
    assert said[0].filename == __file__
    if name != "cone":  # whose spline is slightly elliptic and hyperbolic
        assert len(samples) == 0


def test_no_silhouette() -> None:
    """A bowl seen from above has no vertical tangent plane."""
    bowl = gm.surfaces.elliptic_paraboloid()
    with pytest.warns(
        gm.GaussmapWarning,
        match=r"none of the normals.*; there are 0 samples instead of the requested 20",
    ):
        samples = gm.silhouette(bowl, [0, 0, 1], count=20)
    assert len(samples) == 0
    assert samples.polylines == ()


NO_COUNT = "count must be a whole number of at least 1"


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"direction": [0, 0, 0]}, "^direction is the zero vector, which has no direction"),
        ({"direction": [0, np.nan, 0]}, "^direction holds NaN or infinity"),
        ({"direction": [[0, 0, 1]]}, r"^direction must have the shape \(3,\), not \(1, 3\)"),
        ({"direction": "z"}, "^direction must be an array of real numbers"),
        *(({"direction": [0, 0, 1], "count": x}, NO_COUNT) for x in (0, -1, 1.5, None, "9")),
        ({}, "either a direction or a viewpoint"),
        ({"direction": (1, 2, 3), "viewpoint": (1, 2, 3)}, "either"),
        ({"viewpoint": (1, 2)}, "viewpoint"),
    ],
)
def test_what_is_refused(asked: dict[str, Any], message: str) -> None:
    refused(message, gm.silhouette, TORUS, **asked)


@pytest.mark.parametrize("scale", [5e-324, 1e-300, 1e300])
def test_directions_of_any_length(scale: float) -> None:
    tiny = gm.silhouette(TORUS, [0, 0, scale], count=8, cells=(8, 8))
    assert (tiny.points == gm.silhouette(TORUS, [0, 0, 1], count=8, cells=(8, 8)).points).all()


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "moebius_band"])
def test_it_lies_on_the_surface_and_has_its_count(name: str) -> None:
    """With the surface's own derivatives, at parabolic points too."""
    surface, axis = gm.surfaces.surface(name), np.array([1.0, 0.2, 0.3]) / np.sqrt(1.13)
    outline = gm.silhouette(surface, axis, count=400)
    assert abs(len(outline) - 400) <= 0.05 * 400 + 1
    jets = surface.jets(*outline.uv.T)
    normals = np.cross(jets[:, 1], jets[:, 2])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert np.abs(normals @ axis).max() < 2e-12
    assert np.abs(jets[:, 0] - outline.points).max() < 1e-12
    assert outline.on_surface.all()
    assert (outline.report.on, outline.report.unrefined) == ("surface", 0)
    on_spline = gm.silhouette(surface, axis, count=400, on="spline")
    assert on_spline.report.on == "spline"
    assert len(on_spline.polylines) == len(outline.polylines)


# --- from a viewpoint -----------------------------------------------------------------------------

VIEWPOINT = (3.0, 1.5, 1.6)
SIGHTS: list[dict[str, Any]] = [{"viewpoint": VIEWPOINT}, {"direction": (-3.0, -1.5, -1.6)}]


@covering(
    name=["torus", "ellipsoid", "wavy_graph", "moebius_band", "catenoid"], on=["surface", "spline"]
)
def test_normals_are_perpendicular_to_lines_of_sight(name: str, on: str) -> None:
    surface = gm.surfaces.surface(name)
    outline = gm.silhouette(surface, viewpoint=VIEWPOINT, count=300, on=on)
    rays = outline.points - VIEWPOINT
    cosines = np.einsum("kx,kx->k", outline.normals, rays) / np.linalg.norm(rays, axis=1)
    assert np.abs(cosines).max() < 1e-11
    assert len(outline) == pytest.approx(300, rel=0.03)
    for line in open_lines(outline):
        steps = np.linalg.norm(np.diff(outline.points[line], axis=0), axis=1)
        assert steps.max() <= 1.25 * np.median(steps)
    own: Any = surface if on == "surface" else outline.spline
    np.testing.assert_allclose(own.evaluate(*outline.uv.T), outline.points, atol=1e-12)


def test_a_sphere_from_a_viewpoint() -> None:
    """The circle x·p = r²."""
    sphere, eye = gm.surfaces.sphere(radius=2.0), np.array(VIEWPOINT)
    outline = gm.silhouette(sphere, viewpoint=eye, count=100)
    np.testing.assert_allclose(outline.points @ eye, 4.0, atol=1e-10)
    (line,) = outline.polylines
    assert is_closed(line)
    assert outline.report.unrefined == 0
    assert (outline.normal_index == -1).all()


def test_contours_are_complete_on_a_grid() -> None:
    """Where N·(x − p) changes its sign along u, there is a point."""

    def towards(u: Array, v: Array) -> Array:
        x, xu, xv = np.moveaxis(gm.surfaces.wavy_graph().jets(u.ravel(), v.ravel()), 1, 0)[:3]
        return np.einsum("kx,kx->k", np.cross(xu, xv), x - VIEWPOINT).reshape(u.shape)

    outline = gm.silhouette(gm.surfaces.wavy_graph(), viewpoint=VIEWPOINT, count=2_000)
    assert_complete(outline, towards, 0.05)


def test_far_viewpoints_are_directions_and_trims_cut() -> None:
    far = gm.silhouette(TORUS, viewpoint=1e8 * np.array(DIRECTIONS[-2]), count=200)
    assert np.abs(far.normals @ unit(DIRECTIONS[-2])).max() < 1e-7
    assert [is_closed(x) for x in far.polylines] == [True, True]
    square = [[0.1, 0.2], [2.5, 0.2], [2.5, 6.0], [0.1, 6.0]]
    part = gm.silhouette(TORUS.trimmed([square]), viewpoint=VIEWPOINT, count=200)
    assert (part.uv >= np.array([0.1, 0.2]) - 0.01).all()
    assert not any(map(is_closed, part.polylines))


X, Y, Z = f"({MAJOR}+{MINOR}*cos(v))*cos(u)", f"({MAJOR}+{MINOR}*cos(v))*sin(u)", f"{MINOR}*sin(v)"
ROUND = (0.0, "2*pi")
TORI = {
    "outward": TORUS,
    "inward": gm.Surface.from_sympy((X, Y, Z), ("v", "u"), (ROUND, ROUND), periodic=(True, True)),
    "open": gm.Surface.from_sympy((X, Y, Z), "uv", ((-1.0, 3.0), ROUND), periodic=(False, True)),
}


def is_free(points: Array, to_eye: Array, far: bool, torus: str) -> NDArray[np.bool_]:
    """Return whether lines of sight that touch a torus at the points do not meet it before the eye.

    Its equation is (x·x + R² − r²)² = 4R²(x² + y²), and two of the four roots on a line are at the
    point.
    """
    a, b = np.square(to_eye).sum(axis=1), 2.0 * (points * to_eye).sum(axis=1)
    c = np.square(points).sum(axis=1) + MAJOR**2 - MINOR**2
    d = b * b + 2.0 * a * c - 4.0 * MAJOR**2 * np.square(to_eye[:, :2]).sum(axis=1)
    root = np.sqrt((2.0 * a * b) ** 2 - 4.0 * a * a * d + 0.0j)
    others = (np.stack([-root, root], axis=1) - 2.0 * (a * b)[:, None]) / (2.0 * a * a)[:, None]
    at = others.real
    met = (others.imag == 0.0) & (at > 0.0) & (far | (at < 1.0))
    x, y, _ = np.moveaxis(points[:, None] + at[:, :, None] * to_eye[:, None], 2, 0)
    there = (torus != "open") | ((np.arctan2(y, x) + 1.0) % (2.0 * np.pi) < 4.0)
    return ~(met & there).any(axis=1)


@pytest.mark.parametrize("torus", list(TORI))
@pytest.mark.parametrize("sight", SIGHTS, ids=["viewpoint", "direction"])
def test_visible_parts_of_a_torus(sight: dict[str, Any], torus: str) -> None:
    """What is called seen is seen, up to cusps; next to junctions the mesh may hide too much."""
    outline = gm.silhouette(TORI[torus], count=1_000, **sight)
    seen = outline.visible(by=gm.sample(TORI[torus], 4_000).mesh())
    far = "direction" in sight
    to_eye = -np.array([sight["direction"]]) if far else VIEWPOINT - outline.points
    free = is_free(outline.points, to_eye + 0.0 * outline.points, far, torus)
    assert 0.1 < free[outline.hyperbolic].mean() < 0.9
    assert not (seen & ~free).any()
    assert (free & ~seen).mean() < 0.004
    again = pickle.loads(pickle.dumps(outline))
    assert again.eye.far == far
    assert callable(again.view)  # no field hides the method of samples


def test_nothing_is_visible_of_no_points() -> None:
    with pytest.warns(gm.GaussmapWarning, match="0 samples"):
        outline = gm.silhouette("plane", viewpoint=(1, 1, 5), cells=(8, 8))
    assert outline.visible().shape == (0,)
