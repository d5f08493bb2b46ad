"""The formulas of meshes and of cells, exactly."""

import math

import sympy as sp
from gaussmap.symbolic import formulas
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
from gaussmap.symbolic.notation import scalar

from .calls import components, evaluated


def test_corner_products_of_a_triangle_in_a_plane():
    """The triangle has the area 3 and the normal (0, 0, 1)."""
    corners = components(p0=(1, 1, 5), p1=(4, 1, 5), p2=(2, 3, 5))
    normals = components(n0=(0, 0, 1), n1=(0, 0, -1), n2=(1, 0, 0))
    found = evaluated(formulas["corner_products"], corners | normals)
    assert found == {"s0": 6, "s1": -6, "s2": 0, "L": 6}


def test_border_spacing_is_that_of_samples_of_this_density():
    """In a square lattice of step d half a disk of radius r holds about π r²/(2 d²) points."""
    r, k = sp.Integer(40), sp.S.Zero
    for i in range(-40, 41):
        for j in range(41):
            inside = i * i + j * j <= 1600
            # points on the border count half, as half of their square lies beyond it
            k += sp.Rational(int(inside), 2 if j == 0 else 1)
    spacing = evaluated(formulas["border_spacing"], {scalar("r"): r, scalar("k"): k})["d"]
    # Gauss's circle problem: the number of points is off by less than the perimeter
    assert math.isclose(float(spacing), 1.0, rel_tol=math.pi * 40 / float(k))


def test_corner_cotangents_are_those_of_the_angles():
    """Of 45°, 90° and 45°; and of an angle of tangent 4/3 between equal ones of tangent 2."""
    formula = formulas["corner_cotangents"]
    found = evaluated(formula, components(p0=(0, 0, 0), p1=(2, 0, 0), p2=(2, 0, 2)))
    assert found == {"c0": 4, "c1": 0, "c2": 4, "L": 4}
    found = evaluated(formula, components(p0=(0, 2, 1), p1=(1, 0, 1), p2=(-1, 0, 1)))
    assert found == {"c0": 3, "c1": 2, "c2": 2, "L": 4}


def test_a_ray_meets_a_triangle_where_the_formula_says():
    """From (1, 1, 4) along (0, 0, −2): 2 steps to (1, 1, 0), from the outer side."""
    corners = components(p0=(0, 0, 0), p1=(4, 0, 0), p2=(0, 2, 0))
    ray = components(p=(1, 1, 4), d=(0, 0, -2))
    found = evaluated(formulas["ray_in_triangle"], ray | corners)
    assert [sp.Rational(found[x], found["D"]) for x in "UVT"] == [
        sp.Rational(1, 4),
        sp.Rational(1, 2),
        2,
    ]
    assert found["D"] > 0


# --- the best cells of a quadratic patch ----------------------------------------------------------


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
