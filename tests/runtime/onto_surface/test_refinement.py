"""Newton's method for samples on the surface: normals, marks, borders, poles."""

from collections.abc import Callable

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.onto_surface.newton import FOUND, Target, evaluate_on_surface, refine
from gaussmap.runtime.onto_surface.repeats import kept_once
from numpy.typing import NDArray

from ...exact import Exact
from ...shapes import (
    HALF,
    KNOBBY,
    LATITUDES,
    MERIDIAN,
    TURN,
    Array,
    egg,
    klein,
    normals_at,
    random_rotation,
    revolved,
    same_chunks,
)

NORMAL_ERROR = 1e-12  # radians
MOTIONS = [(0.0, 1.0), (1e6, 1.0), (0.0, 1e9), (0.0, 1e-9)]


def refined(
    surface: gm.Surface, cells: tuple[int, int], normals: Array
) -> tuple[Target, NDArray[np.int64]]:
    """Return the samples after refinement, and the numbers of their normals."""
    spline = gm.fit(surface, cells)
    samples = gm.sample(spline, normals=normals)
    target = Target(
        samples.normals, np.sign(samples.gaussian_curvature), samples.uv, samples.points,
        samples.gaussian_curvature, samples.mean_curvature, np.empty(len(samples), np.int8),
    )  # fmt: skip
    refine(surface, spline, target, 1)
    return target, samples.normal_index


def blob(u: Array, v: Array) -> Array:
    """Return points of a smooth surface with dents."""
    n = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1)
    return n * (1.0 + 0.12 * np.sin(2.0 * n @ [1.0, 2.0, 0.5] + 1.0))[..., None]


def started(surface: gm.Surface, normals: Array, signs: Array, uv: Array) -> Target:
    """Return points with normals and signs of K that are found from parameters."""
    count = len(uv)
    numbers = np.zeros((count, 3)), np.ones(count), np.ones(count), np.empty(count, np.int8)
    target = Target(normals, signs, uv, *numbers)
    refine(surface, gm.fit(surface, (9, 9)), target, 1)
    assert (target.state == FOUND).all()
    return target


def moved(f: Callable[[Array, Array], Array], seed: int, shift: float, factor: float) -> gm.Surface:
    turn = random_rotation(seed)
    return gm.Surface.from_callable(
        lambda u, v: factor * (f(u, v) @ turn.T) + shift, (TURN, LATITUDES), (True, "pole")
    )


def next_to(normal: Array) -> Array:
    """Return a normal, and others 1e-14 to 0.1 radians beside it."""
    across = np.linalg.svd(normal[None])[2][1:]
    away = [10.0**k * (np.cos(k) * across[0] + np.sin(k) * across[1]) for k in range(-14, 0)]
    return np.concatenate([normal[None], normal + np.array(away)])


# --- regular points -------------------------------------------------------------------------------


