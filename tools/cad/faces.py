"""Surfaces of faces: from the arrays of a face to a surface with exact derivatives and a trim.

Parameters are those of Open CASCADE and STEP (see `saving`); their domain is the bounding box of
the loops. Planes, cylinders, cones, spheres, tori and surfaces of revolution are evaluated in a
frame of their own, and then placed. Extrusions are NURBS. Second derivatives of offsets are
numerical (see `offset_surface`).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from ...runtime.domain.domain import Boundary, BoundaryPair, Domain, Interval, checked_domain
from ...runtime.domain.loops import checked_loops
from ...runtime.domain.trim import Trim
from ...runtime.surface.derivatives import Differentiable
from ...runtime.surface.moved import AffineMap, Moved
from ...runtime.surface.nurbs import Nurbs
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import CatalogueFunction
from .nets import SAME_END, curve_of_net, line_of, nurbs_of_curve, nurbs_of_net, nurbs_over
from .offset_surface import OffsetSurface, Turned
from .records import Geometry

Array = NDArray[np.float64]

TURN = 2.0 * math.pi
QUARTER = math.pi / 2.0
OPEN: BoundaryPair = ("open", "open")
PERIODIC: BoundaryPair = ("periodic", "periodic")
# A loop within this distance of the boundary of the domain, relative to the domain, counts as that
# boundary.
ON_BORDER = 1e-9


@dataclass(frozen=True)
class Shape:
    """A surface without its trim: its function in its own frame, and its boundary conditions.

    If `collapses`, sides of the domain may be collapsed to a point, and have to be tested.
    """

    function: Differentiable
    domain: Domain
    boundary: Boundary
    placement: AffineMap | None = None
    collapses: bool = False


def face_surface(
    geometry: Geometry,
    domain: Sequence[Sequence[float]],
    loops: Sequence[Array] = (),
    *,
    is_reversed: bool = False,
    name: str = "face",
) -> Surface:
    """Return the surface of a geometry over the bounding box of the loops, with its trim.

    If `is_reversed`, its normals are opposite to x_u × x_v of the geometry, and u is reversed:
    `own_parameters` returns the parameters of the file. Raises InputError for numbers that define
    no surface.
    """
    if geometry.surface is not None:  # with its own domain and trim
        surface = replace(geometry.surface, name=name)
        return surface.flipped() if is_reversed else surface
    shape = _shape(geometry, checked_domain(domain))
    ends, assumed = (shape.domain, shape.boundary), (shape.collapses, shape.collapses)
    trim, function = None, shape.function
    if len(loops) and not _is_whole(loops, shape.domain):
        trim = Trim(*ends, (checked_loops(loops, *ends),))
    if shape.placement is None:
        surface = Surface(name, function, *ends, trim=trim, assumed_open=assumed)
        return surface.flipped() if is_reversed else surface
    # A face with a frame of its own is placed and reversed in one step, since such faces are
    # numerous. Reversing u keeps the boundary conditions, since both ends of u have the same one.
    moved = Moved(Surface(name, function, *ends), shape.placement, is_reversed, shape.domain[0])
    if is_reversed and trim is not None:
        trim = trim.turned(shape.boundary)
    return Surface(name, moved, *ends, trim=trim, assumed_open=assumed)


def own_parameters(surface: Surface, uv: Array, *, is_reversed: bool) -> Array:
    """Convert parameters (k, 2) of the surface of a face to those of the file, or back.

    If the face is reversed, u is reversed.
    """
    if not is_reversed:
        return uv
    total = sum(surface.domain[0])
    return np.stack([total - uv[:, 0], uv[:, 1]], axis=1)


def _is_whole(loops: Sequence[Array], domain: Domain) -> bool:
    """Return whether the only loop is the boundary of the whole domain."""
    if len(loops) != 1:
        return False
    (loop,) = loops
    low, high = np.array(domain).T
    places = (loop - low) / (high - low)
    at_border = np.minimum(np.abs(places), np.abs(places - 1.0)).min(axis=1) <= ON_BORDER
    if not at_border.all():
        return False
    x, y = places.T
    area = (x[:-1] @ y[1:] - y[:-1] @ x[1:] + x[-1] * y[0] - y[-1] * x[0]) / 2.0
    return abs(abs(area) - 1.0) <= 4.0 * ON_BORDER


# --- kinds ----------------------------------------------------------------------------------------


def _shape(geometry: Geometry, domain: Domain) -> Shape:
    """Return the surface of a geometry; InputError for an unknown kind."""
    if geometry.kind not in BUILDERS:
        raise InputError(f"a face of the kind {geometry.kind!r} has no surface.")
    return BUILDERS[geometry.kind](geometry, domain)


def _placement(numbers: Array) -> AffineMap:
    origin, *axes = np.asarray(numbers[:12], dtype=np.float64).reshape(4, 3)
    return AffineMap(np.stack(axes, axis=1), origin)


def _plane(geometry: Geometry, domain: Domain) -> Shape:
    function = CatalogueFunction("plane", (0.0, 0.0))
    return Shape(function, domain, (OPEN, OPEN), _placement(geometry.numbers))


def _cylinder(geometry: Geometry, domain: Domain) -> Shape:
    function = CatalogueFunction("cylinder", (float(geometry.numbers[12]), 1.0))
    around, ends = _around(domain[0])
    return Shape(function, (around, domain[1]), (ends, OPEN), _placement(geometry.numbers))


def _cone(geometry: Geometry, domain: Domain) -> Shape:
    radius, angle = geometry.numbers[12:].tolist()
    start, way = np.array([radius, 0.0, 0.0]), np.array([math.sin(angle), 0.0, math.cos(angle)])
    around, ends = _around(domain[0])
    return Shape(
        Turned(line_of(start, way, domain[1])),
        (around, domain[1]),
        (ends, OPEN),
        _placement(geometry.numbers),
        collapses=True,
    )


def _sphere(geometry: Geometry, domain: Domain) -> Shape:
    """Return a sphere: a torus whose first radius is 0, restricted between the poles."""
    function = CatalogueFunction("torus", (0.0, float(geometry.numbers[12])))
    around, ends = _around(domain[0])
    slack = SAME_END * TURN
    low, high = (
        math.copysign(QUARTER, x) if abs(abs(x) - QUARTER) <= slack else x for x in domain[1]
    )
    at_poles = tuple(
        "pole" if abs(x) == QUARTER and ends == PERIODIC else "open" for x in (low, high)
    )
    boundary = cast(Boundary, (ends, at_poles))
    return Shape(
        function, (around, (low, high)), boundary, _placement(geometry.numbers), ends != PERIODIC
    )


def _torus(geometry: Geometry, domain: Domain) -> Shape:
    major, minor = geometry.numbers[12:].tolist()
    function = CatalogueFunction("torus", (major, minor))
    (around, ends), (across, ends_across) = map(_around, domain)
    return Shape(
        function,
        (around, across),
        (ends, ends_across),
        _placement(geometry.numbers),
        abs(major) <= abs(minor),
    )


def _nurbs(geometry: Geometry, domain: Domain) -> Shape:
    assert geometry.net is not None
    return _of_nurbs(nurbs_over(nurbs_of_net(geometry.net), domain))


def _extrusion(geometry: Geometry, domain: Domain) -> Shape:
    assert geometry.net is not None
    nurbs = nurbs_of_curve(geometry.net, np.asarray(geometry.numbers), domain[1])
    return replace(_of_nurbs(nurbs_over(nurbs, domain)), collapses=False)


def _of_nurbs(nurbs: Nurbs) -> Shape:
    u, v = (PERIODIC if closes else OPEN for closes in nurbs.periodic)
    return Shape(nurbs, nurbs.domain, (u, v), None, collapses=True)


def _revolution(geometry: Geometry, domain: Domain) -> Shape:
    """Return a curve turned about the z axis of a frame with an arbitrary x axis."""
    assert geometry.net is not None
    origin, axis = np.asarray(geometry.numbers).reshape(2, 3)
    frame = _frame(axis)
    net = replace(geometry.net, points=(geometry.net.points - origin) @ frame)
    around, ends = _around(domain[0])
    curve = nurbs_over(curve_of_net(net), (domain[1], (0.0, 1.0)))
    across = PERIODIC if curve.periodic[0] else OPEN
    placement = AffineMap(frame, origin)
    return Shape(Turned(curve), (around, curve.domain[0]), (ends, across), placement, True)


def _frame(axis: Array) -> Array:
    """Return a rotation (3, 3) whose last column is an axis."""
    z = axis / np.linalg.norm(axis)
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1).astype(np.float64)


def _around(interval: Interval) -> tuple[Interval, BoundaryPair]:
    """Return the interval of an angle and its boundary conditions.

    An interval of nearly one turn is periodic, and becomes exactly one turn.
    """
    low, high = interval
    if abs(high - low - TURN) <= SAME_END * TURN:
        return (low, low + TURN), PERIODIC
    return interval, OPEN


# --- offsets --------------------------------------------------------------------------------------


def _offset(geometry: Geometry, domain: Domain) -> Shape:
    """Return an offset surface.

    Offsets of planes, cylinders, cones, spheres and most tori are surfaces of the same kind.
    """
    simple = simplest(geometry, domain)
    if simple.kind != "offset":
        return _shape(simple, domain)
    assert simple.basis is not None
    shape, distance = _shape(simple.basis, domain), float(simple.numbers[0])
    if shape.placement is not None and shape.placement.reflects:
        distance = -distance
    return replace(
        shape, function=OffsetSurface(shape.function, distance, shape.domain), collapses=True
    )


def simplest(geometry: Geometry, domain: Domain) -> Geometry:
    """Replace an offset of a plane, cylinder, cone, sphere or torus by a surface of that kind.

    Other geometries, among them offsets of a torus that meets its own axis, are returned with the
    simplest basis.
    """
    if geometry.kind != "offset" or geometry.basis is None:
        return geometry
    basis = simplest(geometry.basis, domain)
    numbers = _moved_numbers(basis, float(geometry.numbers[0]), domain)
    if numbers is None:
        return replace(geometry, basis=basis)
    return replace(basis, numbers=numbers)


def _moved_numbers(basis: Geometry, distance: float, domain: Domain) -> Array | None:
    """Return the numbers of an offset as a surface of the same kind as its basis, or None.

    None means that the offset is not of that kind. The distance is along x_u × x_v, which points
    away from the axis if the frame is right-handed and the radius positive.
    """
    if basis.kind not in ("plane", "cylinder", "cone", "sphere", "torus"):
        return None
    numbers = np.array(basis.numbers, dtype=np.float64)
    z, middle = numbers[9:12], sum(domain[1]) / 2.0
    moved = distance * float(np.sign(np.linalg.det(numbers[3:12].reshape(3, 3))))
    if basis.kind == "plane":
        numbers[:3] += moved * z
    elif basis.kind in ("cylinder", "sphere"):
        numbers[12] += moved
    elif basis.kind == "cone":
        radius, angle = numbers[12:]
        moved *= math.copysign(1.0, radius + middle * math.sin(angle))
        numbers[:3] -= moved * math.sin(angle) * z
        numbers[12] += moved * math.cos(angle)
    elif abs(numbers[12]) > abs(numbers[13]):
        numbers[13] += moved
    else:  # the torus meets its axis, and its normal changes sides there
        return None
    return numbers


BUILDERS: dict[str, Callable[[Geometry, Domain], Shape]] = {
    "plane": _plane,
    "cylinder": _cylinder,
    "cone": _cone,
    "sphere": _sphere,
    "torus": _torus,
    "nurbs": _nurbs,
    "extrusion": _extrusion,
    "revolution": _revolution,
    "offset": _offset,
}
