"""Print docs/curves.md: curves sampled by normals, and the orders of their spline, measured."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import gaussmap as gm
import numpy as np
import sympy as sp
from gaussmap.docs.orders import code, listed, markdown, number, wrapped
from gaussmap.symbolic.display import latex_of
from numpy.typing import NDArray

Array = NDArray[np.float64]

t = sp.Symbol("t", real=True)

COUNTS = (16, 32, 64, 128, 256)
PIECES = 4096  # so that the error of the spline is nothing beside that of the polygons
DENSE = 40_000  # parameters at which curve and polygon are compared
GRIDS = (32, 64, 128, 256, 512)
PARTS = 8  # equal steps of each arc at which it is compared
NORMALS = 4_000
STEPS = 8  # of Newton's method
LOST = 0.05  # of the samples: near an inflection a normal need not exist on both curves


@dataclass(frozen=True)
class TrueCurve:
    """A curve with its exact derivatives."""

    name: str
    position: tuple[sp.Expr, sp.Expr]
    ends: tuple[sp.Expr, sp.Expr]
    periodic: bool
    sentence: str

    @cached_property
    def curve(self) -> gm.curves.Curve:
        """The curve as gaussmap takes it."""
        return gm.curves.Curve.from_sympy(
            self.position, t, self.ends, self.periodic, name=self.name
        )

    @cached_property
    def _function(self):  # noqa: ANN202 - lambdify has no types
        rows = [sp.diff(x, t, order) for order in range(3) for x in self.position]
        return sp.lambdify(t, rows, modules="numpy", cse=True)

    def derivatives(self, places: Array) -> Array:
        """Return x, x_t, x_tt at parameters (k,), as an array (3, k, 2)."""
        values = [np.broadcast_to(x, places.shape) for x in self._function(places)]
        return np.moveaxis(np.array(values).reshape(3, 2, -1), 1, 2)

    def curvature(self, places: Array) -> Array:
        """Return the signed curvature."""
        _, first, second = self.derivatives(places)
        return cross(first, second) / np.hypot(*first.T) ** 3

    def places(self, count: int) -> Array:
        """Return equally spaced parameters, both ends included."""
        return np.linspace(*self.curve.domain, count)


def cross(left: Array, right: Array) -> Array:
    """Return left × right for vectors (k, 2)."""
    return left[:, 0] * right[:, 1] - left[:, 1] * right[:, 0]


def angles(left: Array, right: Array) -> Array:
    """Return the angles between vectors (k, 2) in degrees."""
    return np.degrees(np.abs(np.arctan2(cross(left, right), np.einsum("kx,kx->k", left, right))))


def _polar(radius: sp.Expr, angle: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    return radius * sp.cos(angle), radius * sp.sin(angle)


TURN = (sp.S.Zero, 2 * sp.pi)
CURVES = (
    TrueCurve(
        "ellipse", (2 * sp.cos(t), sp.sin(t)), TURN, True, "an ellipse, in its usual parameter"
    ),
    TrueCurve(
        "eight", (sp.sin(t), sp.sin(2 * t)), TURN, True, "a figure eight, with two inflections"
    ),
    TrueCurve(
        "star", _polar(1 + sp.cos(5 * t) / 5, t), TURN, True, "a wavy circle, with ten inflections"
    ),
    TrueCurve(
        "spiral",
        _polar(t, 5 * sp.log(t)),
        (sp.S.One, sp.Integer(40)),
        False,
        "a logarithmic spiral, its parameter proportional to arc length",
    ),
    TrueCurve(
        "corner",
        (t, sp.sqrt(t**2 + sp.Rational(1, 100))),
        (-sp.S.One, sp.S.One),
        False,
        "a hyperbola: a rounded corner between two nearly straight legs",
    ),
)


# --- curve and polygon ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Polygon:
    """A polygon with its vertices on a curve: how far it is from it, and how it is turned."""

    vertices: int
    distance: float
    angle: float

    @classmethod
    def through(cls, true: TrueCurve, parameters: Array) -> Polygon:
        """Measure the polygon through the points at ascending parameters.

        They hold both ends of an open curve, or end one period after the first on a closed one.
        """
        dense = np.linspace(parameters[0], parameters[-1], DENSE)
        point, tangent, _ = true.derivatives(dense)
        vertices = true.derivatives(parameters)[0]
        edge = np.clip(np.searchsorted(parameters, dense) - 1, 0, len(parameters) - 2)
        return cls(
            len(parameters) - true.periodic,
            float(gm.curves.polygon_distance(point, vertices).max()),
            float(angles(np.diff(vertices, axis=0)[edge], tangent).max()),
        )


@dataclass(frozen=True)
class Comparison:
    """Two polygons with equally many vertices: uniform in the parameter, and in the normal."""

    parameter: Polygon
    normal: Polygon


def compare(true: TrueCurve, count: int) -> Comparison:
    """Compare both polygons with about `count` vertices; the ends of an open curve are two."""
    parameters = by_normals(true, count)
    return Comparison(
        Polygon.through(true, true.places(len(parameters))), Polygon.through(true, parameters)
    )


def by_normals(true: TrueCurve, count: int) -> Array:
    """Return the parameters of about `count` points with uniform normals, as `through` has them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        samples = gm.curves.sample(
            true.curve, count=count if true.periodic else count - 2, pieces=PIECES
        )
    low, high = true.curve.domain
    ends = ([], [samples.parameters[0] + high - low]) if true.periodic else ([low], [high])
    return np.concatenate([ends[0], samples.parameters, ends[1]])


