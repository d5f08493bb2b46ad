"""Meshes of parts that Open CASCADE made: closed, outward, and as large as it says."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false

import os
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.opencascade.shapes import parts_of
from gaussmap.tools.cad.part import part_of
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from .conftest import compound

FACE, EDGE = TopAbs_ShapeEnum.TopAbs_FACE, TopAbs_ShapeEnum.TopAbs_EDGE


def box():
    return BRepPrimAPI_MakeBox(3.0, 2.0, 1.0).Shape()


def cylinder(radius, length, direction=(0.0, 0.0, 1.0), origin=(0.0, 0.0, 0.0)):
    axis = gp_Ax2(gp_Pnt(*origin), gp_Dir(*direction))
    return BRepPrimAPI_MakeCylinder(axis, radius, length).Shape()


def rounded():
    whole = box()
    fillet, seen = BRepFilletAPI_MakeFillet(whole), []
    for edge in parts_of(whole, EDGE):
        if not any(edge.IsSame(x) for x in seen):
            seen.append(edge)
            fillet.Add(0.2, TopoDS.Edge(edge))
    return fillet.Shape()


def drilled():
    return BRepAlgoAPI_Cut(box(), cylinder(0.4, 3.0, origin=(1.5, 1.0, -1.0))).Shape()


def cut_ball():
    tool = cylinder(0.8, 10.0, (0.0, 0.1, 1.0), (0.7, 0.2, -5.0))
    return BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(2.0).Shape(), tool).Shape()


def crossed():
    other = cylinder(0.4, 6.0, (1.0, 0.0, 0.0), (-3.0, 0.0, 1.0))
    return BRepAlgoAPI_Fuse(cylinder(1.0, 2.0), other).Shape()


# Their Euler characteristics: two for each ball, less two for each handle.
SHAPES = {
    "box": (box, 2),
    "cylinder": (lambda: cylinder(1.0, 2.0), 2),
    "cone": (lambda: BRepPrimAPI_MakeCone(1.0, 0.0, 2.0).Shape(), 2),
    "sphere": (lambda: BRepPrimAPI_MakeSphere(2.0).Shape(), 2),
    "torus": (lambda: BRepPrimAPI_MakeTorus(2.0, 0.6).Shape(), 0),
    "eighth": (lambda: BRepPrimAPI_MakeSphere(1.0, 0.0, np.pi / 2, np.pi / 2).Shape(), 2),
    "all edges rounded": (rounded, 2),
    "drilled": (drilled, 0),
    "cut ball": (cut_ball, 0),
    "as NURBS": (lambda: BRepBuilderAPI_NurbsConvert(cut_ball(), True).Shape(), 0),
    "crossed cylinders": (crossed, 2),
    "two": (lambda: compound(box(), cylinder(0.3, 1.0, origin=(9.0, 0.0, 0.0))), 4),
}
# The smallest angles in degrees where they are small: at the tip of a cone nothing is flipped.
THIN = {"cone": 0.2}


def volume_of(shape):
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return properties.Mass()


@pytest.mark.parametrize("count", [700, 4000])
@pytest.mark.parametrize("name", SHAPES)
def test_solids_are_closed(name, count, write, read):
    make, characteristic = SHAPES[name]
    shape = make()
    mesh = gm.sample(part_of(read(write(shape, "part.brep"))), count).mesh()
    assert len(mesh.vertices) == count
    assert mesh.closed
    assert mesh.euler_characteristic == characteristic
    assert mesh.volume == pytest.approx(volume_of(shape), rel=25.0 / count)
    assert mesh.angles.max() < 60.0  # and so none is inverted
    assert mesh.smallest_angles.min() > THIN.get(name, 2.0)


@pytest.mark.parametrize("name", ["drilled", "torus", "all edges rounded", "cone"])
def test_solids_are_closed_by_normals(name, write, read):
    make, characteristic = SHAPES[name]
    part = part_of(read(write(make(), "part.brep")))
    mesh, even = (gm.sample(part, 1500).mesh(prefer=x) for x in ("normals", "shape"))
    assert len(mesh.vertices) == 1500
    assert mesh.closed
    assert mesh.euler_characteristic == characteristic
    assert mesh.volume == pytest.approx(volume_of(make()), rel=1e-2)
    assert mesh.angles.mean() < 0.9 * even.angles.mean()


# Files that are not part of gaussmap, see docs/cad.md: their Euler characteristics.
FOLDER = Path(os.environ.get("GAUSSMAP_PARTS", "none"))
FILES = {
    "screw.step": 2, "CrankArm.brep": -4, "bottle.brep": 2, "as1-tu-203.stp": -8,
    "frame.step": -48, "hammer.iges": 2,
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.skipif(not FOLDER.is_dir(), reason="needs the folder GAUSSMAP_PARTS")
@pytest.mark.parametrize("prefer", ["shape", "normals"])
@pytest.mark.parametrize("name", FILES)
def test_no_triangle_of_files_points_inward(name, prefer):
    mesh = gm.sample(gm.read_cad(FOLDER / name), 8000).mesh(prefer=prefer)
    assert len(mesh.vertices) == 8000
    assert mesh.closed
    assert mesh.euler_characteristic == FILES[name]
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    assert (np.einsum("tx,tkx->t", across, mesh.corner_normals) > 0.0).all()


def test_shells_that_share_edges_are_open(write, read):
    faces = [x.Moved(x.Location()) for x in parts_of(box(), FACE)]
    mesh = gm.sample(part_of(read(write(compound(*faces[:5]), "open.brep"))), 300).mesh()
    assert not mesh.closed
    assert mesh.euler_characteristic == 1
    assert len(mesh.vertices) == 300
    whole = gm.sample(part_of(read(write(compound(*faces), "closed.brep"))), 300).mesh()
    assert whole.closed
    assert whole.volume == pytest.approx(6.0, rel=1e-12)
