"""The 2-jet of a surface at a point: normal, curvatures, Newton's step, and charts at poles.

The 2-jet of x(u,v) is the quadratic patch that osculates the surface,

    a = x_uu, b = x_uv, c = x_vv, d = x_u, e = x_v, p = x,

so that the formulas of a patch hold for it: Newton's step to the point with the normal n is the
preimage of n on that patch.
"""

from collections.abc import Sequence

import sympy as sp

from .formula import Formula, Parts, formula
from .notation import Cross, Dot, derivative, scalar, substitute, vectors
from .patch import FORM_TERMS, SOLUTION, VECTORS, A, B, C, D, P, Q, a, b, c, d, e, n, r

N, N_u, N_v, w = vectors(("N", "N_u", "N_v", "w"))
E, F, G, L = (scalar(x) for x in "EFGL")

FIRST_FORM = [("E", Dot(d, d)), ("F", Dot(d, e)), ("G", Dot(e, e))]
# The normal N, and the second fundamental form times the length of N.
NORMAL_AND_SECOND_FORM = [("N", Cross(d, e)), ("A", Dot(N, a)), ("B", Dot(N, b)), ("C", Dot(N, c))]

AT_JET = Formula.build(
    "at_jet",
    "The length $L$ of the normal $N$ of a surface, the unit normal, the Gaussian and the mean "
    "curvature, from its 2-jet: $a = x_uu$, $b = x_uv$, $c = x_vv$, $d = x_u$, $e = x_v$. The mean "
    "curvature is half the sum of the principal curvatures −II/I, positive on a sphere with "
    "outward normals.",
    inputs=VECTORS,
    terms=[*NORMAL_AND_SECOND_FORM, *FIRST_FORM],
    outputs=[
        ("L", sp.sqrt(Dot(N, N))),
        ("n", N / L),
        ("K", SOLUTION.D / L**4),
        ("H", -(E * C - 2 * F * B + G * A) / (2 * L**3)),
    ],
)

FORMS_AT_JET = Formula.build(
    "forms_at_jet",
    "The first fundamental form $E$, $F$, $G$ of a surface, its third fundamental form $e_1$, "
    "$f_1$, $g_1$ (of the derivatives of the unit normal), and $D$, which has the sign of the "
    "Gaussian curvature, from its 2-jet.",
    inputs=VECTORS,
    terms=[*NORMAL_AND_SECOND_FORM, ("r", 1 / Dot(N, N) ** 2)],
    outputs=[
        *FIRST_FORM,
        ("e1", (G * A**2 - 2 * F * A * B + E * B**2) * r),
        ("f1", (G * A * B - F * (A * C + B**2) + E * B * C) * r),
        ("g1", (G * B**2 - 2 * F * B * C + E * C**2) * r),
        ("D", SOLUTION.D),
    ],
)

(q,) = vectors("q")

NEWTON = Formula.build(
    "newton",
    "The step $u$, $v$ of Newton's method for $P = Q = 0$: the preimage of the unit normal $n$ on "
    "the patch that osculates the surface. $s$ is the squared sine of the angle between $n$ and "
    "the normal $N$ of the surface, $q = n × N$, and $m$ has the sign of the cosine.",
    inputs=[*VECTORS, n],
    terms=[*FORM_TERMS, ("D", SOLUTION.D), ("r", 1 / D), ("q", Q * d - P * e), ("N", Cross(d, e))],
    outputs=[
        ("u", SOLUTION.U * r),
        ("v", SOLUTION.V * r),
        ("s", Dot(q, q) / Dot(N, N)),
        ("m", Dot(n, N)),
    ],
)

# The derivatives of N by u and v.
N_ALONG = [derivative(Cross(d, e), by) for by in ({d: a, e: b}, {d: b, e: c})]

CONTOUR = Formula.build(
    "contour",
    "The normal $N$ of a surface, its product $f$ with $w$, and the derivatives of $f$ by $u$ and "
    "$v$, from its 2-jet. The zeros of $f$ are the contour generator of the projection along $w$.",
    inputs=[*VECTORS, w],
    terms=[("N_u", N_ALONG[0]), ("N_v", N_ALONG[1])],
    outputs=[("N", Cross(d, e)), ("f", Dot(N, w)), ("f_u", Dot(N_u, w)), ("f_v", Dot(N_v, w))],
)

(o, m), (U, V) = vectors("om"), (scalar("U"), scalar("V"))

