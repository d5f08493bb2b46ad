"""Meshes of parts that Open CASCADE made: closed, outward, and as large as it says."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false

import gaussmap as gm
import numpy as np
import pytest

pytest.importorskip("OCP")

from OCP.BOPAlgo import BOPAlgo_Builder
from OCP.BRep import BRep_Tool

from ....refusals import refused
from .shapes import SOLIDS, as_nurbs, box, compound, face, faces_of, loose_faces, torus, volume_of

# The smallest angles in degrees where they are small: at the tip of a cone nothing is flipped.
THIN = {"cone": 0.2}


# Triangles around the tip of the other cone are up to 107° off the normals.
@pytest.mark.parametrize("count", [700, 4000])
@pytest.mark.parametrize("name", [x for x in SOLIDS if x != "cone and cylinder"])
def test_solids_are_closed(name, count, part_with):
    make, characteristic, _ = SOLIDS[name]
    mesh = gm.sample(part_with(make()), count).mesh()
    assert len(mesh.vertices) == count
    assert (mesh.closed, mesh.euler_characteristic) == (True, characteristic)
    assert mesh.volume == pytest.approx(volume_of(make()), rel=25.0 / count)
    assert mesh.angles.max() < 60.0  # and so none is inverted
    assert mesh.smallest_angles.min() > THIN.get(name, 2.0)


@pytest.mark.parametrize("name", ["drilled", "torus", "all edges rounded", "cone"])
def test_solids_are_closed_by_normals(name, part_with):
    make, characteristic, _ = SOLIDS[name]
    part = part_with(make())
    mesh, even = (gm.sample(part, 1500).mesh(prefer=x) for x in ("normals", "shape"))
    assert len(mesh.vertices) == 1500
    assert (mesh.closed, mesh.euler_characteristic) == (True, characteristic)
    assert mesh.volume == pytest.approx(volume_of(make()), rel=1e-2)
    assert mesh.angles.mean() < 0.9 * even.angles.mean()


def test_shells_that_share_edges_are_open(part_with):
    faces = loose_faces(box(3.0, 2.0, 1.0))
    mesh, whole = (gm.sample(part_with(compound(*faces[:k])), 300).mesh() for k in (5, 6))
    assert (mesh.closed, mesh.euler_characteristic, len(mesh.vertices)) == (False, 1, 300)
    assert whole.closed
    assert whole.volume == pytest.approx(6.0, rel=1e-12)


def test_solids_that_share_faces_are_meshed_one_by_one(part_with):
    glue = BOPAlgo_Builder()
    for x in (0.0, 3.0):
        glue.AddArgument(box(3.0, 2.0, 1.0, at=(x, 0.0, 0.0)))
    glue.Perform()
    part = part_with(glue.Shape())
    said = "2 solids of part .* share faces .* selected by the indices of its faces"
    refused(said, gm.sample(part, 300).mesh)
    for solid in part.solids:
        mesh = gm.sample(part.select(index=solid.faces), 300).mesh()
        assert mesh.closed
        assert mesh.volume == pytest.approx(6.0)


def test_a_periodic_face_that_starts_elsewhere_is_whole(part_with):
    """Of a torus of NURBS whose seams are elsewhere, three quarters were lost."""
    (ring,) = faces_of(as_nurbs(torus(3.0, 1.0)))
    surface, turn = BRep_Tool.Surface_s(ring), 2.0 * np.pi
    part = part_with(face(surface, 2.0, 2.0 + turn, 3.0, 3.0 + turn, 1e-7))
    points = gm.sample(part, 500).points
    assert len(np.unique(np.sign(points), axis=0)) == 8
    mesh = gm.sample(part, 2000).mesh()
    assert (mesh.closed, mesh.euler_characteristic) == (True, 0)
