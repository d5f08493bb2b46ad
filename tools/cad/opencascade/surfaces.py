"""Surfaces of Open CASCADE as arrays, for all kinds in STEP, IGES and BREP files."""

# pyright: reportMissingImports=false

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BinTools import BinTools_SurfaceSet

from ..records import Geometry, Net
from .curves import UnusableError, curve_net, knots_of, opened
from .shapes import direct_class

Array = NDArray[np.float64]

# For each elementary class: the kind of face, and the methods that return its radii and angles.
ELEMENTARY: dict[str, tuple[str, tuple[str, ...]]] = {
    "Geom_Plane": ("plane", ()),
    "Geom_CylindricalSurface": ("cylinder", ("Radius",)),
    "Geom_ConicalSurface": ("cone", ("RefRadius", "SemiAngle")),
    "Geom_SphericalSurface": ("sphere", ("Radius",)),
    "Geom_ToroidalSurface": ("torus", ("MajorRadius", "MinorRadius")),
}

# The number of bytes that Open CASCADE writes for a surface before the control points: a title; the
# kind of surface; flags, whether it is rational and, for a B-spline, whether it is periodic; the
# degrees; the numbers of control points and of knots of a B-spline.
TITLE = len(b"Surfaces 1\n")
BEFORE_POLES = {
    "Geom_BezierSurface": TITLE + 1 + 2 + 2 * 2,
    "Geom_BSplineSurface": TITLE + 1 + 4 + 2 * 2 + 4 * 4,
}


def basis_of(surface: Any) -> Any:  # noqa: ANN401
    """Return a surface without its own trim, which the trim of the face replaces."""
    while direct_class(surface) == "Geom_RectangularTrimmedSurface":
        surface = surface.BasisSurface()
    return surface


def periods_of(surface: Any) -> tuple[float, float]:  # noqa: ANN401
    """Return the periods in u and v, 0 where not periodic."""
    along_u = float(surface.UPeriod()) if surface.IsUPeriodic() else 0.0
    return along_u, float(surface.VPeriod()) if surface.IsVPeriodic() else 0.0


def geometry_of(surface: Any, domain: Sequence[Sequence[float]]) -> Geometry:  # noqa: ANN401
    """Return a surface as arrays, with the same parameters.

    Lines and other unbounded curves are restricted to the domain. Raises UnusableError with the
    reason if the surface cannot be converted.
    """
    surface = basis_of(surface)
    name = direct_class(surface)
    if name in ELEMENTARY:
        kind, more = ELEMENTARY[name]
        numbers = [*_placement(surface.Position()), *(getattr(surface, x)() for x in more)]
        return Geometry(kind, np.array(numbers, dtype=np.float64))
    if name in MADE_OF:
        return MADE_OF[name](surface, domain)
    raise UnusableError(f"its surface of type {name.removeprefix('Geom_')} is not known")


def _placement(axes: Any) -> list[float]:  # noqa: ANN401
    origin, x, y, z = axes.Location(), axes.XDirection(), axes.YDirection(), axes.Direction()
    return [number for p in (origin, x, y, z) for number in p.Coord()]


def _nurbs(surface: Any, domain: Sequence[Sequence[float]]) -> Geometry:  # noqa: ANN401
    shifts, names = (
        [0.0, 0.0],
        ("{}Knot", "Nb{}Knots", "Insert{}Knot", "Set{}Origin", "Set{}NotPeriodic"),
    )
    periods = periods_of(surface)
    if any(periods):
        surface = surface.Copy()
    for k, (axis, period) in enumerate(zip("UV", periods, strict=True)):
        if period:
            shifts[k] = opened([getattr(surface, x.format(axis)) for x in names], domain[k], period)
    along_u, along_v = range(1, surface.NbUKnots() + 1), range(1, surface.NbVKnots() + 1)
    knots = (
        knots_of([surface.UKnot(k) for k in along_u], [surface.UMultiplicity(k) for k in along_u]),
        knots_of([surface.VKnot(k) for k in along_v], [surface.VMultiplicity(k) for k in along_v]),
    )
    knots = knots[0] + shifts[0], knots[1] + shifts[1]
    return Geometry("nurbs", net=Net(_degrees(surface), knots, *_net(surface)))


def _bezier(surface: Any, domain: Sequence[Sequence[float]]) -> Geometry:  # noqa: ANN401
    degrees = _degrees(surface)
    knots = tuple(np.repeat([0.0, 1.0], p + 1) for p in degrees)
    return Geometry("nurbs", net=Net(degrees, knots, *_net(surface)))


def _degrees(surface: Any) -> tuple[int, int]:  # noqa: ANN401
    return surface.UDegree(), surface.VDegree()


def _net(surface: Any) -> tuple[Array, Array | None]:  # noqa: ANN401
    """Return the control points (m, n, 3) and the weights (m, n), or None for weights of 1."""
    m, n = surface.NbUPoles(), surface.NbVPoles()
    rational = surface.IsURational() or surface.IsVRational()
    numbers = 4 if rational else 3
    # Calls for each control point would take longer than everything else. Writing the surface to a
    # buffer returns all of them at once.
    written, buffer = BinTools_SurfaceSet(), io.BytesIO()
    written.Add(surface)
    written.Write(buffer)
    first = BEFORE_POLES[direct_class(surface)]
    net = np.frombuffer(buffer.getvalue(), "<f8", m * n * numbers, first).reshape(m, n, numbers)
    return net[:, :, :3].astype(np.float64), net[:, :, 3].astype(np.float64) if rational else None


def _revolution(surface: Any, domain: Sequence[Sequence[float]]) -> Geometry:  # noqa: ANN401
    axis = surface.Axis()
    net = curve_net(surface.BasisCurve(), domain[1])
    o, z = axis.Location(), axis.Direction()
    return Geometry("revolution", np.array([o.X(), o.Y(), o.Z(), z.X(), z.Y(), z.Z()]), net)


def _extrusion(surface: Any, domain: Sequence[Sequence[float]]) -> Geometry:  # noqa: ANN401
    net = curve_net(surface.BasisCurve(), domain[0])
    z = surface.Direction()
    return Geometry("extrusion", np.array([z.X(), z.Y(), z.Z()]), net)


def _offset(surface: Any, domain: Sequence[Sequence[float]]) -> Geometry:  # noqa: ANN401
    basis = geometry_of(surface.BasisSurface(), domain)
    return Geometry("offset", np.array([surface.Offset()], dtype=np.float64), basis=basis)


MADE_OF = {
    "Geom_BSplineSurface": _nurbs,
    "Geom_BezierSurface": _bezier,
    "Geom_SurfaceOfRevolution": _revolution,
    "Geom_SurfaceOfLinearExtrusion": _extrusion,
    "Geom_OffsetSurface": _offset,
}
