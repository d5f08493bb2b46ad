"""The C¹ quadratic spline on the criss-cross grid, derived from its defining conditions.

Both diagonals of each grid cell cut it into four triangles. The Zwart-Powell box spline is the only
C¹ piecewise quadratic on that triangulation whose support is three cells wide (up to a factor): its
Bézier net is the solution of a linear system. This net determines the control points of a cell as
combinations of 3 × 3 coefficients, the functionals for coefficients that reproduce all quadratics,
and the extrapolation of the ring of coefficients outside the domain. Cells have the size 1; a cell
is centred at the origin.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement, product
from typing import Any

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from . import patch
from .formula import Formula, Parts, formula
from .notation import VectorSymbol, scalar, substitute

Point = tuple[Fraction, Fraction]
Triangle = tuple[Point, Point, Point]
Moments = Callable[[], Mapping[tuple[int, int], Fraction]]
ZERO, QUARTER, HALF = Fraction(0), Fraction(1, 4), Fraction(1, 2)

# Bézier points of the south triangle of a cell in the order b200, b020, b002, b110, b101, b011.
# Quarter turns of this triangle give the other ones, in the order south, east, north, west.
SOUTH: dict[str, Point] = {
    "200": (-HALF, -HALF),
    "020": (HALF, -HALF),
    "002": (ZERO, ZERO),
    "110": (ZERO, -HALF),
    "101": (-QUARTER, -QUARTER),
    "011": (QUARTER, -QUARTER),
}

NEIGHBOURS: dict[str, tuple[int, int]] = {
    "sw": (-1, -1), "s": (0, -1), "se": (1, -1),
    "w": (-1, 0), "c": (0, 0), "e": (1, 0),
    "nw": (-1, 1), "n": (0, 1), "ne": (1, 1),
}  # fmt: skip


# --- domain points --------------------------------------------------------------------------------


def quarter_turns(point: Sequence[Any], turns: int) -> tuple[Any, Any]:
    """Return a point rotated counter-clockwise about the origin by turns × 90°."""
    x, y = point
    for _ in range(turns % 4):
        x, y = -y, x
    return x, y


def triangles(cells: Iterable[tuple[int, int]]) -> list[Triangle]:
    """Return the corners of the triangles of cells, counter-clockwise, the centre last."""

    def corner(key: str, turns: int, cell: tuple[int, int]) -> Point:
        x, y = quarter_turns(SOUTH[key], turns)
        return x + cell[0], y + cell[1]

    return [
        (corner("200", turns, cell), corner("020", turns, cell), corner("002", turns, cell))
        for cell in cells
        for turns in range(4)
    ]


def middle(left: Point, right: Point) -> Point:
    """Return the domain point between two corners, or at a corner given twice."""
    return (left[0] + right[0]) / 2, (left[1] + right[1]) / 2


def barycentric(point: Point, corners: Triangle) -> list[Fraction]:
    """Return the barycentric coordinates of a point."""

    def area(p: Point, q: Point, r: Point) -> Fraction:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    p, q, r = corners
    return [x / area(p, q, r) for x in (area(point, q, r), area(p, point, r), area(p, q, point))]


# --- the box spline -------------------------------------------------------------------------------


def smoothness_conditions(tiles: Iterable[Triangle]) -> list[dict[Point, Fraction]]:
    """Return the linear conditions under which Bézier ordinates belong to a C¹ piecewise quadratic.

    A condition maps domain points to coefficients: the sum of the products of coefficients and
    ordinates is 0. For an edge PQ between the triangles RPQ and SPQ, with S = αR + βP + γQ, each
    ordinate on the side of S next to the edge is the combination of three ordinates on the side of
    R with the weights α, β, γ. Ordinates on the common edge are shared.
    """
    by_edge: dict[frozenset[Point], list[Point]] = {}
    for tile in tiles:
        for k in range(3):
            by_edge.setdefault(frozenset((tile[k], tile[k - 2])), []).append(tile[k - 1])
    conditions = []
    for edge, opposite in by_edge.items():
        if len(opposite) == 2:
            corners = (opposite[0], min(edge), max(edge))
            weights = barycentric(opposite[1], corners)
            for end in edge:
                places = (middle(end, corner) for corner in corners)
                condition = dict(zip(places, weights, strict=True))
                conditions.append(condition | {middle(end, opposite[1]): Fraction(-1)})
    return conditions


@cache
def box_spline_net() -> Mapping[Point, Fraction]:
    """Return the Bézier ordinates of the Zwart-Powell box spline at the origin, by domain point.

    It is the only solution of these conditions: C¹ across every edge, value and first derivatives 0
    on the boundary of 3 × 3 cells, and translates that sum to 1. Raises ArithmeticError if there is
    not exactly one solution.
    """
    cells = list(NEIGHBOURS.values())
    tiles = triangles(cells)
    pairs = [(x, y) for tile in tiles for x, y in product(tile, repeat=2)]
    zero = {middle(x, y) for x, y in pairs if max(map(abs, x)) == Fraction(3, 2)}
    places = sorted({middle(x, y) for x, y in pairs} - zero)
    rows = [
        [sp.QQ.from_sympy(rational(condition.get(place, ZERO))) for place in places]
        for condition in smoothness_conditions(tiles)
    ]
    kernel = DomainMatrix(rows, (len(rows), len(places)), sp.QQ).nullspace().to_list()
    if len(kernel) != 1:
        raise ArithmeticError(f"{len(kernel)} functions satisfy the conditions of the box spline")
    ordinates = {
        place: Fraction(int(x.numerator), int(x.denominator))
        for place, x in zip(places, kernel[0], strict=True)
    }
    total = sum(ordinates.get((Fraction(i), Fraction(j)), ZERO) for i, j in cells)
    return dict.fromkeys(sorted(zero), ZERO) | {x: y / total for x, y in ordinates.items()}


def net_weights(place: Point) -> dict[str, Fraction]:
    """Return the weights of the 3 × 3 coefficients in the Bézier point at a domain point."""
    net = box_spline_net()
    weights = {
        name: net.get((place[0] - x, place[1] - y), ZERO) for name, (x, y) in NEIGHBOURS.items()
    }
    return {name: weight for name, weight in weights.items() if weight}


# --- the conditions for coefficients --------------------------------------------------------------

MONOMIALS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]


def monomial(powers: tuple[int, int], point: tuple[Fraction | int, Fraction | int]) -> Fraction:
    """Return the value of x^r y^s at a point."""
    return Fraction(point[0]) ** powers[0] * Fraction(point[1]) ** powers[1]


def ordinate(powers: tuple[int, int], left: Point, right: Point) -> Fraction:
    """Return the Bézier ordinate of x^r y^s, r + s <= 2, between two corners."""
    ends = monomial(powers, left) + monomial(powers, right)
    return 2 * monomial(powers, middle(left, right)) - ends / 2


@cache
def functional_moments() -> Mapping[tuple[int, int], Fraction]:
    """Return the coefficient of the central cell that reproduces each monomial x^r y^s, r + s <= 2.

    The coefficients of a quadratic are the values of another quadratic at the centres of cells, as
    a comparison of Bézier nets shows.
    """
    unknown = sp.symbols(f"k:{len(MONOMIALS)}")
    coefficients = {
        name: sum(k * rational(monomial(x, cell)) for k, x in zip(unknown, MONOMIALS, strict=True))
        for name, cell in NEIGHBOURS.items()
    }
    moments = {}
    for powers in MONOMIALS:
        equations = []
        for tile in triangles([(0, 0)]):
            for left, right in combinations_with_replacement(tile, 2):
                weights = net_weights(middle(left, right))
                spline = sum(rational(weight) * coefficients[x] for x, weight in weights.items())
                equations.append(spline - rational(ordinate(powers, left, right)))
        (solution,) = sp.solve(equations, unknown, dict=True)
        moments[powers] = fraction(solution[unknown[0]])
    return moments


def edge_moments() -> Mapping[tuple[int, int], Fraction]:
    """Return the middle Bézier point of an edge along x that reproduces each monomial in x.

    It is the mean of the coefficients on both sides of the edge, which are equal for a monomial in
    x.
    """
    return {powers: x for powers, x in functional_moments().items() if powers[1] == 0}


def coefficient_weights(
    *orbits: Sequence[Point], moments: Moments = functional_moments
) -> list[Fraction]:
    """Return the weights of a functional with given moments: one weight for each orbit of points.

    By default the moments are those of a coefficient. Raises ArithmeticError if the orbits do not
    determine the functional.
    """
    unknown = sp.symbols(f"k:{len(orbits)}")
    equations = []
    for powers, moment in moments().items():
        sums = (rational(sum(monomial(powers, x) for x in points)) for points in orbits)
        terms = (weight * x for weight, x in zip(unknown, sums, strict=True))
        equations.append(sp.Add(*terms) - rational(moment))
    solutions = sp.solve(equations, unknown, dict=True)
    if len(solutions) != 1 or not all(x.is_Rational for x in solutions[0].values()):
        raise ArithmeticError("these points do not determine a functional exact on quadratics")
    return [fraction(solutions[0][x]) for x in unknown]


def orbit(x: Fraction, y: Fraction) -> list[Point]:
    """Return the distinct images of a point under the symmetries of the square."""
    images = {quarter_turns(point, turns) for point in ((x, y), (y, x)) for turns in range(4)}
    return sorted(images)


def extrapolation_weights() -> list[Fraction]:
    """Return the weights at 1, 2, 3 whose sum is the value at 0 of every quadratic."""
    vandermonde = sp.Matrix(3, 3, lambda power, k: (k + 1) ** power)
    return [fraction(x) for x in vandermonde.LUsolve(sp.Matrix([1, 0, 0]))]


def rational(x: Fraction | int) -> sp.Expr:
    """Return a fraction as SymPy's rational number."""
    return sp.Rational(x.numerator, x.denominator)


