"""A mesh of a part: its vertices are shared by all faces around, its normals belong to corners."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.checks import checked_array
from ...runtime.base.wording import plural
from ..meshes.links import edge_numbers
from ..meshes.mesh import Mesh

__all__ = ["PartMesh"]

# Decimal places to which normals at a point differ.
DIGITS = 9
# Fields that have defaults only because those of `Mesh` do.
_GIVEN: Any = None


@dataclass(frozen=True, eq=False, repr=False)
class PartMesh(Mesh):
    """A mesh of a CAD part; made by `Samples.mesh` from samples of a part.

    It has all that a `Mesh` has. `normals` are the means of those of the faces around a vertex,
    `uv` the parameters on one of these faces, and `sample_index` is −1: all vertices are new.

    Attributes
    ----------
    corner_normals : (T, 3, 3) float64 array
        The unit normals at the corners of triangles, those of the face on which they are. Where a
        face has none, as at the tip of a cone, those inside the triangle, and 0 if there are
        none there, either.
    face_index : (T,) int64 array
        The place in `part.faces` of the face of each triangle.
    lines : tuple of int64 arrays
        The vertices along each edge of the part, in its direction; none for one that is not there.
    failed : dict of int to str
        The faces that are missing, and why.

    Examples
    --------
    >>> import gaussmap as gm
    >>> from gaussmap.tools.cad.examples import box
    >>> mesh = gm.sample(box(), 200).mesh()
    >>> mesh
    PartMesh(200 vertices, 396 triangles on box)
    >>> mesh.closed, mesh.euler_characteristic, round(mesh.volume, 12), mesh.failed
    (True, 2, 6.0, {})
    >>> mesh.corner_normals.shape, mesh.face_index.shape, len(mesh.lines)
    ((396, 3, 3), (396,), 12)

    """

    corner_normals: NDArray[np.float64] = _GIVEN
    face_index: NDArray[np.int64] = _GIVEN
    lines: tuple[NDArray[np.int64], ...] = ()
    failed: Mapping[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.triangles)
        for name, shape, dtype in (
            ("corner_normals", (count, 3, 3), np.float64),
            ("face_index", (count,), np.int64),
        ):
            array = checked_array(name, getattr(self, name), shape, np.dtype(dtype))
            object.__setattr__(self, name, array)

    def __repr__(self) -> str:
        return f"Part{super().__repr__()}"

    @cached_property
    def closed(self) -> bool:
        """Whether each edge is in two triangles, which pass it in opposite directions.

        Never if a face is missing.
        """
        count = max(len(self.vertices), 1)
        one, other = self.triangles.ravel(), np.roll(self.triangles, -1, axis=1).ravel()
        ways = np.sort(one * count + other)
        back = np.sort(other * count + one)
        twice = (ways[1:] == ways[:-1]).any()
        return bool(not self.failed and len(ways) and not twice and (ways == back).all())

    @property
    def volume(self) -> float:
        """The volume that the triangles enclose, in L³; NaN unless the mesh is `closed`."""
        if not self.closed:
            return float("nan")
        corners = self.vertices[self.triangles] - self.vertices.mean(axis=0)
        return float(np.linalg.det(corners).sum() / 6.0)

    @cached_property
    def split(self) -> Mesh:
        """The same triangles, with a vertex for each normal that there is at a point."""
        normals = self.corner_normals.reshape(-1, 3).round(DIGITS)
        rows = np.column_stack([self.triangles.ravel(), normals])
        _, first, places = np.unique(rows, axis=0, return_index=True, return_inverse=True)
        at = self.triangles.ravel()[first]
        return Mesh(
            self.vertices[at],
            self.corner_normals.reshape(-1, 3)[first],
            self.uv[at],
            places.reshape(-1, 3).astype(np.int64),
            self.sample_index[at],
            name=self.name,
        )

    def summary(self) -> str:
        """Return one line: vertices, triangles, their quality, and what is missing.

        Examples
        --------
        >>> import gaussmap as gm
        >>> from gaussmap.tools.cad.examples import box
        >>> gm.sample(box(), 200).mesh().summary()
        '200 vertices, 396 triangles, closed; 95 % have angles of at least ...'

        """
        line = f"{len(self.vertices):,} vertices, {len(self.triangles):,} triangles"
        if not len(self.triangles):
            return line
        times = np.unique(edge_numbers(self.triangles, len(self.vertices)), return_counts=True)[1]
        single, many = int((times == 1).sum()), int((times > 2).sum())
        line += ", closed" if self.closed else f", {single:,} edges on borders"
        line += f", {many:,} of more than two triangles" if many else ""
        line += f", {plural(len(self.failed), 'face')} missing" if self.failed else ""
        small, mean, worst = (
            np.quantile(self.smallest_angles, 0.05), self.angles.mean(), self.angles.max(),
        )  # fmt: skip
        line += f"; 95 % have angles of at least {small:.1f}°"
        return f"{line}; they deviate from the normals by {mean:.2f}° (mean), {worst:.2f}° (worst)"
