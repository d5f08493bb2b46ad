"""Surfaces on a part of their domain: inside loops, and where a predicate holds."""

import pickle
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import shapely
from gaussmap.runtime.domain.domain import Boundary
from gaussmap.runtime.domain.loops import checked_loops
from scipy.ndimage import binary_dilation

from ...products import covering
from ...refusals import refused
from ...shapes import circle, farthest, same, widest_angle

UNIT = ((0.0, 1.0), (0.0, 1.0))
OPEN: Boundary = (("open", "open"), ("open", "open"))
SQUARE = np.array([(1.0, 1.0), (4.0, 1.0), (4.0, 4.0), (1.0, 4.0)])
ACROSS_SEAM = np.array([(5.0, 5.0), (8.0, 5.0), (8.0, 8.0), (5.0, 8.0)])
TURN = 2.0 * np.pi


def half(u, v):
    return u < 0.5


def crossings(polygons, places):
    """Return whether places are inside, by the number of sides on their right."""
    inside = np.zeros(len(places), dtype=bool)
    for polygon in polygons:
        for (a, b), (c, d) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            spans = (b <= places[:, 1]) != (d <= places[:, 1])
            with np.errstate(all="ignore"):
                at = a + (c - a) * (places[:, 1] - b) / (d - b)
            inside ^= spans & (at > places[:, 0])
    return inside


def graph():
    def f(u, v):
        return np.stack([u, v, 0.2 * np.sin(3 * u) * np.cos(3 * v)], axis=-1)

    return gm.Surface.from_callable(f, UNIT)


def torus():
    return gm.surfaces.torus()


def test_cells_of_a_border():
    """All that it passes, also those of which it cuts a corner, and none two cells away."""
    polygon = np.random.default_rng(8).uniform(0.0, 1.0, (8, 2))
    found = checked_loops([polygon], UNIT, OPEN).cells_of_border(UNIT, (40, 30))
    along = np.linspace(0.0, 1.0, 20_000, endpoint=False)[:, None, None]
    border = (polygon + along * (np.roll(polygon, -1, axis=0) - polygon)).reshape(-1, 2)
    passed = np.zeros((40, 30), dtype=bool)
    passed[tuple((border * (40, 30)).astype(int).T)] = True
    assert found[passed].all()
    near = np.asarray(binary_dilation(passed, np.ones((3, 3))), dtype=np.bool_)
    assert not (found & ~near).any()


def test_an_open_side_is_outside_a_loop_beside_it():
    """Such points stand for points inside the domain, but for much nearer ones than these."""
    for gap, inside in ((0.0, True), (1e-9, False)):
        ends = gap, 1.0 - gap
        loop = np.array([(ends[k], ends[m]) for k, m in ((0, 0), (1, 0), (1, 1), (0, 1))])
        sides = np.array([(0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.5, 1.0)])
        found = checked_loops([loop], UNIT, OPEN).contains(sides)
        assert (found == inside).all()


