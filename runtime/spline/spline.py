"""The C¹ quadratic spline that approximates a surface: evaluation, control nets, area."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated.spline import NEIGHBOURS, SCALE, TRIANGLE_NEIGHBOURS, triangle
from ...generated.vectors import Patch, Vector
from ..base.checks import checked_array, parameter_arrays, text
from ..base.errors import InputError
from ..base.formula_calls import python_function
from ..base.georeference import Georeference
from ..base.threads import over_ranges
from ..base.tolerances import SAME_PARAMETER
from ..domain.domain import Boundary, Domain, brought_inside, checked_boundary, checked_domain
from ..domain.inside import Inside
from .developable import CellMeasure
from .kernels import spline as kernels
from .kernels.patch import normals_at
from .patch_spline import PatchSpline
from .spline_methods import Methods

if TYPE_CHECKING:
    from ..domain.trim import Trim
    from .misfit import Misfit

LONGEST_LABEL = 40
PATCHES_AT_A_TIME = 1 << 14
# The index of the coefficient of a patch's own cell in NEIGHBOURS.
CENTRE = 4


def short_label(name: str) -> str:
    """Return a name on one line, cut if it is long."""
    label = " ".join(name.split())
    return label if len(label) <= LONGEST_LABEL else label[: LONGEST_LABEL - 1] + "…"


@dataclass(frozen=True, eq=False, repr=False)
class Spline(PatchSpline, Methods):
    """A C¹ quadratic triangular spline on the criss-cross grid (paper, Sect. 3.1); made by `fit`.

    Patches are numbered cell by cell (cell = i n + j, i along u), in each cell south, east, north,
    west.

    Attributes
    ----------
    coefficients : (m + 2, n + 2, 3) float64 array
        One vector for each cell and for one ring of ghost cells outside. They define the spline
        exactly; control nets follow from them with rounding.
    domain : ((u0, u1), (v0, v1)) of float
        The rectangle of the parameters.
    boundary : pair of pairs of str
        For u and for v, the boundary conditions at the lower and the upper bound, see `Surface`.
    name : str
        Label of the surface.
    misfit : Misfit or None
        The distance of the spline from the surface, or from the data, that it approximates: maximum
        and root mean square, with the largest angle between the normals. None if the spline was not
        made by `fit`.
    trim : Trim or None
        The part of the domain that belongs to the surface, None for all of it; see
        `Surface.trimmed`.
    apexes : int
        The number of open sides that are collapsed to a point at which the surface is not smooth:
        the tip of a cone, the corner of a triangle. They are detected with ``periodic=False``.
    georeference : Georeference or None
        The georeference of a `terrain`, see `Surface`.

    Examples
    --------
    >>> import gaussmap as gm
    >>> spline = gm.fit("torus", (16, 12))
    >>> spline
    Spline(16 × 12 cells of torus)
    >>> spline.cells, spline.patches, spline.coefficients.shape, spline.control_nets.shape
    ((16, 12), 768, (18, 14, 3), (768, 6, 3))
    >>> spline.boundary, spline.name
    ((('periodic', 'periodic'), ('periodic', 'periodic')), 'torus')
    >>> (u0, u1), (v0, v1) = spline.domain
    >>> bool((spline.frame == [u0, v0, (u1 - u0) / 16, (v1 - v0) / 12]).all())
    True
    >>> areas, solid_angles = spline.measure
    >>> bool(areas.min() > 0), bool(abs(solid_angles.sum()) < 1e-2)  # 2π χ = 0 on a torus
    (True, True)
    >>> spline.scale, spline.noise < 1e-13, spline.trim, spline.inside
    (1.0, True, None, None)
    >>> spline.misfit.rms < spline.misfit.distance < 3e-3, spline.misfit.angle < 2.0  # degrees
    (True, True)
    >>> spline.apexes, spline.georeference
    (0, None)

    """

    coefficients: NDArray[np.float64]
    domain: Domain
    boundary: Boundary
    name: str
    misfit: Misfit | None = None
    trim: Trim | None = None
    apexes: int = 0
    georeference: Georeference | None = None

    def __post_init__(self) -> None:
        text(self.name, "name")
        object.__setattr__(self, "domain", checked_domain(self.domain))
        object.__setattr__(self, "boundary", checked_boundary(self.boundary)[0])
        checked_array("coefficients", self.coefficients, ("m + 2", "n + 2", 3), np.float64)

    def __repr__(self) -> str:
        return f"Spline({self.cells[0]} × {self.cells[1]} cells of {short_label(self.name)})"

    @property
    def cells(self) -> tuple[int, int]:
        """The numbers (m, n) of cells along u and along v."""
        return self.coefficients.shape[0] - 2, self.coefficients.shape[1] - 2

    @property
    def patches(self) -> int:
        """The number of quadratic patches, four for each cell."""
        return 4 * self.cells[0] * self.cells[1]

    @cached_property
    def control_nets(self) -> NDArray[np.float64]:
        """(patches, 6, 3) float64 array: the Bézier nets.

        Each net is in the order b200, b020, b002, b110, b101, b011.
        """
        nets = np.empty((self.patches, 6, 3))
        kernels.control_nets(self.coefficients, nets)
        return nets

    @property
    def frame(self) -> NDArray[np.float64]:
        """(4,) float64 array: corner of the domain and size of a cell, (u0, v0, du, dv)."""
        (u0, u1), (v0, v1) = self.domain
        return np.array([u0, v0, (u1 - u0) / self.cells[0], (v1 - v0) / self.cells[1]])

    def _coefficients_around(self, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the coefficients (k, 9, 3) that NEIGHBOURS lists, for the patches `rows`."""
        cell, turn = np.divmod(rows, 4)
        i, j = np.divmod(cell, self.cells[1])
        width = self.cells[1] + 2
        steps = width * NEIGHBOURS[..., 0] + NEIGHBOURS[..., 1]
        around = ((i + 1) * width + j + 1)[:, None] + steps[turn]
        return self.coefficients.reshape(-1, 3).take(around, axis=0)

    def _patch(self, rows: NDArray[np.int64] | slice = slice(None)) -> Patch:
        """Return the vectors of the patches `rows` times `scale`, for formulas."""
        around = self._coefficients_around(np.arange(self.patches)[rows])
        around = np.ascontiguousarray(np.moveaxis(around, 0, 2))  # arithmetic is faster on rows
        steps = (around[TRIANGLE_NEIGHBOURS] - around[CENTRE]) * (self.scale / SCALE)
        return python_function(triangle)(*(Vector(*x) for x in steps))

    def _cross_products(
        self, patches: NDArray[np.int64], places: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        found = np.empty((len(patches), 3))
        normals_at(self.coefficients, self.scale, patches, np.ascontiguousarray(places), found)
        return found

    def _origins(self, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        return self._coefficients_around(rows)[:, CENTRE]

    @property
    def _points(self) -> NDArray[np.float64]:
        return self.coefficients

    def _largest_step(self) -> float:
        steps = [np.abs(np.diff(self.coefficients, axis=axis)).max() for axis in (0, 1)]
        return float(max(steps))

    @property
    def extent(self) -> tuple[float, int]:
        """The diagonal of the bounding box, and the larger of the numbers of cells along u and v.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.fit("plane", (8, 12)).extent[1]
        12

        """
        points = self.coefficients[1:-1, 1:-1].reshape(-1, 3)
        return math.hypot(*np.ptp(points, axis=0)), max(self.cells)

    def evaluate(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """Return the points of the spline at parameters.

        Parameters
        ----------
        u, v : array_like
            Parameters that broadcast together. Periodic ones are taken modulo the period.

        Returns
        -------
        (..., 3) float64 array
            The points.

        Raises
        ------
        InputError
            If a parameter that is not periodic lies outside the domain, or any is NaN or infinite.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.fit("torus", (64, 64)).evaluate([0.0, 0.5], 0.0).shape
        (2, 3)

        """
        return self._evaluate(u, v)[0]

    def normals(self, u: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """Return the unit normals of the spline at parameters, along p_u × p_v.

        Parameters
        ----------
        u, v : array_like
            As in `evaluate`.

        Returns
        -------
        (..., 3) float64 array
            The normals; NaN at poles, and at singular points where p_u × p_v vanishes exactly.

        Raises
        ------
        InputError
            As `evaluate`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.fit("torus", (64, 64)).normals(0.0, 0.0).round(6) + 0.0
        array([1., 0., 0.])

        """
        vectors = self._evaluate(u, v)[1]
        with np.errstate(invalid="ignore"):
            vectors /= np.abs(vectors).max(axis=-1, keepdims=True)
            return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)

    @cached_property
    def measure(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Areas and solid angles of the patches, by quadrature: two (patches,) float64 arrays.

        If there is a trim, they are multiplied by the share of each patch inside it. Areas are in
        units of the squared diagonal of the bounding box of the coefficients. Solid angles are the
        signed areas of the Gaussian images.
        """
        areas, solid_angles = np.empty(self.patches), np.empty(self.patches)

        def work(first: int, last: int) -> None:
            kernels.measure_patches(
                self.coefficients, self.scale, first, last,
                areas[first:last], solid_angles[first:last],
            )  # fmt: skip

        list(over_ranges(work, self.patches, PATCHES_AT_A_TIME, None))
        inner = self.coefficients[1:-1, 1:-1].reshape(-1, 3) * self.scale
        diagonal = float(np.linalg.norm(np.ptp(inner, axis=0)))
        if self.inside is not None:
            areas, solid_angles = areas * self.inside.shares, solid_angles * self.inside.shares
        return areas / diagonal**2 if diagonal > 0.0 else areas, solid_angles

    @cached_property
    def _cell_measure(self) -> CellMeasure:
        """Areas, solid angles and curvatures of the cells, see `CellMeasure`."""
        return CellMeasure.of(self.measure, self.cells)

    @cached_property
    def inside(self) -> Inside | None:
        """The share of each patch that is inside the trim; None without a trim."""
        return self.trim and Inside.of(self.trim, self.frame, self.cells, self.name)

    def _evaluate(
        self, u: ArrayLike, v: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        u_array, v_array = parameter_arrays(u, v)
        places = np.stack([u_array.ravel(), v_array.ravel()], axis=1)
        cells = self.in_cells(places)
        points, normals = self._evaluated(cells)
        return points.reshape(*u_array.shape, 3), normals.reshape(*u_array.shape, 3)

    def normals_in_cells(self, cells: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return normals of the spline at parameters in cells.

        Parameters
        ----------
        cells : (k, 2) float64 array
            Parameters inside the domain, in cells from its corner; see `in_cells`.

        Returns
        -------
        (k, 3) float64 array
            The normals p_u × p_v, up to a common positive factor; 0 at poles.

        Raises
        ------
        InputError
            For anything but an array of this shape and type.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> gm.fit("plane", (4, 4)).normals_in_cells(np.array([[0.5, 2.0]]))[0, 2] > 0
        np.True_

        """
        return self._evaluated(checked_array("cells", cells, ("k", 2), np.float64))[1]

    def _evaluated(
        self, cells: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        points, normals = np.empty((len(cells), 3)), np.empty((len(cells), 3))
        kernels.evaluate(self.coefficients, self.scale, cells, points, normals)
        for axis, (count, ends) in enumerate(zip(self.cells, self.boundary, strict=True)):
            for end, place in zip(ends, (0, count), strict=True):
                if end == "pole":  # zero up to rounding
                    normals[np.abs(cells[:, axis] - place) <= SAME_PARAMETER * count] = 0.0
        return points, normals

    def in_cells(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return parameters in units of cells, from the lower corner of the domain.

        Parameters
        ----------
        places : (k, 2) float64 array
            Parameters u, v. Periodic ones are taken modulo the period.

        Returns
        -------
        (k, 2) float64 array
            Parameters in cells: 2.5 is the middle of the third cell.

        Raises
        ------
        InputError
            As `evaluate`.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> gm.fit("torus", (16, 16)).in_cells(np.array([[np.pi, 0.0]]))
        array([[8., 0.]])

        """
        places = checked_array("places", places, ("k", 2), np.float64)
        with np.errstate(invalid="ignore"):
            u, v = brought_inside(places[:, 0], places[:, 1], self.domain, self.boundary)
        cells = (np.stack([u, v], axis=1) - self.frame[:2]) / self.frame[2:]
        slack = 1e-9 * np.array(self.cells)
        outside = ~((cells >= -slack) & (cells <= self.cells + slack))
        if outside.any():
            k, axis = np.argwhere(outside)[0]
            raise InputError(
                f"{'uv'[axis]} = {places[k, axis]} lies outside the domain {self.domain[axis]} "
                f"of {self.name!r}."
            )
        return cells
