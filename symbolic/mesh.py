"""Triangles through points of a surface: how their planes deviate from it, and how far to go."""

from __future__ import annotations

import sympy as sp

from .formula import Cross, Dot, Formula, scalar, vectors

__all__ = ["FORMULAS"]

p0, p1, p2, n0, n1, n2, e, f, N = vectors(("p0", "p1", "p2", "n0", "n1", "n2", "e", "f", "N"))
r, k = scalar("r"), scalar("k")

CORNER_PRODUCTS = Formula.build(
    "corner_products",
    "How a triangle with the corners $p0$, $p1$, $p2$ lies to the surface: $s0/L$, $s1/L$ and "
    "$s2/L$ are the cosines of the angles between its normal and the unit normals $n0$, $n1$, "
    "$n2$ of the surface there. $L$ is twice its area.",
    inputs=[p0, p1, p2, n0, n1, n2],
    terms=[("e", p1 - p0), ("f", p2 - p0), ("N", Cross(e, f))],
    outputs=[("s0", Dot(N, n0)), ("s1", Dot(N, n1)), ("s2", Dot(N, n2)), ("L", sp.sqrt(Dot(N, N)))],
)


BORDER_SPACING = Formula.build(
    "border_spacing",
    "How far apart points of a border are to be if the $k$-th nearest sample is $r$ away: as far "
    "as samples are of which $k$ fill half a disk of radius $r$.",
    inputs=[r, k],
    terms=[("rho", k / (sp.pi * r**2 / 2))],
    outputs=[("d", 1 / sp.sqrt(scalar("rho")))],
)

FORMULAS = (CORNER_PRODUCTS, BORDER_SPACING)
