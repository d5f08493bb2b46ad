"""The judge of the proof: surfaces, queries of normals, and another search.

The other search is interval arithmetic, Krawczyk's operator and bisection. It shares no code and no
bound with the library: it bounds first and second derivatives over boxes by intervals, where the
library uses Taylor polynomials with bounds of third ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import gaussmap as gm
import numpy as np
import sympy as sp
from gaussmap.runtime.proof.index import ProvedIndex, ProvedPlaces
from gaussmap.runtime.proof.kernels.answers import KINDS
from gaussmap.symbolic.surfaces import CATALOGUE
from numpy.typing import NDArray

from ...shapes import KNOBBY, unit

Array = NDArray[Any]

# --- surfaces -------------------------------------------------------------------------------------

TURN, OPEN, AROUND = (0, "2*pi"), "open", "periodic"
SQUARE = ((-1, 1), (-1, 1))
# Position, domain, boundary conditions of u and v; others are in the catalogue.
FORMULAS: dict[str, tuple[Any, Any, Any]] = {
    "knobby": (KNOBBY, (TURN, TURN), (AROUND, AROUND)),
    "waves": (("u", "v", "sin(3*u)*cos(3*v)/5"), SQUARE, (OPEN, OPEN)),
    # The third derivatives of its height are those of functions of one parameter.
    "sum": (("u", "v", "exp(u) + cos(2*v)/2"), SQUARE, (OPEN, OPEN)),
    "menn": (("u", "v", "u**4 + u**2*v - v**2"), (("-4/5", "4/5"),) * 2, (OPEN, OPEN)),
    "rim": (("u*cos(v)", "u*sin(v)", "sqrt(u)"), (("1/2", 1), TURN), (OPEN, AROUND)),
    "bump": (("u", "v", "exp(-4*(u**2 + v**2))/2 + u*v/10"), SQUARE, (OPEN, OPEN)),
    "asphere": (
        ("u*cos(v)", "u*sin(v)", "2*u**2/5 - 9*u**4/20 + 3*u**6/25"),
        (("1/20", "13/10"), TURN), (OPEN, AROUND),
    ),
    "bohemian": (
        ("cos(u)/2", "3*cos(v)/2 + sin(u)/2", "sin(v)"), (TURN, TURN), (AROUND, AROUND)
    ),
    "egg": (
        ("cos(v)*cos(u)", "7/10*cos(v)*sin(u)", "13/10*sin(v)"),
        (TURN, ("-pi/2", "pi/2")), (AROUND, "pole"),
    ),
    # The apex of a horn: a side of the domain that is one point, and not smooth.
    "horn": (("v*cos(u)", "v*sin(u)", "v + v**2/4"), (TURN, (0, 1)), (AROUND, OPEN)),
    # A pole where K is 0, and one where bounds of the Hessian need narrow sectors.
    "bowl": (
        ("v*cos(u)", "v*sin(u)", "v**4*(2 + cos(2*u))"), (TURN, (0, 1)), (AROUND, ("pole", OPEN))
    ),
    "sheared": (
        (
            "cos(u)*sin(v)*(1 + 3*cos(v)**3/10)",
            "12*sin(u)*sin(v)*(1 + cos(4*v)/5)/5 + 27*cos(v)/100",
            "cos(u)*sin(v)/10 + 63*cos(v)/100",
        ),
        (TURN, (0, "pi")), (AROUND, "pole"),
    ),
    "root": (("u", "v", "sqrt(u)/3 + v**2"), ((0, 1), (0, 1)), (OPEN, OPEN)),
    # Its height has the slopes u² − 1 and v, and a fold at u = 0.
    "folded": (("u", "v", "u**3/3 - u + v**2/2"), SQUARE, (OPEN, OPEN)),
    "line": (("u + v", "u + v", "0"), ((0, 1), (0, 1)), (OPEN, OPEN)),
}  # fmt: skip


@cache
def surface_of(name: str) -> gm.Surface:
    if name not in FORMULAS:
        return getattr(gm.surfaces, name)()
    position, domain, boundary = FORMULAS[name]
    return gm.Surface.from_sympy(position, ("u", "v"), domain, periodic=boundary)


@cache
def position_of(name: str) -> sp.Matrix:
    """Return the exact coordinates of a surface as functions of u and v."""
    u, v = sp.symbols("u v", real=True)
    if name in FORMULAS:
        return sp.Matrix(FORMULAS[name][0]).subs({"u": u, "v": v})
    known = CATALOGUE[name]
    return sp.Matrix(known.position).subs({**known.defaults, known.u: u, known.v: v})


# --- questions and answers ------------------------------------------------------------------------


@cache
def index_of(name: str, **options: Any) -> ProvedIndex:
    return new_index(surface_of(name), **options)


def new_index(surface: gm.Surface, **options: Any) -> ProvedIndex:
    assert surface.tape is not None
    index = ProvedIndex.of(surface.tape, surface.domain, surface.boundary, **options)
    assert index is not None
    return index


@cache
def nurbs(degree: int, repeated: int) -> tuple[gm.Surface, ProvedIndex]:
    """Return a graph over the unit square, whose inner knots 1/4, 1/2, 3/4 are repeated."""
    inner = np.repeat([0.25, 0.5, 0.75], repeated)
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    count = len(knots) - degree - 1
    places = np.array([knots[k + 1 : k + degree + 1].mean() for k in range(count)])
    x, y = np.meshgrid(places, places, indexing="ij")
    z = 0.15 * np.random.default_rng(13).normal(size=x.shape)
    net = np.stack([x, y, z], axis=-1)
    surface = gm.Surface.from_nurbs((degree, degree), (knots, knots), net)
    return surface, new_index(surface, cells=(32, 32))


def random_normals(count: int, seed: int = 0) -> Array:
    return unit(np.random.default_rng(seed).normal(size=(count, 3)))


def jets_at(surface: gm.Surface, u: Array, v: Array) -> list[Array]:
    return list(np.moveaxis(surface.jets(u, v), 1, 0))


def normals_at(surface: gm.Surface, u: Array, v: Array) -> Array:
    _, x_u, x_v, *_ = jets_at(surface, u, v)
    return unit(np.cross(x_u, x_v))


def curvature_at(surface: gm.Surface, u: Array, v: Array) -> Array:
    """Return numbers that have the sign of the Gaussian curvature."""
    _, x_u, x_v, *second = jets_at(surface, u, v)
    n = np.cross(x_u, x_v)
    a, b, c = ((n * x).sum(axis=1) for x in second)
    return a * c - b * b


def kinds(found: ProvedPlaces) -> set[str]:
    return {KINDS[k] for k in found.undecided.kinds}


def counts(found: ProvedPlaces, normals: Array) -> Array:
    return np.bincount(found.numbers, minlength=len(normals))


def apart(surface: gm.Surface, one: Array, other: Array) -> Array:
    """Return distances (k, 2) of parameters, modulo periods."""
    distance = np.abs(one - other)
    for axis, ends in enumerate(surface.boundary):
        if ends[0] == "periodic":
            low, high = surface.domain[axis]
            distance[:, axis] = np.minimum(distance[:, axis], high - low - distance[:, axis])
    return distance


def near(surface: gm.Surface, found: ProvedPlaces, u: Array, v: Array, within: float) -> Array:
    """Return how many of the points that are found for normal k are near (u[k], v[k])."""
    away = apart(surface, found.uv, np.stack([u, v], axis=1)[found.numbers])
    return np.bincount(found.numbers[(away <= within).all(axis=1)], minlength=len(u))


# --- intervals ------------------------------------------------------------------------------------


@dataclass
class Interval:
    """Numbers between `low` and `high`; results of operations are rounded outwards."""

    low: Array
    high: Array
    __array_priority__ = 1000.0
    __array_ufunc__ = None

    @classmethod
    def of(cls, x: Any) -> Interval:
        return x if isinstance(x, Interval) else cls(np.asarray(float(x)), np.asarray(float(x)))

    def wider(self, ulps: float = 4.0) -> Interval:
        low, high = (ulps * 2.0**-52 * np.abs(x) + 1e-300 for x in (self.low, self.high))
        return Interval(self.low - low, self.high + high)

    def __neg__(self) -> Interval:
        return Interval(-self.high, -self.low)

    def __add__(self, other: Any) -> Interval:
        y = Interval.of(other)
        return Interval(self.low + y.low, self.high + y.high).wider()

    __radd__ = __add__

    def __sub__(self, other: Any) -> Interval:
        return self + -Interval.of(other)

    def __rsub__(self, other: Any) -> Interval:
        return -self + other

    def __mul__(self, other: Any) -> Interval:
        y = Interval.of(other)
        ends = [self.low * y.low, self.low * y.high, self.high * y.low, self.high * y.high]
        return Interval(np.minimum.reduce(ends), np.maximum.reduce(ends)).wider()

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Interval:
        return self * Interval.of(other) ** -1

    def __rtruediv__(self, other: Any) -> Interval:
        return other * self**-1

    def __pow__(self, exponent: Any) -> Interval:
        k = float(exponent)
        if k < 0.0:
            below = self ** (-k)
            assert ((below.low > 0.0) | (below.high < 0.0)).all()
            return Interval(1.0 / below.high, 1.0 / below.low).wider()
        if not k.is_integer():
            return Interval(np.maximum(self.low, 0.0) ** k, self.high**k).wider()
        if k % 2.0 == 1.0:
            return Interval(self.low**k, self.high**k).wider()
        a, b = np.abs(self.low), np.abs(self.high)
        least = np.where((self.low <= 0.0) & (self.high >= 0.0), 0.0, np.minimum(a, b))
        return Interval(least**k, np.maximum(a, b) ** k).wider()

    @property
    def middle(self) -> Array:
        return 0.5 * (self.low + self.high)

    @property
    def size(self) -> Array:
        return np.maximum(np.abs(self.low), np.abs(self.high))


def cosine(x: Any) -> Any:
    if not isinstance(x, Interval):
        return np.cos(x)
    ends = np.cos(x.low), np.cos(x.high)
    pad = 1e-12 * (1.0 + x.size)  # of the places of extremes

    def holds(offset: float) -> Array:
        turns = (x.low - pad - offset) / (2.0 * np.pi), (x.high + pad - offset) / (2.0 * np.pi)
        return np.ceil(turns[0]) <= np.floor(turns[1])

    low = np.where(holds(np.pi), -1.0, np.minimum(*ends) - 1e-15)
    return Interval(np.maximum(low, -1.0), np.where(holds(0.0), 1.0, np.maximum(*ends) + 1e-15))


def monotone(function: Any) -> Any:
    def applied(x: Any) -> Any:
        if not isinstance(x, Interval):
            return function(x)
        return Interval(function(x.low), function(x.high)).wider(8.0)

    return applied


EXP = monotone(np.exp)
MODULES: Any = [
    {
        "sin": lambda x: cosine(x - np.pi / 2.0) if isinstance(x, Interval) else np.sin(x),
        "cos": cosine, "exp": EXP, "sinh": monotone(np.sinh), "sqrt": lambda x: x**0.5,
        "cosh": lambda x: 0.5 * (EXP(x) + EXP(-x)),
    },
    "numpy",
]  # fmt: skip

# --- the other search -----------------------------------------------------------------------------


@cache
def derivatives_of(name: str) -> Any:
    """Return a function that gives x_u, x_v, x_uu, x_uv, x_vv (15) of numbers or intervals."""
    u, v = sp.symbols("u v", real=True)
    orders = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    values = [sp.diff(x, u, i, v, j) for i, j in orders for x in position_of(name)]
    return sp.lambdify((u, v), values, modules=MODULES, cse=True)


def at_points(name: str, u: Array, v: Array) -> Array:
    values = derivatives_of(name)(u, v)
    return np.array([np.broadcast_to(x, u.shape) for x in values]).reshape(5, 3, -1)


def over_boxes(name: str, u: Array, v: Array, h: tuple[Array, Array]) -> list[list[Interval]]:
    values = derivatives_of(name)(Interval(u - h[0], u + h[0]), Interval(v - h[1], v + h[1]))
    whole = [Interval.of(x) + Interval(0.0 * u, 0.0 * u) for x in values]
    return [whole[3 * k : 3 * k + 3] for k in range(5)]


def product(n: Array, x: list[Interval]) -> Interval:
    return x[0] * Interval(n[0], n[0]) + x[1] * Interval(n[1], n[1]) + x[2] * Interval(n[2], n[2])


def by_intervals(name: str, normals: Array) -> tuple[Array, Array]:
    """Return all points with these normals: the rows of the normals, ascending, and u and v."""
    surface = surface_of(name)
    (u0, u1), (v0, v1) = surface.domain
    count = 48
    half = (u1 - u0) / (2 * count), (v1 - v0) / (2 * count)
    odd = 2 * np.arange(count) + 1
    u, v = (x.ravel() for x in np.meshgrid(u0 + half[0] * odd, v0 + half[1] * odd))
    size = np.ones(count**2)
    possible = np.ones((count**2, len(normals)), dtype=bool)
    for x in over_boxes(name, u, v, (1.1 * half[0] * size, 1.1 * half[1] * size))[:2]:
        middle = np.stack([z.middle for z in x], axis=-1)
        radius = np.stack([z.high - z.middle for z in x], axis=-1)
        reach = (radius @ np.abs(normals).T) * (1.0 + 1e-9) + 1e-12
        possible &= np.abs(middle @ normals.T) <= reach
    box, number = np.nonzero(possible)
    u, v, size = u[box], v[box], size[box]
    numbers, places = [], []
    for _ in range(40):
        if len(number) == 0:
            break
        h = 1.1 * half[0] * size, 1.1 * half[1] * size
        state, point = decide(name, u, v, h, normals[number].T)
        numbers.append(number[state == 1])
        places.append(point[:, state == 1].T)
        rest = state == 2
        u, v, number, size = u[rest], v[rest], number[rest], 0.5 * size[rest]
        steps = [(i, j) for i in (-1.0, 1.0) for j in (-1.0, 1.0)]
        u = np.concatenate([u + i * half[0] * size for i, _ in steps])
        v = np.concatenate([v + j * half[1] * size for _, j in steps])
        number, size = np.tile(number, 4), np.tile(size, 4)
    assert len(number) == 0
    return once(surface, np.concatenate(numbers), np.concatenate(places))


def decide(name: str, u: Array, v: Array, h: tuple[Array, Array], n: Array) -> tuple[Array, Array]:
    """Return for each box 0 if it has no point, 1 if one, 2 if that is not known; and points."""
    x_u, x_v, x_uu, x_uv, x_vv = over_boxes(name, u, v, h)
    f, g = product(n, x_u), product(n, x_v)
    none = (f.low > 0.0) | (f.high < 0.0) | (g.low > 0.0) | (g.high < 0.0)
    normal = [
        x_u[(k + 1) % 3] * x_v[(k + 2) % 3] - x_u[(k + 2) % 3] * x_v[(k + 1) % 3] for k in range(3)
    ]
    none |= product(n, normal).high < 0.0
    a, b, c = (product(n, x) for x in (x_uu, x_uv, x_vv))
    with np.errstate(all="ignore"):
        inverse = np.array([[c.middle, -b.middle], [-b.middle, a.middle]])
        inverse /= a.middle * c.middle - b.middle**2
        centre = np.einsum("kxs,xs->ks", at_points(name, u, v)[:2], n)
        step = -np.einsum("ijs,js->is", inverse, centre)
        # Krawczyk's operator maps the box into a box around the centre and this step.
        rows = zip([[Interval(x, x) for x in row] for row in inverse], np.eye(2), strict=True)
        reach = np.stack(
            [
                (one - (y * a + z * b)).size * h[0] + (two - (y * b + z * c)).size * h[1]
                for (y, z), (one, two) in rows
            ]
        )
        reach = reach * (1.0 + 1e-12) + 1e-14
        inside = (np.abs(step) + reach < np.stack(h)).all(axis=0)
        outside = (np.abs(step) - reach > np.stack(h)).any(axis=0)
        point = np.stack([u, v]) + step
    one = inside & ~none & ~outside
    state = np.where(none | outside, 0, np.where(one, 1, 2))
    for _ in range(4):
        point[:, one] = newton(name, point[:, one], n[:, one])
    normal = np.cross(*at_points(name, *point[:, one])[:2], axis=0)
    # Neither points with the opposite normal, nor poles.
    state[np.flatnonzero(one)[np.einsum("xs,xs->s", normal, n[:, one]) < 1e-9]] = 0
    return state, point


def newton(name: str, point: Array, n: Array) -> Array:
    p, q, a, b, c = np.einsum("kxs,xs->ks", at_points(name, *point), n)
    return point + np.stack([b * q - c * p, b * p - a * q]) / (a * c - b * b)


def once(surface: gm.Surface, numbers: Array, places: Array) -> tuple[Array, Array]:
    """Return each point once, and those of the domain, sorted by their normals."""
    keep = np.ones(len(numbers), dtype=bool)
    for axis in (0, 1):
        low, high = surface.domain[axis]
        if surface.boundary[axis][0] == "periodic":
            places[:, axis] = low + (places[:, axis] - low) % (high - low)
        else:
            keep &= (places[:, axis] >= low) & (places[:, axis] <= high)
    numbers, places = numbers[keep], places[keep]
    order = np.argsort(numbers, kind="stable")
    numbers, places = numbers[order], places[order]
    keep = np.ones(len(numbers), dtype=bool)
    for step in range(1, 12):
        same = numbers[step:] == numbers[:-step]
        close = apart(surface, places[step:], places[:-step]).max(axis=1) < 1e-7
        keep[step:] &= ~(same & close)
    return numbers[keep], places[keep]


def check(name: str, normals: Array) -> None:
    """Assert that both searches find the same points, and that each is within its radius."""
    surface, found = surface_of(name), index_of(name).query(normals)
    numbers, places = by_intervals(name, normals)
    assert len(found.undecided.numbers) == 0
    by_normal = np.bincount(numbers, minlength=len(normals))
    np.testing.assert_array_equal(counts(found, normals), by_normal)
    # The nearest of the points with the same normal, and each of them once.
    starts = np.searchsorted(numbers, np.arange(len(normals) + 1))
    taken = np.zeros(len(numbers), dtype=bool)
    for k, number in enumerate(found.numbers):
        others = slice(starts[number], starts[number + 1])
        away = apart(surface, found.uv[k] + 0.0 * places[others], places[others])
        nearest = int(np.argmin(away.max(axis=1)))
        assert (away[nearest] <= found.radius[k] + 1e-12).all()
        assert not taken[starts[number] + nearest]
        taken[starts[number] + nearest] = True
