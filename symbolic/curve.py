"""Planar curves: the support function of a quadratic arc, and the C¹ quadratic spline, exactly.

    p(t) = ½ a t² + b t + c,     a, b, c ∈ R²

The normal is the tangent p_t turned clockwise by 90°: it points outward on a counter-clockwise
circle. The curvature is positive there, like the mean curvature of a sphere with outward normals,
and negative where a curve bends towards its normal.

The spline has a piece between any two neighbouring integers. Each piece has one coefficient, the
middle control point of its arc. Therefore a coefficient is computed from values by the same
functional as the middle point of an edge on the boundary of a surface (`edge_point`,
`edge_point_from_vertices`).
"""

from itertools import pairwise

import sympy as sp

from .formula import Formula, compose
from .notation import Dot, plane_vectors, scalar, substitute

SECTION = "Sect. 4.1"

a, b, c, n = plane_vectors("abcn")
A, B, t = (scalar(x) for x in "ABt")


# --- one arc --------------------------------------------------------------------------------------

CONTROL_POINTS = b20, b11, b02 = plane_vectors(("b20", "b11", "b02"))


def _power_form() -> Formula:
    """Return the formula of the point (c) and the derivatives (b, a) of an arc at t = 0."""
    point = sp.S.Zero
    for control_point in CONTROL_POINTS:
        i, j = (int(x) for x in control_point.name[1:])
        point += sp.binomial(2, j) * (1 - t) ** i * t**j * control_point
    return Formula.build(
        "arc_power_form",
        "The vectors $a$, $b$, $c$ of an arc from its control points.",
        source=SECTION,
        inputs=CONTROL_POINTS,
        outputs=[
            (name, sp.expand(substitute(sp.diff(point, t, order), {t: sp.S.Zero})))
            for name, order in (("a", 2), ("b", 1), ("c", 0))
        ],
    )


POWER_FORM = _power_form()


def eliminate() -> tuple[sp.Expr, sp.Expr]:
    """Solve n·p_t = 0 for t; return t and h − n·c in A = n·a, B = n·b.

    h is the support function.
    """
    h = A * t**2 / 2 + B * t
    (solution,) = sp.solve(sp.diff(h, t), t)
    return solution, sp.cancel(substitute(h, {t: solution}))


PARAMETER_OF_NORMAL, SUPPORT = eliminate()


def _written(target: sp.Expr, derived: sp.Expr) -> sp.Expr:
    """Return `target`, another form of `derived` in t; ArithmeticError if they are not equal."""
    if sp.cancel(substitute(target, {t: PARAMETER_OF_NORMAL}) - derived) != 0:
        raise ArithmeticError(f"{target} is not {derived}")
    return target


PARAMETER = Formula.build(
    "arc_parameter",
    "The parameter at which the tangent of the arc is perpendicular to $n$.",
    source=f"eq. (9), in the plane: {SECTION}",
    inputs=[a, b, n],
    terms=[("A", Dot(n, a)), ("B", Dot(n, b))],
    outputs=[("t", PARAMETER_OF_NORMAL)],
)

SUPPORT_FUNCTION = Formula.build(
    "arc_support_function",
    "The support function of an arc: a quadratic over a linear form in $n$, homogeneous of degree "
    "1 and odd.",
    source=f"eqs. (3) and (9), in the plane: {SECTION}",
    inputs=[a, b, c, n],
    terms=[("A", Dot(n, a)), ("B", Dot(n, b))],
    outputs=[("h", Dot(n, c) + SUPPORT)],
)

# ∇h = ∂h/∂A a + ∂h/∂B b + c
POINT = _written(t**2 / 2, sp.diff(SUPPORT, A)) * a + _written(t, sp.diff(SUPPORT, B)) * b + c
(p_t,) = plane_vectors(["p_t"])

ENVELOPE = Formula.build(
    "arc_envelope",
    "The envelope operator: the gradient of the support function is the point of the arc that has "
    "the normal $n$, $p(t(n))$.",
    source=f"eqs. (5)-(8), in the plane: {SECTION}",
    inputs=[a, b, c, t],
    outputs=[("x", POINT)],
)

TANGENT = Formula.build(
    "arc_tangent",
    "The tangent vector, and the normal: the tangent after a quarter turn clockwise.",
    source=f"eq. (1), in the plane: {SECTION}",
    inputs=[a, b, t],
    outputs=[("p_t", sp.diff(POINT, t)), ("N_x", p_t.components[1]), ("N_y", -p_t.components[0])],
)


