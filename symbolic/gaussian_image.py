"""The Gaussian image of a quadratic patch: boundary cones and arcs, solid angle, parabolic lines.

The parabolic lines come from one determinant, whatever the rank of [a b c]. Along the direction
(t, −s) of the parameter plane, p_u, p_v and the linear part d u + e v of p change by

    f1 = t a − s b,     f2 = t b − s c,     f3 = t d − s e,

and all points of a line s u + t v + ρ = 0 have the normal n if and only if n is perpendicular to
all three. Indeed, n·f1 = n·f2 = 0 makes (A, B, C) a multiple of (s², st, t²), and n·f3 = 0 makes
(P, Q) a multiple of (s, t), so that n·p_u = 0 and n·p_v = 0 are the same equation. The directions
are hence the roots of the binary cubic det[f1 f2 f3]. If det[a b c] ≠ 0, then f1 × f2 = det[a b c]
(s² a* + st b* + t² c*) with the dual basis a*, b*, c*. If a, b, c span a plane with normal n0, and
λ1 a + λ2 b + λ3 c = 0, the binary cubic is λ(s,t) (t n0·d − s n0·e), up to a factor, with λ(s,t) =
λ1 s² + λ2 st + λ3 t²: the last factor is the line at infinity, with the normal n0, and the other
two are lines in fixed directions. If a, b, c are multiples of one vector (a graph), the binary
cubic vanishes and D(N) is a constant.
"""

from itertools import product

import sympy as sp

from .formula import Formula, Parts, formula
from .notation import Cross, Det, Dot, scalar, substitute, vectors
from .patch import (
    FORM_TERMS,
    LINEAR_FORMS,
    P_U,
    P_V,
    SOLUTION,
    VECTORS,
    A,
    B,
    C,
    P,
    Q,
    a,
    b,
    c,
    d,
    e,
    n,
    u,
    v,
)

s, t = scalar("s"), scalar("t")
z0, z1, z2, r = (scalar(x) for x in ("z0", "z1", "z2", "r"))
p_u, p_v, N, q, n_t, N0, N1, N2, f1, f2, f3, x = vectors(
    ("p_u", "p_v", "N", "q", "n_t", "N0", "N1", "N2", "f1", "f2", "f3", "x")
)


# --- the boundary ---------------------------------------------------------------------------------


@formula(
    "boundary_cones",
    "The rows of the symmetric matrices of the three quadratic cones $U = 0$, $V = 0$, $W = 0$ "
    "that bound the Gaussian image of a patch.",
    source="Sect. 3.2",
)
def BOUNDARY_CONES() -> Parts:
    """Compute half the Hessians of U, V, W with respect to n, row by row, by the chain rule."""
    forms = {"U": SOLUTION.U, "V": SOLUTION.V, "W": SOLUTION.D - SOLUTION.U - SOLUTION.V}
    pairs = list(zip(LINEAR_FORMS, VECTORS, strict=True))
    rows = {
        f"{name}_{axis}": sum(
            (
                sp.diff(form, X, Y) / 2 * y.components["xyz".index(axis)] * x
                for (X, x), (Y, y) in product(pairs, repeat=2)
            ),
            start=sp.S.Zero,
        )
        for name, form in forms.items()
        for axis in "xyz"
    }
    return Parts(inputs=VECTORS, outputs=rows.items())


@formula(
    "edge_vectors",
    "The vectors of a patch on which its form $V$ depends, from the tangents $T = p_u$ and "
    "$X = p_v$ at the ends $(0, 0)$ and $(1, 0)$ of the edge $v = 0$: $V = 0$ is the boundary cone "
    "of this edge.",
    source="Sect. 3.2",
)
def EDGE_VECTORS() -> Parts:
    """Solve p_u = T0, p_v = X0 at (0, 0) and p_u = T1, p_v = X1 at (1, 0) for a, b, d, e."""
    T0, X0, T1, X1 = tangents = vectors(("T0", "X0", "T1", "X1"))
    equations = [
        substitute(field, {u: sp.S(at), v: sp.S.Zero}) - tangent
        for at, pair in ((0, (T0, X0)), (1, (T1, X1)))
        for field, tangent in zip((P_U, P_V), pair, strict=True)
    ]
    (solution,) = sp.solve(equations, [a, b, d, e], dict=True)
    if C in SOLUTION.V.free_symbols:
        raise ArithmeticError("V = 0 depends on more than the edge v = 0")
    return Parts(inputs=tangents, outputs=[(z.name, solution[z]) for z in (a, b, d, e)])


TANGENTIAL = Formula.build(
    "tangential",
    "The component of $x$ perpendicular to $n$, times $|n|^2$.",
    inputs=[x, n],
    outputs=[("y", Dot(n, n) * x - Dot(x, n) * n)],
)

ARC_POINT = (1 - t) ** 2 * N0 + 2 * t * (1 - t) * N1 + t**2 * N2

ARC = Formula.build(
    "boundary_arc",
    "The normals along an edge of a patch, and their derivative: a quadratic Bézier curve with "
    "three of the six control normals. Its projection to the sphere is an arc of the boundary of "
    "the Gaussian image; it lies on one of the cones $U = 0$, $V = 0$, $W = 0$.",
    source="Sect. 3.2",
    inputs=[N0, N1, N2, t],
    outputs=[("n", ARC_POINT), ("n_t", sp.expand(sp.diff(ARC_POINT, t)))],
)

