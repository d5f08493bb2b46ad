"""One quadratic patch: eliminating u, v from eq. (9) gives its support function, exactly.

    p(u,v) = ½ a u² + b uv + ½ c v² + d u + e v + p,     a, b, c, d, e, p ∈ R³

All formulas are derived once, in the five linear forms A = n·a, B = n·b, C = n·c, P = n·d, Q = n·e
of the normal n; the vectors are reintroduced by the chain rule, since ∂A/∂n = a and so on.
"""

from dataclasses import dataclass
from itertools import combinations, product

import sympy as sp

from .formula import Formula, Parts, compose, formula
from .notation import Cross, Det, Dot, scalar, substitute, vectors

a, b, c, d, e, p, n = vectors("abcdepn")
VECTORS = (a, b, c, d, e)
A, B, C, P, Q = LINEAR_FORMS = tuple(scalar(x) for x in "ABCPQ")
D, U, V, W = (scalar(x) for x in "DUVW")
u, v, r = (scalar(x) for x in "uvr")
FORM_TERMS = [(form.name, Dot(n, x)) for form, x in zip(LINEAR_FORMS, VECTORS, strict=True)]


# --- eq. (10): from control points ----------------------------------------------------------------

NET = vectors(("b200", "b020", "b002", "b110", "b101", "b011"))


def multinomial(i: int, j: int, k: int) -> int:
    """Return (i + j + k)! / (i! j! k!)."""
    return int(sp.binomial(i + j + k, i) * sp.binomial(j + k, j))


@formula(
    "power_form",
    "The vectors of eq. (8), $a = a_20$, $b = a_11$, $c = a_02$, $d = a_10$, "
    "$e = a_01$ and $p = a_00$ in the paper, from the control points of a quadratic Bézier "
    "triangle.",
    source="eqs. (8) and (10)",
)
def POWER_FORM() -> Parts:
    """Differentiate the Bernstein form (10) at the origin: the vectors of eq. (8)."""
    point = sp.S.Zero
    for control_point in NET:
        i, j, k = (int(x) for x in control_point.name[1:])
        point += multinomial(i, j, k) * u**i * v**j * (1 - u - v) ** k * control_point
    orders = {"a": (2, 0), "b": (1, 1), "c": (0, 2), "d": (1, 0), "e": (0, 1), "p": (0, 0)}
    origin = {u: sp.S.Zero, v: sp.S.Zero}
    outputs = [
        (name, sp.expand(substitute(sp.diff(point, (u, i), (v, j)), origin)))
        for name, (i, j) in orders.items()
    ]
    return Parts(inputs=NET, outputs=outputs)


# --- eq. (9): elimination -------------------------------------------------------------------------


@dataclass(frozen=True)
class Elimination:
    """The solution of eq. (9) in the linear forms; `h` is the support function without n·p."""

    D: sp.Expr
    U: sp.Expr
    V: sp.Expr
    h: sp.Expr


def eliminate() -> Elimination:
    """Solve n·p_u = n·p_v = 0 for u, v and substitute the solution into n·p(u,v), as in eq. (9)."""
    h = A * u**2 / 2 + B * u * v + C * v**2 / 2 + P * u + Q * v
    (solution,) = sp.solve([sp.diff(h, u), sp.diff(h, v)], [u, v], dict=True)
    determinant = sp.det(sp.hessian(h, (u, v)))
    U_, V_ = (sp.expand(sp.cancel(solution[x] * determinant)) for x in (u, v))
    return Elimination(determinant, U_, V_, sp.cancel(h.subs(solution)))


SOLUTION = eliminate()


def _written(target: sp.Expr, derived: sp.Expr) -> sp.Expr:
    """Return `target`, a shorter expression in D, U, V, u, v that is equal to `derived`.

    Raises ArithmeticError if it is not equal.
    """
    forms = {D: SOLUTION.D, U: SOLUTION.U, V: SOLUTION.V}
    if sp.cancel(substitute(substitute(target, {u: U / D, v: V / D}), forms) - derived) != 0:
        raise ArithmeticError(f"{target} is not {derived}")
    return target


ELIMINATED = [("D", SOLUTION.D), ("U", SOLUTION.U), ("V", SOLUTION.V), ("W", D - U - V)]

FORMS = Formula.build(
    "forms",
    "Eliminating $u$, $v$ from eq. (9) leaves three quadratic forms in $n$, with $u = U/D$, $v = "
    "V/D$ and $w = W/D$. The patch has the normal $n$ where $U$, $V$, $W$ have the same sign, "
    "which is that of $D = U + V + W$; $U = 0$, $V = 0$, $W = 0$ are the three boundary cones of "
    "its Gaussian image.",
    source="eq. (9) and Sect. 3.2",
    inputs=[*VECTORS, n],
    terms=FORM_TERMS,
    outputs=ELIMINATED,
)

