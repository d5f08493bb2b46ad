"""The mesh of a part as an obstacle: rays are tested for intersections with it."""

from ...runtime.base.kept import kept
from .mesh_edges import MeshEdges
from .mesh_spacing import Spacing
from .part import Part
from .part_mesh import PartMesh
from .part_meshing import mesh_of_part
from .results import space_of
from .selection import whole_part

# The number of vertices of the mesh; twice the number that edges need, if that is larger.
VERTICES = 20_000


def obstacle_of(part: Part) -> PartMesh:
    """Return the mesh of a part, cached with the part; raises InputError and warns as meshes do.

    If the part was selected from another part in this session, the mesh is that of the whole part.
    """
    whole = whole_part(part)
    return kept(whole, obstacle_of, lambda: _made(whole))


def _made(part: Part) -> PartMesh:
    least = 0
    if any(x.wires for x in part.faces):
        least = MeshEdges.of(Spacing(space_of(part, None), VERTICES)).least
    return mesh_of_part(part, max(VERTICES, 2 * least))