def slope(numbers: Sequence[float], errors: Sequence[float]) -> float:
    """Return the order by least squares."""
    return -float(np.polyfit(np.log(numbers), np.log(errors), 1)[0])


# --- the spline -----------------------------------------------------------------------------------


def spline_errors(true: TrueCurve, pieces: int) -> list[float]:
    """Return the largest errors of positions, normals (in degrees) and support function."""
    spline = gm.curves.fit(true.curve, pieces)
    places = true.places(PARTS * pieces + 1)
    point, tangent, _ = true.derivatives(places)
    normals = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    return [
        float(np.hypot(*(spline.evaluate(places) - point).T).max()),
        float(angles(spline.normals(places), normals).max()),
        support_error(true, spline),
    ]


def support_error(true: TrueCurve, spline: gm.curves.CurveSpline) -> float:
    """Return the largest difference of the support functions at equal normals.

    Newton's method on n·x_t = 0 leads from the parameter of a sample to the point of the true curve
    with its normal. ArithmeticError if that fails for more than LOST of the samples.
    """
    samples = gm.curves.sample(spline, normals=gm.directions.circle(NORMALS))
    normals, places = samples.normals, samples.parameters
    for _ in range(STEPS):
        _, first, second = true.derivatives(places)
        rows = (np.einsum("kx,kx->k", normals, x) for x in (first, second))
        places = places - np.divide(*rows)
    point, tangent, _ = true.derivatives(places)
    found = np.abs(places - samples.parameters) <= spline.step
    found &= angles(np.column_stack([tangent[:, 1], -tangent[:, 0]]), normals) < 1e-6
    found &= np.signbit(true.curvature(places)) == np.signbit(samples.curvature)
    if found.mean() < 1.0 - LOST:
        raise ArithmeticError(f"Newton's method fails on {true.name}")
    exact = np.einsum("kx,kx->k", normals, point)
    return float(np.abs(exact - samples.support)[found].max())


# --- the page -------------------------------------------------------------------------------------

HEAD = """\
# Curves sampled by normals, measured

Written by `make curves`: do not edit.

The paper (Sect. 4.1, Figs. 4 and 5) draws two polygons through equally many points of a curve: one
through points that are uniform in the parameter, one through points whose normals are uniform on
the circle. Here both are measured, for these curves:
"""

METHOD = """\
The points come from `gaussmap.curves.sample` with {pieces:,} pieces. Both polygons of an open curve
have its two ends. M is the number of vertices; where a curve has inflections, uniform normals
cannot give every number, and M is close to a power of 2.

- **Distance**: the largest distance of a point of the curve from the polygon (the one-sided
  Hausdorff distance), in the unit of the curve, over {dense:,} points;
- **Angle**: the largest angle between the curve and the edge of the polygon that spans it, in
  degrees.

The last columns are quotients, parameter / normal: above 1, uniform normals are better.
"""

MEANING = """\
**Results.** An edge that spans an arc of length ℓ and curvature κ turns by κ ℓ, and its distance
from the arc is κ ℓ²/8. Uniform normals make κ ℓ equal for all edges. No other choice has a smaller
largest angle, so that the polygon resolves each sharp corner. For the distance it is not the best
choice: the distance is then proportional to ℓ, and largest where the curve is flattest. Uniform
normals have the smaller distance where uniform parameters cut off sharp corners, on {better} for
some M. They have the larger one where the parameter is denser at the corners anyway, or once M
resolves the corners: on {worse} for M ≈ {last}. At an inflection samples are rare: the two next to
it are O(M^(−1/2)) apart, elsewhere O(M^(−1)), so that on a curve with inflections the distance
decreases as M^(−3/2), not as M^(−2).
"""