@pytest.mark.kernels
class TestEvenOdd:
    def test_places_on_vertices_and_sides(self):
        rng = np.random.default_rng(0)
        places = (np.indices((9, 9)).reshape(2, -1).T + 1.0) / 10.0
        for _ in range(60):
            # Multiples of 1/64: products of differences are exact.
            polygons = [rng.integers(0, 10, (6, 2)) / 8.0 for _ in range(2)]
            at = np.round(places * 8.0).astype(np.float64) / 8.0
            at = at[((at > 0.0) & (at < 1.0)).all(axis=1)]
            found = checked_loops(polygons, UNIT, OPEN).contains(at)
            np.testing.assert_array_equal(found, crossings(polygons, at))

    def test_two_loops_with_a_common_side_hold_each_point_once(self):
        rng = np.random.default_rng(1)
        corners = rng.uniform(0.2, 0.8, (2, 2))
        left = np.array([(0.0, 0.0), *corners, (0.0, 1.0)])
        right = np.array([(1.0, 1.0), *corners[::-1], (1.0, 0.0)])
        bottom = np.array([(0.0, 0.0), (1.0, 0.0), corners[0]])
        top = np.array([(0.0, 1.0), corners[1], (1.0, 1.0)])
        shares = rng.uniform(0, 1, (2000, 1))
        places = np.concatenate([corners[0] + shares * (corners[1] - corners[0]), corners])
        found = [
            checked_loops([x], UNIT, OPEN).contains(places) for x in (left, right, bottom, top)
        ]
        np.testing.assert_array_equal(np.sum(found, axis=0), 1)

    @pytest.mark.parametrize("scale", [1e-300, 1e-9, 1e9, 1e300])
    def test_scale_and_position_do_not_matter(self, scale):
        rng = np.random.default_rng(2)
        polygon, places = rng.uniform(0, 1, (20, 2)), rng.uniform(0, 1, (500, 2))
        scaled = checked_loops([polygon * scale], ((0.0, scale), (0.0, scale)), OPEN)
        np.testing.assert_array_equal(scaled.contains(places * scale), crossings([polygon], places))
        far = checked_loops([polygon + 1e6], ((1e6, 1e6 + 1.0), (1e6, 1e6 + 1.0)), OPEN)
        assert (far.contains(places + 1e6) != crossings([polygon], places)).sum() <= 1

    def test_a_loop_on_the_border_of_the_domain_holds_the_border(self):
        border = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
        places = np.concatenate([border, [(1.0, 0.3), (0.3, 1.0)]])
        assert checked_loops([border], UNIT, OPEN).contains(places).all()


class TestPeriods:
    def test_a_loop_across_the_seam(self):
        trim = torus().trimmed([ACROSS_SEAM]).trim
        places = np.array(
            [(5.5, 5.5), (1.0, 1.0), (5.5, 1.0), (3.0, 3.0), (TURN, 0.0), (0.0, TURN)]
        )
        inside = [True, True, True, False, True, True]
        np.testing.assert_array_equal(trim.contains(places), inside)
        np.testing.assert_array_equal(trim.contains(places - 4 * TURN), inside)

    def test_a_copy_of_a_point_is_enough(self):
        trim = torus().trimmed([[(0, 0), (14, 4), (14, 4.5), (0, 0.5)]]).trim  # twice around
        places = np.array([(1.0, 0.5), (1.0, 1.2), (1.0, 2.3)])
        assert trim.contains(places).tolist() == [True, False, True]

    def test_the_other_parameter_is_reversed_on_a_moebius_band(self):
        band = gm.surfaces.moebius_band()
        (u0, u1), (v0, v1) = band.domain
        low = v0 + 0.1 * (v1 - v0), v0 + 0.3 * (v1 - v0)
        box = [(u1 - 1.0, low[0]), (u1 + 1.0, low[0]), (u1 + 1.0, low[1]), (u1 - 1.0, low[1])]
        trim = band.trimmed([box]).trim
        v = v0 + 0.2 * (v1 - v0)
        places = np.array([(u1 - 0.5, v), (u0 + 0.5, v0 + v1 - v), (u0 + 0.5, v)])
        np.testing.assert_array_equal(trim.contains(places), [True, True, False])


