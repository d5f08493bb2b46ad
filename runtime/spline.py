"""The C¹ quadratic spline that approximates a surface: fitting it, and reading it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import parameter_arrays, whole_number
from .errors import InputError, SurfaceError, in_memory, shown
from .kernels import spline as kernels
from .ring import Border, Sides, coefficients_with_ring, vertices_with_ring
from .surface import Domain, Ends, Surface
from .surfaces import named
from .threads import over_ranges
from .tolerances import DATA_ERROR

__all__ = [
    "DEFAULT_CELLS",
    "Spline",
    "apart",
    "fit",
    "fit_grid",
    "not_too_large",
    "scale_to_one",
    "short_label",
    "spline_of",
]

DEFAULT_CELLS = (64, 64)
MOST_CELLS = 10**9
LONGEST_LABEL = 40
PATCHES_AT_A_TIME = 1 << 14
# What is said to be one point may be this far apart, beside the size of the surface.
SAME_POINT = 1e-6
# Beyond this binary exponent a number cannot be multiplied by a few small ones.
LARGEST_EXPONENT = 1000
# Parameters that differ by less than this part of their range are the same, up to rounding.
ROUNDING = 1e-12


def spline_of(surface: Surface | Spline | str, cells: Sequence[int] | None) -> Spline:
    """Return a spline as it is, or that of a surface or of the name of one.

    Raises InputError for `cells` beside a spline.
    """
    if isinstance(surface, Spline):
        if cells is not None:
            raise InputError("cells=... is for surfaces; this spline has its cells already.")
        return surface
    return fit(surface, cells)


def short_label(name: str) -> str:
    """Return a name on one line, cut if it is long."""
    label = " ".join(name.split())
    return label if len(label) <= LONGEST_LABEL else label[: LONGEST_LABEL - 1] + "…"


@dataclass(frozen=True, eq=False, repr=False)
class Spline:
    """A C¹ quadratic triangular spline on the criss-cross grid (paper, Sect. 3.1); made by `fit`.

    `coefficients` (m + 2, n + 2, 3) holds one vector for each cell and one ring outside. They
    define the spline exactly; control nets follow from them with rounding. Patches are numbered
    cell by cell (cell = i n + j, i along u), in each cell south, east, north, west.
    """

    coefficients: NDArray[np.float64]
    domain: Domain
    ends: Ends
    name: str

    def __repr__(self) -> str:
        return f"Spline({self.cells[0]} × {self.cells[1]} cells of {short_label(self.name)})"

    @property
    def cells(self) -> tuple[int, int]:
        """The number of cells along u and along v."""
        return self.coefficients.shape[0] - 2, self.coefficients.shape[1] - 2

    @property
    def patches(self) -> int:
        """The number of quadratic patches, four for each cell."""
        return 4 * self.cells[0] * self.cells[1]

    @cached_property
    def control_nets(self) -> NDArray[np.float64]:
        """The Bézier nets (patches, 6, 3), each in the order b200, b020, b002, b110, b101, b011."""
        nets = np.empty((self.patches, 6, 3))
        kernels.control_nets(self.coefficients, nets)
        return nets

    @cached_property
    def frame(self) -> NDArray[np.float64]:
        """The corner of the domain and the size of a cell in the parameters: (u0, v0, du, dv)."""
        (u0, u1), (v0, v1) = self.domain
        return np.array([u0, v0, (u1 - u0) / self.cells[0], (v1 - v0) / self.cells[1]])

    @cached_property
    def scale(self) -> float:
        """A power of two that brings the differences of neighbouring coefficients to about 1."""
        steps = [np.abs(np.diff(self.coefficients, axis=axis)).max() for axis in (0, 1)]
        return scale_to_one(float(max(steps)))

    @cached_property
    def noise(self) -> float:
        """The rounding of the coordinates, times `scale`."""
        return DATA_ERROR * float(np.abs(self.coefficients * self.scale).max())

    def evaluate(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """Return points (..., 3) at parameters that broadcast together.

        Periodic parameters are taken modulo the period; InputError if one that is not periodic lies
        outside the domain, or any is NaN or infinite.
        """
        return self._evaluate(u, v)[0]

    def normals(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """Return unit normals (..., 3) along p_u × p_v; see `evaluate`.

        They are NaN at poles, and at singular points where p_u × p_v vanishes exactly.
        """
        vectors = self._evaluate(u, v)[1]
        with np.errstate(invalid="ignore"):
            vectors /= np.abs(vectors).max(axis=-1, keepdims=True)
            return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)

    @cached_property
    def measure(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Area and signed solid angle of the Gaussian image of each patch, by quadrature.

        Areas are in units of the squared diagonal of the bounding box of the coefficients.
        """
        areas, solid_angles = np.empty(self.patches), np.empty(self.patches)

        def work(first: int, last: int) -> None:
            kernels.measure_patches(
                self.coefficients, self.scale, first, last,
                areas[first:last], solid_angles[first:last],
            )  # fmt: skip

        for _ in over_ranges(work, self.patches, PATCHES_AT_A_TIME, None):
            pass
        inner = self.coefficients[1:-1, 1:-1].reshape(-1, 3) * self.scale
        diagonal = float(np.linalg.norm(np.ptp(inner, axis=0)))
        return areas / diagonal**2 if diagonal > 0.0 else areas, solid_angles

    def _evaluate(
        self, u: ArrayLike, v: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        u_array, v_array = parameter_arrays(u, v)
        places = np.stack([u_array.ravel(), v_array.ravel()], axis=1)
        cells = self.in_cells(places)
        points, normals = np.empty_like(places, shape=(len(places), 3)), np.empty((len(places), 3))
        kernels.evaluate(self.coefficients, self.scale, cells, points, normals)
        for end, place in zip(self.ends[1], (0, self.cells[1]), strict=True):
            if end == "pole":  # all but rounding
                normals[np.abs(cells[:, 1] - place) <= ROUNDING * self.cells[1]] = 0.0
        return points.reshape(*u_array.shape, 3), normals.reshape(*u_array.shape, 3)

    def in_cells(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return parameters (k, 2) in cells from the corner of the domain; see `evaluate`."""
        return self._wrapped((places - self.frame[:2]) / self.frame[2:], places)

    def _wrapped(
        self, cells: NDArray[np.float64], places: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Bring periodic coordinates (in cells) back into the domain; refuse others outside it."""
        for axis, name in enumerate("uv"):
            count = self.cells[axis]
            if self.ends[axis][0] in ("wrap", "flip"):
                with np.errstate(invalid="ignore"):
                    turns = np.where(cells[:, axis] == count, 0.0, np.floor(cells[:, axis] / count))
                    cells[:, axis] -= turns * count
                if self.ends[axis][0] == "flip":
                    other = 1 - axis
                    odd = np.mod(turns, 2.0) == 1.0
                    cells[odd, other] = self.cells[other] - cells[odd, other]
            slack = 1e-9 * count
            inside = (cells[:, axis] >= -slack) & (cells[:, axis] <= count + slack)
            if not inside.all():
                worst = int(np.argmin(inside))
                raise InputError(
                    f"{name} = {places[worst, axis]} lies outside the domain {self.domain[axis]} "
                    f"of {self.name!r}."
                )
        return cells


@in_memory
def fit(surface: Surface | str, cells: Sequence[int] | None = None) -> Spline:
    """Approximate a surface by a C¹ quadratic spline.

    The quasi-interpolant (paper, Sect. 3.1) is exact on quadratics. The error of positions falls
    with the third power of the cell size, that of normals with the second (13).

    Parameters
    ----------
    surface : Surface or str
        The surface, or its name in the catalogue (see `gaussmap.surfaces`).
    cells : (int, int), optional
        The numbers of cells along u and v, at least 3; along u an even one if the surface has a
        pole. By default 64 × 64, or one cell between any four neighbouring points of a grid.

    Returns
    -------
    Spline
        The spline, with four quadratic patches in each cell.

    Raises
    ------
    InputError
        For unusable `cells`, and more of them than a narrow domain can hold.
    UnknownNameError
        If there is no surface of that name.
    SurfaceError
        If the surface cannot be evaluated, or does not close where its ends say so.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.fit("torus", (16, 16))
    Spline(16 × 16 cells of torus)

    """
    surface = named(surface)
    if not isinstance(surface, Surface):
        raise InputError(f"fit takes a Surface, not {type(surface).__name__}.")
    if cells is None and surface.grid is not None:
        return fit_grid(surface.grid, surface.domain, surface.ends, surface.name)
    m, n = _checked_cells(DEFAULT_CELLS if cells is None else cells, surface.ends)
    lines = _lines(surface.domain, m, n)
    centres, vertices = _values(surface, *lines)
    inner = np.empty((m, n, 3))
    kernels.fit_centres_and_vertices(centres, vertices, inner)
    border = Border.of_values(_middles(surface, *lines), vertices)
    coefficients = coefficients_with_ring(inner, border, surface.ends)
    return Spline(coefficients, surface.domain, surface.ends, surface.name)


def fit_grid(points: NDArray[np.float64], domain: Domain, ends: Ends, name: str) -> Spline:
    """Return the spline with one cell between any four neighbouring points (m, n, 3) of a grid."""
    values = vertices_with_ring(not_too_large(points, name), ends)
    inner = np.empty((values.shape[0] - 3, values.shape[1] - 3, 3))
    _checked_cells(inner.shape[:2], ends)
    kernels.fit_vertices(values, inner)
    border = Border.of_vertices(values)
    return Spline(coefficients_with_ring(inner, border, ends), domain, ends, name)


def scale_to_one(largest: float) -> float:
    """Return a power of two that brings a number to about 1."""
    return math.ldexp(1.0, min(-math.frexp(largest)[1], LARGEST_EXPONENT)) if largest else 1.0


def apart(
    first: NDArray[np.float64], second: NDArray[np.float64], points: NDArray[np.float64]
) -> bool:
    """Say whether what should be the same differs by more than rounding, beside all points."""
    extent = points.max(axis=0).max(axis=0) - points.min(axis=0).min(axis=0)  # fastest this way
    size = float(extent.max())
    rounding = 64.0 * float(np.spacing(np.abs(points).max()))
    return float(np.abs(first - second).max()) > SAME_POINT * size + rounding


def not_too_large(points: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """Return points; SurfaceError if formulas would overflow with them."""
    if np.abs(points).max() > 2.0**LARGEST_EXPONENT:
        raise SurfaceError(f"the coordinates of {name!r} are too large to compute with.")
    return points


def _values(
    surface: Surface, lines_u: NDArray[np.float64], lines_v: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Evaluate a surface at the centres (m, n, 3) and vertices (m + 1, n + 1, 3) of its cells.

    Vertices on a seam are made bitwise equal, so that the spline closes exactly.
    """
    centres = not_too_large(surface.evaluate(lines_u[1::2, None], lines_v[1::2]), surface.name)
    vertices = not_too_large(surface.evaluate(lines_u[::2, None], lines_v[::2]), surface.name)
    for axis, (along, ends) in enumerate(zip("uv", surface.ends, strict=True)):
        rows = np.swapaxes(vertices, 0, axis)
        if ends[0] in ("wrap", "flip"):
            first = rows[0] if ends[0] == "wrap" else rows[0, ::-1].copy()
            if apart(rows[-1], first, vertices):
                raise SurfaceError(
                    f"surface {surface.name!r} does not close along {along}: its two ends must be "
                    f"the same{'' if ends[0] == 'wrap' else ', mirrored'}."
                )
            rows[-1] = first
        for end, place, row in zip(ends, surface.domain[axis], (0, -1), strict=True):
            if end == "pole" and apart(rows[row], rows[row, :1], vertices):
                raise SurfaceError(
                    f"surface {surface.name!r} has no pole at {along} = {place}: it is not "
                    "one point there."
                )
    return centres, vertices


def _middles(surface: Surface, lines_u: NDArray[np.float64], lines_v: NDArray[np.float64]) -> Sides:
    """Evaluate a surface in the middle of the edges at the ends of v, and at the ends of u."""
    at_v = not_too_large(surface.evaluate(lines_u[1::2], lines_v[[0, -1], None]), surface.name)
    at_u = not_too_large(surface.evaluate(lines_u[[0, -1], None], lines_v[1::2]), surface.name)
    return (at_v[0], at_v[1]), (at_u[0], at_u[1])


def _lines(domain: Domain, m: int, n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the parameters of the edges and middles of the cells, in turn, along u and v."""
    lines = []
    for along, (low, high), count in zip("uv", domain, (m, n), strict=True):
        line = low + (high - low) * (np.arange(2 * count + 1) / (2 * count))
        if not (np.diff(line) > 0.0).all():
            raise InputError(
                f"the domain of {along} is too narrow for {count} cells: ({low}, {high})."
            )
        lines.append(line)
    return lines[0], lines[1]


def _checked_cells(cells: Sequence[int], ends: Ends) -> tuple[int, int]:
    try:
        m, n = cells
    except (TypeError, ValueError):
        raise InputError(
            f"cells must be a pair of whole numbers (m, n), not {shown(cells)}."
        ) from None
    m, n = whole_number(m, "cells[0]"), whole_number(n, "cells[1]")
    if min(m, n) < 3:
        raise InputError(f"at least 3 x 3 cells are needed, not {m} x {n}.")
    if m * n > MOST_CELLS:
        raise InputError(f"at most {MOST_CELLS:,} cells are possible, not {m:,} x {n:,}.")
    if "pole" in ends[1] and m % 2:
        raise InputError(f"a surface with a pole needs an even number of cells along u, not {m}.")
    return m, n