ORDERS = """\
## Orders of the spline

The C¹ quadratic spline of `gaussmap.curves.fit` with P equal pieces against the exact curve. The
error of **positions** (in the unit of the curve) and of **normals** (in degrees) is the largest at
{parts} steps of each piece and both ends, at equal parameters; that of the **support function** the
largest over the preimages of {normals:,} normals, at equal normals, found on the exact curve by
Newton's method within one piece, with the same sign of κ. Near an inflection a normal need not
exist on both curves: less than {lost:g} % are left out for that. Expected are the orders 3, 2 and
3; slopes are by least squares over all P and over the three largest.
"""

FASTER = """\
Faster than expected: {names}. Its third derivative is tangent to it (checked exactly), so that the
leading term of the error moves points along the curve and does not turn the normal.
"""

QUANTITIES = ("positions", "normals", "support function")


@dataclass(frozen=True)
class Measurement:
    """What was measured on one curve: a comparison for each count, three errors for each grid."""

    true: TrueCurve
    comparisons: list[Comparison]
    errors: list[list[float]]


def measure(
    true: TrueCurve, counts: Sequence[int] = COUNTS, grids: Sequence[int] = GRIDS
) -> Measurement:
    """Measure one curve."""
    return Measurement(
        true, [compare(true, x) for x in counts], [spline_errors(true, x) for x in grids]
    )


def page(measurements: Sequence[Measurement]) -> str:
    """Return the page."""
    ratios = {
        x.true.name: [y.parameter.distance / y.normal.distance for y in x.comparisons]
        for x in measurements
    }
    meaning = MEANING.format(
        better=listed(code(name) for name, x in ratios.items() if max(x) > 1.0),
        worse=listed(code(name) for name, x in ratios.items() if x[-1] < 1.0),
        last=COUNTS[-1],
    )
    orders = ORDERS.format(parts=PARTS, normals=NORMALS, lost=100 * LOST)
    parts = [
        wrapped(HEAD),
        "\n".join(map(described, (x.true for x in measurements))) + "\n",
        wrapped(METHOD.format(pieces=PIECES, dense=DENSE)),
        comparison_table(measurements),
        wrapped(meaning),
        wrapped(orders),
        order_table(measurements),
        faster(measurements),
    ]
    return "\n".join(parts)


def faster(measurements: Sequence[Measurement]) -> str:
    """Name the curves whose normals are faster than expected; ArithmeticError if for no reason."""
    found = [x.true for x in measurements if slope(GRIDS, [y[1] for y in x.errors]) > 2.5]
    for true in found:
        first, third = (sp.Matrix([sp.diff(x, t, k) for x in true.position]) for k in (1, 3))
        if sp.simplify(sp.Matrix.hstack(first, third).det()) != 0:
            raise ArithmeticError(f"the normals of {true.name} are faster without a known reason")
    return wrapped(FASTER.format(names=listed(code(x.name) for x in found)))


def described(true: TrueCurve) -> str:
    """Return one item of the list of curves."""
    x, y = (latex_of(part) for part in true.position)
    low, high = (latex_of(end) for end in true.ends)
    kind = "closed" if true.periodic else "open"
    formula = f"$`({x},\\; {y}), \\; t \\in [{low}, {high}]`$"
    return f"- {code(true.name)}: {true.sentence}; {kind}.  \n  {formula}"


def comparison_table(measurements: Sequence[Measurement]) -> str:
    """Return the table of distances and angles, with a row for each curve and count."""
    header = ["curve", "M", "distance: parameter", "normal", "quotient"]
    header += ["angle: parameter", "normal", "quotient"]
    rows = [row(x.true, y) for x in measurements for y in x.comparisons]
    return markdown(header, rows)


def row(true: TrueCurve, compared: Comparison) -> list[str]:
    """Return one row of that table."""
    left, right = compared.parameter, compared.normal
    pairs = ((left.distance, right.distance), (left.angle, right.angle))
    cells = [cell for x, y in pairs for cell in (number(x), number(y), f"{x / y:.2f}")]
    return [code(true.name), str(right.vertices), *cells]


def order_table(measurements: Sequence[Measurement]) -> str:
    """Return the table of the errors of the spline, with a row for each curve and quantity."""
    header = ["curve", "", *(f"P = {x}" for x in GRIDS), "slope", f"slope, P ≥ {GRIDS[-3]}"]
    rows = [
        [code(x.true.name), quantity, *map(number, errors)]
        + [f"{slope(GRIDS[first:], errors[first:]):.2f}" for first in (0, -3)]
        for x in measurements
        for quantity, errors in zip(QUANTITIES, zip(*x.errors, strict=True), strict=True)
    ]
    return markdown(header, rows)


def main() -> None:
    """Measure every curve and print the page."""
    print(page([measure(x) for x in CURVES]), end="")


if __name__ == "__main__":
    main()
