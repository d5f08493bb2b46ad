"""Bounds over a cell of parameters that prove which points of a surface have a given normal.

Over a cell with parameters s and t in [−1, 1], the derivatives of n·x by s and t are

    P + A s + B t + ½ (T0 s² + 2 T1 s t + T2 t²),
    Q + B s + C t + ½ (T1 s² + 2 T2 s t + T3 t²)

with the linear forms A, B, C, P, Q in n of the patch that osculates at the centre of the cell, and
T0 = n·x_sss, T1 = n·x_sst, T2 = n·x_stt, T3 = n·x_ttt at points between the centre and (s, t). The
points with the normals n and −n are the common zeros of both.
"""

from collections.abc import Iterable
from itertools import product

import sympy as sp

from .formula import Formula, Parts, formula
from .notation import Cross, scalar, substitute
from .patch import LINEAR_FORMS, SOLUTION, VECTORS, A, B, C, D, P, Q, a, b, c, d, e

s, t, x, y, i, j = (scalar(name) for name in "stxyij")


def _names(letter: str) -> tuple[sp.Symbol, ...]:
    return tuple(scalar(f"{letter}{k}") for k in range(4))


THIRDS, RADII = _names("T"), _names("R")
R, S = scalar("R"), scalar("S")
y11, y12, y22 = (scalar(f"y{k}") for k in ("11", "12", "22"))


def _cubic(thirds: Iterable[sp.Expr], along: sp.Expr, across: sp.Expr) -> sp.Expr:
    """Return the cubic form in `along` and `across` with the given four third derivatives."""
    terms = (sp.binomial(3, k) * z * along ** (3 - k) * across**k / 6 for k, z in enumerate(thirds))
    return sum(terms, start=sp.S.Zero)


# The cubic model of n·x, without the constant term.
MODEL = P * s + Q * t + (A * s**2 + 2 * B * s * t + C * t**2) / 2 + _cubic(THIRDS, s, t)
MODEL_AT = Formula.build(
    "model_at",
    "The linear forms at $s$, $t$ of a cubic polynomial with the given linear forms at the origin "
    "and the third derivatives $T0$, …, $T3$.",
    inputs=[*LINEAR_FORMS, *THIRDS, s, t],
    outputs=[
        (f"{form.name}_m", sp.expand(sp.diff(MODEL, *by)))
        for form, by in zip(LINEAR_FORMS, ((s, s), (s, t), (t, t), (s,), (t,)), strict=True)
    ],
)

# --- no point -------------------------------------------------------------------------------------


def _largest(form: sp.Expr) -> sp.Expr:
    """Return a bound of a polynomial over the cell: the sum of the moduli of its coefficients."""
    return sum((sp.Abs(z) for z in sp.Poly(form, s, t).coeffs()), start=sp.S.Zero)


REMAINDERS = Formula.build(
    "remainders",
    "Bounds $R$ and $S$, over a cell, of the remainders of the derivatives of heights by $s$ and "
    "$t$ beyond a quadratic patch, from bounds $T0$, …, $T3$ of the third derivatives.",
    inputs=THIRDS,
    outputs=[
        (
            z.name,
            substitute(_largest(sp.diff(_cubic(THIRDS, s, t), by)), {sp.Abs(k): k for k in THIRDS}),
        )
        for z, by in ((R, s), (S, t))
    ],
)


@formula(
    "excesses",
    "Four numbers; if one is positive, no point of the cell has the normal $n$. Each compares a "
    "derivative of the height along $n$ at the centre, or a combination of both with one parameter "
    "eliminated, with its change over the cell. $R$ and $S$ bound the remainders beyond a "
    "quadratic patch.",
)
def EXCESSES() -> Parts:
    """Bound both derivatives over the cell, and their combinations without t and without s."""
    along, across = P + A * s + B * t, Q + B * s + C * t
    linear = {"e1": along, "e2": across, "e3": C * along - B * across, "e4": A * across - B * along}
    outputs = []
    for name, form in linear.items():
        value = substitute(form, {s: sp.S.Zero, t: sp.S.Zero})
        rest = sum(
            (sp.Abs(sp.diff(form, z)) * bound for z, bound in ((P, R), (Q, S))), start=sp.S.Zero
        )
        slope = _largest(sp.expand(form - value)).xreplace(
            {sp.Abs(sign * SOLUTION.D): sp.Abs(D) for sign in (-1, 1)}
        )
        outputs.append((name, sp.Abs(sp.expand(value)) - slope - rest))
    return Parts(inputs=[*LINEAR_FORMS, R, S], terms=[("D", SOLUTION.D)], outputs=outputs)


