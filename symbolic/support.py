"""Support functions as such, eqs. (4)-(7): of a patch, and of any function h on the sphere.

Whatever a user writes for h off the sphere, the surface depends on its values on the sphere alone:
it is that of the extension |n| h(n/|n|), which is homogeneous of degree 1. The gradient of this
extension is eq. (5) with eq. (6), and its Hessian is derived here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import cast

import sympy as sp

from .formula import Formula, compose
from .notation import Dot, dot, scalar, substitute, vectors
from .patch import CURVATURE, ENVELOPE, FORMS, HESSIAN, PARAMETERS, SUPPORT_FUNCTION, TANGENTS

__all__ = [
    "BRANCH",
    "CURVATURE_FROM_HESSIAN",
    "ENTRIES",
    "ENVELOPE_OPERATOR",
    "FORMULAS",
    "HESSIAN_AT",
    "HESSIAN_OF_EXTENSION",
    "HESSIAN_SYMBOLS",
    "INTRINSIC_GRADIENT",
    "LOOPS",
    "OFFSET",
    "OFFSET_CURVATURE",
    "OFFSET_GROWTH",
    "PARAMETERS_AT",
    "SECOND_DERIVATIVES",
    "TANGENT_PLANE",
]

# The entries of a symmetric matrix, in the order of the formula `hessian`.
ENTRIES = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}

n, x, dh = vectors(("n", "x", "dh"))
(intrinsic,) = vectors(["dh_S"])
h, R = scalar("h"), scalar("R")


def named(name: str) -> tuple[sp.Symbol, ...]:
    """Return the symbols name_xx, name_yy and so on."""
    return tuple(scalar(f"{name}_{key}") for key in ENTRIES)


def symmetric(symbols: Iterable[sp.Symbol]) -> sp.Matrix:
    """Return the symmetric matrix of these symbols."""
    values = {place: x for x, place in zip(symbols, ENTRIES.values(), strict=True)}
    return sp.Matrix(3, 3, lambda i, j: values[min(i, j), max(i, j)])


def entries(name: str, matrix: sp.Matrix) -> list[tuple[str, sp.Expr]]:
    """Return the entries of a symmetric matrix with their names."""
    return [(f"{name}_{key}", cast(sp.Expr, matrix[place])) for key, place in ENTRIES.items()]


SECOND_DERIVATIVES = named("h")
HESSIAN_SYMBOLS = named("H")
SECOND = symmetric(SECOND_DERIVATIVES)
HESSIAN_MATRIX = symmetric(HESSIAN_SYMBOLS)
TANGENTIAL = sp.eye(3) - n.column * n.column.T


def _on_sphere(expression: sp.Expr) -> sp.Expr:
    """Return a polynomial in n for |n| = 1 in its normal form, that of degree below 2 in n_z."""
    n_z = n.components[2]
    return cast(sp.Expr, sp.rem(sp.expand(expression), dot(n.column, n.column) - 1, n_z))


def _derivatives_of_extension(function: sp.Expr, order: int) -> sp.Matrix:
    """Differentiate |n| f(n/|n|) and put |n| = 1; `function` is f in the components of n."""
    square = dot(n.column, n.column)
    length = sp.sqrt(square)
    extension = length * substitute(function, {s: s / length for s in n.components})
    if order == 1:
        derived = sp.Matrix([sp.diff(extension, s) for s in n.components])
    else:
        derived = sp.hessian(extension, n.components)
    return derived.applyfunc(lambda value: substitute(value, {square: sp.S.One}))


def _to_second_order() -> tuple[sp.Expr, dict[sp.Symbol, sp.Expr]]:
    """Return a function with the value h, gradient dh, second derivatives h_xx … at c; and c = n.

    No other function need be looked at: first and second derivatives see no more of it.
    """
    (c,) = vectors("c")
    step = n.column - c.column
    function = h + dot(dh.column, step) + dot(step, SECOND * step) / 2
    return function, dict(zip(c.components, n.components, strict=True))


def _verified(target: sp.Matrix, derived: sp.Matrix) -> sp.Matrix:
    """Return `target` if it is `derived` on the unit sphere; ArithmeticError if not."""
    function_at = _to_second_order()[1]
    for value, expected in zip(target.flat(), derived.flat(), strict=True):
        if _on_sphere(value - substitute(expected, function_at)) != 0:
            raise ArithmeticError(f"{value} is not what differentiation gives")
    return target


TANGENT_PLANE = Formula.build(
    "tangent_plane",
    "The support function at the normal $n$ of the point $x$: the distance of the tangent plane "
    "from the origin.",
    source="eqs. (2) and (4)",
    inputs=[n, x],
    outputs=[("h", Dot(n, x))],
)

INTRINSIC_GRADIENT = Formula.build(
    "intrinsic_gradient",
    "The intrinsic gradient $dh_S$ of a function on the unit sphere: the gradient $dh$ of any "
    "extension of it, projected into the tangent plane of the sphere.",
    source="eq. (6)",
    inputs=[dh, n],
    terms=[("g", Dot(dh, n))],
    outputs=[("dh_S", dh - scalar("g") * n)],
)

_verified(
    n.column * h + dh.column - n.column * dot(dh.column, n.column),
    _derivatives_of_extension(_to_second_order()[0], 1),
)

ENVELOPE_OPERATOR = Formula.build(
    "envelope_operator",
    "The point of the envelope of the tangent planes, for any function $h$ on the unit sphere; "
    "linear in $h$, so that the sum of functions gives the convolution of surfaces.",
    source="eqs. (5) and (7)",
    inputs=[h, intrinsic, n],
    outputs=[("x", h * n + intrinsic)],
)


def _hessian_of_extension() -> Formula:
    """Write the Hessian of |n| h(n/|n|) in h, dh, h_xx …, and check it by differentiation."""
    (along,) = vectors("q")
    g, k, r = (scalar(name) for name in "gkr")
    normal, q, along_normal = n.column, along.column, SECOND * n.column
    written = SECOND - normal * q.T - q * normal.T + (r - k) * normal * normal.T + k * sp.eye(3)
    terms = [
        *((x.name, y) for x, y in zip(along.components, along_normal.flat(), strict=True)),
        ("r", dot(normal, q)),
        ("g", Dot(dh, n)),
        ("k", h - g),
    ]
    values = dict(zip(along.components, along_normal.flat(), strict=True))
    values |= {r: dot(normal, along_normal), k: h - dot(dh.column, normal)}
    plain = written.applyfunc(lambda entry: substitute(entry, values))
    _verified(plain, _derivatives_of_extension(_to_second_order()[0], 2))
    return Formula.build(
        "hessian_of_extension",
        "The Hessian, at a unit normal $n$, of $|n| h(n/|n|)$: it follows from value, gradient and "
        "second derivatives of any function $h$ that has the same values on the sphere.",
        inputs=[h, n, dh, *SECOND_DERIVATIVES],
        terms=terms,
        outputs=entries("H", written),
    )


HESSIAN_OF_EXTENSION = _hessian_of_extension()


def _offset() -> Formula:
    """Differentiate the support function R |n| of a sphere."""
    _verified(n.column * R, _derivatives_of_extension(R, 1))
    hessian = _verified(TANGENTIAL * R, _derivatives_of_extension(R, 2))
    return Formula.build(
        "offset",
        "The sphere of radius $R$, $h = R|n|$, at a unit normal $n$: envelope and Hessian. Its "
        "convolution with a surface is the offset at the distance $R$.",
        source="eqs. (5)-(7)",
        inputs=[R, n],
        outputs=[("x", R * n), *entries("H", hessian)],
    )


OFFSET = _offset()


def _curvature_from_hessian() -> Formula:
    """Read the radii from the characteristic polynomial, of which 0 (with n) is one root."""
    _, minus_trace, minors, _ = HESSIAN_MATRIX.charpoly().all_coeffs()
    m, q = scalar("m"), scalar("q")
    squares = (x**2 for x in symmetric(named("T")).flat())
    formula = Formula.build(
        "curvature_from_hessian",
        "Curvature from the Hessian of a support function at a unit normal $n$: half the sum $m$ "
        "of the principal radii, their product $q$, and the square $S$ of half their difference, "
        "so that they are $m$ plus and minus its root; Gaussian and mean curvature.",
        inputs=[n, *HESSIAN_SYMBOLS],
        terms=[("m", -minus_trace / 2), *entries("T", HESSIAN_MATRIX - m * TANGENTIAL)],
        outputs=[
            ("q", minors),
            ("S", sum(squares, start=sp.S.Zero) / 2),
            ("K", 1 / q),
            ("H", m / q),
        ],
    )
    return replace(formula, outputs=(m, *formula.outputs))


CURVATURE_FROM_HESSIAN = _curvature_from_hessian()


K, H = scalar("K"), scalar("H")
AREA_GROWTH = 1 + 2 * R * H + R**2 * K


def _in_radii(value: sp.Expr, change: sp.Expr = sp.S.Zero) -> sp.Expr:
    """Write what K and H say in the principal radii, after these have changed."""
    R_1, R_2 = (scalar(name) + change for name in ("R_1", "R_2"))
    return substitute(value, {K: 1 / (R_1 * R_2), H: (R_1 + R_2) / (2 * R_1 * R_2)})


def _offset_curvature() -> Formula:
    """Add R to both radii, and write the result in the curvatures."""
    s = scalar("s")
    outputs = [("s", AREA_GROWTH), ("K_offset", K / s), ("H_offset", (H + R * K) / s)]
    for (_, target), curvature in zip(outputs[1:], (K, H), strict=True):
        moved = _in_radii(curvature, R)
        if sp.cancel(_in_radii(substitute(target, {s: AREA_GROWTH})) - moved) != 0:
            raise ArithmeticError(f"{target} is not {moved}")
    return Formula.build(
        "offset_curvature",
        "Gaussian and mean curvature of the offset at the distance $R$, of use also where a radius "
        "is infinite. $s$ is how much the product of the radii grows: 0 where one becomes 0.",
        inputs=[K, H, R],
        outputs=outputs,
    )


def _offset_growth() -> Formula:
    """Say by which factors (R_i + R)/R_i the radii grow: their product and their mean."""
    factors = [1 + R / scalar(name) for name in ("R_1", "R_2")]
    outputs = {"s": AREA_GROWTH, "m": 1 + R * H}
    expected = factors[0] * factors[1], (factors[0] + factors[1]) / 2
    for written, derived in zip(outputs.values(), expected, strict=True):
        if sp.cancel(_in_radii(written) - derived) != 0:
            raise ArithmeticError(f"{written} is not {derived}")
    return Formula.build(
        "offset_growth",
        "The factors by which an offset at the distance $R$ stretches the surface along its two "
        "principal directions: their product $s$ and their mean $m$. Both are positive where $R$ "
        "has passed no radius of curvature; elsewhere the offset is folded.",
        inputs=[K, H, R],
        outputs=list(outputs.items()),
    )


OFFSET_CURVATURE = _offset_curvature()
OFFSET_GROWTH = _offset_growth()

BRANCH = compose(
    "branch",
    "What one patch has at the normal $n$, once its parameters are known: point, Hessian of the "
    "support function, curvatures.",
    [FORMS, TANGENTS, ENVELOPE, HESSIAN, CURVATURE],
    source="eqs. (1), (5)-(9); curvatures beyond the paper",
    outputs=[x, *HESSIAN_SYMBOLS, scalar("K"), scalar("H")],
)

PARAMETERS_AT = compose(
    "parameters_at",
    "The parameters at which a patch has the normal $n$, from its vectors.",
    [FORMS, PARAMETERS],
    source="eq. (9)",
    outputs=[scalar("u"), scalar("v")],
)

HESSIAN_AT = compose(
    "hessian_at",
    "The Hessian of the support function of a patch where the parameters are known already.",
    [FORMS, TANGENTS, HESSIAN],
    source="eqs. (1), (9); Hessian beyond the paper",
    outputs=HESSIAN_SYMBOLS,
)

GRADIENT_AT_NORMAL = compose(
    "gradient_at_normal",
    "The gradient of the support function of a patch at the normal $n$: the point of the patch "
    "that has this normal.",
    [FORMS, PARAMETERS, ENVELOPE],
    source="eqs. (5)-(9)",
    outputs=[x],
)

HESSIAN_AT_NORMAL = compose(
    "hessian_at_normal",
    "The Hessian of the support function of a patch at the normal $n$.",
    [FORMS, PARAMETERS, TANGENTS, HESSIAN],
    source="eqs. (1), (9); Hessian beyond the paper",
    outputs=HESSIAN_SYMBOLS,
)

CURVATURE_AT_NORMAL = compose(
    "curvature_at_normal",
    "Gaussian and mean curvature of a patch at the point that has the unit normal $n$.",
    [FORMS, PARAMETERS, TANGENTS, CURVATURE],
    source="eqs. (1), (9); curvatures beyond the paper",
    outputs=[K, H],
)

# What is emitted as loops over arrays, with the inputs that have a row for each evaluation.
LOOPS = {
    SUPPORT_FUNCTION: (n,),
    GRADIENT_AT_NORMAL: (n,),
    HESSIAN_AT_NORMAL: (n,),
    CURVATURE_AT_NORMAL: (n,),
    BRANCH: (n, scalar("u"), scalar("v")),
    TANGENT_PLANE: (n, x),
}

FORMULAS = (
    TANGENT_PLANE,
    INTRINSIC_GRADIENT,
    ENVELOPE_OPERATOR,
    HESSIAN_OF_EXTENSION,
    OFFSET,
    OFFSET_CURVATURE,
    OFFSET_GROWTH,
    CURVATURE_FROM_HESSIAN,
    BRANCH,
    PARAMETERS_AT,
    HESSIAN_AT,
    GRADIENT_AT_NORMAL,
    HESSIAN_AT_NORMAL,
    CURVATURE_AT_NORMAL,
)
