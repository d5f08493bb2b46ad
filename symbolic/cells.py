"""Optimal cells of samples and of meshes on a quadratic patch, and the errors of these cells.

Over its tangent plane a surface is z = (κ₁ x² + κ₂ y²)/2, up to terms of third order, and its
normal turns by the gradient (κ₁ x, κ₂ y). All formulas are exact for that patch.
"""

from collections.abc import Sequence

import sympy as sp

kappa1, kappa2, area, radius = sp.symbols("kappa1 kappa2 A R", positive=True)
theta = sp.Symbol("theta", real=True)
Corner = Sequence[sp.Expr]


def height(x: sp.Expr, y: sp.Expr) -> sp.Expr:
    """Return the height z over a point of the tangent plane."""
    return (kappa1 * x**2 + kappa2 * y**2) / 2


def gradient(corners: Sequence[Corner]) -> sp.Matrix:
    """Return the gradient of the plane through three points of the patch, given by (x, y)."""
    p, *others = corners
    edges = sp.Matrix([[q[0] - p[0], q[1] - p[1]] for q in others])
    rises = sp.Matrix([height(*q) - height(*p) for q in others])
    return edges.adjugate() * rises / edges.det()


def turning(corners: Sequence[Corner], place: Corner) -> sp.Expr:
    """Return the angle between the plane through `corners` and the tangent plane at `place`.

    For small angles, it is approximated by the length of the difference of their gradients.
    """
    off = gradient(corners) - sp.Matrix([kappa1 * place[0], kappa2 * place[1]])
    return sp.sqrt(sp.simplify(off.dot(off)))


def legs() -> tuple[sp.Expr, sp.Expr]:
    """Return the sides, along x and y, of the rectangle of area A in which normals turn least.

    The angle that is minimized is the largest one: between the normals in the middle and at a
    corner.
    """
    p = sp.Symbol("p", positive=True)
    squared = (kappa1 * p / 2) ** 2 + (kappa2 * area / p / 2) ** 2
    (best,) = sp.solve(sp.diff(squared, p), p)
    return best, sp.simplify(area / best)


def _aligned() -> sp.Expr:
    p, q = legs()
    corner = sp.sqrt((kappa1 * p / 2) ** 2 + (kappa2 * q / 2) ** 2)
    return sp.simplify(corner / sp.sqrt(kappa1 * kappa2 * area))


def _hexagon() -> sp.Expr:
    """Return the circumradius of the regular hexagon of area 1."""
    (found,) = sp.solve(6 * radius**2 * sp.sqrt(3) / 4 - 1, radius)
    return found


# The largest angle between normals in the best rectangle and the normal in its middle, divided by
# sqrt(κ₁ κ₂ A). It is also the angle between the normal of a triangle, half of the rectangle, and
# the normals at its corners.
ALIGNED = _aligned()
# The same angle for a regular hexagon, divided by κ₁ sqrt(A), for κ₁ = κ₂. Equilateral triangles of
# the area A/2 have the same circumradius.
HEXAGON = _hexagon()
# For κ₁ = κ₂, the largest distance between the patch and an equilateral triangle of the area A/2,
# divided by κ₁ A. The distance is κ₁ R²/2, at the centre of the triangle; R is its circumradius.
CHORD = HEXAGON**2 / 2


def turned_triangle(first: sp.Expr, second: sp.Expr) -> list[tuple[sp.Expr, sp.Expr]]:
    """Return a triangle that is equilateral in the metric first² dx² + second² dy².

    Its circumradius in this metric is R; it is turned by θ.
    """
    turns = [theta + 2 * sp.pi * k / 3 for k in range(3)]
    return [(radius * sp.cos(x) / first, radius * sp.sin(x) / second) for x in turns]
