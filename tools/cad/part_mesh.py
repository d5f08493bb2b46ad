"""A mesh of a part: adjacent faces share its vertices, and normals belong to corners."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.wording import plural
from ..meshes.creased import CreasedMesh
from ..meshes.links import edge_numbers


@dataclass(frozen=True, eq=False, repr=False)
class PartMesh(CreasedMesh):
    """A mesh of a CAD part; made by `Samples.mesh` from samples of a part.

    It has all attributes and methods of a `CreasedMesh`.

    Attributes
    ----------
    lines : tuple of int64 arrays
        For each edge of the part, the indices of the vertices along it, in its direction; empty if
        the edge is not meshed.
    failed : dict of int to str
        The reasons why faces are missing, by face index.

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

    lines: tuple[NDArray[np.int64], ...] = ()
    failed: Mapping[int, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return self._named("PartMesh")

    @cached_property
    def closed(self) -> bool:
        """As `Mesh.closed`; False if a face is missing."""
        return not self.failed and super().closed

    def summary(self) -> str:
        """Return one line: vertices, triangles, their quality, and missing faces.

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
        return line + self._quality()