class TestInput:
    def test_a_polygon_of_shapely(self):
        disc = shapely.Point(0.5, 0.5).buffer(0.4, 64)
        ring = disc.difference(shapely.Point(0.5, 0.5).buffer(0.2, 64))
        other = shapely.MultiPolygon([shapely.box(0, 0, 0.1, 0.1), shapely.box(0.9, 0.9, 1, 1)])
        radii = 0.25 + 0.24 * np.cos(200 * np.linspace(0.0, TURN, 4000, endpoint=False))
        star = shapely.Polygon(0.5 + radii[:, None] * circle(4000, 0.0, 1.0))
        teeth = np.stack([np.linspace(0.01, 0.99, 998), np.tile([0.01, 0.9], 499)], axis=1)
        teeth = np.concatenate([teeth, [[0.99, 0.999], [0.01, 0.999]]])
        places = np.random.default_rng(0).uniform(0, 1, (5000, 2))
        for shape in (disc, ring, other, star, *map(shapely.Polygon, (teeth, teeth[::-1]))):
            trim = graph().trimmed(shape).trim
            np.testing.assert_array_equal(
                trim.contains(places), shapely.contains_xy(shape, *places.T)
            )
        both = graph().trimmed([ring, other, SQUARE / 10]).trim
        assert both.contains(places).any()

    def test_conditions_add_up(self):
        places = np.random.default_rng(1).uniform(0, TURN, (5000, 2))
        u, v = places.T
        surface = torus().trimmed([SQUARE], within=lambda u, v: v < 3).trimmed([SQUARE + 1.0])
        inside = (u > 2) & (u < 4) & (v > 2) & (v < 3)
        np.testing.assert_array_equal(surface.trim.contains(places), inside)

    def test_samples_pickle_without_a_spline_whose_predicate_does_not(self):
        surface = torus().trimmed(within=lambda u, v: u < 1)
        samples = gm.sample(surface, 50, cells=(8, 8))
        other = pickle.loads(pickle.dumps(samples))
        assert other.spline is None
        assert other.surface is None
        np.testing.assert_array_equal(other.points, samples.points)
        samples = gm.sample(torus().trimmed([SQUARE - 1.0], within=half), 20, cells=(8, 8))
        other = pickle.loads(pickle.dumps(samples))
        assert other.spline.trim.contains(samples.uv).all()

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            ({"loops": [[(0, 0), (1, 1)]]}, "loop 0 has 2 points; a polygon needs at least 3"),
            ({"loops": [[(0, 0), (1, 1), (0, 0)]]}, "loop 0 has 2 points"),
            ({"loops": [SQUARE, [(0, 0), (1, np.nan), (1, 0)]]}, "loop 1 holds NaN"),
            ({"loops": [np.zeros((4, 3))]}, r"loop 0 must have the shape \(k, 2\)"),
            ({"loops": []}, "loops is empty"),
            ({"loops": "square"}, "loops must be a sequence"),
            ({"loops": 3}, "loops must be a sequence"),
            ({"loops": shapely.Point(0, 0)}, "a Polygon or a MultiPolygon, not a 'Point'"),
            ({"loops": [SQUARE + 1e9]}, "more than 100 periods of u"),
            ({"loops": [[(1, 1), (9, 1), (9, 2), (1, 2)]]}, "overlap their copies"),
            ({"within": 3}, "within must be callable"),
            ({}, "trimmed needs loops"),
        ],
    )
    def test_unusable_arguments(self, arguments, words):
        refused(words, torus().trimmed, **arguments)

    @pytest.mark.parametrize(
        ("within", "words"),
        [
            (lambda u, v: 1 / 0, "raised ZeroDivisionError"),
            (lambda u, v: u[:2] < 1, r"returned the shape \(2,\)"),
            (lambda u, v: u, "must return an array of booleans, not float64"),
            (lambda u, v: True, "must return an array of booleans, not bool"),
            (lambda u, v: u > 7, "leaves nothing of it"),
            (lambda u, v: (u > 4) & (v > 4), "leaves nothing of it"),  # of the loop
        ],
    )
    @pytest.mark.parametrize("kind", [{"density": "gauss"}, {"density": "uniform"}, {}])
    def test_unusable_predicates(self, within, words, kind):
        surface = torus().trimmed([SQUARE]).trimmed(within=within)
        refused(words, gm.sample, surface, 50, cells=(8, 8), **kind, error=gm.errors.SurfaceError)


PARTS = {
    "annulus": torus().trimmed([circle(40, 3.0, 1.5), circle(40, 3.0, 0.7)]),
    "seam": torus().trimmed([ACROSS_SEAM]),
    "predicate": graph().trimmed(within=lambda u, v: (u - 0.4) ** 2 + v**2 < 0.25),
    "thin": graph().trimmed([[(0.1, 0.1), (0.9, 0.2), (0.9, 0.21), (0.1, 0.11)]]),
}