@pytest.mark.parametrize(("shift", "factor"), MOTIONS)
def test_normals_become_the_prescribed_ones(shift: float, factor: float) -> None:
    torus = gm.surfaces.torus()
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = factor * random_rotation(1), shift
    surface = torus.transformed(matrix)
    samples, _ = refined(surface, (24, 16), gm.fibonacci(300))
    assert (samples.state == FOUND).all()
    assert np.abs(normals_at(surface, samples.uv) - samples.normals).max() < NORMAL_ERROR
    rounding = 1e-15 * (factor + shift)
    assert np.abs(surface.evaluate(*samples.uv.T) - samples.points).max() < 2.0 * rounding
    K, H = Exact("torus").curvatures(samples.uv).T
    np.testing.assert_allclose(samples.gaussian * factor**2, K, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(samples.mean * factor, H, rtol=1e-13)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_samples_of_a_coarse_spline_go_on_across_the_ends_of_a_period(sign: float) -> None:
    """The parameters of this torus are uneven: those of its spline are up to a quarter cell off."""
    torus = gm.surfaces.torus()

    def uneven(u: Array, v: Array) -> Array:
        u, v = (sign * x + 0.5 * np.sin(sign * x + 1.0) + 0.3 for x in (u, v))
        return np.asarray(torus.function(u, v))

    surface = gm.Surface.from_callable(uneven, (TURN, TURN), (True, True))
    samples, numbers = refined(surface, (7, 7), gm.fibonacci(2000))
    assert (np.bincount(numbers) == 2).all()
    assert (samples.state == FOUND).all()
    assert ((samples.uv >= 0.0) & (samples.uv <= 2.0 * np.pi)).all()
    assert np.abs(normals_at(surface, samples.uv) - samples.normals).max() < 2.0 * NORMAL_ERROR


@pytest.mark.filterwarnings("ignore:.*could not be moved")
@pytest.mark.parametrize(("amplitude", "frequency"), [(0.2, 3.0), (0.1, 8.0)])
def test_curvatures_are_those_of_the_stored_parameters(amplitude: float, frequency: float) -> None:
    """K and H of z = a sin f x cos f y, by their formulas."""
    surface = gm.surfaces.wavy_graph(amplitude=amplitude, frequency=frequency)
    samples = gm.sample(surface, 3000, density="gauss", cells=(48, 48))
    there = samples.on_surface
    assert there is not None
    exact = Exact("wavy_graph", {"amplitude": amplitude, "frequency": frequency})
    K, H = exact.curvatures(samples.uv[there]).T
    largest = np.abs(samples.principal_curvatures).max()
    assert np.abs(samples.gaussian_curvature[there] - K).max() < 1e-14 * largest**2
    assert np.abs(samples.mean_curvature[there] - H).max() < 1e-14 * largest
    points = surface.evaluate(*samples.uv[there].T)
    np.testing.assert_allclose(samples.points[there], points, rtol=0.0, atol=1e-15)


@pytest.mark.usefixtures("unproved")
@pytest.mark.slow
def test_next_to_singular_points_normals_are_those_that_are_prescribed() -> None:
    """A torus that crosses its axis in two conical points."""
    position = ("(3/5 + cos(v))*cos(u)", "(3/5 + cos(v))*sin(u)", "sin(v)")
    surface = gm.Surface.from_sympy(position, ("u", "v"), ((0, "2*pi"),) * 2, True)
    with pytest.warns(gm.GaussmapWarning, match="could not be moved"):
        samples = gm.sample(surface, normals=gm.icosphere(20), cells=(32, 32))
    there = samples.on_surface
    assert there is not None
    off = np.abs(normals_at(surface, samples.uv[there]) - samples.normals[there])
    assert off.max() < 1e-9
    # That of a conical point, whose derivatives are rounding, would be about 1e33.
    assert np.abs(samples.gaussian_curvature[there]).max() < 1e8


def test_numerical_derivatives_give_the_same_samples() -> None:
    torus = gm.surfaces.torus()
    numerical = gm.Surface.from_callable(torus.function, torus.domain, (True, True))
    exact, _ = refined(torus, (16, 16), gm.fibonacci(100))
    found, _ = refined(numerical, (16, 16), gm.fibonacci(100))
    assert (found.state == FOUND).all()
    np.testing.assert_allclose(found.uv, exact.uv, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(found.gaussian, exact.gaussian, rtol=0.0, atol=1e-7)


def test_samples_without_a_place_on_the_surface_stay_on_the_spline() -> None:
    """The border of the spline has other normals than that of the surface."""
    helicoid, normals = gm.surfaces.helicoid(), gm.fibonacci(3000)
    spline = gm.fit(helicoid, (6, 6))
    samples = gm.sample(spline, normals=normals)
    found, _ = refined(helicoid, (6, 6), normals)
    outside = found.state != FOUND
    assert 0 < outside.sum() < 0.02 * len(outside)
    np.testing.assert_array_equal(found.uv[outside], samples.uv[outside])
    np.testing.assert_array_equal(found.points[outside], samples.points[outside])
    assert (np.abs(np.abs(found.uv[outside]) - [1.0, np.pi]).min(axis=1) < 0.1).all()


@pytest.mark.kernels
def test_a_place_at_the_very_border_is_inside() -> None:
    surface = gm.surfaces.enneper()
    ends = [-1.0, -0.4, 0.3, 1.0]
    uv = np.array([(u, v) for u in ends for v in (-1.0, 1.0)])
    _, _, K, _ = evaluate_on_surface(surface, gm.fit(surface, (16, 16)), uv)
    start = np.clip(uv + 0.003, -1.0, 1.0)
    target = started(surface, normals_at(surface, uv), np.sign(K), start)
    np.testing.assert_allclose(target.uv, uv, rtol=0.0, atol=1e-11)


def test_flat_points_are_reached_as_far_as_normals_tell() -> None:
    """Newton's method converges to the flat point slowly; its normal is right long before."""
    surface = gm.surfaces.monkey_saddle()
    samples, _ = refined(surface, (9, 9), np.array([[0.0, 0.0, 1.0]]))
    found = samples.state == FOUND
    assert np.abs(normals_at(surface, samples.uv[found]) - [0.0, 0.0, 1.0]).max() < NORMAL_ERROR
    assert np.abs(samples.uv).max() < 0.2


@pytest.mark.kernels
def test_a_curvature_of_zero_keeps_its_sign() -> None:
    """At the flat point of a monkey saddle, where two samples may begin."""
    surface = gm.surfaces.monkey_saddle()
    upwards = np.array([[0.0, 0.0, 1.0]] * 2)
    target = started(surface, upwards, np.array([1.0, -1.0]), np.zeros((2, 2)))
    assert (target.gaussian == 0.0).all()
    np.testing.assert_array_equal(np.signbit(target.gaussian), [False, True])


@pytest.mark.parametrize("on", ["spline", "surface"])
def test_aligned_normals_have_the_sum_of_signs_by_the_sign_bit(on: str) -> None:
    """Along the axis of a torus whole circles are parabolic: K is 0 there, or its rounding."""
    normals = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3), axis=-1).reshape(-1, 3)
    normals = normals[normals.any(axis=1)]
    samples = gm.sample("torus", normals=normals, cells=(16, 16), on=on)
    K = samples.gaussian_curvature
    signs = np.where(samples.component == gm.Component.REGULAR, np.copysign(1, K), 0.0)
    assert (np.bincount(samples.normal_index, signs, len(normals)) == 0).all()
    assert not samples.report.unrefined


