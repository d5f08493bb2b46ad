"""Faces against Open CASCADE: points, derivatives, and what is inside."""

import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.runtime.cad.faces import face_surface
from gaussmap.runtime.cad.records import Geometry, Net
from OCP.Geom import (
    Geom_BSplineCurve,
    Geom_BSplineSurface,
    Geom_ConicalSurface,
    Geom_CylindricalSurface,
    Geom_OffsetSurface,
    Geom_Plane,
    Geom_RectangularTrimmedSurface,
    Geom_SphericalSurface,
    Geom_SurfaceOfLinearExtrusion,
    Geom_SurfaceOfRevolution,
    Geom_ToroidalSurface,
)
from OCP.gp import gp_Ax1, gp_Ax3, gp_Dir, gp_Pnt, gp_Vec

try:
    from OCP.TColgp import TColgp_Array1OfPnt as Points
    from OCP.TColgp import TColgp_Array2OfPnt as PointGrid
    from OCP.TColStd import TColStd_Array1OfInteger as Integers
    from OCP.TColStd import TColStd_Array1OfReal as Reals
    from OCP.TColStd import TColStd_Array2OfReal as RealGrid
except ImportError:  # 8.0
    from OCP.collections import Array1_double as Reals
    from OCP.collections import Array1_gp_Pnt as Points
    from OCP.collections import Array1_int as Integers
    from OCP.collections import Array2_double as RealGrid
    from OCP.collections import Array2_gp_Pnt as PointGrid

# Points, first and second derivatives, relative to the largest of each on the face.
TOLERANCES = (1e-13, 1e-11, 1e-10)
KNOTS, MULTIPLICITIES = [0.0, 1.0, 2.5, 4.0], [4, 1, 1, 4]


def row(values, kind):
    array = kind(1, len(values))
    for k, x in enumerate(values, 1):
        array.SetValue(k, x)
    return array


def grid(values, kind):
    array = kind(1, len(values), 1, len(values[0]))
    for i, line in enumerate(values, 1):
        for j, x in enumerate(line, 1):
            array.SetValue(i, j, x)
    return array


def frame(left_handed=False):
    axes = gp_Ax3(gp_Pnt(3.0, -2.0, 5.0), gp_Dir(1.0, 2.0, -0.5), gp_Dir(0.3, -1.0, 0.2))
    if left_handed:
        axes.YReverse()
    return axes


def xyz(thing):
    return thing.X(), thing.Y(), thing.Z()


def placement(axes):
    parts = (axes.Location(), axes.XDirection(), axes.YDirection(), axes.Direction())
    return np.array([xyz(x) for x in parts]).ravel()


def some_curve(weights=True):
    """Return a cubic NURBS curve and its net."""
    points = np.random.default_rng(5).normal(size=(6, 3)) + 4.0 * np.arange(6)[:, None] ** 0.5
    w = np.linspace(1.0, 2.0, 6) if weights else np.ones(6)
    curve = Geom_BSplineCurve(
        row([gp_Pnt(*p) for p in points.tolist()], Points), row(w.tolist(), Reals),
        row(KNOTS, Reals), row(MULTIPLICITIES, Integers), 3,
    )  # fmt: skip
    return curve, Net((3,), (np.repeat(KNOTS, MULTIPLICITIES),), points, w)


def some_nurbs(rational=True):
    rng = np.random.default_rng(3)
    points = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0), indexing="ij"), axis=-1)
    points = np.concatenate([points, rng.random((6, 6, 1))], axis=2)
    weights = 1.0 + rng.random((6, 6)) if rational else np.ones((6, 6))
    nodes = grid([[gp_Pnt(*p) for p in line] for line in points.tolist()], PointGrid)
    knots, counts = row(KNOTS, Reals), row(MULTIPLICITIES, Integers)
    surface = Geom_BSplineSurface(
        nodes, grid(weights.tolist(), RealGrid), knots, knots, counts, counts, 3, 3
    )
    knots = np.repeat(KNOTS, MULTIPLICITIES)
    return surface, Geometry("nurbs", net=Net((3, 3), (knots, knots), points, weights))


