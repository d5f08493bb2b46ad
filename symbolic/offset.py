"""Sect. 3: the linear field of normals of a quadratic patch, and its exact rational offset.

The envelope operator is rational and homogeneous of degree 0 in the normal n. So any field of
normals gives a parametrization x(s,t) = ∇h(n(s,t)) of a patch: a linear field gives a rational one,
and a polynomial field of polynomial length gives a rational offset, without square roots.
"""

import sympy as sp

from .formula import Formula, Parts, compose, formula
from .notation import dot, scalar, substitute, vectors
from .patch import ENVELOPE, FORMS, PARAMETERS

SOURCE = "Sect. 3"

n, n0, n1, n2, x, y = vectors(("n", "n_0", "n_1", "n_2", "x", "y"))
BASIS = vectors(("e_1", "e_2", "e_3"))
s, t, R, length = (scalar(name) for name in "stRq")

LINEAR_FIELD = Formula.build(
    "linear_field",
    "A linear field of normals: all directions are those of $n(s, t)$, if $n_0$, $n_1$, $n_2$ are "
    "linearly independent.",
    source=SOURCE,
    inputs=[n0, n1, n2, s, t],
    outputs=[("n", n0 + s * n1 + t * n2)],
)

LINEAR_NORMALS = compose(
    "linear_normals",
    "The patch with a linear field of normals: a rational parametrization $x(s, t)$ whose normal "
    "has the direction of $n(s, t)$.",
    [LINEAR_FIELD, FORMS, PARAMETERS, ENVELOPE],
    source=SOURCE,
    outputs=[n, x],
)


@formula(
    "spherical_field",
    "A field of normals whose length $q$ is a polynomial: the stereographic projection, with "
    "respect to an orthonormal basis. It gives every direction except $-e_3$.",
    source=SOURCE,
)
def SPHERICAL_FIELD() -> Parts:
    """Project the plane of e_1, e_2 onto the unit sphere from −e_3, and clear the denominators."""
    k = sp.Symbol("k")
    on_line = sp.Matrix([k * s, k * t, k - 1])  # −e_3 at k = 0
    (place,) = (x for x in sp.solve(dot(on_line, on_line) - 1, k) if x != 0)
    below = sp.denom(sp.together(place))
    along = (sp.expand(sp.cancel(substitute(x, {k: place}) * below)) for x in on_line.flat())
    return Parts(
        inputs=[*BASIS, s, t],
        outputs=[
            ("n", sum((x * y for x, y in zip(along, BASIS, strict=True)), start=sp.S.Zero)),
            ("q", sp.expand(below)),
        ],
    )


MOVED = Formula.build(
    "moved",
    "A point moved by the distance $R$ along its normal $n$, whose length is $q$.",
    source=SOURCE,
    inputs=[x, n, length, R],
    outputs=[("y", x + R / length * n)],
)

RATIONAL_OFFSET = compose(
    "rational_offset",
    "The offset of a patch at the distance $R$, in a rational parametrization $y(s, t)$ without "
    "square roots; its normal has the direction of $n(s, t)$.",
    [SPHERICAL_FIELD, FORMS, PARAMETERS, ENVELOPE, MOVED],
    source=SOURCE,
    outputs=[y],
)

FORMULAS = (LINEAR_FIELD, LINEAR_NORMALS, SPHERICAL_FIELD, RATIONAL_OFFSET)
