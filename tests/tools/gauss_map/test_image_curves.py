"""Folds and borders: on the surface, with images across which the number of points changes."""

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused
from ...shapes import Array, klein_bottle

pytestmark = pytest.mark.compiled

RADIUS = "(0.35 + 0.06*sin(4*u + 3*v))"
KNOBBY = gm.Surface.from_sympy(
    (f"(1 + {RADIUS}*cos(v))*cos(u)", f"(1 + {RADIUS}*cos(v))*sin(u)", f"{RADIUS}*sin(v)"),
    ("u", "v"), ((0, "2*pi"), (0, "2*pi")), periodic=True,
)  # fmt: skip
BOWL = gm.Surface.from_sympy(("u", "v", "(u**2 + v**2)/2"), ("u", "v"), ((-1, 1), (-1, 1)))


@pytest.fixture(scope="module")
def knobby() -> gm.GaussMap:
    return gm.GaussMap(KNOBBY)


def across(fold: gm.gauss_map.ImageCurve) -> tuple[Array, Array]:
    """Return normals (k, 3) of the middle vertices, and directions across the image there."""
    along = fold.normals[2:] - fold.normals[:-2]
    here = fold.normals[1:-1]
    found = np.cross(here, along)
    return here, found / np.linalg.norm(found, axis=1, keepdims=True)


def test_folds_of_a_torus():
    """They are its circles on top and below, with one normal each."""
    folds = gm.GaussMap("torus").folds()
    assert sorted(round(float(x.uv[0, 1]) / np.pi, 12) for x in folds) == [0.5, 1.5]
    for fold in folds:
        assert fold.closed
        assert len(fold.cusps) == 0
        np.testing.assert_allclose(np.abs(fold.normals[:, 2]), 1.0, atol=1e-15)
        np.testing.assert_allclose(np.linalg.norm(fold.points[:, :2], axis=1), 1.0, atol=1e-14)


def test_margins_on_a_torus():
    normals = gm.fibonacci(500)
    margins = gm.GaussMap("torus").margin(normals)
    expected = np.degrees(np.arccos(np.abs(normals[:, 2])))
    np.testing.assert_allclose(margins, expected, atol=1e-9)


def test_folds_are_where_the_curvature_vanishes(knobby):
    """LN − M² from exact derivatives is zero up to the rounding of its terms."""
    for fold in knobby.folds():
        u, v = np.mod(fold.uv, 2.0 * np.pi).T.copy()
        _, x_u, x_v, *second = np.moveaxis(KNOBBY.jets(u, v), 1, 0)
        normal = np.cross(x_u, x_v)
        L, M, N = (np.einsum("kx,kx->k", normal, x) for x in second)
        assert (np.abs(L * N - M * M) < 1e-12 * (np.abs(L * N) + M * M + np.abs(L + N))).all()
        unit = normal / np.linalg.norm(normal, axis=1, keepdims=True)
        np.testing.assert_allclose(fold.normals, unit, atol=1e-14)
        np.testing.assert_allclose(fold.points, KNOBBY.evaluate(u, v), atol=1e-14)


def test_two_points_appear_across_a_fold(knobby):
    """Where no other fold is near, nor the other branch at a cusp."""
    differences = list[int]()
    for fold in knobby.folds():
        here, beyond = across(fold)
        cusps = np.linalg.norm(here[:, None] - fold.normals[fold.cusps], axis=2).min(axis=1)
        chosen = np.flatnonzero(cusps > 0.02)[::40]
        sides = [here[chosen] + side * 1e-3 * beyond[chosen] for side in (-1.0, 1.0)]
        alone = np.min([knobby.margin(x) for x in sides], axis=0) > np.degrees(0.99e-3)
        counts = [knobby.count(x)[alone] for x in sides]
        differences += np.abs(counts[0] - counts[1]).tolist()
    assert len(differences) > 40
    assert set(differences) == {2}


def test_the_image_turns_back_at_cusps_only(knobby):
    cusps = 0
    for fold in knobby.folds():
        steps = np.diff(fold.normals, axis=0)
        forward = np.einsum("kx,kx->k", steps[:-1], steps[1:]) > 0.0
        turns = np.flatnonzero(~forward) + 1
        assert turns.tolist() == fold.cusps.tolist()
        cusps += len(turns)
    assert cusps == 8


STAR = gm.directions.circle(14) * np.where(np.arange(14) % 2, 2.0, 0.7)[:, None] + 3.0
SURFACES = {
    "sharp corners, reversed": KNOBBY.trimmed([STAR]).flipped(),
    "beyond open sides": gm.surfaces.wavy_graph().trimmed([[(-9, 0), (0, 0.4), (9, 0), (0, -0.4)]]),
    "across a mirrored seam": gm.surfaces.moebius_band().trimmed([[(5, -3), (9, 0), (5.5, 0.5)]]),
    "bottle": klein_bottle(),
}