def fraction(x: sp.Expr) -> Fraction:
    """Return a rational number of SymPy as a fraction."""
    numerator, denominator = x.as_numer_denom()
    return Fraction(int(numerator), int(denominator))


# --- the formulas ---------------------------------------------------------------------------------

MU = {name: VectorSymbol(f"mu_{name}") for name in NEIGHBOURS}


def _linear(weights: Iterable[Fraction], symbols: Iterable[sp.Symbol]) -> sp.Expr:
    return sp.Add(*(rational(weight) * x for weight, x in zip(weights, symbols, strict=True)))


def _used(expressions: Iterable[sp.Expr]) -> list[VectorSymbol]:
    """Return the coefficients that occur in the expressions, in the order of NEIGHBOURS."""
    symbols = {symbol for x in expressions for symbol in x.free_symbols}
    return [x for x in MU.values() if x in symbols]


@cache
def control_points() -> Mapping[sp.Symbol, sp.Expr]:
    """Return the control points of the south triangle in terms of the coefficients."""
    weights = {point: net_weights(SOUTH[point.name[1:]]) for point in patch.NET}
    return {point: _linear(x.values(), (MU[name] for name in x)) for point, x in weights.items()}


@formula(
    "control_net",
    "The Bézier net of the south triangle of a cell from the coefficients of the cell and its "
    "eight neighbours; the other three triangles follow by quarter turns.",
    source="Sect. 3.1",
)
def CONTROL_NET() -> Parts:
    """Sum the nets of the box splines that do not vanish on the cell."""
    net = control_points()
    return Parts(inputs=_used(net.values()), outputs=[(x.name, y) for x, y in net.items()])


