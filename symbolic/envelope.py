"""The envelope of any function h on the sphere, eqs. (5)-(7), and the Hessian of its extension.

The surface depends only on the values of h on the sphere, whatever its extension: it is the
envelope of |n| h(n/|n|), which is homogeneous of degree 1. The gradient of this extension is eq.
(5) with eq. (6), and its Hessian is derived here.
"""

from collections.abc import Iterable
from typing import cast

import sympy as sp

from .formula import Formula, Parts, formula
from .notation import Dot, dot, scalar, substitute, vectors

# The entries of a symmetric matrix, in the order of the formula `hessian`.
ENTRIES = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}

n, x, dh = vectors(("n", "x", "dh"))
(intrinsic,) = vectors(["dh_S"])
h = scalar("h")


def named(name: str) -> tuple[sp.Symbol, ...]:
    """Return the symbols name_xx, name_yy and so on."""
    return tuple(scalar(f"{name}_{key}") for key in ENTRIES)


def symmetric(symbols: Iterable[sp.Symbol]) -> sp.Matrix:
    """Return the symmetric matrix (3, 3) with these six symbols, in the order of ENTRIES."""
    values = {place: x for x, place in zip(symbols, ENTRIES.values(), strict=True)}
    return sp.Matrix(3, 3, lambda i, j: values[min(i, j), max(i, j)])


def entries(name: str, matrix: sp.Matrix) -> list[tuple[str, sp.Expr]]:
    """Return the entries of a symmetric matrix as pairs of a name (such as H_xx) and a value."""
    return [(f"{name}_{key}", cast(sp.Expr, matrix[place])) for key, place in ENTRIES.items()]


SECOND_DERIVATIVES = named("h")
HESSIAN_SYMBOLS = named("H")
SECOND = symmetric(SECOND_DERIVATIVES)
HESSIAN_MATRIX = symmetric(HESSIAN_SYMBOLS)
TANGENTIAL = sp.eye(3) - n.column * n.column.T


def _on_sphere(expression: sp.Expr) -> sp.Expr:
    """Return a polynomial in n reduced by |n| = 1 to a degree below 2 in n_z."""
    n_z = n.components[2]
    return cast(sp.Expr, sp.rem(sp.expand(expression), dot(n.column, n.column) - 1, n_z))


def derivatives_of_extension(function: sp.Expr, order: int) -> sp.Matrix:
    """Differentiate |n| f(n/|n|) and substitute |n| = 1; `function` is f in the components of n."""
    square = dot(n.column, n.column)
    length = sp.sqrt(square)
    extension = length * substitute(function, {s: s / length for s in n.components})
    if order == 1:
        derived = sp.Matrix([sp.diff(extension, s) for s in n.components])
    else:
        derived = sp.hessian(extension, n.components)
    return derived.applyfunc(lambda value: substitute(value, {square: sp.S.One}))


def _to_second_order() -> tuple[sp.Expr, dict[sp.Symbol, sp.Expr]]:
    """Return a polynomial f(n) of degree 2 about a point c, and the substitution that sets c to n.

    At c, f has the value h, the gradient dh and the second derivatives h_xx, …. Therefore f can
    stand for any function: first and second derivatives at c do not depend on terms of higher
    order.
    """
    (c,) = vectors("c")
    step = n.column - c.column
    function = h + dot(dh.column, step) + dot(step, SECOND * step) / 2
    return function, dict(zip(c.components, n.components, strict=True))


def verified(target: sp.Matrix, derived: sp.Matrix) -> sp.Matrix:
    """Return `target` if it equals `derived` on the unit sphere; else raise ArithmeticError."""
    function_at = _to_second_order()[1]
    for value, expected in zip(target.flat(), derived.flat(), strict=True):
        if _on_sphere(value - substitute(expected, function_at)) != 0:
            raise ArithmeticError(f"{value} is not what differentiation gives")
    return target


@formula(
    "intrinsic_gradient",
    "The intrinsic gradient $dh_S$ of a function on the unit sphere: the gradient $dh$ of any "
    "extension of it, projected into the tangent plane of the sphere.",
    source="eq. (6)",
)
def INTRINSIC_GRADIENT() -> Parts:
    """Write eq. (6), and check by differentiation that h n + dh_S is eq. (5)."""
    verified(
        n.column * h + dh.column - n.column * dot(dh.column, n.column),
        derivatives_of_extension(_to_second_order()[0], 1),
    )
    outputs = [("dh_S", dh - scalar("g") * n)]
    return Parts(inputs=[dh, n], terms=[("g", Dot(dh, n))], outputs=outputs)


ENVELOPE_OPERATOR = Formula.build(
    "envelope_operator",
    "The point of the envelope of the tangent planes, for any function $h$ on the unit sphere; "
    "linear in $h$, so that the sum of functions gives the convolution of surfaces.",
    source="eqs. (5) and (7)",
    inputs=[h, intrinsic, n],
    outputs=[("x", h * n + intrinsic)],
)


@formula(
    "hessian_of_extension",
    "The Hessian, at a unit normal $n$, of $|n| h(n/|n|)$: it follows from value, gradient and "
    "second derivatives of any function $h$ that has the same values on the sphere.",
)
def HESSIAN_OF_EXTENSION() -> Parts:
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
    verified(plain, derivatives_of_extension(_to_second_order()[0], 2))
    return Parts(inputs=[h, n, dh, *SECOND_DERIVATIVES], terms=terms, outputs=entries("H", written))