def inner_points(surface, cells, count):
    """Return the spline, and points of it with their normals from all over the part."""
    spline = gm.fit(surface, cells)
    low, high = np.array(surface.domain).T
    uv = low + (high - low) * np.random.default_rng(0).uniform(0, 1, (count, 2))
    uv = uv[surface.trim.contains(uv)]
    return spline, spline.evaluate(*uv.T), spline.normals(*uv.T)


class TestSampling:
    @covering(name=PARTS, asked=["coverage", "angle"])
    def test_guarantees_hold_on_the_part(self, name, asked):
        spline, points, normals = inner_points(PARTS[name], (12, 12), 40_000)
        size = 8.0 if asked == "angle" else 0.15 if name in ("annulus", "seam") else 0.03
        request: Any = {asked: size}
        samples = gm.sample(spline, **request)
        assert spline.trim.contains(samples.uv).all()
        if asked == "angle":
            assert widest_angle(samples, normals) <= samples.report.angle <= size
        else:
            assert farthest(samples, points) <= samples.report.coverage <= size
            assert farthest(samples, points) <= samples.coverage()

    @covering(density=["balanced", "uniform", 0.5, "gauss"], name=PARTS)
    def test_count_is_met(self, name, density):
        spline = gm.fit(PARTS[name], (12, 12))
        samples = gm.sample(spline, 300, density=density, fields=("points", "patch_index"))
        assert samples.fields == ("points", "patch_index")
        if density == "gauss":
            assert abs(len(samples) - 300) <= 11
        else:
            assert len(samples) == 300

    def test_samples_at_normals_are_those_of_the_whole_that_are_inside(self):
        normals = gm.icosphere(12)
        whole = gm.sample("torus", normals=normals, cells=(12, 12))
        part = gm.sample(PARTS["annulus"], normals=normals, cells=(12, 12))
        assert part.report.undecided == ()
        # A piece of one of both circles is inside.
        assert (part.component == gm.Component.CURVE).sum() == 1
        whole, part = (x[x.component == gm.Component.REGULAR] for x in (whole, part))
        inside = PARTS["annulus"].trim.contains(whole.uv)
        assert 0 < inside.sum() < len(whole)
        for name in whole.fields:
            np.testing.assert_array_equal(getattr(part, name), getattr(whole, name)[inside])
        assert len(part) == inside.sum()

    @pytest.mark.parametrize("fields", [None, ("points",)])
    def test_a_stream_is_the_same(self, fields):
        spline = gm.fit(PARTS["annulus"], (12, 12))
        samples = gm.sample(spline, 500, density="gauss", fields=fields)
        chunks = list(gm.sample_stream(spline, 500, chunk=64, fields=fields))
        assert max(map(len, chunks)) <= 64
        assert min(map(len, chunks)) > 0
        same(samples, gm.Samples.concatenate(chunks))

    def test_a_stream_of_nothing_is_one_empty_chunk(self):
        spline = gm.fit(PARTS["predicate"], (12, 12))
        with pytest.warns(gm.GaussmapWarning, match="none of the normals"):
            chunks = list(gm.sample_stream(spline, normals=[[0, 0, -1]], chunk=4))
        assert [len(x) for x in chunks] == [0]

    def test_the_areas_of_patches_are_those_inside(self):
        disc = graph().trimmed([circle(200, 0.5, 0.3)])
        flat = gm.Surface.from_callable(lambda u, v: np.stack([u, v, 0 * u], axis=-1), UNIT)
        spline = gm.fit(flat.trimmed([circle(200, 0.5, 0.3)]), (12, 12))
        share = spline.inside.shares.mean()
        assert share == pytest.approx(np.pi * 0.3**2, rel=2e-3)
        assert spline.measure[0].sum() * 2.0 == pytest.approx(share, rel=0.2)  # of the diagonal²
        inside = gm.fit(disc, (12, 12)).inside
        assert inside.shares.mean() == share

    def test_a_developable_part_is_all_of_the_rest(self):
        # A plane with a bump: without the bump all of it is flat.
        def f(u, v):
            bump = np.exp(-100 * ((u - 0.5) ** 2 + (v - 0.5) ** 2))
            return np.stack([u, v, 0.2 * bump], axis=-1)

        surface = gm.Surface.from_callable(f, UNIT)
        rest = surface.trimmed(within=lambda u, v: u < 0.1)
        shares = [
            gm.sample(x, 50, cells=(16, 16)).report.developable_share for x in (surface, rest)
        ]
        assert shares[0] < 0.6
        assert shares[1] > 0.9