def test_the_seam_of_a_moebius_band_is_no_way_through() -> None:
    band = gm.surfaces.moebius_band()
    samples, _ = refined(band, (48, 12), gm.fibonacci(2000))
    found = samples.state == FOUND
    assert found.mean() > 0.9
    assert (normals_at(band, samples.uv[found]) * samples.normals[found]).sum(axis=1).min() > 0.5
    assert np.abs(normals_at(band, samples.uv[found]) - samples.normals[found]).max() < NORMAL_ERROR


# --- samples that meet ----------------------------------------------------------------------------


TORUS = gm.fit("torus", (16, 16))


def kept(*samples: tuple[float, float, float, int, bool], at_pole: bool = False) -> list[bool]:
    """Return which samples of one normal are kept, of rows (u, v, K, patch, is on the surface)."""
    u, v, K, patch, found = (np.array(x) for x in zip(*samples, strict=True))
    arrays = {
        "points": TORUS.evaluate(u, v), "uv": np.stack([u, v], axis=1), "gaussian_curvature": K,
        "normal_index": np.full(len(u), 3), "patch_index": patch, "on_surface": found,
    }  # fmt: skip
    return kept_once(TORUS, arrays, np.full(len(u), at_pole)).tolist()


# A place of the torus, the patch in which it is, and another one.
HERE, ELSEWHERE = (1.23, 0.77), (1.23, 2.34)
OWN, OTHER = (
    gm.sample(TORUS, normals=TORUS.normals([1.23], [0.77])).arrays()["patch_index"][:1].tolist()[0],
    7,
)


