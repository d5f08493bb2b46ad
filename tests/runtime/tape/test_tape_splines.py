"""Tapes of NURBS: derivatives and bounds, compared with exact rational arithmetic."""

from fractions import Fraction
from functools import partial
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from .made import ORDERS, balls_on, boxes, check, errors_on, graph, tape_of, used_radii

KNOTS = (0.25, 0.6, 1.1, 1.3)


# --- exact values ---------------------------------------------------------------------------------


def basis_at(knots: list[Fraction], degree: int, span: int, x: Fraction) -> list[list[Fraction]]:
    """Return the basis functions of a span as polynomials in the distance from x."""
    rows = [[Fraction(1)]]
    for j in range(1, degree + 1):
        rows = [[Fraction(0), *row] for row in [[], *rows, []]]
        old, rows = rows, []
        for r in range(j + 1):
            row = [Fraction(0)] * (j + 1)
            for k in (0, 1):  # rising over the support of one function, falling over the next
                start, end = knots[span - j + r + k], knots[span + r + k]
                for power, value in enumerate(old[r + k][1:]):
                    share = (1 - 2 * k) * value / (end - start)
                    row[power] += share * (x - (end if k else start))
                    row[power + 1] += share
            rows.append(row)
    return rows


def exact_coefficients(nurbs: Any, u: float, v: float) -> np.ndarray:
    """Return the Taylor coefficients (10, 3) of a NURBS surface as fractions."""
    along = []
    for knots, degree, x in zip(nurbs.knots, nurbs.degrees, (u, v), strict=True):
        span = int(np.clip(np.searchsorted(knots, x, "right") - 1, degree, len(knots) - degree - 2))
        along.append((span, basis_at([*map(Fraction, knots.tolist())], degree, span, Fraction(x))))
    (i, in_u), (j, in_v) = along
    p, q = nurbs.degrees
    size = nurbs.points.shape[2]
    sums = {
        (a, b): [
            sum(
                (in_u[r][a] * in_v[s][b] * Fraction(float(nurbs.points[i - p + r, j - q + s, c]))
                for r in range(p + 1) for s in range(q + 1)),
                start=Fraction(0),
            ) if a <= p and b <= q else Fraction(0)
            for c in range(size)
        ]
        for a, b in ORDERS
    }  # fmt: skip
    found: dict[tuple[int, int], list[Fraction]] = {}
    for a, b in ORDERS:  # x w = A, order by order
        found[a, b] = [
            (
                sums[a, b][c]
                - sum(
                    (found[k, m][c] * sums[a - k, b - m][3]
                    for k in range(a + 1) for m in range(b + 1) if (k, m) != (a, b)),
                    start=Fraction(0),
                )
            ) / sums[0, 0][3] if size == 4 else sums[a, b][c]
            for c in range(3)
        ]  # fmt: skip
    centre = [Fraction(float(x)) for x in nurbs.centre]
    found[0, 0] = [x + y for x, y in zip(found[0, 0], centre, strict=True)]
    return np.array([found[x] for x in ORDERS], dtype=object)


# --- surfaces -------------------------------------------------------------------------------------


# --- tests ----------------------------------------------------------------------------------------

CASES = [
    ((3, 3), KNOTS, False), ((3, 3), KNOTS, True), ((2, 4), KNOTS[:2], True),
    ((3, 2), (0.6, 0.6, 1.3), False), ((1, 3), (), True), ((6, 5), KNOTS[:1], True),
]  # fmt: skip


@pytest.mark.parametrize("width", [0.2, 0.02, 1e-6, 0.0])
@pytest.mark.parametrize(("degrees", "knots", "rational"), CASES)
def test_bounds_contain_exact_values(degrees, knots, rational, width):
    surface = graph(degrees, knots, rational)
    exact = partial(exact_coefficients, surface.function)
    check(tape_of(surface), exact, boxes(width, 2.0 - width, width, 12, 1))


def test_radii_are_finite_between_knots_up_to_their_ends():
    surface = graph((2, 2), KNOTS, True)
    ends = np.array([0.0, *KNOTS, 2.0])
    middles, halves = (ends[1:] + ends[:-1]) / 2, np.diff(ends) / 2
    centres = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    widths = np.stack(np.meshgrid(halves, halves), axis=-1).reshape(-1, 2)
    balls = balls_on(tape_of(surface), centres, widths)
    assert np.isfinite(balls).all()


@pytest.mark.parametrize(("degree", "knots", "orders"), [
    (3, (0.6,), []),  # second derivatives are continuous: third ones jump, and are bounded
    (2, (0.6,), [6]),
    (3, (0.6, 0.6), [6]),
    (2, (0.6, 0.6), [3, 6, 7]),
])  # fmt: skip
def test_radii_are_infinite_where_derivatives_are_not_bounded(degree, knots, orders):
    surface = graph((degree, 3), (), False)
    nurbs: Any = surface.function
    vectors = [0.0] * (degree + 1) + [*knots] + [2.0] * (degree + 1), nurbs.knots[1]
    random = np.random.default_rng(5)
    points = random.normal(size=(degree + 1 + len(knots), 4, 3))
    tape = tape_of(gm.Surface.from_nurbs((degree, 3), vectors, points))
    box = np.array([[0.6, 1.0]]), np.array([[0.1, 0.1]])
    balls, errors = balls_on(tape, *box), errors_on(tape, *box)
    unbounded = [k for k in range(10) if np.isinf(balls[0, 1, k]).all()]
    assert unbounded == orders
    assert np.isfinite(errors).all()


def test_bounds_of_single_polynomials_are_attained():
    """A tenth less would be wrong: at corners of small boxes the error is the radius."""
    surface = graph((3, 3), (), False)
    centres, widths, _ = boxes(0.01, 1.99, 0.01, 20, 4)
    balls = balls_on(tape_of(surface), centres, widths)
    used = used_radii(balls, partial(exact_coefficients, surface.function), centres, widths)
    assert np.median(used[:, 6:, 2]) > 0.9
