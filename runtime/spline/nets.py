"""A spline of quadratic patches that are given by their control nets, on any triangulation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import patch as formulas
from ...generated.vectors import Patch
from ..base.aliases import Array
from ..base.checks import finite_array, finite_number, text
from ..base.errors import InputError, SurfaceError
from ..base.formula_calls import python_function, vector
from ..domain.inside import subcentroids
from .developable import CellMeasure
from .joints import Joints, Topology, merged_points
from .patch_spline import PatchSpline
from .spline import Spline, short_label
from .spline_methods import NetMethods

# Areas and solid angles are sums over the centroids of PARTS² triangles of a patch.
PARTS = 4


@dataclass(frozen=True, eq=False, repr=False)
class NetSpline(PatchSpline, NetMethods):
    """A spline of T quadratic Bézier triangles on any triangulation; made by `Spline.from_nets`.

    The parameters `uv` of a sample refer to its patch: u, v ≥ 0 and u + v ≤ 1. Functions that need
    a grid of cells raise InputError.

    Attributes
    ----------
    control_nets : (T, 6, 3) float64 array
        The nets, each in the order b200, b020, b002, b110, b101, b011.
    triangles : (T, 6) int64 array
        The indices of the points of the nets; points that patches share have one index.

    Examples
    --------
    >>> import gaussmap as gm
    >>> torus = gm.Spline.from_nets(gm.fit("torus", (16, 16)).control_nets, name="torus")
    >>> torus, torus.control_nets.shape, torus.triangles.shape
    (NetSpline(1,024 patches of torus), (1024, 6, 3), (1024, 6))
    >>> len(gm.sample(torus, normals=[[1, 0, 0], [0, 0.6, 0.8]]))
    4
    >>> torus.mesh()
    CreasedMesh(512 vertices, 1,024 triangles on torus)

    """

    control_nets: NDArray[np.float64]
    triangles: NDArray[np.int64]
    name: str
    smooth: float

    def __post_init__(self) -> None:
        text(self.name, "name")

    @classmethod
    def checked(
        cls, points: ArrayLike, triangles: ArrayLike | None, name: str, smooth: float
    ) -> NetSpline:
        """Make a spline from the arguments of `Spline.from_nets`, after checking them."""
        limit = finite_number(smooth, "smooth")
        if not 0.0 <= limit < 90.0:
            raise InputError(f"smooth must be an angle from 0 to 90 degrees, not {limit:g}.")
        if triangles is None:
            nets = finite_array(points, ("T", 6, 3), "nets")
            _, numbers = merged_points(nets.reshape(-1, 3)) if len(nets) else (0, np.empty(0, int))
            indices = numbers.reshape(-1, 6)
        else:
            known, indices = finite_array(points, ("N", 3), "points"), np.asarray(triangles)
            if indices.ndim != 2 or indices.shape[1] != 6 or indices.dtype.kind not in "iu":
                raise InputError("triangles must be whole numbers of the shape (T, 6).")
            if len(indices) and not 0 <= indices.min() <= indices.max() < len(known):
                raise InputError(
                    f"triangles have points that are not there: there are {len(known)}."
                )
            nets = known[indices]
        if len(nets) == 0:
            raise InputError("a spline needs at least one net.")
        spline = cls(np.ascontiguousarray(nets), indices.astype(np.int64), name, limit)
        if not np.abs(spline.vectors).any():
            raise SurfaceError(f"all control points of {name!r} are the same.")
        spline.joints  # noqa: B018 - refuses nets that do not fit together
        return spline

    def __repr__(self) -> str:
        kind = "patch" if self.patches == 1 else "patches"
        return f"NetSpline({self.patches:,} {kind} of {short_label(self.name)})"

    @property
    def patches(self) -> int:
        """The number of patches."""
        return len(self.control_nets)

    @property
    def _points(self) -> NDArray[np.float64]:
        return self.control_nets

    def _largest_step(self) -> float:
        return float(np.abs(self.control_nets - self.control_nets[:, 2:3]).max())

    @cached_property
    def vectors(self) -> Array:
        """The vectors a, b, c, d, e (T, 5, 3) of all patches (paper, eq. (8)), times `scale`."""
        return vectors_of_nets((self.control_nets - self.control_nets[:, 2:3]) * self.scale)

    @cached_property
    def topology(self) -> Topology:
        """The topology of the patches: their edges, joints and corners."""
        normals = python_function(formulas.control_normals)(self._patch())
        control = np.stack([np.stack(x, axis=-1) for x in normals], axis=1)
        sizes = np.square(self.vectors).sum(axis=-1).max(axis=1)[:, None, None]
        return Topology(
            self.control_nets,
            self.triangles,
            control / np.where(sizes > 0.0, sizes, 1.0),
            self.smooth,
        )

    @property
    def joints(self) -> Joints:
        """The joints of the patches, with the angles between their normals."""
        return self.topology.joints

    @property
    def extent(self) -> tuple[float, int]:
        """The diagonal of the bounding box, and the square root of the number of patches."""
        points = self.control_nets.reshape(-1, 3)
        return math.hypot(*np.ptp(points, axis=0)), math.isqrt(self.patches)

    def _patch(self, rows: NDArray[np.int64] | slice = slice(None)) -> Patch:
        """Return the vectors of the patches `rows` times `scale`, for formulas; p₀ is 0."""
        a, b, c, d, e = np.moveaxis(self.vectors[rows], 1, 0)
        zero = np.zeros_like(a)
        return Patch(vector(a), vector(b), vector(c), vector(d), vector(e), vector(zero))

    def _cross_products(self, patches: NDArray[np.int64], places: Array) -> Array:
        patch = self._patch(patches)
        return np.stack(python_function(formulas.tangents)(patch, *places.T)[2], axis=1)

    def _origins(self, rows: NDArray[np.int64]) -> Array:
        return self.control_nets[rows, 2]

    @property
    def cap(self) -> tuple[Array, float]:
        """A unit vector, the axis, and the least cosine of angles between axis and normals.

        The cosine is −1 unless all normals are within 90° of the axis.
        """
        control = self.topology.normals.reshape(-1, 3)
        lengths = np.linalg.norm(control, axis=1)
        unit = control[lengths > 0.0] / lengths[lengths > 0.0, None]
        mean = unit.sum(axis=0)
        size = float(np.linalg.norm(mean))
        axis = mean / size if size > 0.0 else np.array([0.0, 0.0, 1.0])
        least = float((unit @ axis).min(initial=1.0))
        return axis, least if size > 0.0 and least > 0.0 else -1.0

    @cached_property
    def measure(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Areas and signed solid angles of the patches, by quadrature: two (T,) float64 arrays.

        Areas are in units of the squared diagonal of the bounding box.
        """
        u, v = subcentroids(PARTS).T
        areas, angles = np.zeros(self.patches), np.zeros(self.patches)
        with np.errstate(divide="ignore", invalid="ignore"):
            for x, y in zip(u, v, strict=True):
                N = np.stack(python_function(formulas.tangents)(self._patch(), x, y)[2], axis=1)
                area = np.linalg.norm(N, axis=1)
                normals = vector(N / area[:, None])
                K = python_function(formulas.curvature_at)(self._patch(), normals, x, y)[0]
                areas += 0.5 / len(u) * area
                angles += 0.5 / len(u) * np.nan_to_num(K * area)
        diagonal = self.extent[0] * self.scale
        return areas / diagonal**2, angles

    @cached_property
    def _cell_measure(self) -> CellMeasure:
        areas, angles = self.measure
        with np.errstate(divide="ignore", invalid="ignore"):
            curvatures = np.where(areas > 0.0, np.abs(angles) / areas, 0.0)
        return CellMeasure(areas, np.abs(angles), curvatures)