@pytest.mark.kernels
def test_samples_that_meet_are_one() -> None:
    """The one that has left its patch goes, whatever the order, and the other side of its fold."""
    assert kept((*HERE, 1.0, OWN, True), (*HERE, 1.0, OTHER, True)) == [True, False]
    assert kept((*HERE, 1.0, OTHER, True), (*HERE, 1.0, OWN, True)) == [False, True]
    close = (HERE[0] + 1e-7, HERE[1])
    fold = [(*HERE, 1.0, OTHER, True), (*ELSEWHERE, -1.0, 0, False), (*close, 1.0, 5, True)]
    assert kept(*fold) == [True, False, False]
    assert kept(*fold, (*ELSEWHERE, -1.0, 9, False)) == [True, False, False, True]
    # one whose K has the same sign is not the other side of the fold
    assert kept(*fold[::2], (*ELSEWHERE, 1.0, 0, False)) == [True, False, True]


@pytest.mark.kernels
def test_samples_on_both_sides_of_a_seam_meet() -> None:
    ends = (0.0, 0.77, 1.0, OTHER, True), (2.0 * np.pi, 0.77, 1.0, OTHER, True)
    assert kept(*ends) == [True, False]


@pytest.mark.kernels
def test_samples_that_do_not_meet_are_kept() -> None:
    assert all(kept((*HERE, 1.0, OWN, True), (*ELSEWHERE, 1.0, OTHER, True)))
    assert all(kept((*HERE, 1.0, OWN, True), (*HERE, -1.0, OTHER, True)))
    assert all(kept((*HERE, 1.0, OWN, True), (*HERE, 1.0, OTHER, False)))
    assert all(kept((*HERE, 1.0, OWN, False), (*HERE, 0.0, OTHER, False)))


@pytest.mark.kernels
def test_next_to_a_pole_parameters_do_not_matter_and_nothing_goes_along() -> None:
    fold = (*HERE, 1.0, OWN, True), (*HERE, 1.0, OTHER, True), (*ELSEWHERE, -1.0, 0, False)
    assert kept(*fold, at_pole=True) == [True, False, True]


def test_a_point_that_is_covered_twice_is_two_samples() -> None:
    """A torus around which u goes twice: at one point the parameters are a turn apart."""
    torus = gm.surfaces.torus()
    twice = gm.Surface.from_callable(
        lambda u, v: torus.evaluate(u % (2.0 * np.pi), v), ((0.0, 4.0 * np.pi), TURN), (True, True)
    )
    normals = gm.fibonacci(200)
    samples = gm.sample(twice, normals=normals, cells=(40, 16))
    assert (np.bincount(samples.normal_index) == 4).all()


def repeated(samples: gm.Samples, periodic: tuple[bool, bool]) -> int:
    """Return how many samples on the surface have the normal and parameters of another one."""
    assert samples.on_surface is not None
    there = np.flatnonzero(samples.on_surface)
    there = there[np.argsort(samples.normal_index[there], kind="stable")]
    number, count = samples.normal_index[there], 0
    for k in range(1, int(np.bincount(number).max())):
        away = np.abs(samples.uv[there[k:]] - samples.uv[there[:-k]])
        away = np.where(periodic, np.minimum(away, np.abs(2.0 * np.pi - away)), away)
        count += int(((number[k:] == number[:-k]) & (away < 1e-9).all(axis=1)).sum())
    return count