def _radius() -> sp.Expr:
    """Return the trace of Hess h = −p_t p_tᵀ/A, checked in coordinates with respect to a, b."""
    hessian, along = sp.hessian(SUPPORT, (A, B)), (t, sp.S.One)  # p_t = t a + b
    for i, j in ((0, 0), (0, 1), (1, 1)):
        _written(-along[i] * along[j] / A, hessian[i, j])
    return -Dot(p_t, p_t) / A


CURVATURE = Formula.build(
    "arc_curvature",
    "The curvature at the point with the unit normal $n$: the reciprocal of the radius of "
    "curvature, which is the trace of the Hessian of the support function (positive on a circle "
    "with outward normals).",
    source=f"beyond the paper: {SECTION}",
    inputs=[A, p_t],
    outputs=[("kappa", 1 / _radius())],
)


SAMPLE = compose(
    "arc_sample",
    "Point, tangent and curvature of a sample of a curve.",
    [ENVELOPE, TANGENT, CURVATURE],
    source=f"eqs. (5)-(8), in the plane: {SECTION}",
    outputs=[*plane_vectors("x"), scalar("kappa")],
)


# --- the spline -----------------------------------------------------------------------------------

COEFFICIENTS = mu_l, mu_c, mu_r = plane_vectors(("mu_l", "mu_c", "mu_r"))


def b_spline_net() -> sp.Matrix:
    """Return the Bézier ordinates (piece, point) of the uniform quadratic B-spline.

    It is the only solution of these conditions: three pieces, C¹ at all four joints, and translates
    that sum to 1. Raises ArithmeticError if there is not exactly one solution.
    """
    net = sp.Matrix(3, 3, sp.symbols("o:9"))
    zero = sp.zeros(1, 3)
    pieces = [zero, *(net.row(k) for k in range(3)), zero]
    equations = [sum(net.col(place)) - 1 for place in range(3)]
    for left, right in pairwise(pieces):
        equations += [left[2] - right[0], left[2] - left[1] - (right[1] - right[0])]
    solutions = sp.solve(equations, net.flat(), dict=True)
    if len(solutions) != 1 or len(solutions[0]) != len(net):
        raise ArithmeticError("the conditions do not determine the B-spline")
    return net.subs(solutions[0])


def _net() -> dict[sp.Symbol, sp.Expr]:
    """Return the control points of an arc in terms of its three coefficients."""
    weights = b_spline_net()  # the B-spline of the left coefficient ends on this arc
    return {
        point: sp.Add(*(weights[2 - k, place] * mu for k, mu in enumerate(COEFFICIENTS)))
        for place, point in enumerate(CONTROL_POINTS)
    }


NET = _net()

CONTROL_NET = Formula.build(
    "arc_control_points",
    "The control points of an arc of the quadratic spline from the coefficients of its piece "
    "and the two next to it.",
    source=SECTION,
    inputs=COEFFICIENTS,
    outputs=[(point.name, value) for point, value in NET.items()],
)

ARC = Formula.build(
    "arc",
    "The vectors of an arc of the spline, $c$ relative to the coefficient of its piece, from the "
    "differences $mu_l$, $mu_r$ of the neighbouring coefficients from that one.",
    source=SECTION,
    inputs=[mu_l, mu_r],
    outputs=[
        (x.name, sp.expand(substitute(substitute(value, NET), {mu_c: sp.S.Zero})))
        for x, value in POWER_FORM.definitions
    ],
)


def _beyond_end() -> Formula:
    """Derive the coefficient of the piece before an arc, from the arc's first control point f."""
    f, inside = scalar("f"), scalar("mu_c")
    (solution,) = sp.solve(NET[b20] - f, mu_l)
    return Formula.build(
        "beyond_end",
        "The coefficient beyond an end of an open curve from that of the last piece and the value "
        "$f$ at the end, which the spline interpolates.",
        source=SECTION,
        inputs=[f, inside],
        outputs=[("mu_l", substitute(sp.expand(solution), {mu_c: inside}))],
    )


BEYOND_END = _beyond_end()

FORMULAS = (
    POWER_FORM,
    PARAMETER,
    SUPPORT_FUNCTION,
    ENVELOPE,
    TANGENT,
    CURVATURE,
    SAMPLE,
    CONTROL_NET,
    ARC,
    BEYOND_END,
)
