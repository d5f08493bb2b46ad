"""Rational surfaces, such as NURBS: the derivatives of a quotient."""

import sympy as sp

from .formula import Parts, formula
from .notation import scalar, substitute, vectors

SOURCE = "beyond the paper; Piegl & Tiller, The NURBS Book, eqs. (4.19) and (4.20)"
# The derivatives of order 0, 1 and 2, named by parameters; each follows the derivatives on which it
# depends.
ORDERS = ("", "u", "v", "uu", "uv", "vv")


def _symbol(kind: str, order: str) -> sp.Symbol:
    """Return the symbol of a derivative of the numerator A, the denominator w or the point x."""
    name = f"{kind}_{order}" if order else kind
    return scalar(name) if kind == "w" else vectors([name])[0]


@formula(
    "rational_jet",
    "The point $x = A/w$ of a rational surface and its first and second derivatives, from those of "
    "the numerator $A$ and the denominator $w$.",
    source=SOURCE,
)
def RATIONAL_JET() -> Parts:
    """Solve for the derivatives of x = A/w from those of A = w x, with r = 1/w."""
    u, v = sp.symbols("u v")
    point, weight = (sp.Function(name)(u, v) for name in ("x", "w"))
    r = scalar("r")
    results: list[tuple[str, sp.Expr]] = []
    for order in ORDERS:
        product = sp.diff(weight * point, *order) if order else weight * point
        known = {
            (sp.diff(f, *x) if x else f): _symbol(kind, x)
            for x in ORDERS
            for kind, f in (("x", point), ("w", weight))
        }
        wanted = _symbol("x", order)
        equation = substitute(product.doit(), known) - _symbol("A", order)
        (solution,) = sp.solve(equation, wanted)
        numerator = sp.expand(solution * scalar("w"))
        results.append((wanted.name, r * numerator))
    return Parts(
        inputs=[_symbol(kind, order) for kind in "Aw" for order in ORDERS],
        terms=[("r", 1 / scalar("w"))],
        outputs=results,
    )


FORMULAS = (RATIONAL_JET,)