# --- one point ------------------------------------------------------------------------------------


@formula(
    "contraction",
    "The inverse $y11$, $y12$, $y22$ of the Hessian $A$, $B$, $C$ at the centre, and bounds $q1$ "
    "and $q2$ of the rows of its product with the change of the Hessian over the cell, whose third "
    "derivatives are $T0$, …, $T3$ up to $R0$, …, $R3$. If both bounds are below 1, at most one "
    "point of the cell has the normal $n$ or $-n$.",
)
def CONTRACTION() -> Parts:
    """Multiply the change of the Hessian over the cell by the inverse of the Hessian."""
    hessian = sp.hessian(_cubic(THIRDS, s, t), (s, t))
    inverse = sp.Matrix([[y11, y12], [y12, y22]])
    change = inverse * hessian
    radii = inverse.applyfunc(sp.Abs) * sp.hessian(_cubic(RADII, s, t), (s, t))
    rows = [
        sum((_largest(sp.expand(change[k, j])) for j in (0, 1)), start=sp.S.Zero)
        + sum((sp.expand(radii[k, j]).subs({s: 1, t: 1}) for j in (0, 1)), start=sp.S.Zero)
        for k in (0, 1)
    ]
    entries = sp.Matrix([[C, -B], [-B, A]]) / D
    return Parts(
        inputs=[A, B, C, *THIRDS, *RADII],
        terms=[("D", SOLUTION.D)],
        outputs=[
            ("y11", entries[0, 0]),
            ("y12", entries[0, 1]),
            ("y22", entries[1, 1]),
            ("q1", rows[0]),
            ("q2", rows[1]),
        ],
    )


# --- normals --------------------------------------------------------------------------------------


def _ordinate(polynomial: sp.Expr, places: dict[sp.Symbol, sp.Expr]) -> sp.Expr:
    """Return one Bernstein ordinate, over −1 … 1, of a polynomial of degree 2 in each parameter.

    `places` selects the ordinate by a value for each parameter: −1 for the first, 0 for the middle
    and 1 for the last one.
    """
    for z, place in places.items():
        low, middle, high = (polynomial.subs(z, k) for k in (-1, 0, 1))
        polynomial = {-1: low, 0: 2 * middle - (low + high) / 2, 1: high}[int(place)]
    return polynomial


@formula(
    "normal_ordinates",
    "The Bernstein ordinates of $x_s × x_t$ of a patch over the cell: its normals lie in the cone "
    "that they span.",
)
def NORMAL_ORDINATES() -> Parts:
    """Expand x_s × x_t of the patch by s and t; products of vectors are symbols."""
    along, across = (d, a, b), (e, b, c)
    powers = (sp.S.One, s, t)
    normal = sum(
        (
            Cross(m, k) * i * j
            for (m, i), (k, j) in product(
                zip(along, powers, strict=True), zip(across, powers, strict=True)
            )
            if m != k
        ),
        start=sp.S.Zero,
    )
    names = (sp.S.NegativeOne, sp.S.Zero, sp.S.One)
    return Parts(
        inputs=VECTORS,
        outputs=[
            (f"N{k}", sp.expand(_ordinate(normal, {s: i, t: j})))
            for k, (i, j) in enumerate(product(names, names))
        ],
    )


# --- no point, two, or a double one ---------------------------------------------------------------
#
# If the Hessian has one small eigenvalue, rotated parameters are used, i along the other
# eigenvector (x, y) and j across it: s = x i − y j, t = y i + x j. The derivative by i of the
# height along n is 0 on one curve i(j), along which the other derivative is strictly convex or
# concave.


def _turned(thirds: Iterable[sp.Expr]) -> list[sp.Expr]:
    """Return the third derivatives by i and j from third derivatives by s and t."""
    form = _cubic(thirds, x * i - y * j, y * i + x * j)
    return [sp.expand(sp.diff(form, *by)) for by in ((i, i, i), (i, i, j), (i, j, j), (j, j, j))]