ELIMINATED_FORMS = Formula.build(
    "eliminated_forms",
    "The quadratic forms of a patch from the linear ones, by elimination of $u$ and $v$.",
    source="eq. (9) and Sect. 3.2",
    inputs=LINEAR_FORMS,
    outputs=ELIMINATED,
)

OTHER_FORMS = tuple(scalar(f"{form.name}_m") for form in LINEAR_FORMS)


def _polar(form: sp.Expr) -> sp.Expr:
    """Return F(n + m) − F(n) − F(m) for a quadratic form F: by Euler, the derivative along m."""
    pairs = zip(LINEAR_FORMS, OTHER_FORMS, strict=True)
    return sum((sp.diff(form, X) * Y for X, Y in pairs), start=sp.S.Zero)


POLAR_FORMS = Formula.build(
    "polar_forms",
    "Coefficients of $s t$ in the quadratic forms at $s n + t m$, from the linear forms of the "
    "normals $n$ and $m$; for $m = n$, twice the quadratic forms.",
    source="eq. (9)",
    inputs=[*LINEAR_FORMS, *OTHER_FORMS],
    outputs=[*((name, _polar(form)) for name, form in ELIMINATED[:3]), ELIMINATED[3]],
)

LINEAR_FORMS_OF_NORMAL = Formula.build(
    "linear_forms",
    "The linear forms in $n$ of eq. (9), from which $u$, $v$ are eliminated.",
    source="eq. (9)",
    inputs=[*VECTORS, n],
    outputs=FORM_TERMS,
)

PARAMETERS = Formula.build(
    "parameters",
    "The parameters at which the patch has the normal $n$.",
    source="eq. (9)",
    inputs=[D, U, V],
    terms=[("r", 1 / D)],
    outputs=[("u", U * r), ("v", V * r)],
)

SUPPORT_FUNCTION = Formula.build(
    "support_function",
    "The support function of a quadratic patch: a cubic over a quadratic form in $n$, homogeneous "
    "of degree 1 and odd.",
    source="eqs. (3) and (9)",
    inputs=[*VECTORS, p, n],
    terms=[*FORM_TERMS, ("D", SOLUTION.D), ("U", SOLUTION.U), ("V", SOLUTION.V)],
    outputs=[("h", Dot(n, p) + _written((U * P + V * Q) / (2 * D), SOLUTION.h))],
)


# --- eqs. (4)-(7): the envelope, and what its derivatives say -------------------------------------

# ∇h = Σ ∂h/∂X x + p over the pairs (X, x) = (A, a) … (Q, e).
GRADIENT = [
    _written(target, sp.diff(SOLUTION.h, form))
    for form, target in zip(LINEAR_FORMS, (u**2 / 2, u * v, v**2 / 2, u, v), strict=True)
]
POINT = sum((x * y for x, y in zip(GRADIENT, VECTORS, strict=True)), start=p)
P_U, P_V = sp.diff(POINT, u), sp.diff(POINT, v)
p_u, p_v, N = vectors(("p_u", "p_v", "N"))

ENVELOPE = Formula.build(
    "envelope",
    "The envelope operator: the gradient of the support function is the point of the patch that "
    "has the normal $n$, $p(u(n), v(n))$.",
    source="eqs. (5)-(8)",
    inputs=[*VECTORS, p, u, v],
    outputs=[("x", POINT)],
)

TANGENTS = Formula.build(
    "tangents",
    "The tangent vectors and their cross product, the oriented normal of the patch at $(u, v)$.",
    source="eqs. (1) and (14)",
    inputs=[*VECTORS, u, v],
    outputs=[("p_u", P_U), ("p_v", P_V), ("N", Cross(p_u, p_v))],
)