def test_sides_of_boxes_are_those_of_shapely():
    """Those that touch a segment are neither inside nor outside."""
    stars = [circle(7, (1.5, 3.0), 1.0)[[0, 2, 4, 6, 1, 3, 5]], circle(9, (4.0, 2.0), 0.7)]
    rng = np.random.default_rng(3)
    low, sizes = rng.uniform(0.0, 5.0, (4000, 2)), 10.0 ** rng.uniform(-8, 0, (4000, 2))
    corners = np.concatenate(stars)
    low[:16] = corners - sizes[:16] * np.repeat([0.0, 1.0], 8)[:, None]  # with a corner in common
    boxes = np.stack([low[:, 0], low[:, 0] + sizes[:, 0], low[:, 1], low[:, 1] + sizes[:, 1]], 1)
    trim = torus().trimmed(stars).trim
    sides = trim.sides(boxes, np.zeros((4000, 3)))
    lines = shapely.MultiLineString([[*x, x[0]] for x in stars])
    rectangles = shapely.box(boxes[:, 0], boxes[:, 2], boxes[:, 1], boxes[:, 3])
    meets = shapely.intersects(rectangles, lines)
    meets[:16] = True  # rounding decides there
    inside = crossings(stars, (boxes[:, ::2] + boxes[:, 1::2]) / 2)
    np.testing.assert_array_equal(sides, np.where(meets, 0, np.where(inside, 1, -1)))
    assert {*sides.tolist()} == {-1, 0, 1}


def test_sides_of_boxes_at_a_seam():
    """Boxes and loops may both pass it."""
    trim = torus().trimmed([ACROSS_SEAM]).trim
    middles = np.array([[6.28, 6.28], [0.0, 0.0], [1.0, 6.0], [8.0 - TURN, 1.0], [5.0, 3.0]])
    boxes = np.repeat(middles, 2, axis=1) + 0.1 * np.array([-1, 1, -1, 1])
    assert trim.sides(boxes, np.zeros((5, 3))).tolist() == [1, 1, 1, 0, -1]


LOOPS = {
    "around": ([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)], 1),
    "beside": ([(0.2, -0.5), (0.5, -0.5), (0.5, 0.5), (0.2, 0.5)], 0),
    "through": ([(0.0, -0.5), (0.5, -0.5), (0.5, 0.5), (0.0, 0.5)], 1),
}


@pytest.mark.parametrize("place", LOOPS)
def test_flat_points_outside_of_a_trim_are_known(place):
    loop, inside = LOOPS[place]
    surface = gm.surfaces.monkey_saddle()
    for trimmed, side in ((surface.trimmed([loop]), 1), (surface.trimmed([loop]).flipped(), -1)):
        samples = gm.GaussMap(trimmed).points(side * np.array([[0, 0, 1], [0.3, 0, 1]]))
        report, found = samples.report, samples.report.undecided or ()
        # On the border it is a sample, or listed as beside it.
        assert (samples.normal_index == 0).sum() + len(found) == inside
        assert [(x.normal, x.kind, x.border) for x in found] in ([], [(0, "isolated", True)])
        assert place == "through" or found == ()
        assert report.proved == 2 - len(found)


def test_normals_out_of_reach_are_known():
    samples = gm.sample("torus", normals=[[0, 0, 1], [0, 0, -1]], reach=((0, 0, 1), 40))
    assert (samples.normal_index.tolist(), samples.report.proved) == ([0], 2)


