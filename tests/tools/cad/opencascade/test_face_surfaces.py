"""Surfaces of faces against Open CASCADE: derivatives, what is inside, areas, normals."""

# pyright: reportMissingImports=false

import math

import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.faces import face_surface, own_parameters
from gaussmap.tools.cad.opencascade.faces import FaceReader
from gaussmap.tools.cad.opencascade.shapes import parts_of
from gaussmap.tools.cad.opencascade.surfaces import geometry_of
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepLib import BRepLib
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeRevol,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.Geom import (
    Geom_CylindricalSurface,
    Geom_OffsetSurface,
    Geom_RectangularTrimmedSurface,
)
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.IntTools import IntTools_FClass2d
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum, TopAbs_State
from OCP.TopoDS import TopoDS

from .test_surfaces import ELLIPSE, SURFACES

# Points, first and second derivatives, relative to the largest of each.
TOLERANCES = (1e-13, 1e-11, 1e-10)
# Interpolated offset curves that nearly have a cusp have less accurate second derivatives.
AMPLIFIED = (1e-13, 1e-11, 5e-10)
NEAR_CUSPS = ("extrusion, offset curve",)
PLACES = 500
# The largest error of what is inside, and of areas.
OF_BOX, OF_AREA = 1e-3, 1e-3


def xyz(p):
    return p.X(), p.Y(), p.Z()


def jets_of(surface, uv):
    """Return x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) by Open CASCADE."""
    jets = np.empty((len(uv), 6, 3))
    point, vectors = gp_Pnt(), [gp_Vec() for _ in range(5)]
    for k, (u, v) in enumerate(uv.tolist()):
        surface.D2(u, v, point, *vectors)
        x_u, x_v, x_uu, x_vv, x_uv = map(xyz, vectors)
        jets[k] = xyz(point), x_u, x_v, x_uu, x_uv, x_vv
    return jets


def errors(found, wanted):
    """Return the largest errors of points, first and second derivatives, relative to their size."""
    orders = ([0], [1, 2], [3, 4, 5])
    sizes = [float(np.abs(wanted[:, k]).max()) or 1.0 for k in orders]
    pairs = zip(orders, sizes, strict=True)
    return np.array([np.abs(found[:, k] - wanted[:, k]).max() / size for k, size in pairs])


def places(domain, count):
    low, high = np.array(domain).T
    return low + (high - low) * np.random.default_rng(1).random((count, 2))


def offset(name, distance):
    """Return an offset of one of the surfaces, and a part of its domain."""
    surface, domain, _ = SURFACES[name]
    inside = tuple((low + (high - low) / 9, high - (high - low) / 7) for low, high in domain)
    (u0, u1), (v0, v1) = inside
    trimmed = Geom_RectangularTrimmedSurface(surface, u0, u1, v0, v1)
    return Geom_OffsetSurface(trimmed, distance), inside


# No left-handed plane: 7.9 moves it along x_u × x_v, as the manual says, and 8.0 to the other side.
OFFSETS = {
    f"offset, {name}": offset(name, distance)
    for name, distance in (
        ("plane", 0.5), ("cylinder, left-handed", 0.5), ("cone", -0.3),
        ("sphere", -0.3), ("torus", 0.4), ("nurbs, Bézier", 0.1), ("nurbs", 0.2),
        ("revolution, arc", -0.2), ("extrusion, ellipse", 0.2),
    )
}  # fmt: skip
CASES = {name: (surface, domain) for name, (surface, domain, _) in SURFACES.items()} | OFFSETS


@pytest.mark.parametrize("name", CASES)
def test_derivatives_are_those_of_open_cascade(name):
    surface, domain = CASES[name]
    uv = places(domain, 200)
    jets = face_surface(geometry_of(surface, domain), domain).jets(*np.ascontiguousarray(uv.T))
    tolerances = AMPLIFIED if name in NEAR_CUSPS else TOLERANCES
    assert (errors(jets, jets_of(surface, uv)) <= tolerances).all()


# --- faces ----------------------------------------------------------------------------------------


def thread():
    """Return a band on a cylinder that goes around nearly twice."""
    surface = Geom_CylindricalSurface(gp_Ax3(), 4.0)
    corners = [(0.1, 0.0), (12.4, 2.5), (12.4, 2.9), (0.1, 0.4)]
    wire = BRepBuilderAPI_MakeWire()
    for first, last in zip(corners, corners[1:] + corners[:1], strict=True):
        step = np.subtract(last, first).tolist()
        line = Geom2d_Line(gp_Pnt2d(*first), gp_Dir2d(*step))
        edge = BRepBuilderAPI_MakeEdge(line, surface, 0.0, math.hypot(*step)).Edge()
        BRepLib.BuildCurves3d_s(edge)
        wire.Add(edge)
    return BRepBuilderAPI_MakeFace(surface, wire.Wire()).Shape()


def drilled(shape):
    """Return a shape with a slanted hole."""
    axes = gp_Ax2(gp_Pnt(-20.0, 2.0, 3.0), gp_Dir(1.0, 0.15, 0.1))
    return BRepAlgoAPI_Cut(shape, BRepPrimAPI_MakeCylinder(axes, 1.5, 60.0).Shape()).Shape()


