"""A triangle mesh through samples."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.checks import checked_array, text, whole_number
from ...runtime.base.errors import InputError
from ...runtime.base.scales import scale_to_one
from ...runtime.domain.domain import Boundary, Domain, checked_domain, checked_sides
from ...runtime.spline.spline import short_label
from .kernels.flips import smallest_cosines, smallest_tangents
from .links import edges_of, is_closed
from .mesh_methods import Methods
from .texture import corner_places

# The default of `sides`: 1 everywhere.
_ALL_ALIKE: Any = None


@dataclass(frozen=True, eq=False, repr=False)
class Mesh(Methods):
    """A triangle mesh of a surface, with M vertices and T triangles; made by `Samples.mesh`.

    All arrays are C-contiguous; one that is not is copied.

    Attributes
    ----------
    vertices : (M, 3) float64 array
        Points of the surface.
    normals : (M, 3) float64 array
        The unit normals of the surface at the vertices. Where the surface has no normal, as at an
        apex, the mean of the normals at the adjacent vertices.
    uv : (M, 2) float64 array
        The parameters. They jump where a triangle crosses a seam.
    triangles : (T, 3) int64 array
        Rows of `vertices`, counterclockwise as seen from the tip of the normals; on a one-sided
        surface, of the normal at the first corner.
    sample_index : (M,) int64 array
        The index of the sample at a vertex; −1 for points added on boundaries, at poles and at
        apexes.
    name : str
        Label of the surface.
    sides : (T, 3) int64 array
        For each corner 1, or −1 if its normal and the normal at the first corner are on opposite
        sides of the triangle: on a one-sided surface normals change sides somewhere. By default 1.
    left_out : int
        The number of samples that are not vertices: samples too close to others, samples removed
        with small triangles, samples of components that are not regular and, with an `angle`,
        samples in no remaining triangle.
    domain : ((u0, u1), (v0, v1)) of float or None
        The rectangle of the parameters, if known.
    boundary : pair of pairs of str or None
        The boundary conditions of the domain, see `Surface`; "pole" for each collapsed side.
    unit : str
        The unit of length, such as "mm"; empty if unknown.

    Raises
    ------
    InputError
        If an array has another shape or dtype, or a triangle has a vertex that does not exist.

    Examples
    --------
    >>> import gaussmap as gm
    >>> mesh = gm.sample("torus", 200, cells=(16, 16)).mesh()
    >>> mesh
    Mesh(200 vertices, 400 triangles on torus)
    >>> mesh.vertices.shape, mesh.normals.shape, mesh.uv.shape, mesh.triangles.shape
    ((200, 3), (200, 3), (200, 2), (400, 3))
    >>> bool((mesh.sample_index >= 0).all()), bool((mesh.sides == 1).all()), mesh.name
    (True, True, 'torus')
    >>> mesh.faces is mesh.triangles, mesh.split is mesh
    (True, True)
    >>> len(mesh.edges), len(mesh.boundary_edges), mesh.euler_characteristic
    (600, 0, 0)
    >>> mesh.left_out, mesh.unit, mesh.domain == gm.surfaces.torus().domain, mesh.boundary[0]
    (0, '', True, ('periodic', 'periodic'))
    >>> bool(mesh.angles.mean() < 30), bool(mesh.smallest_angles.min() > 5)
    (True, True)

    """

    vertices: NDArray[np.float64]
    normals: NDArray[np.float64]
    uv: NDArray[np.float64]
    triangles: NDArray[np.int64]
    sample_index: NDArray[np.int64]
    name: str = "surface"
    sides: NDArray[np.int64] = _ALL_ALIKE
    left_out: int = 0
    domain: Domain | None = None
    boundary: Boundary | None = None
    unit: str = ""

    def __post_init__(self) -> None:
        text(self.name, "name")
        text(self.unit, "unit")
        floating, whole = np.dtype(np.float64), np.dtype(np.int64)
        count = len(checked_array("vertices", self.vertices, ("M", 3), floating))
        faces = len(checked_array("triangles", self.triangles, ("T", 3), whole))
        if self.sides is None:
            object.__setattr__(self, "sides", np.ones((faces, 3), dtype=np.int64))
        wanted: dict[str, tuple[np.dtype[Any], tuple[int, ...]]] = {
            "vertices": (floating, (count, 3)),
            "normals": (floating, (count, 3)),
            "uv": (floating, (count, 2)),
            "triangles": (whole, (faces, 3)),
            "sample_index": (whole, (count,)),
            "sides": (whole, (faces, 3)),
        }
        for name, (dtype, shape) in wanted.items():
            array = checked_array(name, getattr(self, name), shape, dtype)
            object.__setattr__(self, name, array)
        if faces and not 0 <= self.triangles.min() <= self.triangles.max() < count:
            raise InputError(f"triangles have vertices that are not there: there are {count}.")
        object.__setattr__(self, "left_out", whole_number(self.left_out, "left_out", 0))
        if self.domain is not None:
            object.__setattr__(self, "domain", checked_domain(self.domain))
        if self.boundary is not None:
            object.__setattr__(self, "boundary", checked_sides(self.boundary))

    def __repr__(self) -> str:
        return self._named("Mesh")

    def _named(self, kind: str) -> str:
        return (
            f"{kind}({len(self.vertices):,} vertices, {len(self.triangles):,} triangles on "
            f"{short_label(self.name)})"
        )

    @property
    def faces(self) -> NDArray[np.int64]:
        """(T, 3) int64 array: `triangles`, by the name that trimesh gives them."""
        return self.triangles

    @cached_property
    def split(self) -> Mesh:
        """A mesh of the same triangles, with a separate vertex for each normal at a point.

        It differs from this mesh only where normals jump, see `CreasedMesh`.
        """
        return self

    @cached_property
    def _edges(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The edges (E, 2), and the number of triangles of each."""
        return edges_of(self.triangles, max(len(self.vertices), 1))

    @property
    def edges(self) -> NDArray[np.int64]:
        """(E, 2) int64 array: the edges, each once, as pairs of vertices."""
        return self._edges[0]

    @property
    def boundary_edges(self) -> NDArray[np.int64]:
        """(B, 2) int64 array: the edges in a single triangle; empty if the mesh is closed."""
        edges, times = self._edges
        return edges[times == 1]

    @cached_property
    def closed(self) -> bool:
        """Whether each edge is in two triangles, which traverse it in opposite directions.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> mesh = gm.sample("torus", 200, cells=(16, 16)).mesh()
        >>> mesh.closed, bool(0.9 < mesh.volume / (2 * np.pi**2 * 0.35**2) < 1)
        (True, True)

        """
        return is_closed(self.triangles, max(len(self.vertices), 1))

    @property
    def volume(self) -> float:
        """The volume that the triangles enclose, in L³; NaN unless the mesh is `closed`.

        It is negative if the normals point inwards.
        """
        if not self.closed:
            return float("nan")
        corners = self.vertices[self.triangles] - self.vertices.mean(axis=0)
        return float(np.linalg.det(corners).sum() / 6.0)

    @property
    def euler_characteristic(self) -> int:
        """M − E + T: 2 for a sphere, 1 for a disk, 0 for a torus, a band or a Klein bottle."""
        return len(self.vertices) - len(self.edges) + len(self.triangles)

    @cached_property
    def corner_uv(self) -> NDArray[np.float64]:
        """(T, 3, 2) float64 array: texture coordinates at the corners of each triangle.

        They are the parameters, with the domain scaled to 1 × 1, and do not jump: across a seam
        they continue beyond 1, for textures that repeat. A pole has separate coordinates in each
        triangle. `.obj` files have them.

        Examples
        --------
        >>> import gaussmap as gm
        >>> mesh = gm.sample("torus", 200, cells=(16, 16)).mesh()
        >>> mesh.corner_uv.shape, bool(mesh.corner_uv.max() > 1)  # across a seam
        ((400, 3, 2), True)

        """
        return corner_places(self.uv, self.triangles, self.domain, self.boundary)

    @cached_property
    def angles(self) -> NDArray[np.float64]:
        """(T,) float64 array: the largest angle between a triangle and the normals at its corners.

        In degrees; 180 for a triangle without area.
        """
        split = self.split
        cosines = cosines_of(split.vertices, split.normals, split.triangles, split.sides)
        return np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))

    @cached_property
    def smallest_angles(self) -> NDArray[np.float64]:
        """(T,) float64 array: the smallest angle of each triangle, in degrees; at most 60."""
        return np.degrees(np.arctan(tangents_of(self.vertices, self.triangles)))

    def summary(self) -> str:
        """Return one line: vertices, samples left out, triangles, and their quality.

        Returns
        -------
        str
            The line, without a line break.

        Examples
        --------
        >>> import gaussmap as gm
        >>> gm.sample("torus", 200, cells=(16, 16)).mesh().summary()
        '200 vertices, 400 triangles, closed; 95 % have angles of at least 3...°; they deviate ...'

        """
        added = int(np.count_nonzero(self.sample_index < 0))
        line = f"{len(self.vertices):,} vertices"
        line += f" ({added:,} of them added)" if 0 < added < len(self.vertices) else ""
        line += f", {self.left_out:,} of the samples left out" if self.left_out else ""
        line += f", {len(self.triangles):,} triangles"
        if not len(self.triangles):
            return line
        border = len(self.boundary_edges)
        line += f", {border:,} edges on the border" if border else ", closed"
        return line + self._quality()

    def _quality(self) -> str:
        """Return the end of a summary: angles in triangles, angles from triangles to normals."""
        return (
            f"; 95 % have angles of at least {np.quantile(self.smallest_angles, 0.05):.1f}°; they "
            f"deviate from the normals by {self.angles.mean():.2f}° (mean), "
            f"{self.angles.max():.2f}° (worst)"
        )


def cosines_of(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    triangles: NDArray[np.int64],
    sides: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Return the smallest cosine (T,) between a triangle's normal and its corners' normals."""
    cosines = np.empty(len(triangles))
    if len(triangles):
        smallest_cosines(scaled(points), normals, triangles, sides, cosines)
    return cosines


def tangents_of(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the tangent of the smallest angle (T,) of each triangle."""
    tangents = np.empty(len(triangles))
    if len(triangles):
        smallest_tangents(scaled(points), triangles, tangents)
    return tangents


def scaled(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points (k, 3) centred and scaled to about 1, so that products do not overflow."""
    around, scale = centred(points)
    return around * scale


def centred(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Return points (k, 3) centred, and a power of two that scales them to about 1."""
    low, high = points.min(axis=0), points.max(axis=0)
    around = points - (low / 2.0 + high / 2.0)
    return around, scale_to_one(float(np.abs(around).max()))
