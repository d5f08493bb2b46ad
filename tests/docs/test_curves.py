"""The measurements of docs/curves.py against theory, and the committed page against a fresh run."""

import re
from functools import cache
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.docs import curves

pytestmark = [pytest.mark.compiled, pytest.mark.slow]

PAGE = (Path(curves.__file__).parent / "curves.md").read_text(encoding="utf-8")
EACH_CURVE = pytest.mark.parametrize("true", curves.CURVES, ids=lambda x: x.name)
CIRCLE = curves.TrueCurve("circle", (sp.cos(curves.t), sp.sin(curves.t)), curves.TURN, True, "")
DIGITS = 0.006  # relative: a number with three digits is off by half of the last one


def cells(line: str) -> list[str]:
    return [x.strip(" `") for x in line.strip("|\n").split("|")]


@cache
def committed() -> dict[tuple[str, str], list[str]]:
    """Return the rows of both tables by curve and M, or by curve and quantity."""
    rows = (cells(x) for x in PAGE.splitlines() if x.startswith("| `"))
    return {(name, second): others for name, second, *others in rows}


@EACH_CURVE
def test_committed_comparisons_are_those_of_a_fresh_run(true):
    for count in curves.COUNTS[:3]:
        _, vertices, *fresh = curves.row(true, curves.compare(true, count))
        there = committed()[true.name, vertices]
        np.testing.assert_allclose(
            [float(x) for x in fresh], [float(x) for x in there], rtol=2 * DIGITS
        )


def test_every_comparison_is_there():
    numbers = {name: [] for name, _ in committed()}
    for name, second in committed():
        if second.isdigit():
            numbers[name].append(int(second))
    for vertices in numbers.values():
        np.testing.assert_allclose(vertices, curves.COUNTS, rtol=0.1)
    assert list(numbers) == [x.name for x in curves.CURVES]


@EACH_CURVE
def test_committed_errors_are_those_of_a_fresh_run(true):
    columns = np.array([curves.spline_errors(true, pieces) for pieces in curves.GRIDS[:3]])
    for quantity, fresh in zip(curves.QUANTITIES, columns.T, strict=True):
        there = [float(x) for x in committed()[true.name, quantity][:3]]
        np.testing.assert_allclose(fresh, there, rtol=DIGITS)


@pytest.mark.parametrize("name", ["ellipse", "eight", "star", "corner"])
def test_orders(name):
    (true,) = [x for x in curves.CURVES if x.name == name]
    grids = (256, 512)
    errors = zip(*(curves.spline_errors(true, x) for x in grids), strict=True)
    faster = 1.0 if name == "ellipse" else 0.0  # its third derivative is tangent
    for order, (quantity, found) in zip(
        (3, 2 + faster, 3 + faster), zip(curves.QUANTITIES, errors, strict=True), strict=True
    ):
        slope = curves.slope(grids, found)
        # the next order is still felt where the curve has a sharp bend
        assert order - 0.1 < slope < order + 0.3, quantity


def test_on_a_circle_both_polygons_are_regular():
    for count in (5, 12, 100):
        compared = curves.compare(CIRCLE, count)
        for polygon in (compared.parameter, compared.normal):
            assert polygon.vertices == count
            # at most π/40 000 from the middle of an edge, and as far from its ends
            step = np.pi / curves.DENSE
            height = 1 - np.cos(np.pi / count)
            assert height - 2 * step**2 < polygon.distance < height + 1e-6
            assert 180 / count - 0.01 < polygon.angle < 180 / count + 1e-4


def test_on_an_ellipse_the_quotient_is_that_of_theory():
    """κ ℓ²/8: largest a (2π/M)²/8 for the parameter, (2π/M)²/(8 κ) with κ = b/a² for the normal."""
    (true,) = [x for x in curves.CURVES if x.name == "ellipse"]
    compared = curves.compare(true, 256)
    unit = (2 * np.pi / 256) ** 2 / 8
    assert compared.parameter.distance == pytest.approx(2 * unit, rel=0.01)
    assert compared.normal.distance == pytest.approx(4 * unit, rel=0.02)


@pytest.mark.parametrize(("name", "order"), [("ellipse", 2.0), ("star", 1.5)])
def test_distances_fall_as_the_page_says(name, order):
    """With inflections as M^(−3/2); two counts far apart, for where the normals fall varies."""
    (true,) = [x for x in curves.CURVES if x.name == name]
    pair = [curves.compare(true, count).normal for count in (60, 960)]
    slope = curves.slope([x.vertices for x in pair], [x.distance for x in pair])
    assert slope == pytest.approx(order, abs=0.1)


def test_the_angle_is_never_worse():
    for (_, second), row in committed().items():
        if second.isdigit():
            assert float(row[-1]) > 1.0


def test_words_follow_from_the_numbers():
    text = " ".join(PAGE.split())
    ratios = {}
    for (name, second), row in committed().items():
        if second.isdigit():
            ratios.setdefault(name, []).append(float(row[2]))
    better = re.search(r"cut off sharp corners, on (.*?) for some M", text)
    worse = re.search(r"M resolves the corners: on (.*?) for M ≈ 256", text)
    assert better is not None
    assert worse is not None
    assert re.findall(r"`(\w+)`", better[1]) == [x for x, y in ratios.items() if max(y) > 1.0]
    assert re.findall(r"`(\w+)`", worse[1]) == [x for x, y in ratios.items() if y[-1] < 1.0]


def test_newton_that_fails_is_said():
    spline = gm.curves.fit(CIRCLE.curve, 64)
    other = curves.TrueCurve("other", (curves.t, curves.t**2), curves.TURN, False, "")
    with pytest.raises(ArithmeticError, match="fails on other"):
        curves.support_error(other, spline)


def test_a_faster_curve_needs_a_reason():
    measured = curves.Measurement(
        curves.CURVES[1], [], [[1.0, float(x) ** -3, 1.0] for x in curves.GRIDS]
    )
    with pytest.raises(ArithmeticError, match="without a known reason"):
        curves.faster([measured])
