"""Signatures of gaussmap.surfaces for type checkers and completion; nothing runs this.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

from ..runtime.surface.surface import Surface

def torus(major: float = 1.0, minor: float = 0.35) -> Surface:
    """The torus around the z axis; u is the angle around the axis, v the angle around the tube,
    from its outer equator upwards. Normals point out of the tube.
    """

def ellipsoid(a: float = 1.0, b: float = 0.6, c: float = 0.3) -> Surface:
    """The whole ellipsoid x²/a² + y²/b² + z²/c² = 1 with the longitude u and the latitude v of
    the sphere that is stretched, poles at z = ±c, and outward normals.
    """

def ellipsoid_patch(a: float = 1.0, b: float = 0.6, c: float = 0.3) -> Surface:
    """The belt of the ellipsoid between the latitudes v = ±π/3, without its poles, with the
    longitude u and outward normals.
    """

def sphere(radius: float = 1.0) -> Surface:
    """The whole sphere around the origin, with the longitude u, the latitude v, poles on the z
    axis, and outward normals.
    """

def hyperboloid(a: float = 1.0, b: float = 0.8, c: float = 1.0) -> Surface:
    """The hyperboloid of one sheet x²/a² + y²/b² − z²/c² = 1, cut off at z = ±c sinh 1; u goes
    around the z axis, v along it. Normals point away from the axis.
    """

def elliptic_paraboloid(a: float = 1.0, b: float = 1.5) -> Surface:
    """The graph z = x²/a² + y²/b² of x = u and y = v, with upward normals, which point to its
    inside.
    """

def hyperbolic_paraboloid(a: float = 1.0, b: float = 1.5) -> Surface:
    """The saddle z = x²/a² − y²/b², a graph of x = u and y = v with upward normals."""

def monkey_saddle(scale: float = 0.5) -> Surface:
    """The monkey saddle z = scale (x³ − 3 x y²), a graph of x = u and y = v with upward normals
    and a flat point at the origin.
    """

def enneper(scale: float = 1.0) -> Surface:
    """Enneper's minimal surface, without the self-intersections that it has farther out, in
    conformal parameters, with its normal at the origin pointing upwards.
    """

def catenoid(radius: float = 1.0) -> Surface:
    """The minimal surface √(x² + y²) = radius cosh(z/radius), cut off at z = ±radius; u is the
    angle around the z axis, v = z/radius. Normals point away from the axis.
    """

def helicoid(pitch: float = 0.5) -> Surface:
    """One turn of the right-handed helicoid; u is the signed distance from the z axis, v the
    angle. Normals point upwards where u > 0 and downwards where u < 0.
    """

def moebius_band(radius: float = 1.0, half_width: float = 0.4) -> Surface:
    """The Möbius band around the z axis; u is the angle around the axis, v runs across. It is
    upright at u = 0, where its normal points away from the axis; after one turn the normal is
    opposite.
    """

def dupin_cyclide(a: float = 1.0, b: float = 0.96, d: float = 0.5) -> Surface:
    """The ring cyclide round the ellipse x²/a² + y²/b² = 1, on which spheres of radius d − x
    √(a² − b²)/a are centred, in lines of curvature u, v, with normals pointing outwards.
    """

def wavy_graph(amplitude: float = 0.2, frequency: float = 3.0) -> Surface:
    """The graph z = amplitude sin(frequency x) cos(frequency y) of x = u and y = v, with upward
    normals.
    """

def cylinder(radius: float = 1.0, height: float = 2.0) -> Surface:
    """The circular cylinder around the z axis; u is the angle, v = z/height. Normals point away
    from the axis.
    """

def cone(bottom: float = 1.0, top: float = 0.5, height: float = 1.0) -> Surface:
    """The frustum of a circular cone around the z axis, without its apex; u is the angle, v =
    z/height. Normals point away from the axis.
    """

def plane(slope_u: float = 0.0, slope_v: float = 0.0) -> Surface:
    """The plane z = slope_u x + slope_v y, a graph of x = u and y = v with upward normals."""
