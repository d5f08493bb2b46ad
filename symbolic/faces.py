"""Faces of CAD parts: surfaces of revolution, offset surfaces, and normals of tori and cones.

Faces of other kinds are rational surfaces, or surfaces of the catalogue moved in space.
"""

from collections.abc import Iterable
from typing import cast

import sympy as sp

from .formula import BEYOND_THE_PAPER, Content, Formula, Parts, formula
from .jet import N_ALONG
from .notation import Dot, VectorSymbol, derivative, scalar, substitute, vectors
from .patch import VECTORS, a, b, c, d, e, p
from .surfaces import TORUS

# The derivatives of a surface by u and v, in the order of its 2-jet.
ORDERS = ("", "u", "v", "uu", "uv", "vv")

x, y = scalar("x"), scalar("y")
CURVE: tuple[VectorSymbol, ...] = vectors(("c", "c_v", "c_vv"))


def _revolution() -> Content:
    """Rotate a curve c(v) about the z axis, and differentiate."""
    u, v = sp.symbols("u v", real=True)
    along = [sp.Function(f"c_{axis}")(v) for axis in "xyz"]
    turned = [
        along[0] * sp.cos(u) - along[1] * sp.sin(u),
        along[0] * sp.sin(u) + along[1] * sp.cos(u),
        along[2],
    ]
    known = {
        (sp.diff(function, v, order) if order else function): component
        for order, vector in enumerate(CURVE)
        for function, component in zip(along, vector.components, strict=True)
    } | {sp.cos(u): x, sp.sin(u): y}
    outputs = vectors([f"x_{order}" if order else "p" for order in ORDERS])
    by = {"u": u, "v": v}
    definitions = tuple(
        (symbol, substitute(sp.diff(value, *map(by.get, order)) if order else value, known))
        for vector, order in zip(outputs, ORDERS, strict=True)
        for symbol, value in zip(vector.components, turned, strict=True)
    )
    return Content((*CURVE, x, y), definitions, outputs)


REVOLUTION_JET = Formula(
    "revolution_jet",
    "The point $p$ and the derivatives of a surface of revolution around the z axis, from those of "
    "the curve $c(v)$ that is turned; $x$ and $y$ are the cosine and the sine of the angle $u$.",
    BEYOND_THE_PAPER,
    _revolution,
)

THIRD: tuple[VectorSymbol, ...] = vectors(("x_uuu", "x_uuv", "x_uvv", "x_vvv"))
n, n_u, n_v = vectors(("n", "n_u", "n_v"))
N_u, N_v, N_uu, N_uv, N_vv = vectors(("N_u", "N_v", "N_uu", "N_uv", "N_vv"))
L, L_u, L_v, L_uu, L_uv, L_vv, R, g = map(
    scalar, ("L", "L_u", "L_v", "L_uu", "L_uv", "L_vv", "R", "g")
)


@formula(
    "offset_jet",
    "The point $y = p + R n$ and the derivatives of the offset of a surface, from the point $p$, "
    "the 2-jet and the third derivatives of the surface, its unit normal $n$, and the length $L$ "
    "of $N = d × e$.",
)
def OFFSET_JET() -> Parts:
    """Differentiate N = x_u × x_v and N = L n, with |n| = 1, for the derivatives of n."""
    uuu, uuv, uvv, vvv = THIRD
    along_u, along_v = N_ALONG
    by_u, by_v = {d: a, e: b, a: uuu, b: uuv}, {d: b, e: c, a: uuv, b: uvv, c: vvv}
    return Parts(
        inputs=[*VECTORS, p, *THIRD, n, L, R],
        terms=[
            ("g", 1 / L),
            ("N_u", along_u),
            ("N_v", along_v),
            ("N_uu", derivative(along_u, by_u)),
            ("N_uv", derivative(along_u, by_v)),
            ("N_vv", derivative(along_v, by_v)),
            ("L_u", Dot(N_u, n)),
            ("L_v", Dot(N_v, n)),
            ("n_u", g * (N_u - L_u * n)),
            ("n_v", g * (N_v - L_v * n)),
            ("L_uu", Dot(N_uu, n) + L * Dot(n_u, n_u)),
            ("L_uv", Dot(N_uv, n) + L * Dot(n_u, n_v)),
            ("L_vv", Dot(N_vv, n) + L * Dot(n_v, n_v)),
        ],
        outputs=[
            ("y", p + R * n),
            ("y_u", d + R * n_u),
            ("y_v", e + R * n_v),
            ("y_uu", a + R * g * (N_uu - L_uu * n - 2 * L_u * n_u)),
            ("y_uv", b + R * g * (N_uv - L_uv * n - L_u * n_v - L_v * n_u)),
            ("y_vv", c + R * g * (N_vv - L_vv * n - 2 * L_v * n_v)),
        ],
    )


