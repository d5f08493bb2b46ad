"""Tapes of NURBS: derivatives and bounds, compared with exact rational arithmetic."""

from fractions import Fraction
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.tape.kernels.balls import BALL, bounds_of_boxes
from gaussmap.runtime.tape.kernels.points import POINT, Tape, points_jets
from gaussmap.runtime.tape.kernels.rounding import rounding_of_boxes

ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))
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
            for lower, sign, knot, width in (
                (old[r], 1, knots[span - j + r], knots[span + r] - knots[span - j + r]),
                (
                    old[r + 1],
                    -1,
                    knots[span + 1 + r],
                    knots[span + 1 + r] - knots[span + 1 - j + r],
                ),
            ):
                for k, value in enumerate(lower[1:]):
                    share = sign * value / width
                    row[k] += share * (x - knot)
                    row[k + 1] += share
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


def graph(degrees: tuple[int, int], knots: tuple[float, ...], rational: bool) -> gm.Surface:
    """Return a NURBS graph with random heights over [0, 2] × [0, 2]."""
    random = np.random.default_rng(3)
    vectors = [[0.0] * (p + 1) + [*knots] + [2.0] * (p + 1) for p in degrees]
    m, n = (len(knots) + p + 1 for p in degrees)
    x, y = np.meshgrid(np.linspace(0, 2, m), np.linspace(0, 1, n), indexing="ij")
    points = np.stack([x, y, 0.2 * random.normal(size=x.shape)], axis=-1) + 3.0
    weights = random.uniform(0.5, 2.0, (m, n)) if rational else None
    return gm.Surface.from_nurbs(degrees, vectors, points, weights)


def tape_of(surface: gm.Surface) -> Tape:
    assert surface.tape is not None
    return surface.tape


def bounds(tape: Tape, centres: np.ndarray, widths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return balls (k, 2, 10, 3) of Taylor coefficients on boxes, and errors (k, 6, 3) in them."""
    middles, radii, errors = (np.empty(BALL * (len(tape.operations) + 1)) for _ in range(3))
    balls, ends = np.empty((len(centres), 2, 10, 3)), np.empty((2, 4))
    bounds_of_boxes(tape, 3, centres, widths, middles, radii, ends, balls)
    rounding = np.empty((len(centres), 6, 3))
    rounding_of_boxes(tape, centres, widths, middles, radii, errors, ends, rounding)
    return balls, rounding


def jets(tape: Tape, places: np.ndarray) -> np.ndarray:
    """Return the Taylor coefficients (k, 6, 3) at places (k, 2)."""
    found = np.empty((len(places), 6, 3))
    u, v = (np.ascontiguousarray(x) for x in places.T)
    points_jets(tape, u, v, np.empty(POINT * len(tape.operations)), found)
    return found / np.array([1, 1, 1, 2, 1, 2])[:, None]


def boxes(count: int, width: float, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return centres and half widths of boxes in [0, 2] × [0, 2], and a place in each."""
    random = np.random.default_rng(seed)
    centres, widths = random.uniform(width, 2.0 - width, (count, 2)), np.full((count, 2), width)
    shares = random.uniform(-1.0, 1.0, (count, 2))
    shares = np.where(random.random((count, 2)) < 0.5, np.sign(shares), shares)
    return centres, widths, np.nextafter(centres + shares * widths, centres)


def check(surface: gm.Surface, found: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    centres, widths, places = found
    balls, errors = bounds(tape_of(surface), centres, widths)
    computed = jets(tape_of(surface), places)
    for k, place in enumerate(places.tolist()):
        exact = exact_coefficients(surface.function, *place)
        for order in range(10):
            for axis in range(3):
                middle, radius = balls[k, :, order, axis].tolist()
                if np.isfinite(radius):
                    distance = abs(exact[order, axis] - Fraction(middle))
                    assert distance <= Fraction(radius), (place, order)
                if order < 6:
                    distance = abs(exact[order, axis] - Fraction(float(computed[k, order, axis])))
                    assert distance <= Fraction(float(errors[k, order, axis])), (place, order)


# --- tests ----------------------------------------------------------------------------------------

CASES = [
    ((3, 3), KNOTS, False),
    ((3, 3), KNOTS, True),
    ((2, 4), KNOTS[:2], True),
    ((3, 2), (0.6, 0.6, 1.3), False),
    ((1, 3), (), True),
    ((6, 5), KNOTS[:1], True),
]


@pytest.mark.parametrize("width", [0.2, 0.02, 1e-6, 0.0])
@pytest.mark.parametrize(("degrees", "knots", "rational"), CASES)
def test_bounds_contain_exact_values(degrees, knots, rational, width):
    check(graph(degrees, knots, rational), boxes(12, width, 1))


def test_radii_are_finite_between_knots_up_to_their_ends():
    surface = graph((2, 2), KNOTS, True)
    ends = np.array([0.0, *KNOTS, 2.0])
    middles, halves = (ends[1:] + ends[:-1]) / 2, np.diff(ends) / 2
    centres = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    widths = np.stack(np.meshgrid(halves, halves), axis=-1).reshape(-1, 2)
    balls, _ = bounds(tape_of(surface), centres, widths)
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
    balls, errors = bounds(tape, np.array([[0.6, 1.0]]), np.array([[0.1, 0.1]]))
    unbounded = [k for k in range(10) if np.isinf(balls[0, 1, k]).all()]
    assert unbounded == orders
    assert np.isfinite(errors).all()


def test_bounds_of_single_polynomials_are_attained():
    """A tenth less would be wrong: at corners of small boxes the error is the radius."""
    surface = graph((3, 3), (), False)
    centres, widths, _ = boxes(20, 0.01, 4)
    balls, _ = bounds(tape_of(surface), centres, widths)
    used = np.zeros(balls[:, 1].shape)
    for signs in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        for k, place in enumerate((centres + np.array(signs) * widths).tolist()):
            exact = exact_coefficients(surface.function, *place).astype(np.float64)
            used[k] = np.maximum(used[k], np.abs(exact - balls[k, 0]) / (balls[k, 1] + 1e-300))
    assert np.median(used[:, 6:, 2]) > 0.9
