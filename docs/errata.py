"""Print docs/errata.md: what is wrong or unclear in the paper, each with the computation shown.

Every claim on the page is checked, exactly, before it is printed: ArithmeticError if one fails.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations, permutations, product
from pathlib import Path
from random import Random
from typing import cast

import sympy as sp
from gaussmap.docs.markdown import markdown
from gaussmap.symbolic import BezierTriangle, formulas
from gaussmap.symbolic.notation import dot, substitute
from gaussmap.symbolic.spline import box_spline_net, middle, triangles
from gaussmap.symbolic.surfaces import CATALOGUE, ParametricSurface
from sympy.polys.matrices import DomainMatrix

PAGE = Path(__file__).parent / "_pages" / "errata.md"  # a template for the computed values
n1, n2, n3 = n = sp.symbols("n_1 n_2 n_3", real=True)
u, v, tau = sp.symbols("u v tau", real=True)
x, z, w = sp.symbols("x z w", real=True)

# (11) and (12) of the paper, and what (11) should be: b200, b020, b002, b110, b101, b011.
PRINTED_11 = [
    ["2", 0, 0], [0, "2", 0], [0, 0, "2"], ["3/2", 0, 0], [0, "3/2", 0], [0, 0, "3/2"]
]  # fmt: skip
RIGHT_11 = [
    ["3/2", 0, 0], [0, "3/2", 0], [0, 0, "3/2"], [1, 1, "1/2"], [1, "1/2", 1], ["1/2", 1, 1]
]  # fmt: skip
NUMERATOR_12 = (
    5 * (n1**3 + n2**3 + n3**3)
    + 4 * (n1**2 * n2 + n1**2 * n3 + n1 * n2**2 + n1 * n3**2 + n3 * n2**2 + n3**2 * n2)
    + 13 * n1 * n2 * n3
)
DENOMINATOR_12 = 2 * (n1**2 + 3 * n1 * n2 + n2**2 + 3 * n1 * n3 + 3 * n2 * n3 + n3**2)


def claim(truth: object) -> None:
    """Raise ArithmeticError unless a claim of the page is known to be true."""
    if truth is not True:
        raise ArithmeticError("a claim of docs/errata.md does not hold")


def equal(left: object, right: object) -> bool:
    """Say whether two rational expressions (or matrices of them) are equal, exactly."""
    difference = sp.Matrix([left]) - sp.Matrix([right])
    return difference.applyfunc(sp.cancel).is_zero_matrix is True


def in_paper_symbols(triangle: BezierTriangle, expression: sp.Expr) -> sp.Expr:
    """Write n_1, n_2, n_3 for the components of the normal."""
    return substitute(expression, dict(zip(triangle.normal, n, strict=True)))


def support_function(triangle: BezierTriangle) -> sp.Expr:
    """Return h(n_1, n_2, n_3)."""
    return in_paper_symbols(triangle, triangle.support_function)


def patch(vectors: Mapping[str, Sequence[object]]) -> tuple[sp.Matrix, BezierTriangle]:
    """Return p(u,v) (8) and its Bézier triangle from the vectors a … e; p(0,0) is the origin."""
    a, b, c, d, e = (sp.Matrix(vectors[name]) for name in "abcde")
    p = a * u**2 / 2 + b * u * v + c * v**2 / 2 + d * u + e * v
    net = [d + a / 2, e + c / 2, sp.zeros(3, 1), (d + e + b) / 2, d / 2, e / 2]
    return p, BezierTriangle([point.flat() for point in net])


def second_form(p: sp.Matrix) -> tuple[sp.Matrix, sp.Expr]:
    """Return N = p_u × p_v and LN − M² of a patch p(u,v)."""

    def derivative(*by: sp.Symbol) -> sp.Matrix:
        return sp.Matrix([sp.diff(component, *by) for component in p.flat()])

    normal = derivative(u).cross(derivative(v))
    L, M, N = (dot(normal, derivative(*by)) for by in ((u, u), (u, v), (v, v)))
    return normal, cast(sp.Expr, sp.expand(L * N - M**2))


# --- the page -------------------------------------------------------------------------------------


def page() -> str:
    """Return the page."""
    sections = (control_points, composition, bijectivity, box_splines, parabolic_lines, biangles)
    values = {name: text for section in sections for name, text in section().items()}
    return PAGE.read_text(encoding="utf-8").format(**values)


# --- Sect. 3, eqs. (11) and (12) ------------------------------------------------------------------


def control_points() -> dict[str, object]:
    """Compare the support function of the points (11) with (12), and solve for the right ones."""
    printed, right = BezierTriangle(PRINTED_11), BezierTriangle(RIGHT_11)
    h_12 = NUMERATOR_12 / DENOMINATOR_12
    claim(equal(support_function(right), h_12))
    claim(not equal(support_function(printed), h_12))
    ones = dict.fromkeys(n, sp.S.One)
    test_normal = (1, 2, 4)
    test_value = substitute(h_12, dict(zip(n, map(sp.Integer, test_normal), strict=True)))
    values = values_in_all_orders(PRINTED_11, test_normal)
    claim(fraction(test_value) not in values)
    solutions = symmetric_solutions()
    claim(solutions[0] == (sp.Rational(3, 2), sp.S.One, sp.S.Half))
    return {
        "printed": math(net_latex(printed)),
        "h_printed": math(quotient("h", *sp.fraction(support_function(printed)))),
        "h_12": math(quotient("h", NUMERATOR_12, DENOMINATOR_12)),
        "value_printed": substitute(support_function(printed), ones),
        "value_12": substitute(h_12, ones),
        "orders": len(values),
        "test_value": test_value,
        "test_normal": test_normal,
        "solutions": math(
            r",\quad ".join(f"(x, z, w) = {sp.latex(solution)}" for solution in solutions)
        ),
        "right": math(net_latex(right)),
    }


def values_in_all_orders(
    points: Sequence[Sequence[object]], normal: tuple[int, int, int]
) -> list[Fraction]:
    """Return h(normal) for every patch whose control points are these six in some order.

    Orders that only rename the corners give the same patch, and are taken once.
    """
    symbols = sp.symbols("b0:6x b0:6y b0:6z", real=True)
    net = [symbols[k::6] for k in range(6)]
    triangle = BezierTriangle(net)
    at_normal = dict(zip(triangle.normal, map(sp.Integer, normal), strict=True))
    h = substitute(triangle.evaluate(formulas["support_function"])["h"], at_normal)
    numerator, denominator = (
        sp.lambdify(symbols, sp.expand(part)) for part in sp.fraction(sp.together(h))
    )
    exact = [[Fraction(str(coordinate)) for coordinate in point] for point in points]
    values = []
    for corners in combinations(range(6), 3):
        others = [k for k in range(6) if k not in corners]
        for edges in permutations(others):
            flat = [exact[k][axis] for axis in range(3) for k in (*corners, *edges)]
            values.append(Fraction(numerator(*flat)) / Fraction(denominator(*flat)))
    return values


def symmetric_solutions() -> list[tuple[sp.Expr, ...]]:
    """Return all (x, z, w) whose symmetric net has the support function (12), x > 0 first."""
    triangle = BezierTriangle([[x, 0, 0], [0, x, 0], [0, 0, x], [z, z, w], [z, w, z], [w, z, z]])
    numerator, denominator = sp.fraction(support_function(triangle))
    difference = sp.expand(numerator * DENOMINATOR_12 - NUMERATOR_12 * denominator)
    basis = sp.groebner(sp.Poly(difference, *n).coeffs(), x, z, w, order="lex")
    found = sp.solve(list(basis.exprs), [x, z, w], dict=True)
    form = triangle.forms["D"]
    regular = [s for s in found if sp.expand(form.subs(s)) != 0]
    return sorted((tuple(s[k] for k in (x, z, w)) for s in regular), reverse=True)


def net_latex(triangle: BezierTriangle) -> str:
    """Return the control points as an aligned block."""
    names = ("200", "020", "002", "110", "101", "011")
    points = [
        rf"\mathbf{{b}}_{{{name}}} &= {sp.latex(tuple(point.flat()))}"
        for name, point in zip(names, triangle.control_points, strict=True)
    ]
    rows = [" & ".join(points[k : k + 3]) for k in (0, 3)]
    return "\\begin{aligned}\n" + " \\\\[1ex]\n".join(rows) + "\n\\end{aligned}"


# --- Sect. 2 --------------------------------------------------------------------------------------


def composition() -> dict[str, object]:
    """Show on the ellipsoid which order of composition gives its support function."""
    entry = CATALOGUE["ellipsoid"]
    a, b, c = entry.defaults
    inverse = (sp.atan2(b * n2, a * n1), sp.atan2(c * n3, sp.sqrt((a * n1) ** 2 + (b * n2) ** 2)))
    at_normal = dict(zip((entry.u, entry.v), inverse, strict=True))
    point = sp.Matrix(entry.position).xreplace(at_normal).applyfunc(sp.simplify)
    normal = sp.Matrix(entry.normal_field).xreplace(at_normal).applyfunc(sp.simplify)
    column = sp.Matrix(n)
    claim(equal(list(normal.cross(column)), [0, 0, 0]))
    claim(positive(dot(normal, column)))
    h = cast(sp.Expr, sp.simplify(dot(column, point)))
    claim(equal(h**2, (a * n1) ** 2 + (b * n2) ** 2 + (c * n3) ** 2))
    gradient = [sp.simplify(sp.diff(h, by) - q) for by, q in zip(n, point, strict=True)]
    claim(gradient == [0, 0, 0])
    maps = {"N": (2, 3), "H": (2, 1), "N⁻¹": (len(n), len(inverse))}
    return {
        "maps": composition_table(maps),
        "ellipsoid": math(f"x(u, v) = {sp.latex(entry.position)},"),
        "inverse": math(rf"N^{{-1}}(n) = (u, v) = {sp.latex(inverse)}"),
        "h_ellipsoid": math(f"h(n) = (H \\circ N^{{-1}})(n) = {sp.latex(h)}"),
    }


def positive(expression: sp.Expr) -> bool:
    """Say whether an expression is known to be positive for all n without zero components.

    It is if it is even in each component, and positive in the first octant.
    """
    even = all(sp.simplify(expression - expression.subs(q, -q)) == 0 for q in n)
    octant = {q: sp.Symbol(q.name, positive=True) for q in n}
    return even and sp.simplify(substitute(expression, octant)).is_positive is True


def composition_table(maps: Mapping[str, tuple[int, int]]) -> str:
    """Return a table of maps and compositions: how many numbers each takes and gives."""
    rows = [(name, str(takes), str(gives)) for name, (takes, gives) in maps.items()]
    for outer, inner in (("H", "N⁻¹"), ("N⁻¹", "H")):
        (needs, gives), (takes, inner_gives) = maps[outer], maps[inner]
        fits = needs == inner_gives
        claim(fits is (outer == "H"))
        clash = f"– ({inner} gives {inner_gives}, {outer} takes {needs})"
        rows.append((f"{outer} ∘ {inner}", str(takes), str(gives) if fits else clash))
    return markdown(("map", "takes numbers", "gives numbers"), rows, ":--")


def bijectivity() -> dict[str, object]:
    """Show a surface without parabolic and singular points that has each normal several times."""
    entry: ParametricSurface = CATALOGUE["helicoid"]
    (pitch,) = entry.defaults
    turn = {entry.v: entry.v + 2 * sp.pi}
    normal = sp.Matrix(entry.normal_field)
    curvature, area = map(sp.simplify, (entry.gaussian_curvature, dot(normal, normal)))
    claim(curvature.is_negative and area.is_positive)
    claim(all(sp.simplify(q.xreplace(turn) - q) == 0 for q in normal.flat()))
    shift = tuple(sp.simplify(q.xreplace(turn) - q) for q in entry.position)
    claim(shift == (0, 0, 2 * sp.pi * pitch))
    position, curvature, area, shift = (
        sp.latex(q, symbol_names={pitch: "c"}) for q in (entry.position, curvature, area, shift)
    )
    return {
        "helicoid": math(f"x(u, v) = {position}"),
        "curvature": math(rf"K = {curvature} < 0, \qquad |x_u \times x_v|^2 = {area} > 0,"),
        "shift": math(rf"N(u, v + 2\pi) = N(u, v), \qquad x(u, v + 2\pi) = x(u, v) + {shift}."),
    }


# --- Sect. 3.1 ------------------------------------------------------------------------------------


COUNTED_GRIDS = ((1, 1), (2, 2), (3, 2), (3, 3), (4, 3), (5, 4))


def box_splines() -> dict[str, object]:
    """Count the box splines that do not vanish on a domain of several sizes."""
    rows = []
    for columns, lines in COUNTED_GRIDS:
        found = box_splines_on(columns, lines)
        outside = sum(not (0 <= i < columns and 0 <= j < lines) for i, j in found)
        rank = dimension(list(found.values()))
        printed = (columns + 1) * (lines + 1)
        claim(len(found) == (columns + 2) * (lines + 2))
        claim(outside == 2 * (columns + lines) + 4)
        claim(printed < rank == len(found) - 1)
        claim(chessboard_vanishes(found))
        numbers = (printed, len(found), outside, rank)
        rows.append((f"{columns} × {lines}", *map(str, numbers)))
    header = ("n × m cells", "printed", "counted", "centre outside", "dimension")
    return {"counts": markdown(header, rows, ":--")}


Ordinates = dict[tuple[Fraction, Fraction], Fraction]


def box_splines_on(columns: int, lines: int) -> dict[tuple[int, int], Ordinates]:
    """Return the box splines that do not vanish on columns × lines cells, by their centres.

    Each has its Bézier ordinates on the domain, also those that are 0, by position.
    """
    cells = list(product(range(columns), range(lines)))
    places = {middle(p, q) for tile in triangles(cells) for p, q in product(tile, repeat=2)}
    net = box_spline_net()
    found = {}
    for i, j in product(range(-3, columns + 3), range(-3, lines + 3)):
        ordinates = {p: net.get((p[0] - i, p[1] - j), Fraction(0)) for p in sorted(places)}
        if any(ordinates.values()):
            found[i, j] = ordinates
    return found


def dimension(functions: Sequence[Ordinates]) -> int:
    """Return the dimension of the span of functions, given by their Bézier ordinates."""
    rows = [
        [sp.QQ(y.numerator, y.denominator) for y in function.values()] for function in functions
    ]
    return DomainMatrix(rows, (len(rows), len(rows[0])), sp.QQ).rank()


def chessboard_vanishes(found: Mapping[tuple[int, int], Ordinates]) -> bool:
    """Say whether the sum of (−1)^(i+j) B_ij is zero on the domain."""
    places = next(iter(found.values()))
    return all(
        sum((-1) ** (i + j) * ordinates[place] for (i, j), ordinates in found.items()) == 0
        for place in places
    )


# --- Sect. 3.2 ------------------------------------------------------------------------------------


EXAMPLE = """\
### {title}