SCALE = 8  # the common denominator of the weights of a patch


@formula(
    "triangle",
    f"The vectors of the quadratic patch over the south triangle of a cell, times {SCALE}, from "
    "the differences $mu_s$, … of the neighbouring coefficients from that of the cell: integer "
    "weights, so that integers give exact results.",
    source="Sect. 3.1 and eq. (8)",
)
def TRIANGLE() -> Parts:
    """Express the vectors a … e of eq. (8), and p − mu_c, by the coefficients, times SCALE.

    Raises ArithmeticError if one of them changes under translation, or if SCALE is not the common
    denominator.
    """
    net = control_points()
    found = {x.name: sp.expand(substitute(y, net)) for x, y in patch.POWER_FORM.definitions}
    found["p"] -= MU["c"]
    rows = [[*map(fraction, x.as_coefficients_dict().values())] for x in found.values()]
    if any(map(sum, rows)):
        raise ArithmeticError("a vector of the patch changes under translation")
    if math.lcm(*(x.denominator for row in rows for x in row)) != SCALE:
        raise ArithmeticError(f"{SCALE} is not the common denominator of the weights")
    scaled = {k: sp.expand(SCALE * substitute(x, {MU["c"]: sp.S.Zero})) for k, x in found.items()}
    return Parts(inputs=_used(scaled.values()), outputs=scaled.items())