BEND = Formula.build(
    "bend",
    "The second fundamental form $k$ of a tangent vector $w = U x_u + V x_v$ of a surface, times "
    "the length of the normal $N$, from its 2-jet. Positive where the surface bends along $w$ "
    "towards $N$.",
    inputs=[*VECTORS, w],
    terms=[
        *NORMAL_AND_SECOND_FORM,
        ("r", 1 / Dot(N, N)),
        ("o", Cross(e, N)),
        ("m", Cross(N, d)),
        ("U", Dot(o, w) * r),
        ("V", Dot(m, w) * r),
    ],
    outputs=[("k", A * U**2 + 2 * B * U * V + C * V**2)],
)


# --- poles ----------------------------------------------------------------------------------------
#
# At a pole the parameters u, v are polar coordinates: an angle φ, and the distance r from the pole.
# The surface is smooth in s = r cos φ, t = r sin φ.

x, y = scalar("x"), scalar("y")
# The orders of the derivatives, by u or s and by v or t, in a 2-jet.
ORDERS = ((2, 0), (1, 1), (0, 2), (1, 0), (0, 1))


def _along_polar(jet: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Return derivatives of a surface by φ and r from those by s and t, for cos φ = x, sin φ = y.

    The orders of the derivatives are ORDERS. First and second derivatives by s and t determine
    those by φ and r, so that a quadratic patch can replace the surface.
    """
    phi, psi, radius = sp.symbols("phi psi radius", real=True)
    s = radius * sp.cos(psi) - r * sp.cos(phi)
    t = radius * sp.sin(psi) - r * sp.sin(phi)
    terms = (
        z * s**i * t**j / (sp.factorial(i) * sp.factorial(j))
        for z, (i, j) in zip(jet, ORDERS, strict=True)
    )
    patch = sum(terms, start=sp.S.Zero)
    here = {psi: phi, radius: r}
    direction = {sp.cos(phi): x, sp.sin(phi): y}
    return [
        substitute(substitute(sp.diff(patch, (psi, i), (radius, j)), here), direction)
        for i, j in ORDERS
    ]


@formula(
    "polar_chart",
    "The 2-jet in the regular chart $s = r x$, $t = r y$ at a pole, from derivatives by the polar "
    "angle (first $d$, second $a$), by angle and distance ($b$) and by the distance $r > 0$; $x$ "
    "and $y$ are the cosine and the sine of the angle.",
)
def POLAR_CHART() -> Parts:
    """Write the 2-jet by s and t, and check by the chain rule that it gives the 2-jet by φ and r.

    Raises ArithmeticError if it does not.
    """
    (along, mixed, across) = vectors(("o", "m", "h"))
    terms = {along: d / r, mixed: b / r - along / r, across: a / r**2 + e / r}
    outputs = {
        "X_ss": x**2 * c - 2 * x * y * mixed + y**2 * across,
        "X_st": x * y * c + (x**2 - y**2) * mixed - x * y * across,
        "X_tt": y**2 * c + 2 * x * y * mixed + x**2 * across,
        "X_s": x * e - y * along,
        "X_t": y * e + x * along,
    }
    plain = [substitute(substitute(z, terms), terms) for z in outputs.values()]
    for given, derived in zip(VECTORS, _along_polar(plain), strict=True):
        if sp.rem(sp.expand(derived - given), x**2 + y**2 - 1, x) != 0:
            raise ArithmeticError(f"the chart does not give {given}")
    return Parts(
        inputs=[*VECTORS, r, x, y],
        terms=[(z.name, value) for z, value in terms.items()],
        outputs=outputs.items(),
    )


@formula(
    "at_pole",
    "The 2-jet at a pole, in its chart, from the first and second derivatives $e$ and $c$ by the "
    "distance from it, along the directions of 0, 45 and 90 degrees.",
)
def AT_POLE() -> Parts:
    """Solve for the 2-jet at a pole, which determines two derivatives by r along each direction."""
    known = vectors(("e0", "c0", "c1", "e2", "c2"))
    e0, c0, c1, e2, c2 = known
    X = sp.symbols("X_ss X_st X_tt X_s X_t")
    half = sp.sqrt(sp.S.Half)

    def along(cosine: sp.Expr, sine: sp.Expr) -> list[sp.Expr]:
        jet = [substitute(z, {r: sp.S.Zero, x: cosine, y: sine}) for z in _along_polar(X)]
        return [jet[4], jet[2]]

    (first0, second0), (_, second1), (first2, second2) = (
        along(*z) for z in ((sp.S.One, sp.S.Zero), (half, half), (sp.S.Zero, sp.S.One))
    )
    equations = [first0 - e0, second0 - c0, second1 - c1, first2 - e2, second2 - c2]
    (solution,) = sp.solve(equations, X, dict=True)
    return Parts(inputs=known, outputs=[(z.name, solution[z]) for z in X])


# At a pole r = 0, around which the parameter u runs, the surface is a graph h over its tangent
# plane with coordinates q1, q2. As r → 0, q_u, q_uu and h_r, h_ur vanish like r, and h_u, h_uu like
# r².

INVERSE = i11, i12, i21, i22 = tuple(scalar(z) for z in ("i11", "i12", "i21", "i22"))
SLOPES = G1, G2 = scalar("G1"), scalar("G2")
o1, o2, e1, e2, h1, h2 = (scalar(z) for z in ("o1", "o2", "e1", "e2", "h1", "h2"))
a1, a2, b1, b2, c1, c2 = (scalar(z) for z in ("a1", "a2", "b1", "b2", "c1", "c2"))
h11, h12, h22 = (scalar(z) for z in ("h11", "h12", "h22"))

GRAPH_SLOPES = Formula.build(
    "graph_slopes",
    "The inverse $i11$, … of the matrix of $o$ and $e$: the derivatives of coordinates $q1$, $q2$ "
    "of a plane by $u$, divided by $r$, and by $r$. Also the first derivatives $G1$, $G2$ of a "
    "graph $h$ by $q1$, $q2$, from $h1$ by $u$, divided by $r$, and $h2$ by $r$.",
    inputs=[o1, o2, e1, e2, h1, h2],
    terms=[("d", 1 / (o1 * e2 - o2 * e1))],
    outputs=[
        ("i11", scalar("d") * e2),
        ("i12", -scalar("d") * e1),
        ("i21", -scalar("d") * o2),
        ("i22", scalar("d") * o1),
        ("G1", i11 * h1 + i21 * h2),
        ("G2", i12 * h1 + i22 * h2),
    ],
)


@formula(
    "graph_at_pole",
    "The second derivatives $H11$, $H12$, $H22$ of a graph $h$ by the coordinates $q1$, $q2$ of "
    "its tangent plane, near a pole with the parameters $u$ around it and $r = 0$ at it. Inputs "
    "are $i11$, … and $G1$, $G2$ of `graph_slopes`, the latter divided by $r$; the second "
    "derivatives of $q1$, $q2$: $a$ by $u$, divided by $r$, $b$ by both, $c$ by $r$; and those of "
    "$h$: $h11$ by $u$, divided by $r^2$, $h12$ by both, divided by $r$, $h22$ by $r$.",
)
def GRAPH_AT_POLE() -> Parts:
    """Write the second derivatives of a graph, and check them by the chain rule.

    Raises ArithmeticError if they differ.
    """
    A, B, C = (scalar(z) for z in "ABC")
    terms = {
        A: h11 - G1 * a1 - G2 * a2,
        B: h12 - G1 * b1 - G2 * b2,
        C: h22 - r * (G1 * c1 + G2 * c2),
    }
    outputs = {
        "H11": i11**2 * A + 2 * i11 * i21 * B + i21**2 * C,
        "H12": i11 * i12 * A + (i11 * i22 + i12 * i21) * B + i21 * i22 * C,
        "H22": i12**2 * A + 2 * i12 * i22 * B + i22**2 * C,
    }
    jacobian = sp.Matrix([[r * o1, e1], [r * o2, e2]])
    slopes = jacobian.T.inv() * sp.Matrix([r**2 * h1, r * h2])
    second = sp.Matrix([[r**2 * h11, r * h12], [r * h12, h22]])
    second -= slopes[0] * sp.Matrix([[r * a1, b1], [b1, c1]])
    second -= slopes[1] * sp.Matrix([[r * a2, b2], [b2, c2]])
    hessian = jacobian.T.inv() * second * jacobian.inv()
    first = {scalar(name): value for name, value in GRAPH_SLOPES.expanded().items()}
    for name, (i, j) in {"H11": (0, 0), "H12": (0, 1), "H22": (1, 1)}.items():
        written = substitute(substitute(outputs[name], terms), first)
        if sp.cancel(written - hessian[i, j]) != 0:
            raise ArithmeticError(f"the chain rule does not give {name}")
    return Parts(
        inputs=[*INVERSE, *SLOPES, a1, a2, b1, b2, c1, c2, h11, h12, h22, r],
        terms=[(z.name, value) for z, value in terms.items()],
        outputs=outputs.items(),
    )


FORMULAS = (
    AT_JET,
    FORMS_AT_JET,
    NEWTON,
    CONTOUR,
    BEND,
    POLAR_CHART,
    AT_POLE,
    GRAPH_SLOPES,
    GRAPH_AT_POLE,
)