{vectors}

{cubic}

{q}

{lines}
"""

UNIT_VECTORS = {"a": (1, 0, 0), "b": (0, 1, 0), "c": (0, 0, 1)}


def parabolic_lines() -> dict[str, object]:
    """Show on random integer patches that LN − M² splits into three lines."""
    check_lines({**UNIT_VECTORS, "d": sp.symbols("d1:4"), "e": sp.symbols("e1:4")})
    general = math(
        r"n(\tau) = a^* + \tau b^* + \tau^2 c^*, \quad \rho(\tau) = n(\tau) \cdot d, \quad "
        r"q(\tau) = \tau\, (n(\tau) \cdot d) - n(\tau) \cdot e"
    )
    identity = math(
        r"\det(a, b, c)^2\, \mathrm{Res} = -(c^* \cdot d)\, (LN - M^2), \qquad \deg(LN - M^2) = 3,"
    )
    examples = []
    for count, title in ((1, "One real line"), (3, "Three real lines")):
        vectors = random_patch(count)
        check_lines(vectors)
        _, cubic = second_form(patch(vectors)[0])
        q, rho, _ = lines_of(vectors)
        roots = [cast(sp.Expr, root) for root in q.real_roots()]
        lines = [f"u {signed(t)}\\, v {signed(substitute(rho, {tau: t}))} = 0" for t in roots]
        examples.append(
            EXAMPLE.format(
                title=title,
                vectors=math(r",\quad ".join(f"{k} = {sp.latex(t)}" for k, t in vectors.items())),
                cubic=math(f"LN - M^2 = {sp.latex(cubic)}"),
                q=math(f"q(\\tau) = {sp.latex(q.as_expr())}"),
                lines=math(r",\qquad ".join(lines)),
            )
        )
    return {"general": general, "identity": identity, "examples": "\n".join(examples)}


def signed(value: sp.Expr) -> str:
    """Return a number with six digits, its sign set apart."""
    return f"{'-' if value < 0 else '+'} {float(abs(value)):.6g}"


def random_patch(real_lines: int) -> dict[str, tuple[int, ...]]:
    """Return the first random patch with three distinct lines, a given number of them real."""
    random = Random(2024)
    while True:
        vectors = {name: tuple(random.randint(-3, 3) for _ in range(3)) for name in "abcde"}
        if sp.Matrix([vectors[name] for name in "abc"]).det() != 0:
            q, _, _ = lines_of(vectors)
            distinct = q.degree() == 3 and q.discriminant() != 0
            if distinct and len(q.real_roots()) == real_lines:
                return vectors


def lines_of(vectors: Mapping[str, Sequence[object]]) -> tuple[sp.Poly, sp.Expr, sp.Matrix]:
    """Return q(τ), ρ(τ) and n(τ) of a patch whose vectors a, b, c are a basis."""
    basis = sp.Matrix([vectors[name] for name in "abc"])
    normal = basis.inv() * sp.Matrix([1, tau, tau**2])
    d, e = (sp.Matrix(vectors[name]) for name in "de")
    rho = sp.expand(dot(normal, d))
    return sp.Poly(tau * rho - dot(normal, e), tau), rho, normal


def check_lines(vectors: Mapping[str, Sequence[object]]) -> None:
    """Check that LN − M² is the product of three lines, and that each of them has one normal."""
    normal, cubic = second_form(patch(vectors)[0])
    q, rho, common = lines_of(vectors)
    claim(sp.Poly(cubic, u, v).total_degree() == 3)
    claim(q.degree() == 3)
    resultant = sp.resultant(q.as_expr(), u + tau * v + rho, tau)
    determinant = cast(sp.Expr, sp.Matrix([vectors[name] for name in "abc"]).det())
    claim(equal(determinant**2 * resultant, -q.LC() * cubic))
    along = normal.xreplace({u: -tau * v - rho}).cross(common)
    claim(all(sp.prem(sp.expand(x), q.as_expr(), tau) == 0 for x in along.flat()))


PARABOLOID = {"a": (0, 0, 1), "b": (0, 0, 0), "c": (0, 0, 1), "d": (1, 0, 0), "e": (0, 1, 0)}
FLAT_EDGE = {"a": (0, 0, 1), "b": (1, 0, 0), "c": (0, 0, 0), "d": (1, 0, 0), "e": (0, 1, 0)}


def biangles() -> dict[str, object]:
    """Show a patch with singular cones and three corners, and one whose image is a biangle."""
    rows = []
    for vectors, corners in ((PARABOLOID, 3), (FLAT_EDGE, 2)):
        p, triangle = patch(vectors)
        forms = [in_paper_symbols(triangle, triangle.forms[name]) for name in "UVW"]
        ranks = [cone.rank() for cone in triangle.boundary_cones]
        normal, _ = second_form(p)
        directions = {direction(normal.subs({u: i, v: j})) for i, j in ((0, 0), (1, 0), (0, 1))}
        claim(len(directions) == corners)
        rows.append(
            (
                f"({', '.join(map(plain, p.flat()))})",
                *(plain(sp.factor(form)) for form in forms),
                ", ".join(map(str, ranks)),
                str(len(directions)),
            )
        )
    normal, cubic = second_form(patch(FLAT_EDGE)[0])
    claim(normal.subs(u, 0) == sp.Matrix([0, 0, 1 + v]) and cubic.subs(u, 0) == 0)
    header = ("p(u, v)", "U", "V", "W", "ranks of the cones", "corners of the image")
    return {"cones": markdown(header, rows, ":--"), "cubic": plain(cubic)}


def direction(vector: sp.Matrix) -> tuple[sp.Expr, ...]:
    """Return a vector divided by its length."""
    length = sp.sqrt(dot(vector, vector))
    return tuple(q / length for q in vector.flat())


# --- Markdown and LaTeX ---------------------------------------------------------------------------


def math(latex: str) -> str:
    """Return a displayed formula."""
    return f"```math\n{latex}\n```"


def quotient(name: str, numerator: sp.Expr, denominator: sp.Expr) -> str:
    """Return name(n) = numerator / denominator as LaTeX."""
    bottom = sp.latex(sp.factor_terms(denominator))
    return rf"{name}(n) = \frac{{{sp.latex(sp.expand(numerator))}}}{{{bottom}}}"


def plain(expression: sp.Expr) -> str:
    """Return a polynomial as text without formulas, for tables."""
    text = str(expression).replace("**2", "²").replace("*", " ").replace("-", "−")
    return re.sub(r"n_([123])", lambda found: f"n{'₁₂₃'[int(found[1]) - 1]}", text)


def fraction(value: sp.Expr) -> Fraction:
    """Return a rational number of SymPy as a fraction."""
    return Fraction(str(value))


if __name__ == "__main__":
    print(page(), end="")
