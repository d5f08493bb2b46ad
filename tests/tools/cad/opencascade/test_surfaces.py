"""Surfaces of all kinds as numbers: their formulas give the points of Open CASCADE."""

# pyright: reportMissingImports=false

import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.opencascade.surfaces import geometry_of, periods_of
from OCP.Geom import (
    Geom_BezierSurface,
    Geom_Circle,
    Geom_ConicalSurface,
    Geom_CylindricalSurface,
    Geom_Ellipse,
    Geom_Hyperbola,
    Geom_Line,
    Geom_OffsetCurve,
    Geom_OffsetSurface,
    Geom_Plane,
    Geom_RectangularTrimmedSurface,
    Geom_SphericalSurface,
    Geom_SurfaceOfLinearExtrusion,
    Geom_SurfaceOfRevolution,
    Geom_ToroidalSurface,
    Geom_TrimmedCurve,
)
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Dir, gp_Pnt
from scipy.interpolate import BPoly

from .conftest import points_of

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
    return Geom_BezierSurface(points, weights)


def spline(surface, u, v):
    part = Geom_RectangularTrimmedSurface(surface, *u, *v)
    return GeomConvert.SurfaceToBSplineSurface_s(part)


def revolved(curve):
    return Geom_SurfaceOfRevolution(curve, AXIS)


def extruded(curve):
    return Geom_SurfaceOfLinearExtrusion(curve, SLANTED)


ELLIPSE = Geom_Ellipse(ACROSS, 2.0, 1.0)
CIRCLE = GeomConvert.CurveToBSplineCurve_s(Geom_Circle(ACROSS, 2.0))
TORUS = Geom_ToroidalSurface(AXES, 5.0, 2.0)
SIDE = ((0.1, 6.0), (-1.0, 2.0))
SURFACES = {
    "plane": (Geom_Plane(AXES), ((-3.0, 2.0), (0.0, 5.0)), (0, 0)),
    "plane, left-handed": (Geom_Plane(LEFT_HANDED), ((-3.0, 2.0), (0.0, 5.0)), (0, 0)),
    "cylinder": (Geom_CylindricalSurface(AXES, 2.0), SIDE, (TURN, 0)),
    "cylinder, left-handed": (Geom_CylindricalSurface(LEFT_HANDED, 2.0), SIDE, (TURN, 0)),
    "cone": (Geom_ConicalSurface(AXES, 0.4, 2.0), SIDE, (TURN, 0)),
    "sphere": (Geom_SphericalSurface(AXES, 2.0), ((0.0, 6.0), (-1.5, 1.5)), (TURN, 0)),
    "torus": (TORUS, ((0.0, 6.0), (0.0, 6.0)), (TURN, TURN)),
    "nurbs, Bézier": (bezier(), ((0.0, 1.0), (0.0, 1.0)), (0, 0)),
    "nurbs": (spline(TORUS, (0.5, 2.0), (1.0, 4.0)), ((0.5, 2.0), (1.0, 4.0)), (0, 0)),
    "nurbs, periodic": (
        GeomConvert.SurfaceToBSplineSurface_s(TORUS), ((0.0, TURN), (0.0, TURN)), (TURN, TURN)
    ),
    "revolution, circle": (
        revolved(Geom_Circle(ACROSS, 5.0)), ((0.0, 6.0), (0.0, 6.0)), (TURN, TURN)
    ),
    "revolution, arc": (
        revolved(Geom_TrimmedCurve(Geom_Circle(ACROSS, 2.0), 5.0, 8.0)),
        ((0.0, 6.0), (5.0, 8.0)), (TURN, 0),
    ),
    "revolution, arc of a spline": (
        revolved(Geom_TrimmedCurve(CIRCLE, 5.0, 8.0)), ((0.0, 6.0), (5.0, 8.0)), (TURN, 0)
    ),
    "revolution, skew line": (
        revolved(Geom_Line(gp_Pnt(3.0, 0.0, 0.0), SLANTED)), ((0.0, 6.0), (-2.0, 7.0)), (TURN, 0)
    ),
    "extrusion, ellipse": (extruded(ELLIPSE), ((0.0, 6.0), (-1.0, 5.0)), (TURN, 0)),
    "extrusion, hyperbola": (
        extruded(Geom_Hyperbola(ACROSS, 2.0, 1.0)), ((-1.5, 2.5), (-1.0, 5.0)), (0, 0)
    ),
    "extrusion, offset curve": (
        extruded(Geom_OffsetCurve(ELLIPSE, 0.4, gp_Dir(0.2, 1.0, 0.1))),
        ((0.0, 6.0), (-1.0, 5.0)), (TURN, 0),
    ),
}  # fmt: skip


def grid(domain, count=17):
    (u0, u1), (v0, v1) = domain
    u, v = np.meshgrid(np.linspace(u0, u1, count), np.linspace(v0, v1, count))
    return np.stack([u.ravel(), v.ravel()], axis=1)


def points_by_ocp(surface, uv):
    points = (surface.Value(u, v) for u, v in uv.tolist())
    return np.array([(p.X(), p.Y(), p.Z()) for p in points])


@pytest.mark.parametrize("name", SURFACES)
def test_points_are_those_of_open_cascade(name):
    surface, domain, periods = SURFACES[name]
    geometry, uv = geometry_of(surface, domain), grid(domain)
    truth = points_by_ocp(surface, uv)
    assert geometry.kind == name.split(",")[0]
    assert np.abs(points_of(geometry, uv) - truth).max() < 1e-14 * 8 * np.abs(truth).max()
    assert periods_of(surface) == pytest.approx(periods)


def test_curves_that_are_no_nurbs_have_exact_derivatives():
    surface, domain, _ = SURFACES["extrusion, ellipse"]
    net = geometry_of(surface, domain).net
    assert net is not None
    degree, ends = net.degrees[0], np.unique(net.knots[0])
    spans = degree * np.arange(len(ends) - 1)
    pieces = np.stack([net.points[spans + k] for k in range(degree + 1)])
    curve = BPoly(pieces, ends)
    t = np.linspace(ends[0], ends[-1], 101)
    for order, tolerance in ((1, 1e-12), (2, 1e-10)):
        truth = np.array([(d.X(), d.Y(), d.Z()) for d in (ELLIPSE.DN(x, order) for x in t)])
        assert np.abs(curve.derivative(order)(t) - truth).max() < tolerance


def test_an_offset_has_its_basis():
    surface, domain, _ = SURFACES["revolution, circle"]
    trimmed = Geom_RectangularTrimmedSurface(surface, 1.0, 2.0, 1.0, 2.0)
    geometry = geometry_of(Geom_OffsetSurface(trimmed, 0.25), domain)
    assert geometry.kind == "offset"
    assert geometry.numbers.tolist() == [0.25]
    assert geometry.basis is not None
    assert geometry.basis.kind == "revolution"