def not_listed(samples: gm.Samples, count: int) -> NDArray[np.bool_]:
    """Return which normals have no points of the spline that could not be moved, in their boxes."""
    found = np.ones(count, dtype=np.bool_)
    for normal, box, kind, *_ in samples.report.undecided or ():
        found[normal] = False
        assert kind == "unmoved"
        assert (np.diff(np.reshape(box, (2, 2))) > 0.0).all()
    return found


CURVED: dict[str, tuple[gm.Surface, tuple[bool, bool]]] = {
    "figure 8": (gm.Surface.from_callable(klein, (TURN, TURN), (False, True)), (False, True)),
    "knobby": (
        gm.Surface.from_sympy(KNOBBY, ("u", "v"), (TURN, TURN), (True, True)),
        (True, True),
    ),
    "wavy": (gm.surfaces.wavy_graph(amplitude=0.1, frequency=8.0), (False, False)),
}
# Of the figure 8, one that was found twice at one place, with the default number of cells.
TWICE = [0.04430118180966494, 0.19546534701936175, -0.9797094994971047]


@pytest.mark.usefixtures("unproved")
@pytest.mark.filterwarnings("ignore:.*could not be moved")
@pytest.mark.parametrize("cells", [(20, 20), None])
@pytest.mark.parametrize("name", CURVED)
@pytest.mark.quick_for("cells0")
def test_no_sample_of_a_normal_is_repeated(name: str, cells: tuple[int, int] | None) -> None:
    surface, periodic = CURVED[name]
    normals = np.concatenate([[TWICE], gm.directions.random(3000, seed=3)])
    on_spline, on_surface = (
        gm.sample(surface, normals=normals, cells=cells, on=x) for x in ("spline", "surface")
    )
    assert repeated(on_surface, periodic) == 0
    before, after = (
        np.bincount(x.normal_index, np.copysign(1.0, x.gaussian_curvature), len(normals))
        for x in (on_spline, on_surface)
    )
    sure = not_listed(on_surface, len(normals))
    np.testing.assert_array_equal(before[sure], after[sure])
    stream = gm.sample_stream(surface, normals=normals, cells=cells, chunk=500)
    same_chunks(stream, on_surface, 500)


@pytest.mark.usefixtures("unproved")
@pytest.mark.filterwarnings("ignore:.*could not be moved")
@pytest.mark.parametrize("cells", [8, 16])
def test_folds_of_a_coarse_spline_are_no_folds_of_the_surface(cells: int) -> None:
    band, normals = gm.surfaces.moebius_band(), gm.fibonacci(3000)
    folded = gm.sample(band, normals=normals, cells=(cells, cells), on="spline")
    samples = gm.sample(band, normals=normals, cells=(cells, cells), on="surface")
    assert samples.on_surface.all()
    assert (samples.gaussian_curvature < 0.0).all()
    assert (folded.gaussian_curvature > 0.0).any()
    assert np.bincount(samples.normal_index).max() <= 2
    before, after = (
        np.bincount(x.normal_index, np.sign(x.gaussian_curvature), 3000) for x in (folded, samples)
    )
    sure = not_listed(samples, 3000)
    assert sure.mean() > 0.9
    np.testing.assert_array_equal(before[sure], after[sure])


# --- poles ----------------------------------------------------------------------------------------


def check_once(surface: gm.Surface, cells: int, normals: Array, euler: int = 1) -> gm.Samples:
    samples = gm.sample(surface, normals=normals, cells=(cells, cells), on="surface")
    assert samples.on_surface is not None
    signs = np.sign(samples.gaussian_curvature)
    totals = np.bincount(samples.normal_index, signs, minlength=len(normals))
    assert (totals[not_listed(samples, len(normals))] == euler).all()
    return samples