def _without_signs(expression: sp.Expr) -> sp.Expr:
    terms = (term.as_coeff_Mul() for term in sp.Add.make_args(expression))
    size = {x: sp.Abs(x), y: sp.Abs(y)}
    return sum((abs(k) * rest.xreplace(size) for k, rest in terms), start=sp.S.Zero)


TURNED = Formula.build(
    "turned",
    "The third derivatives by $i$ and $j$ in turned coordinates, $s = x i - y j$, $t = y i + x j$, "
    "from those by $s$ and $t$: $T0$, …, $T3$ up to $R0$, …, $R3$.",
    inputs=[*THIRDS, *RADII, x, y],
    outputs=[
        *((f"M{k}", z) for k, z in enumerate(_turned(THIRDS))),
        *((f"S{k}", _without_signs(z)) for k, z in enumerate(_turned(RADII))),
    ],
)

TURNED_FORMS = Formula.build(
    "turned_forms",
    "The linear forms by $i$ and $j$ in turned coordinates, $s = x i - y j$, $t = y i + x j$.",
    inputs=[*LINEAR_FORMS, x, y],
    outputs=[
        (
            f"{form.name}_m",
            sp.expand(sp.diff(substitute(MODEL, {s: x * i - y * j, t: y * i + x * j}), *by)).subs(
                {i: 0, j: 0}
            ),
        )
        for form, by in zip(LINEAR_FORMS, ((i, i), (i, j), (j, j), (i,), (j,)), strict=True)
    ],
)

G0, G1, G2, W, c2, g, h, k, m, r, z = (
    scalar(name) for name in ("G0", "G1", "G2", "W", "c2", "g", "h", "k", "m", "r", "z")
)
first, second, off = scalar("o1"), scalar("o2"), scalar("o3")

FOLD_CURVE = Formula.build(
    "fold_curve",
    "The curve $i(j)$ on which the derivative by $i$ of the height along $n$ vanishes, in a "
    "rectangle with the half widths $h$ and $W$. $m > 0$ bounds the second derivative by $i$ from "
    "below, and $k$ the slope of the curve. $g$ bounds the difference between the second "
    "derivative of the other equation along the curve and the third derivative by $j$. The curve "
    "reaches from $-W$ to $W$ if $z < 0$. $A$ and $P$ are derivatives by $i$ at the centre, where "
    "that by $i$ and $j$ vanishes; $G0$, $G1$, $G2$ bound third derivatives, and $o1$, $o2$ the "
    "rounding of first and second ones.",
    inputs=[A, P, G0, G1, G2, h, W, first, second],
    outputs=[
        ("m", sp.Abs(A) - G0 * h - G1 * W - second),
        ("k", (G1 * h + G2 * W + second) / m),
        ("g", 3 * G2 * k + 3 * G1 * k**2 + G0 * k**3),
        ("z", sp.Abs(P) + first + second * W + G2 * W**2 / 2 - m * h),
    ],
)

FOLD_EXTREME = Formula.build(
    "fold_extreme",
    "A test of the other equation near its extreme value along the curve of `fold_curve`, where "
    "its second derivative is at least $c2$ in absolute value: it has no zero if $|Q| > r$ and $Q$ "
    "has the sign of this derivative. Otherwise zeros are at most $y$ away by $j$, and $z$ by $i$.",
    inputs=[*LINEAR_FORMS, G0, G1, G2, k, m, c2, first, second],
    terms=[
        ("o3", (sp.Abs(P) + first) / m),
        ("g", sp.Abs(C - B**2 / A) + (G2 + 2 * k * G1 + k**2 * G0) * off + second * (1 + k) ** 2),
        ("h", first + k * (sp.Abs(P) + first)),
    ],
    outputs=[
        ("r", h + g**2 / (2 * c2)),
        ("y", (g + sp.sqrt(g**2 + 2 * c2 * (sp.Abs(Q) + h))) / c2),
        ("z", off + k * y),
    ],
)

FORMULAS = (
    MODEL_AT,
    REMAINDERS,
    EXCESSES,
    CONTRACTION,
    NORMAL_ORDINATES,
    TURNED,
    TURNED_FORMS,
    FOLD_CURVE,
    FOLD_EXTREME,
)
