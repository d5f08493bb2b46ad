"""The dimensions of planes, cylinders, cones, spheres and tori: axes, centres, radii."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...runtime.base.aliases import Array
from .records import Geometry

Dimensions = dict[str, Any]


def dimensions_of(
    geometry: Geometry, domain: Sequence[Sequence[float]], is_reversed: bool
) -> Dimensions:
    """Return the dimensions of a geometry, by name, as `Face.dimensions` has them.

    The module `saving` describes the numbers of a geometry.
    """
    if geometry.kind not in ("plane", "cylinder", "cone", "sphere", "torus"):
        return {}
    origin, x, y, z = geometry.numbers[:12].reshape(4, 3).copy()
    sizes = geometry.numbers[12:].tolist()
    # If the frame is right-handed, x_u × x_v points outward; on a plane, it points along z.
    outward = is_reversed == bool(np.cross(x, y) @ z < 0.0)
    if geometry.kind == "plane":
        return {"point": origin, "normal": z if outward else -z}
    if geometry.kind == "cone":
        found = _cone(origin, z, sizes, sum(domain[1]) / 2.0)
    elif geometry.kind == "cylinder":
        found = {"point": origin, "axis": z, "radius": sizes[0]}
    elif geometry.kind == "sphere":
        found = {"centre": origin, "radius": sizes[0]}
    else:
        major, minor = sizes
        found = {"centre": origin, "axis": z, "major_radius": major, "minor_radius": minor}
    return {**found, "hollow": not outward} if found else {}


def _cone(origin: Array, z: Array, sizes: Sequence[float], v: float) -> Dimensions:
    """Return the dimensions of a cone; an empty dict if its angle is zero.

    `v` is the middle of the domain along v. It tells on which nappe of the cone the face lies: the
    axis points from the apex to this nappe.
    """
    radius, angle = sizes
    if angle == 0.0:
        return {}
    wider = math.copysign(1.0, angle) * math.copysign(1.0, radius + v * math.sin(angle))
    return {
        "apex": origin - radius / math.tan(angle) * z,
        "axis": wider * z,
        "half_angle": math.degrees(abs(angle)),
    }
