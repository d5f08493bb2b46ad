"""Print docs/orders.md: the error estimates (13) and that of the support function, measured.

All parameters below are those of the unit square, as in the paper: each end of the domain of a
surface is moved to 0 or 1.
"""

from __future__ import annotations

import math
import re
import textwrap
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import gaussmap as gm
import numpy as np
import sympy as sp
from gaussmap.docs import poles
from gaussmap.symbolic.notation import dot
from gaussmap.symbolic.spline import triangles
from gaussmap.symbolic.surfaces import CATALOGUE, ParametricSurface
from numpy.typing import NDArray
from tqdm import tqdm

Array = NDArray[np.float64]

GRIDS = (16, 32, 64, 128, 256)
LAST = 3  # the number of the finest grids for the second slope
NORMALS = 40_000
PARTS = 4  # every patch is compared at the barycentric lattice of step 1/PARTS
STRIP = 4  # rows of cells at a time, which fit into the cache
FLAT = 0.01  # of the largest |K|
NEAR = 2.0  # cells
STEPS = 8  # of Newton's method
REASONS = ("flat", "lost", "turned", "outside")  # for which samples are left out


@dataclass(frozen=True)
class Quantity:
    """What is measured: its title, the order that the paper claims, and the constant of it."""

    title: str
    order: int
    constant: str
    definition: str


POSITIONS = Quantity(
    "Positions",
    3,
    "C̃",
    "the largest |x − p|, in the unit of the surface. Claimed: at most C̃ k³ (Sect. 3.1)",
)
DERIVATIVES = Quantity(
    "First derivatives",
    2,
    "C₁",
    "the largest of |x_u − p_u| and |x_v − p_v|, u and v running over the unit square. Claimed: at "
    "most C₁ k² (13)",
)
ANGLES = Quantity(
    "Normals",
    2,
    "Cₙ",
    "the largest angle between x_u × x_v and p_u × p_v, in degrees. It follows from (13) that it "
    "is at most Cₙ k²",
)
SUPPORT = Quantity(
    "Support function",
    3,
    "Ĉ",
    "the largest |h_x(n) − h_p(n)| over normals n, in the unit of the surface. Claimed: at most "
    "Ĉ k³ (Sect. 3.2)",
)
QUANTITIES = (POSITIONS, DERIVATIVES, ANGLES, SUPPORT)


# --- the true surface -----------------------------------------------------------------------------


class TrueSurface:
    """A surface of the catalogue with its exact derivatives, by parameters in the unit square."""

    def __init__(self, name: str, **values: float) -> None:
        """Take the surface with these values of its parameters, else the default ones."""
        self.name = name
        entry: ParametricSurface = CATALOGUE[name]
        parameters = tuple(
            replace(x, default=sp.Float(values.get(x.symbol.name, x.default)))
            for x in entry.parameters
        )
        self.entry = replace(entry, parameters=parameters) if values else entry
        self.surface = gm.surfaces.surface(name, **values)
        self.derivatives = _lambdified(self.entry)

    @property
    def reproduced(self) -> bool:
        """Whether the position is a quadratic polynomial, which the spline reproduces."""
        u, v = self.entry.u, self.entry.v
        return all(
            x.is_polynomial(u, v) and sp.Poly(x, u, v).total_degree() <= 2
            for x in self.entry.position
        )

    @cached_property
    def largest_curvature(self) -> float:
        """The largest |K| on a lattice; ArithmeticError if the surface is singular there."""
        side = np.linspace(0.0, 1.0, 129)
        with np.errstate(all="ignore"):
            curvature = np.abs(gaussian_curvature(self.derivatives(side[:, None], side, 2)))
        if not np.isfinite(curvature).all():
            raise ArithmeticError(f"{self.name} has a singular point")
        return float(curvature.max())

    @property
    def developable(self) -> bool:
        """Whether K vanishes everywhere, but for rounding."""
        return self.largest_curvature < 1e-12

    def unit(self, uv: Array) -> Array:
        """Return parameters of the surface as parameters in the unit square."""
        (u0, u1), (v0, v1) = self.surface.domain
        return (uv - [u0, v0]) / [u1 - u0, v1 - v0]

    def inside(self, places: Array) -> NDArray[np.bool_]:
        """Say which parameters lie in the domain, whose periodic directions have no ends."""
        cut = np.array([ends[0] == "open" for ends in self.entry.boundary])
        return np.all(~cut | ((places >= 0.0) & (places <= 1.0)), axis=1)