PREDICATES = {
    "disc": lambda u, v: (u - 0.1) ** 2 + v**2 < 0.25,
    "joined": lambda u, v: ~((np.sin(3 * u) > v) & (u <= 0.5)) | (np.hypot(u, v) < 0.3),
    "absolute": lambda u, v: (np.abs(v - u) <= 0.2) & (abs(u) > np.exp(v) - 1.0),
}


@pytest.mark.parametrize("name", PREDICATES)
def test_sides_of_boxes_follow_predicates(name):
    """Where the predicate is the same on a grid, it is known of most boxes, and never wrong."""
    trim = gm.surfaces.monkey_saddle().trimmed(within=PREDICATES[name]).trim
    rng = np.random.default_rng(4)
    low, sizes = rng.uniform(-0.9, 0.8, (2000, 2)), 10.0 ** rng.uniform(-4, -1, (2000, 2))
    boxes = np.stack([low[:, 0], low[:, 0] + sizes[:, 0], low[:, 1], low[:, 1] + sizes[:, 1]], 1)
    sides = trim.sides(boxes, np.zeros((2000, 3)))
    parts = np.stack(np.meshgrid(*2 * [np.linspace(0, 1, 9)]), axis=-1).reshape(-1, 1, 2)
    u, v = (low + sizes * parts).reshape(-1, 2).T
    inside = PREDICATES[name](u, v).reshape(81, -1)
    assert inside[:, sides == 1].all()
    assert not inside[:, sides == -1].any()
    same = inside.all(axis=0) | ~inside.any(axis=0)
    assert {*sides.tolist()} == {-1, 0, 1}
    assert (sides[same] != 0).mean() > 0.95


def untraced(u, v):
    return np.floor(u + 4.2) == 3.0 * np.ones(u.shape)


def inconsistent(u, v):
    return u > (0.3 if isinstance(u, np.ndarray) else 0.0)


def chosen(u, v):
    return np.where(u < 0, v < 0, True)


@pytest.mark.parametrize("within", [untraced, inconsistent, chosen])
def test_predicates_that_are_not_inequalities_leave_boxes_open(within):
    trim = graph().trimmed(within=within).trim
    assert trim.sides(np.array([[0.9, 0.91, 0.9, 0.91]]), np.zeros((1, 3))).tolist() == [0]


@pytest.mark.parametrize("radius", [0.5, 0.6])
@pytest.mark.quick_for("0.5")
def test_a_callable_has_values_inside_its_trim_only(radius):
    def half_sphere(u, v):
        height = np.sqrt(1.0 - u * u - v * v)
        points = np.stack([u, v, height], axis=-1)
        return np.where((u * u + v * v < radius)[..., None], points, np.nan)

    whole = gm.Surface.from_callable(half_sphere, ((-1, 1), (-1, 1)))
    cap = whole.trimmed(within=lambda u, v: u * u + v * v < 0.5)
    assert np.isnan(cap.evaluate(0.9, 0.9)).all()
    fitted, normals = gm.GaussMap(cap, cells=(32, 32)), gm.fibonacci(1000)
    misfit = gm.fit(cap, (32, 32)).misfit
    angle = misfit.angle or np.inf
    assert angle < 3.0  # the spline continues it smoothly
    samples = fitted.points(normals)
    away = np.degrees(np.arccos(normals[:, 2])) - 45.0
    found = np.isin(np.arange(1000), samples.normal_index)
    np.testing.assert_array_equal(found[abs(away) > angle], (away < 0.0)[abs(away) > angle])
    # First derivatives are numerical, up to 1e-12.
    np.testing.assert_allclose(samples.points, samples.normals, rtol=0, atol=1e-11)
    np.testing.assert_allclose(cap.bounds[1], [np.sqrt(0.5), np.sqrt(0.5), 1.0], atol=1e-4)
    with pytest.raises(gm.errors.SurfaceError, match="not finite at u = "):
        gm.fit(whole.trimmed(within=lambda u, v: u > -0.9))
