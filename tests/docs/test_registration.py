"""The parts, starts and errors of docs/registration.md, and its page against a fresh run."""

import math
from pathlib import Path

import numpy as np
import pytest
from gaussmap.docs import registration
from scipy.spatial.transform import Rotation

PAGE = (Path(registration.__file__).parent / "registration.md").read_text(encoding="utf-8")
ROUNDING = 32 * np.finfo(float).eps  # of some products of numbers up to 1
# Half of the last digit of two printed numbers, and what the order of sums in parallel does to ICP.
DIGITS = 0.0021


def test_starts_turn_by_what_is_said_and_slide_no_farther():
    for seed in range(20):
        motion = registration.start(np.random.default_rng(seed), 2.0)
        R, t = motion[:3, :3], motion[:3, 3]
        np.testing.assert_allclose(R @ R.T, np.eye(3), rtol=0, atol=ROUNDING)
        turn = math.degrees(Rotation.from_matrix(R).magnitude())
        # The angle of a matrix that is off by ε is off by about ε, in radians.
        assert turn == pytest.approx(registration.TURN, rel=0, abs=math.degrees(ROUNDING))
        assert (np.abs(t) <= [2.0, 2.0, registration.LIFT]).all()


def test_starts_differ():
    found = [registration.start(np.random.default_rng(x), 1.0) for x in (1, 2)]
    assert (found[0] != found[1])[:3].all()


@pytest.mark.parametrize("degrees", [1e-6, 1.0, 90.0, 180.0])
def test_errors_of_a_known_motion(degrees):
    motion = np.eye(4)
    motion[:3, :3] = Rotation.from_rotvec(np.radians([0.0, 0.0, degrees])).as_matrix()
    motion[:3, 3] = [0.0, 3.0, 4.0]
    result = registration.Errors()
    result.add(motion, np.zeros((2, 3)))
    assert result.turns == pytest.approx([degrees], rel=0, abs=math.degrees(ROUNDING))
    assert result.shifts == result.points == [5.0]
    assert result.failed == 1
    result.add(np.eye(4), np.ones((2, 3)))
    assert (result.turns[1], result.points[1], result.failed) == (0.0, 0.0, 1)


@pytest.mark.parametrize("part", registration.PARTS, ids=lambda x: x.title)
def test_places_lie_on_the_part(part):
    places = part.places(np.random.default_rng(3), 100)
    assert places.shape == (100, 3)
    if "sphere" in part.title:
        np.testing.assert_allclose(np.linalg.norm(places, axis=1), 30.0, rtol=ROUNDING)
    else:
        np.testing.assert_array_equal(part.surface.evaluate(*places[:, :2].T), places)


@pytest.mark.parametrize("part", registration.PARTS[:3], ids=lambda x: x.title)
def test_slopes_of_plates_are_so_small_that_places_are_uniform_by_area(part):
    u = np.linspace(-50, 50, 1001)
    z = part.surface.evaluate(u[:, None], u)[..., 2]
    slopes = np.hypot(*np.gradient(z, u, u))
    # Slopes of a bump or a groove reach 1.05 e^(−1/2) / 3 = 0.21, of the plate 0.07; two grooves
    # cross at nearly right angles.
    assert slopes.max() < 0.21 * math.sqrt(2) * 1.1 + 0.07 < 0.4


def rows(label, density):
    lines = [x.strip("| ").split(" | ") for x in PAGE.splitlines() if x.startswith("|")]
    return [x[2:] for x in lines if x[:2] == [label, density]]


def test_page_has_all_rows():
    labels = [f"{x:,}" for x in registration.COUNTS] + [x.title for x in registration.PARTS[1:]]
    assert all(len(rows(x, y)) == 1 for x in labels for y in registration.DENSITIES)
    slides = [f"{x:g} mm" for x in registration.SLIDES]
    assert all(len(rows(x, y)) == 1 for x in slides for y in registration.PLANS)


def test_page_shows_where_it_helps_and_where_not():
    def points(label, density):
        return float(rows(label, density)[0][4])

    def failed(label, density):
        return int(rows(label, density)[0][5].split()[0])

    for label in ("100", "500"):
        assert max(points(label, x) for x in ("gauss", "balanced")) < points(label, "uniform")
    assert failed("8 mm", "gauss") > failed("8 mm", "uniform")
    assert failed("8 mm", "uniform → gauss") <= failed("8 mm", "uniform") + 1
    alone = [failed("the plate alone", x) for x in registration.DENSITIES]
    assert min(alone) > registration.SEEDS / 2


@pytest.mark.compiled
def test_committed_numbers_are_those_of_a_fresh_run():
    pytest.importorskip("open3d")
    part = registration.BUMPS
    plans = [[registration.samples(part, x, registration.COUNT)] for x in ("uniform", "gauss")]
    fresh = registration.errors(part, plans, registration.SLIDES[0])
    for density, result in zip(("uniform", "gauss"), fresh, strict=True):
        committed = rows(f"{registration.COUNT}", density)[0]
        numbers = [[float(x) for x in cells[:5]] for cells in (result.cells(), committed)]
        np.testing.assert_allclose(*numbers, rtol=0, atol=DIGITS)
        assert result.cells()[5] == committed[5]
