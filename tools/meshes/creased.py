"""A mesh whose normals may jump: vertices are shared, and normals belong to corners."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.checks import checked_array
from ...runtime.directions.unit import unit_or_zero
from .mesh import Mesh

# Normals at a point count as equal if they agree to this number of decimals.
DIGITS = 9
# These fields have defaults only because the last fields of `Mesh` have defaults.
_GIVEN: Any = None


@dataclass(frozen=True, eq=False, repr=False)
class CreasedMesh(Mesh):
    """A mesh of faces that meet at creases: faces of a part, or patches of a spline of nets.

    It has all attributes and methods of a `Mesh`. `normals` are the unit means of the normals at
    the corners of triangles, `uv` the parameters on one of the faces around a vertex, and
    `sample_index` is −1: no vertex is a sample.

    Attributes
    ----------
    corner_normals : (T, 3, 3) float64 array
        The unit normals at the corners of triangles, on the face of the triangle. Where the face
        has no normal, as at the apex of a cone, it is replaced by the normal inside the triangle
        or patch, or by 0 if that is undefined, too.
    face_index : (T,) int64 array
        The index of each triangle's face in `part.faces`, or of its patch.

    Examples
    --------
    >>> import gaussmap as gm
    >>> points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, 0, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)]
    >>> below = [(-1, 0, 0), (1, 0, 0), (0, 0, -1), (0, 0, 0), (-0.5, 0, -0.5), (0.5, 0, -0.5)]
    >>> mesh = gm.Spline.from_nets([points, below], name="bent").mesh()
    >>> mesh, mesh.split
    (CreasedMesh(4 vertices, 2 triangles on bent), Mesh(6 vertices, 2 triangles on bent))
    >>> mesh.corner_normals.shape, mesh.face_index, mesh.closed
    ((2, 3, 3), array([0, 1]), False)

    """

    corner_normals: NDArray[np.float64] = _GIVEN
    face_index: NDArray[np.int64] = _GIVEN

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
        return self._named("CreasedMesh")

    @cached_property
    def split(self) -> Mesh:
        """A mesh of the same triangles, with a separate vertex for each normal at a point."""
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
            unit=self.unit,
        )


def mean_normals(
    triangles: NDArray[np.int64], corner_normals: NDArray[np.float64], count: int
) -> NDArray[np.float64]:
    """Return the unit mean (count, 3) of the corner normals (T, 3, 3) at each vertex.

    The mean is 0 where the normals cancel.
    """
    total = np.zeros((count, 3))
    np.add.at(total, triangles, corner_normals)
    return unit_or_zero(total)
