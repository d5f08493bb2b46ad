"""Triangles through points of a surface: deviation, angles, spacing, and curved edges."""

import sympy as sp

from .formula import Formula, Parts, formula
from .notation import Cross, Dot, scalar, vectors

p0, p1, p2, n0, n1, n2 = vectors(("p0", "p1", "p2", "n0", "n1", "n2"))
e, f, g, N, d, p, h, q, s = vectors(("e", "f", "g", "N", "d", "p", "h", "q", "s"))
r, k, beta = scalar("r"), scalar("k"), scalar("beta")

CORNER_PRODUCTS = Formula.build(
    "corner_products",
    "Cosines $s0/L$, $s1/L$, $s2/L$ of the angles between the normal of a triangle with the "
    "corners $p0$, $p1$, $p2$ and the unit normals $n0$, $n1$, $n2$ of the surface there. $L$ is "
    "twice its area.",
    inputs=[p0, p1, p2, n0, n1, n2],
    terms=[("e", p1 - p0), ("f", p2 - p0), ("N", Cross(e, f))],
    outputs=[("s0", Dot(N, n0)), ("s1", Dot(N, n1)), ("s2", Dot(N, n2)), ("L", sp.sqrt(Dot(N, N)))],
)


CORNER_COTANGENTS = Formula.build(
    "corner_cotangents",
    "Cotangents $c0/L$, $c1/L$, $c2/L$ of the angles of a triangle with the corners $p0$, $p1$, "
    "$p2$. $L$ is twice its area.",
    inputs=[p0, p1, p2],
    terms=[("e", p1 - p0), ("f", p2 - p0), ("g", p2 - p1), ("N", Cross(e, f))],
    outputs=[("c0", Dot(e, f)), ("c1", -Dot(e, g)), ("c2", Dot(f, g)), ("L", sp.sqrt(Dot(N, N)))],
)


BORDER_SPACING = Formula.build(
    "border_spacing",
    "The spacing of boundary points where the distance to the $k$-th nearest sample is $r$: the "
    "spacing of samples of which $k$ fill half a disk of radius $r$.",
    inputs=[r, k],
    terms=[("rho", k / (sp.pi * r**2 / 2))],
    outputs=[("d", 1 / sp.sqrt(scalar("rho")))],
)


@formula(
    "edge_over_surface",
    "The middle Bézier point of a quadratic curve from $p0$ to $p1$ whose end tangents are "
    "perpendicular to the unit normals $n0$ and $n1$, in the sense of least squares.",
)
def EDGE_OVER_SURFACE() -> Parts:
    """Derive by least squares how far the middle Bézier point of an edge moves along n0 + n1.

    The edge, a quadratic curve, should be perpendicular to n0 and n1 at its ends: the products of
    n0 and n1 with the first and the last leg of its control polygon, e/2 ± beta (n0 + n1), should
    vanish.
    """
    towards = 1 + Dot(n0, n1)
    legs = Dot(e, n0) / 2 + beta * towards, Dot(e, n1) / 2 - beta * towards
    (bulge,) = sp.solve(sp.diff(legs[0] ** 2 + legs[1] ** 2, beta), beta)
    return Parts(
        inputs=[p0, p1, n0, n1],
        terms=[("e", p1 - p0), ("beta", sp.factor(bulge))],
        outputs=[("b", (p0 + p1) / 2 + beta * (n0 + n1))],
    )


RAY_IN_TRIANGLE = Formula.build(
    "ray_in_triangle",
    "Where a ray, $p + T/D d$, meets the plane of a triangle, $p0 + U/D (p1 - p0) + V/D (p2 - "
    "p0)$. $D$ is positive if the ray comes from the side from which $p0$, $p1$, $p2$ are "
    "anticlockwise.",
    inputs=[p, d, p0, p1, p2],
    terms=[("e", p1 - p0), ("f", p2 - p0), ("s", p - p0), ("h", Cross(d, f)), ("q", Cross(s, e))],
    outputs=[("D", Dot(e, h)), ("U", Dot(s, h)), ("V", Dot(d, q)), ("T", Dot(f, q))],
)


FORMULAS = (
    CORNER_PRODUCTS, CORNER_COTANGENTS, BORDER_SPACING, EDGE_OVER_SURFACE, RAY_IN_TRIANGLE,
)  # fmt: skip