def elementary(kind, left_handed=False):
    axes = frame(left_handed)
    made, numbers = {
        "plane": lambda: (Geom_Plane(axes), ()),
        "cylinder": lambda: (Geom_CylindricalSurface(axes, 2.5), (2.5,)),
        "cone": lambda: (Geom_ConicalSurface(axes, 0.3, 2.5), (2.5, 0.3)),
        "sphere": lambda: (Geom_SphericalSurface(axes, 2.5), (2.5,)),
        "torus": lambda: (Geom_ToroidalSurface(axes, 2.5, 0.7), (2.5, 0.7)),
    }[kind]()
    return made, Geometry(kind, np.array([*placement(axes), *numbers]))


def revolution():
    curve, net = some_curve()
    axis = gp_Ax1(gp_Pnt(1.0, -9.0, 2.0), gp_Dir(0.2, 0.1, 1.0))
    numbers = np.array([*xyz(axis.Location()), *xyz(axis.Direction())])
    return Geom_SurfaceOfRevolution(curve, axis), Geometry("revolution", numbers, net)


def extrusion():
    curve, net = some_curve()
    direction = gp_Dir(0.2, 1.0, -2.0)
    made = Geom_SurfaceOfLinearExtrusion(curve, direction)
    return made, Geometry("extrusion", np.array(xyz(direction)), net)


def offset(basis, domain, distance=-0.2):
    surface, geometry = basis
    (u0, u1), (v0, v1) = domain
    trimmed = Geom_RectangularTrimmedSurface(surface, u0, u1, v0, v1)
    made = Geom_OffsetSurface(trimmed, distance)
    return made, Geometry("offset", np.array([distance]), basis=geometry)


ANGLES, LONG, NET = (0.4, 5.2), (-1.0, 2.0), (0.2, 3.7)
CASES = {
    **{
        f"{kind}{' left-handed' * left}": (lambda k=kind, x=left: elementary(k, x), domain)
        for kind, domain in (
            ("plane", (LONG, NET)), ("cylinder", (ANGLES, LONG)), ("cone", (ANGLES, LONG)),
            ("sphere", (ANGLES, (-1.2, 0.9))), ("torus", (ANGLES, (-2.0, 7.0))),
        )
        for left in (False, True)
    },
    "nurbs": (some_nurbs, (NET, NET)),
    "b-spline": (lambda: some_nurbs(False), (NET, NET)),
    "revolution": (revolution, (ANGLES, NET)),
    "extrusion": (extrusion, (NET, LONG)),
    **{
        f"offset {kind}{' left-handed' * left}": (
            lambda k=kind, x=left, d=domain: offset(elementary(k, x), d), domain
        )
        for kind, domain in (
            ("plane", (LONG, NET)), ("cylinder", (ANGLES, LONG)), ("cone", (ANGLES, LONG)),
            ("sphere", (ANGLES, (-1.2, 0.9))), ("torus", (ANGLES, (-2.0, 2.0))),
        )
        for left in (False, True)
    },
    "offset nurbs": (lambda: offset(some_nurbs(), (NET, NET)), (NET, NET)),
    "offset revolution": (lambda: offset(revolution(), (ANGLES, NET)), (ANGLES, NET)),
    "offset extrusion": (lambda: offset(extrusion(), (NET, LONG)), (NET, LONG)),
}  # fmt: skip


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
    result = []
    for rows in ([0], [1, 2], [3, 4, 5]):
        size = np.abs(wanted[:, rows]).max() or 1.0
        result.append(float(np.abs(found[:, rows] - wanted[:, rows]).max() / size))
    return result


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_points_and_derivatives(case):
    make, domain = case
    made, geometry = make()
    low, high = np.array(domain).T
    uv = low + (high - low) * np.random.default_rng(1).random((200, 2))
    surface = face_surface(geometry, domain)
    assert (np.array(errors(surface.jets(*uv.T), jets_of(made, uv))) <= TOLERANCES).all()
