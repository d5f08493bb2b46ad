"""Support functions, eqs. (4)-(7), of patches, spheres and offsets; and curvature."""

import sympy as sp

from .envelope import (
    ENVELOPE_OPERATOR,
    HESSIAN_MATRIX,
    HESSIAN_OF_EXTENSION,
    HESSIAN_SYMBOLS,
    INTRINSIC_GRADIENT,
    TANGENTIAL,
    derivatives_of_extension,
    entries,
    n,
    named,
    symmetric,
    verified,
    x,
)
from .formula import BEYOND_THE_PAPER, Content, Formula, Parts, compose, formula
from .notation import Dot, scalar, substitute
from .patch import CURVATURE, ENVELOPE, FORMS, HESSIAN, PARAMETERS, SUPPORT_FUNCTION, TANGENTS

R = scalar("R")

TANGENT_PLANE = Formula.build(
    "tangent_plane",
    "The support function at the normal $n$ of the point $x$: the distance of the tangent plane "
    "from the origin.",
    source="eqs. (2) and (4)",
    inputs=[n, x],
    outputs=[("h", Dot(n, x))],
)


@formula(
    "offset",
    "The sphere of radius $R$, $h = R|n|$, at a unit normal $n$: envelope and Hessian. Its "
    "convolution with a surface is the offset at the distance $R$.",
    source="eqs. (5)-(7)",
)
def OFFSET() -> Parts:
    """Differentiate the support function R |n| of a sphere."""
    verified(n.column * R, derivatives_of_extension(R, 1))
    hessian = verified(TANGENTIAL * R, derivatives_of_extension(R, 2))
    return Parts(inputs=[R, n], outputs=[("x", R * n), *entries("H", hessian)])


def _curvature_from_hessian() -> Content:
    """Derive the principal radii from the characteristic polynomial, which has the root 0 for n."""
    _, minus_trace, minors, _ = HESSIAN_MATRIX.charpoly().all_coeffs()
    m, q = scalar("m"), scalar("q")
    squares = (x**2 for x in symmetric(named("T")).flat())
    parts = Parts(
        inputs=[n, *HESSIAN_SYMBOLS],
        terms=[("m", -minus_trace / 2), *entries("T", HESSIAN_MATRIX - m * TANGENTIAL)],
        outputs=[
            ("q", minors),
            ("S", sum(squares, start=sp.S.Zero) / 2),
            ("K", 1 / q),
            ("H", m / q),
        ],
    )
    content = parts.named()
    return content._replace(outputs=(m, *content.outputs))


CURVATURE_FROM_HESSIAN = Formula(
    "curvature_from_hessian",
    "Gaussian and mean curvature from the Hessian of a support function at a unit normal $n$. "
    "$m$ is the mean of the principal radii, $q$ their product and $S$ the square of half their "
    "difference.",
    BEYOND_THE_PAPER,
    _curvature_from_hessian,
)

K, H = scalar("K"), scalar("H")
AREA_GROWTH = 1 + 2 * R * H + R**2 * K


def _in_radii(value: sp.Expr, change: sp.Expr = sp.S.Zero) -> sp.Expr:
    """Write K and H in the principal radii, after adding `change` to both radii."""
    R_1, R_2 = (scalar(name) + change for name in ("R_1", "R_2"))
    return substitute(value, {K: 1 / (R_1 * R_2), H: (R_1 + R_2) / (2 * R_1 * R_2)})


@formula(
    "offset_curvature",
    "Gaussian and mean curvature of the offset at the distance $R$; principal radii may be "
    "infinite. $s$ is the factor by which the product of the radii grows, 0 where one of them "
    "becomes 0.",
)
def OFFSET_CURVATURE() -> Parts:
    """Add R to both principal radii, and write K and H of the offset in terms of K and H."""
    s = scalar("s")
    outputs = [("s", AREA_GROWTH), ("K_offset", K / s), ("H_offset", (H + R * K) / s)]
    for (_, target), curvature in zip(outputs[1:], (K, H), strict=True):
        moved = _in_radii(curvature, R)
        if sp.cancel(_in_radii(substitute(target, {s: AREA_GROWTH})) - moved) != 0:
            raise ArithmeticError(f"{target} is not {moved}")
    return Parts(inputs=[K, H, R], outputs=outputs)


@formula(
    "offset_growth",
    "The factors by which an offset at the distance $R$ stretches the surface along its two "
    "principal directions: their product $s$ and their mean $m$. Both are positive where $R$ has "
    "passed no radius of curvature; elsewhere the offset is folded.",
)
def OFFSET_GROWTH() -> Parts:
    """Write the factors (R_i + R)/R_i by which the radii grow: their product and their mean."""
    factors = [1 + R / scalar(name) for name in ("R_1", "R_2")]
    outputs = {"s": AREA_GROWTH, "m": 1 + R * H}
    expected = factors[0] * factors[1], (factors[0] + factors[1]) / 2
    for written, derived in zip(outputs.values(), expected, strict=True):
        if sp.cancel(_in_radii(written) - derived) != 0:
            raise ArithmeticError(f"{written} is not {derived}")
    return Parts(inputs=[K, H, R], outputs=outputs.items())


BRANCH = compose(
    "branch",
    "Point, Hessian of the support function and curvatures of a patch at the normal $n$, given "
    "its parameters.",
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
    "The Hessian of the support function of a patch at given parameters.",
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

# The formulas that are emitted as loops over arrays, with the inputs that are arrays.
LOOPS = {
    SUPPORT_FUNCTION: (n,),
    GRADIENT_AT_NORMAL: (n,),
    HESSIAN_AT_NORMAL: (n,),
    CURVATURE_AT_NORMAL: (n,),
    BRANCH: (n, scalar("u"), scalar("v")),
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
