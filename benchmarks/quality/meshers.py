"""The meshes that are judged: of gaussmap, through samples of two densities, and of other tools."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import gaussmap as gm

from ..peers.forms import ClosedForm
from ..peers.peer import Peer
from ..peers.triangles import Triangles, by_grid, gmsh_triangles, opencascade_triangles
from .ways import GMSH, OPENCASCADE, PERFECT

Prefer = Literal["shape", "normals"]


@dataclass(frozen=True)
class Mesher:
    """A way to get meshes of about a number of vertices; `needs` is a peer of the same package."""

    title: str
    needs: Peer
    mesh: Callable[[ClosedForm, int], Triangles]

    @property
    def missing(self) -> str:
        """The reason why the mesher cannot be used here; empty if it can."""
        return self.needs.missing


def through(density: str, prefer: Prefer) -> Callable[[ClosedForm, int], Triangles]:
    """Return a function: a mesh of about `count` vertices, samples and added boundary points."""

    def mesh(form: ClosedForm, count: int) -> Triangles:
        first = gm.sample(form.surface, count=count, density=density)
        added = len(first.mesh(prefer=prefer).vertices) - len(first)
        found = gm.sample(form.surface, count=count - added, density=density).mesh(prefer=prefer)
        return found.vertices, found.triangles

    return mesh


def own(density: str, prefer: Prefer) -> Mesher:
    """Return a mesher of gaussmap."""
    call = f"**{density}**" + (', prefer="normals"' if prefer == "normals" else "")
    return Mesher(call, PERFECT, through(density, prefer))


MESHERS = (
    own("balanced", "shape"),
    own("balanced", "normals"),
    own("aligned", "normals"),
    Mesher("grid of parameters", PERFECT, by_grid),
    Mesher(GMSH.title, GMSH, gmsh_triangles),
    Mesher(OPENCASCADE.title, OPENCASCADE, opencascade_triangles),
)
