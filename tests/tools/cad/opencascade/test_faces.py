"""Faces against Open CASCADE: what is inside, areas, normals."""

# pyright: reportMissingImports=false

import math

import numpy as np
import pytest
import shapely

pytest.importorskip("OCP")

from gaussmap.tools.cad.faces import face_surface, own_parameters
from gaussmap.tools.cad.opencascade.faces import FaceReader
from OCP.BRepLib import BRepLib
from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
from OCP.Geom import Geom_CylindricalSurface, Geom_Ellipse
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Ax1, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d

from ....shapes import area_of
from . import shapes
from .shapes import axes, ball, box, cone, cut, cylinder, faces_of, states_of, torus

PLACES = 500
# The largest error of what is inside, and of areas.
OF_BOX, OF_AREA = 1e-3, 1e-3


def places(domain, count):
    low, high = np.array(domain).T
    return low + (high - low) * np.random.default_rng(1).random((count, 2))


def thread():
    """Return a band on a cylinder that goes around nearly twice."""
    surface = Geom_CylindricalSurface(gp_Ax3(), 4.0)
    corners = [(0.1, 0.0), (12.4, 2.5), (12.4, 2.9), (0.1, 0.4)]
    edges = []
    for first, last in zip(corners, corners[1:] + corners[:1], strict=True):
        step = np.subtract(last, first).tolist()
        line = Geom2d_Line(gp_Pnt2d(*first), gp_Dir2d(*step))
        edges.append(shapes.edge(line, surface, 0.0, math.hypot(*step)))
        BRepLib.BuildCurves3d_s(edges[-1])
    return shapes.face(surface, shapes.wire(*edges))


def drilled(shape):
    """Return a shape with a slanted hole."""
    return cut(shape, cylinder(1.5, 60.0, (-20.0, 2.0, 3.0), (1.0, 0.15, 0.1)))


def ring():
    ellipse = Geom_Ellipse(axes((4.0, 0.0, 0.0), (0.2, 1.0, 0.1)), 2.0, 1.0)
    edge = shapes.edge(ellipse)
    axis = gp_Ax1(gp_Pnt(-1.0, 0.0, 0.0), gp_Dir(0.0, 0.1, 1.0))
    return BRepPrimAPI_MakeRevol(edge, axis, 4.0).Shape()


SHAPES = {
    "box": lambda: drilled(box(10.0, 14.0, 12.0, at=(-5, -5, -5))),
    "sphere": lambda: drilled(ball(8.0)),
    "torus": lambda: drilled(torus(8.0, 4.0)),
    "cone": lambda: drilled(cone(9.0, 14.0)),
    "straight hole": lambda: cut(box(30.0, 20.0, 10.0), cylinder(4.0, 12.0, (10.0, 10.0, -1.0))),
    "ring": ring,
    "thread": thread,
}


def with_surfaces(shape):
    """Return the faces of a shape, what is read of them, and their surfaces."""
    faces, reader = faces_of(shape), FaceReader()
    records = [reader.record(x) for x in faces]
    assert not any(x.reason for x in records)
    surfaces = [
        face_surface(x.geometry, x.domain, x.loops, is_reversed=x.reversed) for x in records
    ]
    return list(zip(faces, records, surfaces, strict=True))


def distances(uv, record):
    """Return the distances (k,) of places from the loops of a face, relative to its box."""
    low, high = np.array(record.domain).T
    loops = [shapely.LinearRing((x - low) / (high - low)) for x in record.loops]
    return shapely.distance(shapely.union_all(loops), shapely.points((uv - low) / (high - low)))


@pytest.mark.parametrize("name", SHAPES)
def test_trims_and_areas_are_those_of_open_cascade(name):
    for face, record, surface in with_surfaces(SHAPES[name]()):
        uv = places(record.domain, PLACES)
        # Not modulo the period: of a face that goes around twice, places one turn on are others.
        states = states_of(face, uv, periodic=False)
        own = own_parameters(surface, uv, is_reversed=record.reversed)
        inside = surface.trim.contains(own) if surface.trim else np.ones(PLACES, dtype=np.bool_)
        assert not inside[states == -1].any()
        wrong = inside != (states == 1)
        assert not wrong.any() or distances(uv[wrong], record).max() < OF_BOX
        assert wrong.mean() < 0.01
        if name == "straight hole":  # whose curves are exact: the middles of sides are not outside
            middles = [(x + np.roll(x, 1, axis=0)) / 2.0 for x in record.loops]
            assert (states_of(face, np.concatenate(middles)) >= 0).all()
        side = 1000 if name == "thread" else 250  # which covers 7 % of its box
        assert area_of(surface, side) == pytest.approx(record.area, rel=OF_AREA)


def test_the_seam_of_a_whole_sphere_is_no_border():
    ((_, record, surface),) = with_surfaces(ball(2.0))
    assert record.domain == ((0.0, 2 * math.pi), (-math.pi / 2, math.pi / 2))
    assert surface.trim is None
    assert surface.boundary == (("periodic", "periodic"), ("pole", "pole"))
