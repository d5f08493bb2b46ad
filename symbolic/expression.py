"""A user's support function h(n): from a SymPy expression to the source of a function of arrays."""

import math
import textwrap
from collections.abc import Sequence
from typing import cast

import sympy as sp
from sympy.logic.boolalg import Boolean

from .envelope import (
    ENTRIES,
    ENVELOPE_OPERATOR,
    HESSIAN_OF_EXTENSION,
    HESSIAN_SYMBOLS,
    INTRINSIC_GRADIENT,
    SECOND_DERIVATIVES,
    n,
    x,
)
from .formula import Content, Formula, compose
from .notation import Definition, dot, flat, scalar
from .printer import array_source_of, source_of
from .simplify import straight_line

NORMAL = n.components
# For longer expressions, homogeneity is not tested, and the general formula is used, which always
# holds.
LONGEST_PROOF = 2000
MOST_EXPANDED = 10_000  # the largest number of terms to which the proof may expand
ROUNDING = 1e-9  # relative to h
GENERIC = sp.Rational(3, 7), sp.Rational(5, 11), sp.Rational(8, 13)


def array_function(h: sp.Expr, domain: Boolean | bool = True) -> str:
    """Return the source of a function `evaluate`: envelope and Hessian of h for many normals.

    The arguments of `evaluate` are the components of unit normals, arrays (k,). It returns whether
    they are in the domain, the components of the points, and the six entries of the Hessians, as
    arrays (k,) or constants.

    `h` and `domain` are in the real symbols n_x, n_y, n_z. Raises NotImplementedError for functions
    that `math` does not have, and for sums over an index.
    """
    if h.has(sp.Sum, sp.Product):
        raise NotImplementedError("sums and products over an index")
    condition = cast(sp.Expr, sp.sympify(domain))
    code = straight_line(branch(_exact(h))).assignments
    for each in (condition, *(value for _, value in code)):
        source_of(each)  # raises NotImplementedError
    lines = [f"{name} = {array_source_of(value)}" for name, value in code]
    results = [array_source_of(condition), *map(str, (*x.components, *HESSIAN_SYMBOLS))]
    body = textwrap.indent("\n".join([*lines, f"return {', '.join(results)}"]), "    ")
    used = [f"import {x}" for x in ("functools", "numpy", "scipy.special") if f"{x}." in body]
    head = f"def evaluate({', '.join(map(str, NORMAL))}):"
    return "\n".join([*used, "\n", head, body, ""])


def branch(h: sp.Expr) -> Formula:
    """Return the formula of envelope and Hessian at a unit normal.

    The gradient of a function that is homogeneous of degree 1 is the envelope; for other functions,
    eqs. (5) and (6) are used.
    """
    gradient = [_derivative(h, axis) for axis in NORMAL]
    hessian = [_derivative(gradient[i], NORMAL[j]) for i, j in ENTRIES.values()]
    outputs = (*x.components, *HESSIAN_SYMBOLS)
    if is_homogeneous(h, gradient):
        return _given((*zip(outputs, (*gradient, *hessian), strict=True),))
    names = (scalar("h"), *flat([INTRINSIC_GRADIENT.inputs[0]]), *SECOND_DERIVATIVES)
    parts = [
        _given((*zip(names, (h, *gradient, *hessian), strict=True),)),
        *(y.in_components() for y in (INTRINSIC_GRADIENT, ENVELOPE_OPERATOR, HESSIAN_OF_EXTENSION)),
    ]
    return compose("given", "", parts, source="eqs. (5) and (6)", outputs=outputs)


def _given(definitions: tuple[Definition, ...]) -> Formula:
    symbols = tuple(symbol for symbol, _ in definitions)
    content = Content(NORMAL, definitions, symbols)
    return Formula("given", "", "eqs. (5) and (6)", lambda: content)


def is_homogeneous(h: sp.Expr, gradient: Sequence[sp.Expr] | None = None) -> bool:
    """Return whether h is proved to be homogeneous of degree 1, by Euler's relation n·∇h = h."""
    if gradient is None:
        gradient = [_derivative(h, axis) for axis in NORMAL]
    defect = dot(sp.Matrix(gradient), n.column) - h
    if defect.count_ops() > LONGEST_PROOF:
        return False
    if not _vanishes(defect, h):
        return False
    signs = {s: sp.Abs(s.args[0]) / s.args[0] for s in defect.atoms(sp.sign)}
    quotient = cast(sp.Expr, sp.together(defect.xreplace(signs)))
    numerator = quotient.as_numer_denom()[0]
    return _expanded_terms(numerator) <= MOST_EXPANDED and sp.expand(numerator) == 0


def _vanishes(defect: sp.Expr, h: sp.Expr) -> bool:
    """Return whether the defect n·∇h − h is rounding error at one point.

    This quickly excludes most functions that are not homogeneous. The test is in float64, as evalf
    takes exponential time for nested sums and products, and longer for exp(exp(exp(n_x))).
    """
    try:
        evaluate = sp.lambdify(NORMAL, [defect, h], modules="math", cse=True)
        value, size = (float(x) for x in evaluate(*map(float, GENERIC)))
    except (ArithmeticError, ValueError, TypeError, NameError, RecursionError, SyntaxError):
        return False
    return abs(value) <= ROUNDING * abs(size)


def _expanded_terms(expression: sp.Expr) -> float:
    """Return an upper bound of the number of terms into which an expression expands."""
    inner = [_expanded_terms(cast(sp.Expr, x)) for x in expression.args]
    if expression.is_Add:
        return sum(inner)
    if expression.is_Mul:
        return math.prod(inner)
    if isinstance(expression, sp.Pow) and expression.exp.is_Integer:
        degree, terms = abs(int(cast(sp.Integer, expression.exp))), inner[0]
        return math.comb(degree + int(terms) - 1, degree) if terms < MOST_EXPANDED else math.inf
    return max(inner, default=1)


def _derivative(expression: sp.Expr, by: sp.Symbol) -> sp.Expr:
    """Differentiate where the function is smooth.

    The delta functions that SymPy gives at kinks, such as that of |n_x|, are dropped: (7) does not
    apply there.
    """
    derivative = sp.diff(expression, by)
    kinks = dict.fromkeys(derivative.atoms(sp.DiracDelta), sp.S.Zero)
    return cast(sp.Expr, derivative.xreplace(kinks))


def _exact(h: sp.Expr) -> sp.Expr:
    """Replace floats by their exact binary values, so that their sums cancel exactly."""
    return cast(sp.Expr, h.xreplace({x: sp.Rational(x) for x in h.atoms(sp.Float)}))