def ring():
    edge = BRepBuilderAPI_MakeEdge(ELLIPSE).Edge()
    axis = gp_Ax1(gp_Pnt(-1.0, 0.0, 0.0), gp_Dir(0.0, 0.1, 1.0))
    return BRepPrimAPI_MakeRevol(edge, axis, 4.0).Shape()


SHAPES = {
    "box": lambda: drilled(BRepPrimAPI_MakeBox(gp_Pnt(-5, -5, -5), 10.0, 14.0, 12.0).Shape()),
    "sphere": lambda: drilled(BRepPrimAPI_MakeSphere(8.0).Shape()),
    "torus": lambda: drilled(BRepPrimAPI_MakeTorus(8.0, 4.0).Shape()),
    "cone": lambda: drilled(BRepPrimAPI_MakeCone(9.0, 0.0, 14.0).Shape()),
    "ring": ring,
    "thread": thread,
}


def faces_of(shape):
    faces = [TopoDS.Face(x) for x in parts_of(shape, TopAbs_ShapeEnum.TopAbs_FACE)]
    reader = FaceReader()
    records = [reader.record(x) for x in faces]
    assert not any(x.reason for x in records)
    surfaces = [
        face_surface(x.geometry, x.domain, x.loops, is_reversed=x.reversed) for x in records
    ]
    return list(zip(faces, records, surfaces, strict=True))


def distances(uv, record):
    """Return the distances (k,) of places from the loops of a face, relative to its box."""
    low, high = np.array(record.domain).T
    p = (uv - low) / (high - low)
    nearest = np.full(len(uv), np.inf)
    for loop in record.loops:
        ends = (loop - low) / (high - low)
        for a, b in zip(ends, np.roll(ends, -1, axis=0), strict=True):
            t = np.clip((p - a) @ (b - a) / max((b - a) @ (b - a), 1e-300), 0.0, 1.0)
            nearest = np.minimum(nearest, np.hypot(*(p - a - t[:, None] * (b - a)).T))
    return nearest


def area_of(surface, side):
    """Return the area inside the trim from jittered places, a square of so many on a side."""
    (u0, u1), (v0, v1) = surface.domain
    cells = np.stack(np.meshgrid(*[np.arange(side)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    parts = (cells + np.random.default_rng(3).random(cells.shape)) / side
    uv = np.array([u0, v0]) + parts * (u1 - u0, v1 - v0)
    uv = uv if surface.trim is None else uv[surface.trim.contains(uv)]
    jets = surface.jets(*np.ascontiguousarray(uv.T))
    lengths = np.linalg.norm(np.cross(jets[:, 1], jets[:, 2]), axis=1)
    return float(lengths.sum()) * (u1 - u0) * (v1 - v0) / side**2


@pytest.mark.parametrize("name", SHAPES)
def test_trims_and_areas_are_those_of_open_cascade(name):
    for face, record, surface in faces_of(SHAPES[name]()):
        uv = places(record.domain, PLACES)
        forward = TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
        classifier = IntTools_FClass2d(forward, 1e-9)
        # Not modulo the period: of a face that goes around twice, places one turn on are others.
        states = [classifier.Perform(gp_Pnt2d(*x), False) for x in uv.tolist()]
        truth = np.array([x == TopAbs_State.TopAbs_IN for x in states])
        own = own_parameters(surface, uv, is_reversed=record.reversed)
        inside = surface.trim.contains(own) if surface.trim else np.ones(PLACES, dtype=np.bool_)
        wrong = inside != truth
        assert not wrong.any() or distances(uv[wrong], record).max() < OF_BOX
        side = 1000 if name == "thread" else 250  # which covers 7 % of its box
        assert area_of(surface, side) == pytest.approx(record.area, rel=OF_AREA)


def test_normals_point_out_of_a_drilled_sphere():
    for _, record, surface in faces_of(SHAPES["sphere"]()):
        uv = own_parameters(surface, places(record.domain, 50), is_reversed=record.reversed)
        jets = surface.jets(*np.ascontiguousarray(uv.T))
        normals = np.cross(jets[:, 1], jets[:, 2])
        outward = 1.0 if record.geometry.kind == "sphere" else -1.0
        arms = jets[:, 0]
        if outward < 0.0:  # of the axis of the hole, to which its normals point
            z = record.geometry.numbers[9:12]
            arms = arms - record.geometry.numbers[:3]
            arms = arms - (arms @ z)[:, None] * z
        assert ((normals * arms).sum(axis=1) * outward > 0.0).all()


def test_the_seam_of_a_whole_sphere_is_no_border():
    ((_, record, surface),) = faces_of(BRepPrimAPI_MakeSphere(2.0).Shape())
    assert record.domain == ((0.0, 2 * math.pi), (-math.pi / 2, math.pi / 2))
    assert surface.trim is None
    assert surface.boundary == (("periodic", "periodic"), ("pole", "pole"))
