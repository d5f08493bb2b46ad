"""One quadratic Bézier triangle, given by numbers or symbols, and its support function."""

from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import combinations_with_replacement
from reprlib import repr as shown
from typing import Any, cast

import sympy as sp

from .formula import Formula
from .notation import flat, scalar, substitute
from .offset import BASIS, LINEAR_FIELD, MOVED, SPHERICAL_FIELD, n0, n1, n2
from .patch import CLOSED_CURVATURE, FORMS, NET, ORIENTATION, POWER_FORM, SUPPORT_FUNCTION, n, u, v
from .reading import ReadingError, read

PAPER_NORMAL = (scalar("n_1"), scalar("n_2"), scalar("n_3"))
AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


class BezierTriangle:
    """A quadratic Bézier triangle (10) with exact control points.

    `control_points` are six points of three coordinates in the order b200, b020, b002, b110, b101,
    b011; u belongs to b200, v to b020. Coordinates are numbers, SymPy expressions, or texts of
    either. A float stands for its exact binary value, a text such as "0.1" for its decimal value.

    Results are expressions in the components of `normal`, of any length: by default n_1, n_2, n_3
    as in the paper (real symbols, available as `patch.normal`), or the three given symbols. Results
    that need the support function raise ValueError if the patch is developable, and so has none.
    """

    def __init__(
        self, control_points: Iterable[Iterable[object]], normal: Sequence[sp.Symbol] = PAPER_NORMAL
    ) -> None:
        """Raise ValueError unless given six points of three real coordinates, and three symbols.

        Texts are read by `reading.read`, which runs no code.
        """
        self.normal = _three_symbols(normal)
        reserved = {*normal, u, v}
        rows = [[_exact(x, reserved) for x in point] for point in _six_points(control_points)]
        self.control_points = tuple(sp.ImmutableMatrix(row) for row in rows)
        net = dict(zip(flat(NET), (x for row in rows for x in row), strict=True))
        self._values = {
            scalar(name): substitute(x, net) for name, x in POWER_FORM.expanded().items()
        }

    def evaluate(self, formula: Formula) -> dict[str, sp.Expr]:
        """Return the outputs of a formula for this patch.

        Inputs that do not belong to the patch stay symbols.
        """
        values = self._values | dict(zip(n.components, self.normal, strict=True))
        return {name: substitute(x, values) for name, x in formula.expanded().items()}

    @cached_property
    def forms(self) -> dict[str, sp.Expr]:
        """The quadratic forms D, U, V, W."""
        return {name: sp.expand(form) for name, form in self.evaluate(FORMS).items()}

    @cached_property
    def parameters(self) -> tuple[sp.Expr, sp.Expr]:
        """The parameters u(n), v(n)."""
        self._require_support_function()
        u_of_n, v_of_n = (sp.cancel(self.forms[x] / self.forms["D"]) for x in "UV")
        return u_of_n, v_of_n

    @cached_property
    def support_function(self) -> sp.Expr:
        """The support function h(n): cubic over quadratic, written as in formula (12)."""
        return written_in_groups(self._cubic_over_quadratic, self.normal)

    @cached_property
    def _cubic_over_quadratic(self) -> sp.Expr:
        self._require_support_function()
        return sp.cancel(self.evaluate(SUPPORT_FUNCTION)["h"])

    @cached_property
    def gradient(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """The gradient of the support function: the point of the patch with the normal n."""
        x, y, z = (sp.cancel(sp.diff(self._cubic_over_quadratic, by)) for by in self.normal)
        return x, y, z

    @cached_property
    def hessian(self) -> sp.ImmutableMatrix:
        """The Hessian of the support function."""
        entries = {
            (i, j): sp.cancel(sp.diff(self.gradient[i], self.normal[j]))
            for i, j in combinations_with_replacement(range(3), 2)
        }
        return sp.ImmutableMatrix(3, 3, lambda i, j: entries[min(i, j), max(i, j)])

    @cached_property
    def orientation(self) -> sp.Expr:
        """The cubic form c3(n), which is positive if n is the oriented normal."""
        return sp.expand(self.evaluate(ORIENTATION)["c3_twice"] / 2)

    @cached_property
    def gaussian_curvature(self) -> sp.Expr:
        """The Gaussian curvature K(n); ValueError if no point of the patch is regular."""
        self._require_support_function()
        if self.orientation == 0:
            raise ValueError("the patch has no regular point (c3 = 0)")
        values = {
            scalar("D"): self.forms["D"],
            scalar("c3_twice"): 2 * self.orientation,
            **dict(zip(n.components, self.normal, strict=True)),
        }
        return sp.cancel(substitute(CLOSED_CURVATURE.expanded()["K"], values))

    @cached_property
    def mean_curvature(self) -> sp.Expr:
        """The mean curvature at the point with the oriented normal n."""
        return sp.cancel(self._trace * self.gaussian_curvature) * self._length / 2

    @cached_property
    def principal_radii(self) -> tuple[sp.Expr, sp.Expr]:
        """The signed principal radii of curvature, the larger one first."""
        half_sum = self._trace * self._length / 2
        root = sp.sqrt(half_sum**2 - 1 / self.gaussian_curvature)
        return half_sum + root, half_sum - root

    @cached_property
    def boundary_cones(self) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
        """The symmetric matrices M of the cones nᵀMn = 0 that bound the Gaussian image: U, V, W."""
        u_cone, v_cone, w_cone = (sp.hessian(self.forms[name], self.normal) / 2 for name in "UVW")
        return u_cone, v_cone, w_cone

    def linear_normals(
        self, field: Iterable[Iterable[object]] = (AXES[2], AXES[0], AXES[1])
    ) -> tuple[sp.Matrix, sp.Matrix]:
        """Return the patch with a linear field of normals (Sect. 3): x(s,t) and n(s,t).

        `field` is three vectors n_0, n_1, n_2 for n(s,t) = n_0 + s n_1 + t n_2, by default
        (s, t, 1); s and t are real symbols of these names. The coordinates of x(s,t) are rational,
        and its normal has the direction of n(s,t). Raises ValueError without a support function.
        """
        normal = _given_vectors(LINEAR_FIELD, (n0, n1, n2), field)[:3]
        return self._point_with(normal), sp.Matrix(normal)

    def rational_offset(
        self, distance: object, basis: Iterable[Iterable[object]] = AXES
    ) -> sp.Matrix:
        """Return the exact offset at a distance, three rational expressions in s and t (Sect. 3).

        `basis` is three orthonormal vectors e_1, e_2, e_3: the normal has the direction of
        2s e_1 + 2t e_2 + (1 − s² − t²) e_3. The distance is a number, a SymPy expression or a text.
        Raises ValueError without a support function.
        """
        *normal, length = _given_vectors(SPHERICAL_FIELD, BASIS, basis)
        given = [*self._point_with(normal), *normal, length, _exact(distance, set())]
        values = dict(zip(flat(MOVED.inputs), given, strict=True))
        return sp.Matrix([substitute(y, values) for y in MOVED.expanded().values()])

    def _point_with(self, normal: Sequence[sp.Expr]) -> sp.Matrix:
        """Return the point with the normal n(s,t), as quotients of polynomials in s and t."""
        values = dict(zip(self.normal, normal, strict=True))
        quotients = (sp.fraction(component) for component in self.gradient)
        return sp.Matrix(
            [
                sp.expand(substitute(above, values)) / sp.expand(substitute(below, values))
                for above, below in quotients
            ]
        )

    def _require_support_function(self) -> None:
        if self.forms["D"] == 0:
            raise ValueError("the patch is developable (D = 0): it has no support function")

    @cached_property
    def _trace(self) -> sp.Expr:
        return cast(sp.Expr, sp.cancel(self.hessian.trace()))

    @property
    def _length(self) -> sp.Expr:
        return sp.sqrt(sum((x**2 for x in self.normal), start=sp.S.Zero))

    def latex(self) -> str:
        """Return h(n) = … as LaTeX; ValueError if there is no support function."""
        names = ", ".join(sp.latex(x) for x in self.normal)
        return f"h({names}) = {sp.latex(self.support_function, order='none')}"

    def _repr_latex_(self) -> str | None:
        """Show the support function in a notebook, if there is one."""
        return None if self.forms["D"] == 0 else rf"$\displaystyle {self.latex()}$"

    def __repr__(self) -> str:
        points = ", ".join(str(tuple(x.flat())) for x in self.control_points)
        return f"BezierTriangle([{points}])"


def written_in_groups(quotient: sp.Expr, variables: Sequence[sp.Symbol]) -> sp.Expr:
    """Write a quotient of polynomials with rational coefficients as eq. (12) in the paper.

    Terms of the numerator with equal coefficients, up to the sign, are in brackets; terms and
    brackets are in the order of their highest powers. The common factor of the denominator precedes
    the quotient.
    """
    above, below = (sp.Poly(x, *variables) for x in sp.fraction(quotient))
    if not all(x.is_Rational for x in (*above.coeffs(), *below.coeffs())):
        return quotient
    factor, denominator = below.primitive()
    groups: dict[sp.Expr, list[sp.Expr]] = {}
    for powers, coefficient in above.terms():
        monomial = sp.Mul(*(x**k for x, k in zip(variables, powers, strict=True)))
        terms = groups.setdefault(abs(coefficient), [])
        terms.append(monomial if coefficient > 0 else -monomial)
    parts = [_times(coefficient, sp.Add(*terms)) for coefficient, terms in groups.items()]
    numerator = sp.Add(*parts, evaluate=False) if len(parts) > 1 else parts[0]
    inverse = sp.Pow(denominator.as_expr(), -1, evaluate=False)
    return sp.Mul(*([] if factor == 1 else [1 / factor]), numerator, inverse, evaluate=False)


def _times(factor: sp.Expr, expression: sp.Expr) -> sp.Expr:
    """Return a product that SymPy does not multiply out."""
    if factor == 1 or not expression.is_Add:
        return factor * expression
    return sp.Mul(factor, expression, evaluate=False)


def _three_symbols(normal: Sequence[sp.Symbol]) -> tuple[sp.Symbol, ...]:
    """Return the components of the normal; ValueError unless they are three different symbols."""
    components = tuple(normal) if isinstance(normal, Iterable) else ()
    symbols = [x for x in components if isinstance(x, sp.Symbol)]
    if len(components) != 3 or len(set(symbols)) != 3:
        raise ValueError(f"normal must be three different SymPy symbols, not {shown(normal)}")
    return components


def _six_points(control_points: Iterable[Iterable[object]]) -> list[list[object]]:
    """Return the coordinates of six points; ValueError unless they are six times three."""
    try:
        points = [[] if isinstance(point, str) else list(point) for point in control_points]
    except TypeError:
        points = []
    if [len(point) for point in points] != [3] * 6:
        raise ValueError("control_points must be six points of three coordinates each")
    return points


def _given_vectors(
    formula: Formula, names: Sequence[sp.Symbol], rows: Iterable[Iterable[object]]
) -> list[sp.Expr]:
    """Return the outputs of a formula for three given vectors.

    Their coordinates are numbers, SymPy expressions or texts, as those of control points.
    """
    numbers = [_exact(entry, set()) for row in rows for entry in row]
    values = dict(zip(flat(names), numbers, strict=True))
    return [substitute(output, values) for output in formula.expanded().values()]


def _exact(value: object, reserved: set[sp.Symbol]) -> sp.Expr:
    """Return a coordinate as an exact SymPy expression, without floating-point numbers.

    Raises ValueError unless it is real and finite (or a symbol) and does not use n, u, v.
    """
    try:
        text = isinstance(value, str)
        expression = read(value, exact=True) if text else cast(Any, sp.sympify)(value, strict=True)
    except (ReadingError, sp.SympifyError, ValueError, TypeError):
        expression = None
    if not isinstance(expression, sp.Expr) or expression.is_Matrix:
        raise ValueError(f"{shown(value)} is not a coordinate")
    expression = substitute(expression, {x: sp.Rational(x) for x in expression.atoms(sp.Float)})
    if expression.is_real is False or expression.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise ValueError(f"the coordinate {shown(value)} is not a real number")
    if used := expression.free_symbols & reserved:
        raise ValueError(f"the coordinate {shown(value)} uses {shown(sorted(map(str, used)))}")
    return expression
