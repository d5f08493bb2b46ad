"""Surfaces of all kinds against Open CASCADE: points by their numbers, and derivatives."""

# pyright: reportMissingImports=false

import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.faces import face_surface
from gaussmap.tools.cad.opencascade.surfaces import geometry_of, periods_of
from OCP import Geom
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Dir, gp_Pnt, gp_Vec

from .shapes import xyz

try:
    from OCP.TColgp import TColgp_Array2OfPnt as PointGrid
    from OCP.TColStd import TColStd_Array2OfReal as RealGrid
except ImportError:  # 8.0
    from OCP.collections import Array2_double as RealGrid
    from OCP.collections import Array2_gp_Pnt as PointGrid

TURN = 2.0 * np.pi
AXES = gp_Ax3(gp_Pnt(1.0, -2.0, 3.0), gp_Dir(0.3, 0.5, 1.0), gp_Dir(1.0, 0.2, 0.0))
LEFT_HANDED = gp_Ax3(AXES.Ax2())
LEFT_HANDED.YReverse()
AXIS = gp_Ax1(gp_Pnt(0.5, 0.0, 0.0), gp_Dir(0.0, 0.1, 1.0))
ACROSS = gp_Ax2(gp_Pnt(4.0, 0.0, 0.0), gp_Dir(0.2, 1.0, 0.1))
SLANTED = gp_Dir(0.2, 0.5, 1.0)


def bezier():
    points, weights = PointGrid(1, 3, 1, 4), RealGrid(1, 3, 1, 4)
    for i in range(1, 4):
        for j in range(1, 5):
            points.SetValue(i, j, gp_Pnt(i, j, 0.3 * i * j - 0.2 * j * j))
            weights.SetValue(i, j, 1.0 + 0.1 * i + 0.05 * j)
    return Geom.Geom_BezierSurface(points, weights)


def spline(surface, u, v):
    part = Geom.Geom_RectangularTrimmedSurface(surface, *u, *v)
    return GeomConvert.SurfaceToBSplineSurface_s(part)


def revolved(curve):
    return Geom.Geom_SurfaceOfRevolution(curve, AXIS)


def extruded(curve):
    return Geom.Geom_SurfaceOfLinearExtrusion(curve, SLANTED)