@pytest.mark.quick_for("sharp corners, reversed", "across a mirrored seam")
@pytest.mark.parametrize("name", SURFACES)
def test_the_number_of_points_does_not_change_within_the_margin(name: str):
    known = gm.GaussMap(SURFACES[name])
    random = np.random.default_rng(0)
    normals = gm.fibonacci(40)
    margins, counts = np.radians(known.margin(normals)), known.count(normals)
    for _ in range(20):
        beside = np.cross(normals, random.normal(size=normals.shape))
        beside /= np.linalg.norm(beside, axis=1, keepdims=True)
        share = 0.9 * random.random(len(normals)) * margins
        moved = np.cos(share)[:, None] * normals + np.sin(share)[:, None] * beside
        assert (known.count(moved) == counts).all()


def test_borders_of_a_bowl():
    """Its normals are (−u, −v, 1): planes through the origin bound the image."""
    known = gm.GaussMap(BOWL)
    assert known.folds() == ()
    borders = known.border_image()
    assert len(borders) == 4
    for side in borders:
        assert (np.abs(side.uv).max(axis=1) == 1.0).all()
        assert not side.closed
    uv = np.random.default_rng(1).uniform(-2.0, 2.0, (200, 2))
    normals = np.column_stack([-uv, np.ones(len(uv))])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    t = np.linspace(-1.0, 1.0, 20_001)
    sides = [np.column_stack([np.full_like(t, end), t]) for end in (-1.0, 1.0)]
    edge = np.concatenate([*sides, *(side[:, ::-1] for side in sides)])
    image = np.column_stack([-edge, np.ones(len(edge))])
    image /= np.linalg.norm(image, axis=1, keepdims=True)
    expected = np.degrees(np.arccos(np.clip((normals @ image.T).max(axis=1), -1.0, 1.0)))
    np.testing.assert_allclose(known.margin(normals), expected, atol=1e-5)
    assert (known.count(normals) == (np.abs(uv) <= 1.0).all(axis=1)).all()


def test_folds_and_borders_end_at_a_trim():
    square = [(1.0, 1.0), (4.0, 1.0), (4.0, 4.0), (1.0, 4.0)]
    known = gm.GaussMap(gm.surfaces.torus().trimmed([square]))
    (fold,) = known.folds()
    assert not fold.closed
    assert (fold.uv[:, 0] >= 1.0 - 1e-6).all()
    assert (fold.uv[:, 0] <= 4.0 + 1e-6).all()
    (border,) = known.border_image()
    assert border.closed
    np.testing.assert_allclose(np.abs(border.uv - 2.5).max(axis=1), 1.5)


def test_folds_of_a_surface_that_is_nan_outside_of_its_trim():
    """The curves K = 0 run into places where the surface, or its differences, are NaN."""
    texts = ("u", "v", "2*u**2*v/5 - v**3/10 + u*v/5 + log(4/5 - u**2 - v**2)/10")
    formula = gm.Surface.from_sympy(texts, ("u", "v"), ((-1, 1), (-1, 1)))

    def masked(u: Array, v: Array) -> Array:
        z = 0.4 * u * u * v - 0.1 * v**3 + 0.2 * u * v + 0.1 * np.log(0.8 - u * u - v * v)
        return np.stack([u, v, np.where(u * u + v * v < 0.6, z, np.nan)], axis=-1)

    points = gm.Surface.from_callable(masked, formula.domain)
    disc = 0.7 * gm.directions.circle(60)
    known = [gm.GaussMap(x.trimmed([disc])) for x in (formula, points)]
    found = [x.folds() for x in known]
    assert [[y.closed for y in x.border_image()] for x in known] == [[True]] * 2
    for folds in found:
        assert sorted(len(x.cusps) for x in folds) == [0, 1]
        for fold in folds:
            assert (np.linalg.norm(fold.uv, axis=1) <= 0.7).all()
    for a, b in zip(*found, strict=True):
        np.testing.assert_allclose(a.uv[a.cusps], b.uv[b.cusps], atol=1e-6)
    jets = np.concatenate([formula.jets(*x.uv.T.copy()) for x in found[0]])
    uu, uv, vv = jets[:, 3:, 2].T
    assert (np.abs(uu * vv - uv * uv) < 1e-9).all()


def test_splines_have_folds_on_edges_of_patches():
    spline = gm.fit("torus", (16, 16))
    folds = gm.GaussMap(spline).folds()
    assert len(folds) == 2
    exact = gm.GaussMap("torus").folds()[0].points
    assert all(np.abs(np.abs(x.points[:, 2]) - np.abs(exact[0, 2])).max() < 0.02 for x in folds)


def test_a_tip_without_normals_is_no_border():
    texts = ("u*cos(v)", "u*sin(v)", "u**2 + u")
    flower = gm.Surface.from_sympy(texts, "uv", ((0, 1), (0, "2*pi")), periodic=(False, True))
    slopes = np.degrees(np.arctan(3.0))  # at the other border, and the normal is vertical
    np.testing.assert_allclose(gm.GaussMap(flower).margin([[0, 0, 1]]), slopes, atol=1e-6)


def test_what_has_no_border_known_is_refused():
    hidden = gm.surfaces.wavy_graph().trimmed(within=lambda u, v: u > v)
    refused("trim it by loops", gm.GaussMap(hidden).border_image, error=gm.GaussmapError)
    refused("tolerance", gm.GaussMap("torus").folds, tolerance=1.0, error=gm.GaussmapError)