def _functional(
    name: str,
    sentence: str,
    orbits: Mapping[str, Sequence[Point]],
    moments: Moments = functional_moments,
) -> Formula:
    """Return the formula of a functional from values at points, which `orbits` names.

    The points of one orbit have the same weight.
    """
    symbols = [
        scalar(f"{letter}{k}" if len(points) > 1 else letter)
        for letter, points in orbits.items()
        for k in range(len(points))
    ]

    @formula(name, f"{sentence}: exact on all quadratics.", source="Sect. 3.1")
    def functional() -> Parts:
        weights = coefficient_weights(*orbits.values(), moments=moments)
        repeated = [x for x, points in zip(weights, orbits.values(), strict=True) for _ in points]
        return Parts(inputs=symbols, outputs=[("mu", _linear(repeated, symbols))])

    return functional


CENTRE = [(ZERO, ZERO)]
VERTEX_ORBITS = {"f": orbit(HALF, HALF), "g": orbit(HALF, 3 * HALF)}

COEFFICIENT = _functional(
    "coefficient",
    "The coefficient of a cell from the values of the surface at its centre ($f$) and its four "
    "vertices ($g$)",
    {"f": CENTRE, "g": orbit(HALF, HALF)},
)
COEFFICIENT_FROM_CENTRES = _functional(
    "coefficient_from_centres",
    "The coefficient of a cell from the values at its centre ($f$) and the centres of its four "
    "neighbours ($g$)",
    {"f": CENTRE, "g": orbit(ZERO, Fraction(1))},
)
COEFFICIENT_FROM_VERTICES = _functional(
    "coefficient_from_vertices",
    "The coefficient of a cell from the values at its four vertices ($f$) and the eight next ones "
    "($g$)",
    VERTEX_ORBITS,
)

EDGE_ORBITS = {"f": [(-HALF, ZERO), (HALF, ZERO)], "g": [(-3 * HALF, ZERO), (3 * HALF, ZERO)]}

EDGE_POINT = _functional(
    "edge_point",
    "The middle Bézier point of an edge on the boundary from the values at its middle ($f$) and "
    "its ends ($g$)",
    {"f": CENTRE, "g": EDGE_ORBITS["f"]},
    edge_moments,
)
EDGE_POINT_FROM_VERTICES = _functional(
    "edge_point_from_vertices",
    "The middle Bézier point of an edge on the boundary from the values at its ends ($f$) and at "
    "the next vertices along the boundary ($g$)",
    EDGE_ORBITS,
    edge_moments,
)


def _solved(name: str, sentence: str, point: str, unknown: str) -> Formula:
    """Return the formula of one coefficient, from a Bézier point f of the south triangle."""

    @formula(name, sentence, source="Sect. 3.1")
    def solved() -> Parts:
        value, net = scalar("f"), control_points()
        equation = net[next(x for x in net if x.name == point)] - value
        (solution,) = sp.solve(equation, MU[unknown])
        names = {x: scalar(x.name) for x in _used([solution])}
        outputs = [(f"mu_{unknown}", substitute(sp.expand(solution), names))]
        return Parts(inputs=[value, *names.values()], outputs=outputs)

    return solved


BEYOND_EDGE = _solved(
    "beyond_edge",
    "The coefficient beyond an edge of the boundary from that of its cell and the middle Bézier "
    "point $f$ of the edge.",
    "b110",
    "s",
)
BEYOND_CORNER = _solved(
    "beyond_corner",
    "The coefficient beyond a corner of the domain from the other three around it and the value "
    "$f$ there, which the spline interpolates.",
    "b200",
    "sw",
)

INSIDE = [scalar(name) for name in ("f1", "f2", "f3")]

EXTRAPOLATION = Formula.build(
    "extrapolation",
    "A value one step outside the domain from the next three inside: exact on all quadratics.",
    inputs=INSIDE,
    outputs=[("f0", _linear(extrapolation_weights(), INSIDE))],
)

FORMULAS = (
    CONTROL_NET,
    TRIANGLE,
    COEFFICIENT,
    COEFFICIENT_FROM_CENTRES,
    COEFFICIENT_FROM_VERTICES,
    EDGE_POINT,
    EDGE_POINT_FROM_VERTICES,
    BEYOND_EDGE,
    BEYOND_CORNER,
    EXTRAPOLATION,
)