ELLIPSE = Geom.Geom_Ellipse(ACROSS, 2.0, 1.0)
CIRCLE = GeomConvert.CurveToBSplineCurve_s(Geom.Geom_Circle(ACROSS, 2.0))
CLOSED = GeomConvert.CurveToBSplineCurve_s(Geom.Geom_Circle(ACROSS, 2.0))
CLOSED.SetPeriodic()
TORUS = Geom.Geom_ToroidalSurface(AXES, 5.0, 2.0)
SIDE = ((0.1, 6.0), (-1.0, 2.0))
SURFACES = {
    "plane": (Geom.Geom_Plane(AXES), ((-3.0, 2.0), (0.0, 5.0)), (0, 0)),
    "plane, left-handed": (Geom.Geom_Plane(LEFT_HANDED), ((-3.0, 2.0), (0.0, 5.0)), (0, 0)),
    "cylinder": (Geom.Geom_CylindricalSurface(AXES, 2.0), SIDE, (TURN, 0)),
    "cylinder, left-handed": (Geom.Geom_CylindricalSurface(LEFT_HANDED, 2.0), SIDE, (TURN, 0)),
    "cone": (Geom.Geom_ConicalSurface(AXES, 0.4, 2.0), SIDE, (TURN, 0)),
    "sphere": (Geom.Geom_SphericalSurface(AXES, 2.0), ((0.0, 6.0), (-1.5, 1.5)), (TURN, 0)),
    "torus": (TORUS, ((0.0, 6.0), (0.0, 6.0)), (TURN, TURN)),
    "nurbs, Bézier": (bezier(), ((0.0, 1.0), (0.0, 1.0)), (0, 0)),
    "nurbs": (spline(TORUS, (0.5, 2.0), (1.0, 4.0)), ((0.5, 2.0), (1.0, 4.0)), (0, 0)),
    "nurbs, periodic": (
        GeomConvert.SurfaceToBSplineSurface_s(TORUS), ((0.0, TURN), (0.0, TURN)), (TURN, TURN)
    ),
    "nurbs, turned": (
        GeomConvert.SurfaceToBSplineSurface_s(TORUS), ((-1.0, TURN - 1.0), (8.0, TURN + 8.0)),
        (TURN, TURN),
    ),
    "revolution, turned spline": (revolved(CLOSED), ((0.0, 6.0), (5.0, TURN + 5.0)), (TURN, TURN)),
    "extrusion, turned": (extruded(ELLIPSE), ((5.0, TURN + 5.0), (-1.0, 5.0)), (TURN, 0)),
    "revolution, circle": (
        revolved(Geom.Geom_Circle(ACROSS, 5.0)), ((0.0, 6.0), (0.0, 6.0)), (TURN, TURN)
    ),
    "revolution, arc": (
        revolved(Geom.Geom_TrimmedCurve(Geom.Geom_Circle(ACROSS, 2.0), 5.0, 8.0)),
        ((0.0, 6.0), (5.0, 8.0)), (TURN, 0),
    ),
    "revolution, arc of a spline": (
        revolved(Geom.Geom_TrimmedCurve(CIRCLE, 5.0, 8.0)), ((0.0, 6.0), (5.0, 8.0)), (TURN, 0)
    ),
    "revolution, skew line": (
        revolved(Geom.Geom_Line(gp_Pnt(3.0, 0.0, 0.0), SLANTED)),
        ((0.0, 6.0), (-2.0, 7.0)), (TURN, 0),
    ),
    "extrusion, ellipse": (extruded(ELLIPSE), ((0.0, 6.0), (-1.0, 5.0)), (TURN, 0)),
    "extrusion, hyperbola": (
        extruded(Geom.Geom_Hyperbola(ACROSS, 2.0, 1.0)), ((-1.5, 2.5), (-1.0, 5.0)), (0, 0)
    ),
    "extrusion, offset curve": (
        extruded(Geom.Geom_OffsetCurve(ELLIPSE, 0.4, gp_Dir(0.2, 1.0, 0.1))),
        ((0.0, 6.0), (-1.0, 5.0)), (TURN, 0),
    ),
}  # fmt: skip


# Points, first and second derivatives, relative to the largest of each.
TOLERANCES = (1e-13, 1e-11, 1e-10)
# Interpolated offset curves that nearly have a cusp have less accurate second derivatives.
AMPLIFIED = (1e-13, 1e-11, 5e-10)
NEAR_CUSPS = ("extrusion, offset curve",)


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


def offset(name, distance):
    """Return an offset of one of the surfaces, and a part of its domain."""
    surface, domain, _ = SURFACES[name]
    inside = tuple((low + (high - low) / 9, high - (high - low) / 7) for low, high in domain)
    (u0, u1), (v0, v1) = inside
    trimmed = Geom.Geom_RectangularTrimmedSurface(surface, u0, u1, v0, v1)
    return Geom.Geom_OffsetSurface(trimmed, distance), inside


# No left-handed plane: 7.9 moves it along x_u × x_v, as the manual says, and 8.0 to the other side.
OFFSETS = {
    f"offset, {name}": offset(name, distance)
    for name, distance in (
        ("plane", 0.5), ("cylinder, left-handed", 0.5), ("cone", -0.3),
        ("sphere", -0.3), ("torus", 0.4), ("nurbs, Bézier", 0.1), ("nurbs", 0.2),
        ("revolution, arc", -0.2), ("extrusion, ellipse", 0.2),
    )
}  # fmt: skip
CASES = SURFACES | OFFSETS


@pytest.mark.parametrize("name", CASES)
def test_surfaces_are_those_of_open_cascade(name):
    surface, domain, *periods = CASES[name]
    geometry, (low, high) = geometry_of(surface, domain), np.array(domain).T
    uv = low + (high - low) * np.random.default_rng(1).random((289, 2))
    wanted, jets = jets_of(surface, uv), face_surface(geometry, domain).jets(*uv.T.copy())
    tolerances = AMPLIFIED if name in NEAR_CUSPS else TOLERANCES
    assert (errors(jets, wanted) <= tolerances).all()
    assert geometry.kind == name.split(",")[0]
    if name in SURFACES:
        assert periods_of(surface) == pytest.approx(*periods)
