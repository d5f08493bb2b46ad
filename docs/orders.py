"""Print docs/orders.md: the error estimates (13) and that of the support function, measured.

All parameters below are those of the unit square, as in the paper: each end of the domain of a
surface is moved to 0 or 1.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path

import gaussmap as gm
import numpy as np
import sympy as sp
from gaussmap.docs import poles
from gaussmap.docs.exact import angles, derivatives_of, lengths
from gaussmap.docs.markdown import above, code, listed, markdown, number, wrapped
from gaussmap.runtime.onto_surface.on_spline import OnSpline
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
FLAT = 0.01  # of the largest |K|
NEAR = 2.0  # cells
STEPS = 8  # of Newton's method
PAGE = Path(__file__).parent / "_pages" / "orders.md"  # a template for numbers and tables
REASONS = ("flat", "lost", "turned", "outside")  # for which samples are left out


@dataclass(frozen=True)
class Quantity:
    """A measured quantity: title, claimed order, symbol of the constant, and definition."""

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
        self.derivatives = derivatives_of(self.entry)

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


def gaussian_curvature(derivatives: Array) -> Array:
    """Return K from x, x_u, x_v, x_uu, x_uv, x_vv, shape (..., 6, 3)."""
    normal = np.cross(derivatives[..., 1, :], derivatives[..., 2, :])
    L, M, N = np.moveaxis(np.einsum("...kx,...x->...k", derivatives[..., 3:, :], normal), -1, 0)
    return (L * N - M * M) / np.einsum("...x,...x->...", normal, normal) ** 2


# --- errors at equal parameters -------------------------------------------------------------------


LATTICE = np.array([x for x in product(range(PARTS + 1), repeat=3) if sum(x) == PARTS]) / PARTS
# The distinct lattice points of the four patches of a cell, as positions in the cell.
PLACES = np.unique((LATTICE @ np.array(triangles([(0, 0)]), dtype=float)).reshape(-1, 2), axis=0)


def parameter_errors(true: TrueSurface, cells: int) -> Array:
    """Return the largest errors of positions, first derivatives and normals (in degrees)."""
    jets = OnSpline(gm.fit(true.surface, (cells, cells))).jets
    (u0, u1), (v0, v1) = true.surface.domain
    t = (np.arange(cells)[:, None] + 0.5 + PLACES[:, 1]).ravel() / cells
    largest = np.zeros(3)
    for row in range(cells):
        s = np.tile((row + 0.5 + PLACES[:, 0]) / cells, cells)
        x, x_s, x_t = np.moveaxis(true.derivatives(s, t, 1), -2, 0)
        p, p_u, p_v, *_ = np.moveaxis(jets(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t), 1, 0)
        p_s, p_t = (u1 - u0) * p_u, (v1 - v0) * p_v
        slopes = np.maximum(lengths(x_s - p_s), lengths(x_t - p_t))
        normals = angles(np.cross(x_s, x_t), np.cross(p_s, p_t))
        largest = np.maximum(largest, [lengths(x - p).max(), slopes.max(), normals.max()])
    return largest


# --- errors at equal normals ----------------------------------------------------------------------


@dataclass(frozen=True)
class SupportErrors:
    """The largest error of the support function, and the number of samples that were compared.

    `left_out` counts the other samples for each reason that the page explains. `closed_form` is the
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
        turned = angles(np.cross(derivatives[:, 1], derivatives[:, 2]), samples.normals)
        found = turned < 1e-7  # orientation included
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
    """The measurements on one surface: `errors` has a row for each quantity, by grid."""

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

FASTER = """\
Faster than claimed: {names}. All third derivatives of this surface are tangent to it, so that the
leading term of the error of p_u and p_v does not turn the normal.
"""


def page(measurements: Sequence[Measurement]) -> str:
    """Return the page."""
    grids = measurements[0].grids
    differences = {
        x.true.name: max(y.closed_form for y in x.support)
        for x in measurements
        if x.support and not math.isnan(x.support[0].closed_form)
    }
    at_poles = [poles.measured(x.name, cells) for x in poles.surfaces() for cells in grids]
    text = PAGE.read_text(encoding="utf-8").format(
        grids=listed(map(str, grids)),
        quantities="\n".join(f"- **{x.title}**: {x.definition};" for x in QUANTITIES)[:-1] + ".",
        places=len(LATTICE),
        parts=PARTS,
        last=LAST,
        exact=listed(code(x.true.name) for x in measurements if x.true.reproduced),
        singular=listed(map(code, singular_surfaces())),
        normals=NORMALS,
        closed=listed(map(code, differences)),
        difference=above(max(differences.values())).removeprefix("< "),
        flat=100 * FLAT,
        near=NEAR,
        developable=listed(code(x.true.name) for x in measurements if x.true.developable),
        faster=_faster(measurements),
        rows=poles.ALONG.size * poles.ACROSS.size,
        egg=poles.EGG.sentence[0].lower() + poles.EGG.sentence[1:],
        tip=above(max(x.at_pole for x in at_poles)).removeprefix("< "),
    )
    tables = {x.title: table(x, measurements) for x in QUANTITIES} | {
        "counts": counts(measurements)
    }
    tables |= {x: poles.table(grids, x) for x in ("positions", "normals")}
    return re.sub(
        r"^\[([\w ]+)\]\n", lambda found: tables[found[1]], wrapped(text), flags=re.MULTILINE
    )


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


def _faster(measurements: Sequence[Measurement]) -> str:
    """Name the surfaces whose normals converge faster than claimed.

    Raises ArithmeticError if third derivatives of one of them are not tangent to it.
    """
    faster = [
        x.true
        for x in measurements
        if not x.true.reproduced and x.slope(ANGLES, LAST) > ANGLES.order + 0.5
    ]
    if not all(third_derivatives_are_tangent(x.entry) for x in faster):
        raise ArithmeticError("normals are faster than claimed without the known reason")
    return FASTER.format(names=listed(code(x.name) for x in faster)) if faster else ""


def third_derivatives_are_tangent(entry: ParametricSurface) -> bool:
    """Say whether all third derivatives of the position are tangent to the surface."""
    u, v = entry.u, entry.v
    normal = sp.Matrix(entry.normal_field)
    return all(
        sp.simplify(dot(entry.derivative(*by), normal)) == 0
        for by in ((u, u, u), (u, u, v), (u, v, v), (v, v, v))
    )


def main() -> None:
    """Measure every regular surface and print the page."""
    normals = gm.fibonacci(NORMALS)
    names = tqdm(regular_surfaces(), desc="measuring", unit="surface", disable=None)
    print(page([measure(name, GRIDS, normals) for name in names]), end="")


if __name__ == "__main__":
    main()
