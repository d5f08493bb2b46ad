"""The best cells of a quadratic patch, exactly."""

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
    turning,
)


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
