"""The mesh of a part as an obstacle: rays are tested for intersections with it."""

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.kept import kept
from ...runtime.onto_surface.reach import without_reach
from ...runtime.surface.surface import Surface
from ..meshes.rays import Obstacle
from .mesh_edges import MeshEdges
from .mesh_spacing import Spacing
from .part import Part
from .part_meshing import mesh_of_part
from .results import space_of
from .selection import whole_part

# The number of vertices of the mesh; twice the number that edges need, if that is larger.
VERTICES = 20_000


def obstacle_of(given: Part | Surface) -> Obstacle:
    """Return the mesh of a part or surface, cached with it; raises and warns as meshes do.

    If a part was selected from another part in this session, the mesh is that of the whole part;
    for a surface that is trimmed to a reach, it is that of the whole surface. Triangles have the
    orientation of the normals, even if the normals point into a closed surface.
    """
    if isinstance(given, Surface):
        return kept(given, obstacle_of, lambda: _of_surface(without_reach(given)))
    whole = whole_part(given)
    return kept(whole, obstacle_of, lambda: Obstacle.of(*_mesh_of(whole)))


def _of_surface(surface: Surface) -> Obstacle:
    part = Part([surface], name=surface.name)
    vertices, triangles = _mesh_of(part)
    return Obstacle.of(vertices, triangles[:, ::-1] if part.faces[0].reversed else triangles)


def _mesh_of(part: Part) -> tuple[Array, Indices]:
    least = 0
    if any(x.wires for x in part.faces):
        least = MeshEdges.of(Spacing(space_of(part, None), VERTICES)).least
    mesh = mesh_of_part(part, max(VERTICES, 2 * least))
    return mesh.vertices, mesh.triangles
