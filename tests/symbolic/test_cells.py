"""The best cells of a quadratic patch, exactly."""

import mpmath as mp
import sympy as sp
from gaussmap.symbolic.cells import (
    ALIGNED,
    CHORD,
    HEXAGON,
    area,
    gradient,
    kappa1,
    kappa2,
    legs,
    radius,
    theta,
    turned_triangle,
    turning,
)

SYMBOLS = (kappa1, kappa2, radius, theta)


def test_constants():
    assert sp.sqrt(2) / 2 == ALIGNED
    assert sp.simplify(HEXAGON**2 - 2 / (3 * sp.sqrt(3))) == 0
    assert sp.simplify(CHORD - 1 / (3 * sp.sqrt(3))) == 0


def test_normals_turn_as_much_along_both_sides_of_the_best_rectangle():
    p, q = legs()
    assert sp.simplify(p * q - area) == 0
    assert sp.simplify(kappa1 * p - kappa2 * q) == 0


def test_triangles_of_a_rectangle_deviate_as_much_as_its_corners():
    """Their normal is that of the patch in the middle of the rectangle, whatever its sides are."""
    p, q = legs()
    for corners in ([(0, 0), (p, 0), (p, q)], [(0, 0), (p, q), (0, q)]):
        middle = sp.Matrix([kappa1 * p / 2, kappa2 * q / 2])
        assert sp.simplify(gradient(corners) - middle) == sp.zeros(2, 1)
        worst = [turning(corners, corner) for corner in corners]
        expected = ALIGNED * sp.sqrt(kappa1 * kappa2 * area)
        assert all(sp.simplify(x - expected) == 0 for x in worst)


def lean(first, second, turn):
    """The gradient of the plane of a turned triangle, for κ₁ = 5, κ₂ = 1/3 and R = 2."""
    with mp.workdps(30):
        found = sp.lambdify(SYMBOLS, gradient(turned_triangle(first, second)).flat(), "mpmath")
        return found(mp.mpf(5), mp.mpf(1) / 3, mp.mpf(2), mp.mpf(turn))


def test_turned_triangles_of_the_third_form_deviate_without_bound():
    """Their plane leans across the narrow side by (κ₁/κ₂ − 1) R cos 3θ / 4."""
    for turn in (0, 0.2, 2):
        found = lean(kappa1, kappa2, turn)
        with mp.workdps(30):
            expected = (
                -14 * mp.cos(3 * mp.mpf(turn)) / 2,
                -(14 / mp.mpf(15)) * mp.sin(3 * mp.mpf(turn)) / 2,
            )
        assert max(abs(x - y) for x, y in zip(found, expected, strict=True)) < 1e-25


def test_turned_triangles_of_the_safe_metric_lie_as_the_patch():
    """On elliptic patches κ₁ |II| makes the plane that of the normal in the circumcentre."""
    for turn in (0, 0.2, 2):
        assert max(map(abs, lean(kappa1, sp.sqrt(kappa1 * kappa2), turn))) < 1e-25