@pytest.mark.parametrize(("shift", "factor"), MOTIONS)
@pytest.mark.parametrize(
    ("shape", "count", "cells"),
    [(egg, 400, 20), *(pytest.param(x, 20_000, 64, marks=pytest.mark.slow) for x in (egg, blob))],
)
def test_every_normal_once(
    shape: Callable[[Array, Array], Array], count: int, cells: int, shift: float, factor: float
) -> None:
    surface = moved(shape, 2, shift, factor)
    assert surface.differences is not None
    normals = [gm.fibonacci(count), gm.icosphere(4)]
    for end in LATITUDES:
        normals.append(next_to(evaluate_on_surface(
            surface, gm.fit(surface, (16, 16)), np.array([[0.0, end]])
        )[1][0]))  # fmt: skip
    wanted = np.concatenate(normals)
    samples = check_once(surface, cells, wanted)
    if shape is blob:
        return
    assert len(samples) == len(wanted)
    assert samples.on_surface.all()
    assert (samples.gaussian_curvature > 0.0).all()
    # Far from the origin, differences tell normals to ε |x|/step of a surface of size 1.
    error = 1e-11 if shift == 0.0 else 1e-6
    away = np.abs(np.abs(samples.uv[:, 1]) - np.pi / 2) > 1e-2
    found = normals_at(moved(egg, 2, 0.0, 1.0), samples.uv[away])
    assert np.abs(found - samples.normals[away]).max() < error


def test_poles_at_the_ends_of_u() -> None:
    """The same surface with exchanged parameters has opposite normals."""
    along_v = gm.Surface.from_callable(egg, (TURN, LATITUDES), (True, "pole"))
    along_u = gm.Surface.from_callable(lambda v, u: egg(u, v), (LATITUDES, TURN), ("pole", True))
    normals = gm.fibonacci(500)
    first, second = check_once(along_v, 16, normals), check_once(along_u, 16, -normals)
    order = np.argsort(first.normal_index), np.argsort(second.normal_index)
    np.testing.assert_allclose(first.points[order[0]], second.points[order[1]], atol=1e-10)
    np.testing.assert_allclose(
        first.mean_curvature[order[0]], -second.mean_curvature[order[1]], atol=1e-6
    )


@pytest.mark.kernels
def test_curvatures_at_poles() -> None:
    """K and H at the poles of an ellipsoid: c²/(a² b²) and c (a² + b²)/(2 a² b²)."""
    a, b, c = 1.0, 0.6, 0.3
    ellipsoid = gm.surfaces.ellipsoid(a=a, b=b, c=c)
    away = np.array([0.0, 1e-14, 1e-10, 1e-8, 1e-6])
    uv = np.stack([np.full(10, 0.7), np.concatenate([np.pi / 2 - away, away - np.pi / 2])], axis=1)
    spline = gm.fit(ellipsoid, (16, 16))
    _, normals, K, H = evaluate_on_surface(ellipsoid, spline, uv)
    np.testing.assert_allclose(normals[:5, 2], 1.0, atol=1e-10)
    np.testing.assert_allclose(normals[5:, 2], -1.0, atol=1e-10)
    np.testing.assert_allclose(K, c**2 / (a * b) ** 2, rtol=1e-6)
    np.testing.assert_allclose(H, c * (a * a + b * b) / (2.0 * a * a * b * b), rtol=1e-6)


@pytest.mark.kernels
def test_curvature_at_any_distance_from_a_pole() -> None:
    """A NURBS is an ellipsoid 5 from the origin: its derivatives by the angle are differences."""
    a, b, c = 1.0, 0.7, 1.3
    ellipsoid = revolved(MERIDIAN, HALF, [a, b, c], [5.0, 0.0, 0.0], periodic=(True, "pole"))
    away = 2.0 ** -np.arange(4.0, 50.0)
    uv = np.stack([np.full(len(away), 0.7), 2.0 - away], axis=1)
    _, normals, K, _ = evaluate_on_surface(ellipsoid, gm.fit(ellipsoid, (16, 16)), uv)
    exact = np.square(np.square(normals * [a, b, c]).sum(axis=1) / (a * b * c))
    np.testing.assert_allclose(K, exact, rtol=2.0**-14)