OFFSET_SIDE = Formula.build(
    "offset_side",
    "A number $D$ with the sign of the product of the normals of a surface and of its offset by "
    "$R$: the determinant of the first fundamental form minus $R$ times the second one, from "
    "first and second derivatives of the surface and its unit normal $n$.",
    inputs=[*VECTORS, n, R],
    outputs=[
        (
            "D",
            (Dot(d, d) - R * Dot(a, n)) * (Dot(e, e) - R * Dot(c, n))
            - (Dot(d, e) - R * Dot(b, n)) ** 2,
        )
    ],
)


def _quotient(field: Iterable[sp.Expr], longitude: sp.Expr, latitude: sp.Expr) -> sp.Expr:
    """Divide a normal field by the parallel unit vector at a longitude and latitude.

    Raises ValueError if they are not parallel.
    """
    across = sp.cos(latitude)
    direction = sp.cos(longitude) * across, sp.sin(longitude) * across, sp.sin(latitude)
    quotients = {
        sp.factor(sp.simplify(value / part)) for value, part in zip(field, direction, strict=True)
    }
    (quotient,) = cast(set[sp.Expr], quotients)
    return quotient


@formula(
    "torus_normal",
    "The quotient $q$ of $x_u × x_v$ and the unit vector with the longitude $u$ and the latitude "
    "$v$, on a torus with the radii $R$ and $r$, a sphere if $R = 0$; $x$ is the cosine of $v$.",
)
def TORUS_NORMAL() -> Parts:
    """Divide the normal field of a torus by the unit vector at the same angles."""
    quotient = _quotient(TORUS.normal_field, TORUS.u, TORUS.v)
    R, r, x = map(scalar, ("R", "r", "x"))
    major, minor = TORUS.defaults
    return Parts(
        inputs=[R, r, x],
        outputs=[("q", substitute(quotient, {major: R, minor: r, sp.cos(TORUS.v): x}))],
    )


@formula(
    "cone_normal",
    "The quotient $q$ of $x_u × x_v$ and the unit vector with the longitude $u$ and the latitude "
    "that is minus the half angle, on a cone whose radius is $R$ where $v = 0$, or a cylinder; $x$ "
    "is the sine of the half angle, $y$ is $v$.",
)
def CONE_NORMAL() -> Parts:
    """Rotate a line about the z axis, and divide the normal by the unit vector along it."""
    u, v, angle, radius = sp.symbols("u v angle radius", real=True)
    across = radius + v * sp.sin(angle)
    position = sp.Matrix([across * sp.cos(u), across * sp.sin(u), v * sp.cos(angle)])
    along_u, along_v = sp.Matrix(position.diff(u)), sp.Matrix(position.diff(v))
    quotient = _quotient(along_u.cross(along_v), u, -angle)
    R, x, y = map(scalar, ("R", "x", "y"))
    return Parts(
        inputs=[R, x, y], outputs=[("q", substitute(quotient, {radius: R, sp.sin(angle): x, v: y}))]
    )


FORMULAS = (REVOLUTION_JET, OFFSET_JET, OFFSET_SIDE, TORUS_NORMAL, CONE_NORMAL)