def hessian_factors(x: sp.Expr, y: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Return the rows s, t of −M⁻¹ J, where x, y are the rows of J and M = [A B; B C]."""
    return (B * y - C * x) / D, (B * x - A * y) / D


@formula(
    "hessian",
    "The Hessian of the support function; for a unit normal its eigenvalues on the tangent plane "
    "are the signed principal radii, positive on a sphere with outward normals.",
)
def HESSIAN() -> Parts:
    """Write the Hessian as p_u sᵀ + p_v tᵀ, checked in coordinates with respect to a … e."""
    derived = sp.hessian(SOLUTION.h, LINEAR_FORMS)
    x, y = ([sp.diff(g, by) for g in GRADIENT] for by in (u, v))
    for i, j in product(range(5), repeat=2):
        left, right = hessian_factors(x[j], y[j])
        _written(x[i] * left + y[i] * right, derived[i, j])
    s, t = vectors("st")

    def entry(i: int, j: int) -> sp.Expr:
        return p_u.components[i] * s.components[j] + p_v.components[i] * t.components[j]

    return Parts(
        inputs=[A, B, C, D, p_u, p_v],
        terms=zip("st", hessian_factors(p_u, p_v), strict=True),
        outputs=[
            (f"H_{name}", entry(*("xyz".index(axis) for axis in name)))
            for name in ("xx", "yy", "zz", "xy", "xz", "yz")
        ],
    )


E, F, G, g = (scalar(x) for x in "EFGg")
FIRST_FORM = [("E", Dot(p_u, p_u)), ("F", Dot(p_u, p_v)), ("G", Dot(p_v, p_v))]
# tr Hess h = p_u·s + p_v·t
TRACE: sp.Expr = sp.cancel(hessian_factors(E, F)[0] + hessian_factors(F, G)[1])

RADII = Formula.build(
    "principal_radii",
    "Sum and product of the signed principal radii of curvature for a unit normal $n$: trace and "
    "determinant of the Hessian of the support function on the tangent plane.",
    inputs=[A, B, C, D, p_u, p_v, N],
    terms=FIRST_FORM,
    outputs=[("R_sum", TRACE), ("R_product", Dot(N, N) / D)],
)

CURVATURE = Formula.build(
    "curvature",
    "Gaussian and mean curvature for a unit normal $n$: the reciprocal of the product of the "
    "principal radii, and half the sum of their reciprocals (positive on a sphere with outward "
    "normals).",
    inputs=[A, B, C, D, p_u, p_v, N],
    terms=[*FIRST_FORM, ("g", 1 / Dot(N, N))],
    outputs=[("K", D * g), ("H", TRACE * D * g / 2)],
)


# --- orientation and the closed form of the curvature ---------------------------------------------


def _gradient(form: sp.Expr) -> sp.Expr:
    """Return the gradient with respect to n of an expression in A, B, C, P, Q."""
    parts = (sp.diff(form, X) * x for X, x in zip(LINEAR_FORMS, VECTORS, strict=True))
    return sum(parts, start=sp.S.Zero)


c3_twice, n_n = scalar("c3_twice"), scalar("n_n")

ORIENTATION = Formula.build(
    "orientation",
    "Twice the cubic form $c_3$, with $p_u × p_v = n c_3/D^2$: $n$ is the oriented normal of the "
    "patch where $c_3 > 0$, and $-n$ where $c_3 < 0$.",
    inputs=[*VECTORS, n],
    terms=[
        *FORM_TERMS,
        ("dU", _gradient(SOLUTION.U)),
        ("dV", _gradient(SOLUTION.V)),
        ("dD", _gradient(SOLUTION.D)),
    ],
    outputs=[("c3_twice", Det(*vectors(("dU", "dV", "dD"))))],
)

CLOSED_CURVATURE = Formula.build(
    "gaussian_curvature_closed_form",
    "The Gaussian curvature as a rational function of the normal (of any length) alone; kernels "
    "use the equal formula `curvature`, which does not overflow.",
    inputs=[D, c3_twice, n],
    terms=[("n_n", Dot(n, n))],
    outputs=[("K", 4 * D**5 / (c3_twice * n_n) ** 2)],
)


# --- the normal field of a patch, in Bernstein form -----------------------------------------------


def bernstein(polynomial: sp.Expr, degree: int) -> dict[str, sp.Expr]:
    """Return the Bézier coefficients b_ijk, by ijk, of a polynomial in u, v over u, v, w >= 0."""
    power = sp.Poly(polynomial, u, v)
    result = {}
    for i, j in product(range(degree, -1, -1), repeat=2):
        if i + j <= degree:
            terms = (
                power.coeff_monomial(u**k * v**m)
                * sp.binomial(i, k)
                * sp.binomial(j, m)
                / multinomial(k, m, degree - k - m)
                for k, m in product(range(i + 1), range(j + 1))
            )
            result[f"{i}{j}{degree - i - j}"] = sp.expand(sum(terms, start=sp.S.Zero))
    return result


@formula(
    "control_normals",
    "The Bézier net of the normal field $N(u,v) = p_u × p_v$: every oriented normal of the patch "
    "is a non-negative combination of these six vectors.",
    source="Sect. 3.2, eq. (14)",
)
def CONTROL_NORMALS() -> Parts:
    """Multiply the linear fields p_u and p_v in Bernstein form, given by values at the corners."""
    corners = {"100": (1, 0), "010": (0, 1), "001": (0, 0)}
    tangents = [
        (f"{field_name}{corner}", sp.expand(substitute(field, {u: sp.S(at[0]), v: sp.S(at[1])})))
        for corner, at in corners.items()
        for field_name, field in (("s", P_U), ("t", P_V))
    ]
    outputs: dict[str, sp.Expr] = {}
    for left, right in product(corners, repeat=2):
        index = "".join(str(int(i) + int(j)) for i, j in zip(left, right, strict=True))
        s, t = vectors((f"s{left}", f"t{right}"))
        share = sp.S.One if left == right else sp.S.Half
        outputs[f"N{index}"] = outputs.get(f"N{index}", sp.S.Zero) + share * Cross(s, t)
    return Parts(inputs=VECTORS, terms=tangents, outputs=sorted(outputs.items(), reverse=True))


@formula(
    "parabolic_cubic",
    "The Bézier net of $D(N(u,v))$, a cubic whose zeros are the parabolic points of the patch and "
    "whose sign is that of the Gaussian curvature; it vanishes when the patch is developable. "
    "$abc$ is the determinant of $a$, $b$, $c$, and so on.",
    source="Sect. 3.2 and Remark 3.1",
)
def PARABOLIC_CUBIC() -> Parts:
    """Substitute n = N(u,v) into D; the quartic terms cancel in triple products."""
    triples = {"".join(x): Det(*vectors(x)) for x in combinations("abcde", 3)}
    along_u, along_v = (
        {x.name: sp.diff(g, by) for x, g in zip(VECTORS, GRADIENT, strict=True)} for by in (u, v)
    )

    def along_normal(z: str) -> sp.Expr:
        """Return N·z by expanding the triple product of p_u, p_v and z."""
        total = sp.S.Zero
        for x, y in product("abcde", repeat=2):
            key = sorted((x, y, z))
            if len(set(key)) == 3:
                sign = sp.LeviCivita(*(key.index(name) for name in (x, y, z)))
                total += sign * along_u[x] * along_v[y] * scalar("".join(key))
        return total

    at_normal = {A: along_normal("a"), B: along_normal("b"), C: along_normal("c")}
    cubic = sp.expand(substitute(SOLUTION.D, at_normal))
    outputs = [(f"D{index}", value) for index, value in bernstein(cubic, 3).items()]
    return Parts(inputs=VECTORS, terms=triples.items(), outputs=outputs)


area = scalar("dA")

MEASURE = Formula.build(
    "measure",
    "Area of the patch and signed area of its Gaussian image (negative where the patch is "
    "hyperbolic), both per area of the parameter plane.",
    inputs=[*VECTORS, u, v],
    terms=[
        ("p_u", P_U),
        ("p_v", P_V),
        ("N", Cross(p_u, p_v)),
        *((form.name, Dot(N, x)) for form, x in ((A, a), (B, b), (C, c))),
    ],
    outputs=[("dA", sp.sqrt(Dot(N, N))), ("dS", SOLUTION.D / (area * Dot(N, N)))],
)


def quadrature_node() -> sp.Rational:
    """Return t for which means over permutations of (1 − 2t, t, t) are exact for quadratics."""
    t = sp.Symbol("t")
    second_moment = sp.integrate(u**2, (u, 0, 1 - v), (v, 0, 1))
    return min(sp.solve(((1 - 2 * t) ** 2 + 2 * t**2) / 6 - second_moment, t))


(x,) = vectors("x")
K, H = scalar("K"), scalar("H")

SAMPLE = compose(
    "sample",
    "The fields of a sample: parameters, point, oriented normal, curvatures.",
    [FORMS, PARAMETERS, ENVELOPE, TANGENTS, CURVATURE],
    source="eqs. (1), (5)-(9); curvatures beyond the paper",
    outputs=[u, v, x, N, K, H],
)

CURVATURE_AT = compose(
    "curvature_at",
    "Gaussian and mean curvature at given parameters $u$, $v$, where $n$ is the unit normal.",
    [FORMS, TANGENTS, CURVATURE],
    source="eqs. (1), (9); curvatures beyond the paper",
    outputs=[K, H],
)

LARGEST_CURVATURE = Formula.build(
    "largest_curvature",
    "The larger absolute value of the two principal curvatures.",
    inputs=[K, H],
    outputs=[("k", sp.Abs(H) + sp.sqrt(sp.Abs(H**2 - K)))],
)


FORMULAS = (
    POWER_FORM,
    FORMS,
    LINEAR_FORMS_OF_NORMAL,
    ELIMINATED_FORMS,
    POLAR_FORMS,
    PARAMETERS,
    SUPPORT_FUNCTION,
    ENVELOPE,
    TANGENTS,
    HESSIAN,
    RADII,
    CURVATURE,
    ORIENTATION,
    CLOSED_CURVATURE,
    CONTROL_NORMALS,
    PARABOLIC_CUBIC,
    MEASURE,
    SAMPLE,
    CURVATURE_AT,
    LARGEST_CURVATURE,
)