ARC_ZEROS = Formula.build(
    "boundary_arc_zeros",
    "The two zeros of the component along $q$ of the normals of a boundary arc. At a singular "
    "point the normal vanishes, and so does the component along every $q$. $s$ is the sign of "
    "$z1$, which avoids cancellation. A negative discriminant, the rounded value of a double zero, "
    "counts as zero.",
    inputs=[N0, N1, N2, q, s],
    terms=[
        *((f"z{k}", Dot(q, x)) for k, x in enumerate((N0, N1, N2))),
        ("r", z1 + s * sp.sqrt(sp.Max(0, z1**2 - z0 * z2))),
    ],
    outputs=[("t1", r / (r - z2)), ("t2", z0 / (z0 - r))],
)

LENGTH: sp.Expr = sp.sqrt(Dot(n, n))

SOLID_ANGLE = Formula.build(
    "solid_angle",
    "Integrand of a solid angle along a curve $n$ of normals of any length, with the derivative "
    "$n_t$: its integral along the boundary of a region of the sphere is the region's solid "
    "angle, unless the region contains $-q$. $q$ is a unit vector.",
    inputs=[q, n, n_t],
    outputs=[("S_t", Det(q, n, n_t) / (LENGTH * (LENGTH + Dot(q, n))))],
)


# --- parabolic lines ------------------------------------------------------------------------------


def _determinant(names: tuple[str, ...]) -> sp.Expr:
    """Return the determinant of three vectors, written with the vectors in alphabetical order."""
    if len(set(names)) < 3:
        return sp.S.Zero
    key = sorted(names)
    return sp.LeviCivita(*(key.index(x) for x in names)) * Det(*vectors(key))


@formula(
    "parabolic_directions",
    "The coefficients of the binary cubic $det[t a − s b, t b − s c, t d − s e]$ in $(s, t)$: its "
    "real roots are the directions of the parabolic lines $s u + t v =$ const. It vanishes where "
    "the patch is developable, and where $a$, $b$, $c$ are multiples of one vector, so that the "
    "curvature has one sign.",
    source="Sect. 3.2",
)
def PARABOLIC_DIRECTIONS() -> Parts:
    """Expand det[t a − s b, t b − s c, t d − s e] by the powers of s and t."""
    coefficients = [sp.S.Zero] * 4
    for choice in product((0, 1), repeat=3):
        names = tuple(pair[k] for pair, k in zip(("ab", "bc", "de"), choice, strict=True))
        coefficients[sum(choice)] += (-1) ** sum(choice) * _determinant(names)
    outputs = [(f"k{k}{3 - k}", coefficients[k]) for k in (3, 2, 1, 0)]
    return Parts(inputs=VECTORS, outputs=outputs)


PARABOLIC_NORMAL = Formula.build(
    "parabolic_normal",
    "Three multiples of the normal along a parabolic line of direction $(s, t)$, which is "
    "constant there up to length and sign. At least one is non-zero, unless the patch is "
    "developable or has no normal on the line.",
    source="Sect. 3.2",
    inputs=[*VECTORS, s, t],
    terms=[("f1", t * a - s * b), ("f2", t * b - s * c), ("f3", t * d - s * e)],
    outputs=[("n12", Cross(f1, f2)), ("n13", Cross(f1, f3)), ("n23", Cross(f2, f3))],
)

PARABOLIC_LINE = Formula.build(
    "parabolic_line",
    "The parabolic line $l_u u + l_v v + l_1 = 0$ of direction $(s, t)$ with the normal $n$; it is "
    "the line at infinity if $l_u = l_v = 0$.",
    source="Sect. 3.2",
    inputs=[*VECTORS, n, s, t],
    terms=FORM_TERMS,
    outputs=[("l_u", s * A + t * B), ("l_v", s * B + t * C), ("l_1", s * P + t * Q)],
)


# --- any surface ----------------------------------------------------------------------------------

CURVATURE_OF_DERIVATIVES = Formula.build(
    "gaussian_curvature_of_derivatives",
    "The Gaussian curvature of any surface from its first derivatives $p_u$, $p_v$ and its second "
    "derivatives $a$, $b$, $c$ (by $uu$, $uv$, $vv$), and the components $l_uu$, $l_uv$, $l_vv$ of "
    "these along the normal $p_u × p_v$.",
    source="Sect. 3.2, Remark 3.1",
    inputs=[p_u, p_v, a, b, c],
    terms=[("N", Cross(p_u, p_v)), ("A", Dot(N, a)), ("B", Dot(N, b)), ("C", Dot(N, c))],
    outputs=[("K", SOLUTION.D / Dot(N, N) ** 2), ("l_uu", A), ("l_uv", B), ("l_vv", C)],
)

FORMULAS = (
    BOUNDARY_CONES,
    EDGE_VECTORS,
    TANGENTIAL,
    ARC,
    ARC_ZEROS,
    SOLID_ANGLE,
    PARABOLIC_DIRECTIONS,
    PARABOLIC_NORMAL,
    PARABOLIC_LINE,
    CURVATURE_OF_DERIVATIVES,
)