def regular_surfaces() -> list[str]:
    """Return the names of the surfaces of the catalogue without poles."""
    return [name for name, x in CATALOGUE.items() if "pole" not in x.boundary[1]]


def singular_surfaces() -> list[str]:
    """Return the names of the others; ArithmeticError unless x_u × x_v vanishes at their poles."""
    names = [name for name in CATALOGUE if name not in regular_surfaces()]
    for entry in map(CATALOGUE.__getitem__, names):
        for pole in entry.domain[1]:
            if any(sp.simplify(x.subs(entry.v, pole)) != 0 for x in entry.normal_field):
                raise ArithmeticError(f"{entry.name} is regular at v = {pole}")
    return names


def _lambdified(entry: ParametricSurface) -> Callable[[Array, Array, int], Array]:
    """Return f(s, t, order) → (..., 3, 3) or (..., 6, 3): x, x_s, x_t; also x_ss, x_st, x_tt."""
    u, v = entry.u, entry.v
    unit = {x: low + (high - low) * x for x, (low, high) in zip((u, v), entry.domain, strict=True)}
    position = sp.Matrix(entry.position).xreplace({**entry.defaults, **unit})
    orders = [(), (u,), (v,), (u, u), (u, v), (v, v)]
    rows = [sp.diff(x, *by) if by else x for by in orders for x in position.flat()]
    functions = {
        1: sp.lambdify((u, v), rows[:9], modules="numpy", cse=True),
        2: sp.lambdify((u, v), rows, modules="numpy", cse=True),
    }

    def derivatives(s: Array, t: Array, order: int) -> Array:
        shape = np.broadcast_shapes(np.shape(s), np.shape(t))
        values = [np.broadcast_to(x, shape) for x in functions[order](s, t)]
        return np.stack(values, axis=-1).reshape(*shape, len(values) // 3, 3)

    return derivatives


def gaussian_curvature(derivatives: Array) -> Array:
    """Return K from x, x_u, x_v, x_uu, x_uv, x_vv, shape (..., 6, 3)."""
    normal = np.cross(derivatives[..., 1, :], derivatives[..., 2, :])
    L, M, N = np.moveaxis(np.einsum("...kx,...x->...k", derivatives[..., 3:, :], normal), -1, 0)
    return (L * N - M * M) / np.einsum("...x,...x->...", normal, normal) ** 2


# --- errors at equal parameters -------------------------------------------------------------------


def _bernstein() -> tuple[Array, Array]:
    """Return the lattice of barycentric coordinates (…, 3) and half the derivatives by them.

    The latter are weights (3, …, 6) of the net b200, b020, b002, b110, b101, b011.
    """
    lattice = [x for x in product(range(PARTS + 1), repeat=3) if sum(x) == PARTS]
    weights = np.array(lattice) / PARTS
    r, s, t = weights.T
    o = np.zeros_like(r)
    rows = [[r, o, o, s, t, o], [o, s, o, r, o, t], [o, o, t, o, r, s]]
    return weights, np.moveaxis(np.array(rows), 1, 2)


LATTICE, HALF_DERIVATIVES = _bernstein()
CORNERS = np.array(triangles([(0, 0)]), dtype=float)  # of the four patches of a cell


def parameter_errors(true: TrueSurface, cells: int) -> Array:
    """Return the largest errors of positions, first derivatives and normals (in degrees)."""
    nets = gm.fit(true.surface, (cells, cells)).control_nets.reshape(cells, cells, 4, 6, 3)
    nets = np.moveaxis(nets, (2, 3), (0, 1))
    strips = [
        _strip_errors(true, nets[turn, :, first : first + STRIP], CORNERS[turn], first)
        for first in range(0, cells, STRIP)
        for turn in range(4)
    ]
    return np.max(strips, axis=0)


def _strip_errors(true: TrueSurface, nets: Array, corners: Array, first: int) -> list[float]:
    """Return the errors on one patch of each cell in a strip; `nets` has shape (6, …, N, 3)."""
    rows, cells = nets.shape[1:3]
    by_place = np.linalg.inv(np.column_stack([corners, np.ones(3)]).T)[:, :2]
    point = np.einsum("lk,klb->lb", LATTICE, HALF_DERIVATIVES)
    along = 2 * cells * np.einsum("kd,klb->dlb", by_place, HALF_DERIVATIVES)
    p, p_u, p_v = (np.tensordot(weights, nets, 1) for weights in (point, *along))
    u, v = (LATTICE @ corners + 0.5).T[:, :, None, None]
    u = (np.arange(first, first + rows)[:, None] + u) / cells
    v = (np.arange(cells) + v) / cells
    x, x_u, x_v = np.moveaxis(true.derivatives(u, v, 1), -2, 0)
    return [
        float(lengths(x - p).max()),
        float(max(lengths(x_u - p_u).max(), lengths(x_v - p_v).max())),
        float(angles(np.cross(x_u, x_v), np.cross(p_u, p_v)).max()),
    ]


def lengths(vectors: Array) -> Array:
    """Return the lengths of vectors (..., 3)."""
    return np.sqrt(np.einsum("...x,...x->...", vectors, vectors))


def angles(left: Array, right: Array) -> Array:
    """Return the angles between vectors in degrees, accurate when they are small."""
    chord = left / lengths(left)[..., None] - right / lengths(right)[..., None]
    return np.degrees(2 * np.arcsin(np.minimum(lengths(chord) / 2, 1.0)))


# --- errors at equal normals ----------------------------------------------------------------------


@dataclass(frozen=True)
class SupportErrors:
    """The largest error of the support function, and how many samples it was looked for in.

    `left_out` counts the others for each reason that the page explains. `closed_form` is the
    largest difference between the exact value and a known closed form, NaN if none is known.
    """

    error: float
    compared: int
    left_out: dict[str, int]
    closed_form: float


def support_errors(true: TrueSurface, cells: int, normals: Array) -> SupportErrors:
    """Compare the support values of samples of the spline with exact ones at equal normals."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        samples = gm.sample(true.surface, normals=normals, cells=(cells, cells), on="spline")
    start = true.unit(samples.uv)
    end = preimages(true, start, samples.normals)
    with np.errstate(all="ignore"):
        derivatives = true.derivatives(end[:, 0], end[:, 1], 2)
        curvature = gaussian_curvature(derivatives)
        found = has_normal(derivatives, samples.normals)
        found &= np.abs(end - start).max(axis=1) * cells <= NEAR
    here = gaussian_curvature(true.derivatives(start[:, 0], start[:, 1], 2))
    reasons = {
        "flat": np.abs(here) < FLAT * true.largest_curvature,
        "lost": ~found,
        "turned": np.signbit(curvature) != samples.hyperbolic,
        "outside": ~true.inside(end),
    }
    good = np.ones(len(samples), dtype=bool)
    left_out = {}
    for name in REASONS:
        left_out[name] = int((good & reasons[name]).sum())
        good &= ~reasons[name]
    exact = np.einsum("nx,nx->n", samples.normals, derivatives[:, 0])[good]
    error = np.abs(exact - samples.support[good]).max()
    closed = closed_form(true, samples.normals[good], curvature[good])
    difference = math.nan if closed is None else float(np.abs(exact - closed).max())
    return SupportErrors(float(error), int(good.sum()), left_out, difference)


def preimages(true: TrueSurface, places: Array, normals: Array) -> Array:
    """Solve n·x_u = n·x_v = 0 by Newton's method, from `places`; NaN where it breaks down."""
    for _ in range(STEPS):
        with np.errstate(all="ignore"):
            derivatives = true.derivatives(places[:, 0], places[:, 1], 2)
            forms = np.einsum("nkx,nx->nk", derivatives, normals)
            P, Q, A, B, C = forms[:, 1:].T
            step = np.stack([B * Q - C * P, B * P - A * Q], axis=1) / (A * C - B * B)[:, None]
            places = places + step
    return places


def has_normal(derivatives: Array, normals: Array) -> NDArray[np.bool_]:
    """Say where x_u × x_v has the direction of the normal, orientation included."""
    return angles(np.cross(derivatives[:, 1], derivatives[:, 2]), normals) < 1e-7


def closed_form(true: TrueSurface, normals: Array, curvature: Array) -> Array | None:
    """Return the support values of a surface that has a closed form, and None for others.

    The torus has two values for a normal, one for each sign of K.
    """
    value = {x.symbol.name: float(x.default) for x in true.entry.parameters}
    x, y, z = normals.T
    if true.name == "torus":
        return value["minor"] + np.sign(curvature) * value["major"] * np.hypot(x, y)
    signs = {"ellipsoid_patch": 1.0, "hyperboloid": -1.0}
    if true.name in signs:
        a, b, c = (value[name] for name in "abc")
        return np.sqrt((a * x) ** 2 + (b * y) ** 2 + signs[true.name] * (c * z) ** 2)
    return None


# --- all of them ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Measurement:
    """What was measured on one surface, grid by grid: `errors` has a row for each quantity."""

    true: TrueSurface
    grids: tuple[int, ...]
    errors: Array
    support: list[SupportErrors]

    def slope(self, quantity: Quantity, last: int = 0) -> float:
        """Return the order by least squares, over the `last` grids or all of them."""
        errors = self.errors[QUANTITIES.index(quantity)][-last:]
        return -float(np.polyfit(np.log(self.grids[-last:]), np.log(errors), 1)[0])

    def constants(self, quantity: Quantity) -> Array:
        """Return error / k^order on each grid."""
        powers = np.array(self.grids, dtype=float) ** quantity.order
        return self.errors[QUANTITIES.index(quantity)] * powers


def measure(name: str, grids: Sequence[int], normals: Array) -> Measurement:
    """Measure one surface on several grids; a developable one has no support function (NaN)."""
    true = TrueSurface(name)
    at_parameters = np.array([parameter_errors(true, cells) for cells in grids]).T
    at_normals = [] if true.developable else [support_errors(true, x, normals) for x in grids]
    support = [x.error for x in at_normals] or [math.nan] * len(grids)
    return Measurement(true, tuple(grids), np.vstack([at_parameters, support]), at_normals)


# --- the page -------------------------------------------------------------------------------------

HEAD = """\
# Orders of approximation, measured

Written by `make orders`: do not edit.

A surface x of the catalogue (`gaussmap surfaces`), with its default parameters, is approximated by
the spline p of `gaussmap.fit` on N × N cells, N = {grids}. As in the paper, k = 1/N is the
size of a cell when the domain is scaled to the unit square. Measured are

{quantities}

The first three are taken over {places} points of each of the 4 N² patches: the barycentric lattice
of step 1/{parts}, which includes vertices and edges of the cells and the border of the domain.

The tables give the error on each grid, the slope of log(error) against log(k) by least squares,
over all grids and over the {last} finest, and the constant: the largest error / kʳ of all grids, r
being the order that is claimed, and its value on the finest grid. A slope above r, with a constant
that decreases towards the finest grid, means that terms of higher order contribute on coarse grids.

{exact} have quadratic polynomials for coordinates. The spline reproduces them
exactly; the remaining rounding error is given as a power of ten above it.

Not in these tables are {singular}. At their poles x_u × x_v = 0 (checked
exactly): these are singular points of the parameterization, without a normal by (1), and an error
of the derivatives, divided by |x_u × x_v|, does not bound that of the normals there. They are in
the last section.
"""

POLES = """\
## Poles

At a pole, an end of v where the surface is one point, the coefficients of the spline around it lie
in one plane, exactly: so the spline has one normal there, and a closed surface has Σ sign K = χ/2
for every normal. The tables give errors in rows of cells, counted from a pole, over {places} places
of each cell, and in the middle half of the domain. Surfaces are rotated, so that no axis of
symmetry is one of the coordinates, and `egg` is {egg}

Positions keep their order. Normals lose one next to poles, unless symmetry hides it: v² u, a term
of third order, is not reproduced, and the error of p_u is divided by the radius of a row, which is
of the order of k. At the poles themselves the normals of spline and surface differ by less than
{tip} degrees here. With `on="surface"`, samples do not have these errors: they are moved to the
surface.
"""

METHOD = """\
h_p comes from `gaussmap.sample`, which returns the support value of every point of the spline that
has one of {normals:,} normals (a Fibonacci lattice on the sphere). h_x is exact: Newton's method on
n·x_u = n·x_v = 0, with exact derivatives, leads from the parameters of the sample to the point of
the true surface with the same normal n, and h_x(n) = n·x there. For {closed}
it agrees with the closed form of the support function: the largest difference is
below {difference}.

Where K is near zero a normal does not determine its point, or has none on one of the two surfaces.
Samples are left out, and counted below, in this order, as

- **flat**, if |K| of the true surface at the parameters of the sample is less than
  {flat:g} % of the largest |K| of the surface;
- **lost**, if Newton's method does not converge to a point of normal n within {near:g} cells of the
  sample;
- **turned**, if K has another sign at that point than at the sample;
- **outside**, if that point lies beyond the border of the domain.

{developable} have K = 0 everywhere, and no support function as a function of the
normal.

Why the order is 3: with n the normal of p at s′ and of x at s,
h_p(n) − h_x(n) = n·(p − x)(s′) + [n·x(s′) − n·x(s)]. The first term is an error of positions. In
the second n·x is stationary at s, and s′ − s is of the order of the error of the normals, k², so
it is O(k⁴). In the limit Ĉ is therefore not larger than C̃ (up to the third digit: each is a
maximum over finitely many points).
"""

FASTER = """\
Faster than claimed: {names}. All third derivatives of this surface are tangent to it, so that the
leading term of the error of p_u and p_v does not turn the normal.
"""


def page(measurements: Sequence[Measurement]) -> str:
    """Return the page."""
    exact = [x.true.name for x in measurements if x.true.reproduced]
    head = HEAD.format(
        grids=listed(map(str, measurements[0].grids)),
        quantities="\n".join(f"- **{x.title}**: {x.definition};" for x in QUANTITIES)[:-1] + ".",
        places=len(LATTICE),
        parts=PARTS,
        last=LAST,
        exact=listed(map(code, exact)),
        singular=listed(map(code, singular_surfaces())),
    )
    parts = [wrapped(head)]
    for quantity in QUANTITIES:
        parts.append(f"## {quantity.title}\n")
        if quantity is SUPPORT:
            parts.append(_method(measurements))
        parts.append(table(quantity, measurements))
        if quantity is ANGLES:
            parts.append(_faster(measurements))
    parts.append("Samples compared and left out, on the coarsest and on the finest grid:\n")
    parts.append(counts(measurements))
    parts.append(at_poles(measurements[0].grids))
    return "\n".join(x for x in parts if x)


def at_poles(grids: Sequence[int]) -> str:
    """Return the section on surfaces with poles."""
    found = [poles.measured(x.name, cells) for x in poles.surfaces() for cells in grids]
    text = POLES.format(
        places=poles.ALONG.size * poles.ACROSS.size,
        egg=poles.EGG.sentence[0].lower() + poles.EGG.sentence[1:],
        tip=above(max(x.at_pole for x in found)).removeprefix("< "),
    )
    parts = [wrapped(text)]
    for title, quantity in (("Positions", "positions"), ("Normals, in degrees", "normals")):
        header, *rows = poles.table(grids, quantity)
        parts += [f"{title}:\n", markdown(header, rows)]
    return "\n".join(parts)


def table(quantity: Quantity, measurements: Sequence[Measurement]) -> str:
    """Return the table of one quantity, with a row for each surface."""
    grids = measurements[0].grids
    header = ["surface", *(f"N = {x}" for x in grids), "slope", f"slope, N ≥ {grids[-LAST:][0]}"]
    header += [quantity.constant, f"{quantity.constant}, N = {grids[-1]}"]
    return markdown(header, [_row(quantity, x) for x in measurements])


def _row(quantity: Quantity, measured: Measurement) -> list[str]:
    errors = measured.errors[QUANTITIES.index(quantity)]
    if np.isnan(errors).any():
        return [code(measured.true.name), *["–"] * len(errors), *["–"] * 4]
    if measured.true.reproduced:
        return [code(measured.true.name), *map(above, errors), "exact", "exact", "0", "0"]
    constants = measured.constants(quantity)
    slopes = (measured.slope(quantity, last) for last in (0, LAST))
    return [
        code(measured.true.name),
        *map(number, errors),
        *(f"{x:.2f}" for x in slopes),
        *map(number, (constants.max(), constants[-1])),
    ]


def counts(measurements: Sequence[Measurement]) -> str:
    """Return the table of the samples that were compared and left out."""
    header = ["surface", "N", "compared", *REASONS]
    rows = [
        [code(x.true.name), str(x.grids[k]), f"{x.support[k].compared:,}"]
        + [f"{x.support[k].left_out[reason]:,}" for reason in REASONS]
        for x in measurements
        for k in (0, -1)
        if x.support
    ]
    return markdown(header, rows)


def _method(measurements: Sequence[Measurement]) -> str:
    differences = {
        x.true.name: max(y.closed_form for y in x.support)
        for x in measurements
        if x.support and not math.isnan(x.support[0].closed_form)
    }
    developable = [x.true.name for x in measurements if x.true.developable]
    return wrapped(
        METHOD.format(
            normals=NORMALS,
            closed=listed(map(code, differences)),
            difference=above(max(differences.values())).removeprefix("< "),
            flat=100 * FLAT,
            near=NEAR,
            developable=listed(map(code, developable)),
        )
    )


def _faster(measurements: Sequence[Measurement]) -> str:
    """Name the surfaces whose normals are faster than claimed, if they have the stated property."""
    faster = [
        x.true
        for x in measurements
        if not x.true.reproduced and x.slope(ANGLES, LAST) > ANGLES.order + 0.5
    ]
    if not all(third_derivatives_are_tangent(x.entry) for x in faster):
        raise ArithmeticError("normals are faster than claimed without the known reason")
    return wrapped(FASTER.format(names=listed(code(x.name) for x in faster))) if faster else ""


def third_derivatives_are_tangent(entry: ParametricSurface) -> bool:
    """Say whether all third derivatives of the position are tangent to the surface."""
    u, v = entry.u, entry.v
    normal = sp.Matrix(entry.normal_field)
    return all(
        sp.simplify(dot(entry.derivative(*by), normal)) == 0
        for by in ((u, u, u), (u, u, v), (u, v, v), (v, v, v))
    )


def markdown(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown, its first column aligned left and the others right."""
    lines = [header, [":--", *["--:"] * (len(header) - 1)], *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def wrapped(text: str) -> str:
    """Break paragraphs and items of a list at 100 characters."""
    blocks = re.split(r"\n(?=- )|\n\n", text.rstrip("\n"))
    lines = [
        textwrap.fill(" ".join(x.split()), 100, subsequent_indent="  " * x.startswith("- "))
        for x in blocks
    ]
    gaps = re.findall(r"\n(?=- )|\n\n", text.rstrip("\n"))
    return "".join(x + gap for x, gap in zip(lines, [*gaps, "\n"], strict=True))


def number(x: float) -> str:
    """Return a number with three digits, small ones with an exponent."""
    if 0.01 <= x < 1000:
        return f"{x:.3g}"
    digits, exponent = f"{x:.2e}".split("e")
    return f"{digits}e{int(exponent)}"


def above(x: float) -> str:
    """Return zero, or a power of ten above a number: the digits of rounding errors mean nothing."""
    return "0" if x == 0.0 else f"< 1e{math.floor(math.log10(x)) + 1}"


def code(name: str) -> str:
    """Return a name as code in Markdown."""
    return f"`{name}`"


def listed(words: Iterable[str]) -> str:
    """Return words as people list them: a, b and c."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def main() -> None:
    """Measure every regular surface and print the page."""
    normals = gm.fibonacci(NORMALS)
    names = tqdm(regular_surfaces(), desc="measuring", unit="surface", disable=None)
    print(page([measure(name, GRIDS, normals) for name in names]), end="")


if __name__ == "__main__":
    main()