AnySpline = Spline | NetSpline


def on_grid(spline: AnySpline) -> Spline:
    """Return a spline on a grid of cells unchanged; InputError for a spline of nets."""
    if isinstance(spline, NetSpline):
        raise InputError(
            f"{spline.name!r} is made of nets and has no grid of cells nor parameters u, v of a "
            "whole surface, which this needs; fit a Surface instead."
        )
    return spline


def vectors_of_nets(nets: Array) -> Array:
    """Return the vectors a, b, c, d, e (T, 5, 3) of nets (T, 6, 3)."""
    found = python_function(formulas.power_form)(*map(vector, np.moveaxis(nets, 1, 0)))
    return np.stack([np.stack(x, axis=-1) for x in found[:5]], axis=1)


@staticmethod
def from_nets(
    nets: ArrayLike, triangles: ArrayLike | None = None, *, name: str = "nets", smooth: float = 0.01
) -> NetSpline:
    """Return a spline of quadratic Bézier triangles on any triangulation.

    Joints are edges with the same ends and the same middle control point, up to rounding, or with
    the same indices. If the normals of both patches agree along a joint, each normal there belongs
    to one of the two patches, and every point with a given normal is found exactly once. Otherwise
    the joint is a crease, and part of the boundary of both patches.

    Parameters
    ----------
    nets : (T, 6, 3) or (N, 3) array_like
        The nets, each in the order b200, b020, b002, b110, b101, b011, as in
        `SupportFunction.of_patch`; with `triangles`, the points.
    triangles : (T, 6) array_like of int, optional
        The points of each net, in the same order. Patches that are joined share them.
    name : str, default "nets"
        Label of the surface.
    smooth : float, default 0.01
        A joint is smooth if the normals of its patches differ by at most this angle, in degrees;
        see `NetSpline.joints`.

    Returns
    -------
    NetSpline
        The spline. Functions that take a `Spline` take it, too, unless they need a grid of cells.

    Raises
    ------
    InputError
        For arrays of other shapes, NaN, infinity, or indices without a point; if `smooth` is not in
        [0, 90); if a corner of a patch is inside an edge of another one, if more than two patches
        share an edge, or if two have opposite orientations.
    SurfaceError
        If all points are the same.

    Examples
    --------
    >>> import gaussmap as gm
    >>> points = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1)]
    >>> octant = gm.Spline.from_nets([points], name="octant")
    >>> octant
    NetSpline(1 patch of octant)
    >>> gm.sample(octant, normals=[[1, 1, 1]]).points.round(3)
    array([[0.556, 0.556, 0.556]])

    """
    return NetSpline.checked(nets, triangles, name, smooth)
