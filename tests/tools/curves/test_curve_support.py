"""Support functions of planar curves: branches, convolution, offset and motions."""

from typing import Any, cast

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.curves import Curve, SupportFunction

from ...refusals import refused

NORMALS = gm.directions.circle(90)
TURN = (0, "2*pi")
of_spline = SupportFunction.of_spline


def ellipse(a: float, b: float) -> SupportFunction:
    curve = Curve.from_sympy((f"{a}*cos(t)", f"{b}*sin(t)"), "t", TURN, True)
    return of_spline(curve, 256)


def support_of_ellipse(a: float, b: float) -> np.ndarray:
    return np.hypot(a * NORMALS[:, 0], b * NORMALS[:, 1])


EIGHT = of_spline(Curve.from_sympy(("sin(t)", "sin(2*t)"), "t", TURN, True), 128)
# The error of splines with 256 pieces is below this: h³ with h = 2π/256, and size 3.
NEAR = 3.0 * (2.0 * np.pi / 256) ** 3


def test_values_are_those_of_the_curve():
    branches = ellipse(3, 1).branches(NORMALS)
    assert np.abs(branches.support - support_of_ellipse(3, 1)).max() < NEAR
    exact = support_of_ellipse(3, 1)
    assert np.abs(branches.radius / (9.0 / exact**3) - 1.0).max() < 0.02
    assert (branches.normal_index == np.arange(len(NORMALS))).all()


def test_branches_are_the_samples():
    samples = gm.curves.sample(EIGHT.spline, normals=NORMALS)  # pyright: ignore
    branches = EIGHT.branches(NORMALS)
    order = np.argsort(samples.normal_index, kind="stable")
    assert (branches.points == samples.points[order]).all()
    assert np.allclose(branches.curvature, samples.curvature[order], rtol=1e-15)
    assert np.abs((branches.points * branches.normals).sum(axis=1) - branches.support).max() < 1e-15


def test_convolution_adds_support_functions():
    total = (ellipse(3, 1) + ellipse(1, 2)).branches(NORMALS)
    exact = support_of_ellipse(3, 1) + support_of_ellipse(1, 2)
    assert np.abs(total.support - exact).max() < 2 * NEAR
    assert np.abs((total.points * NORMALS).sum(axis=1) - total.support).max() < 1e-14


def test_convolution_has_all_pairs():
    count = np.bincount(EIGHT.branches(NORMALS).normal_index, minlength=len(NORMALS))
    total = (EIGHT + EIGHT).branches(NORMALS)
    assert (np.bincount(total.normal_index, minlength=len(NORMALS)) == count**2).all()
    assert count.max() > 1
    assert len(sum([EIGHT, EIGHT]).branches(NORMALS)) == len(total)  # pyright: ignore


def test_the_offset_is_the_convolution_with_a_circle():
    circle = of_spline(Curve.from_sympy(("cos(t)/2", "sin(t)/2"), "t", TURN, True), 256)
    offset, total = (
        x.branches(NORMALS) for x in (ellipse(3, 1).offset(0.5), ellipse(3, 1) + circle)
    )
    assert np.abs(offset.points - total.points).max() < NEAR
    assert np.abs(offset.radius - total.radius).max() < 0.01


def test_an_offset_folds_where_the_radius_becomes_negative():
    inside = ellipse(3, 1).offset(-1.0).branches([[1, 0], [0, 1]])  # radii 1/3 and 9
    assert inside.radius[0] < 0 < inside.radius[1]


def test_motions_move_points_and_keep_radii():
    h = ellipse(3, 1)
    plain, turned = h.branches(NORMALS), h.rotated(90.0).branches(NORMALS[:, ::-1] * [-1, 1])
    assert np.abs(turned.points - plain.points[:, ::-1] * [-1, 1]).max() < 1e-14
    assert np.abs(turned.radius / plain.radius - 1).max() < 1e-9
    moved = h.translated((2, -1)).branches(NORMALS)
    assert np.abs(moved.points - plain.points - [2, -1]).max() < 1e-15
    assert np.abs(moved.support - plain.support - NORMALS @ [2, -1]).max() < 1e-14
    scaled = h.scaled(-2).branches(NORMALS)
    assert (scaled.points == -2 * plain.points).all()
    assert (scaled.radius == -2 * plain.radius).all()


def test_reversing_twice_is_the_curve():
    plain, again = (x.branches(NORMALS) for x in (EIGHT, EIGHT.reversed().reversed()))
    assert (plain.points == again.points).all()
    assert (plain.radius == again.radius).all()
    opposite = EIGHT.reversed().branches(NORMALS)
    assert (opposite.points == EIGHT.branches(-NORMALS).points).all()
    assert np.abs((opposite.points * opposite.normals).sum(axis=1) - opposite.support).max() < 1e-15


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: of_spline(cast(Any, "circle")), "Curve"),
        (lambda: of_spline(cast(Any, EIGHT).spline, 12), "pieces"),
        (lambda: EIGHT.branches([[0, 0]]), "zero"),
        (lambda: EIGHT.offset(np.nan), "distance"),
        (lambda: EIGHT.translated((1, 2, 3)), "shift"),
        (lambda: EIGHT.rotated(np.inf), "angle"),
        (lambda: EIGHT.scaled(0), "factor"),
    ],
)
def test_bad_input(call, words):
    refused(words, call, error=gm.GaussmapError)
    with pytest.raises(TypeError):
        EIGHT + 1  # pyright: ignore
