"""The catalogue of parametric surfaces: exact positions, domains, boundary conditions."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import sympy as sp

from .jet import AT_JET
from .notation import substitute
from .patch import VECTORS

Triple = tuple[sp.Expr, sp.Expr, sp.Expr]
BoundaryCondition = Literal["open", "periodic", "mirrored", "pole"]
BoundaryPair = tuple[BoundaryCondition, BoundaryCondition]
Boundary = tuple[BoundaryPair, BoundaryPair]

OPEN: BoundaryPair = ("open", "open")
PERIODIC: BoundaryPair = ("periodic", "periodic")
MIRRORED: BoundaryPair = ("mirrored", "mirrored")
POLES: BoundaryPair = ("pole", "pole")

u, v = sp.symbols("u v", real=True)


@dataclass(frozen=True)
class Parameter:
    """A number that a user may choose; it must be greater than zero if `positive`."""

    symbol: sp.Symbol
    default: sp.Expr
    sentence: str
    positive: bool = True


@dataclass(frozen=True)
class ParametricSurface:
    """A surface x(u,v) over the rectangle [u0,u1] × [v0,v1], and its boundary conditions.

    `boundary` holds, for u and for v, the conditions at the lower and at the upper bound:

    - "open": the surface has an edge here, or is cut off;
    - "periodic": periodic, x(u1 + s, v) = x(u0 + s, v);
    - "mirrored": periodic with a mirror image, x(u1 + s, v) = x(u0 + s, v0 + v1 − v);
    - "pole": this side of v is collapsed to a point; the opposite meridian continues the surface,
      x(u, v1 − s) = x(u + (u1 − u0)/2, v1 + s).
    """

    name: str
    sentence: str
    position: Triple
    u: sp.Symbol
    v: sp.Symbol
    parameters: tuple[Parameter, ...]
    domain: tuple[tuple[sp.Expr, sp.Expr], tuple[sp.Expr, sp.Expr]]
    boundary: Boundary

    def __post_init__(self) -> None:
        """Refuse unknown symbols, invalid domains and contradictory boundary conditions."""
        if not self.name.isidentifier():
            raise ValueError(f"{self.name!r} is not an identifier")
        known = {self.u, self.v, *self.defaults}
        if unknown := sp.Tuple(*self.position).free_symbols - known:
            raise ValueError(f"{self.name}: unknown symbols {sorted(map(str, unknown))}")
        for low, high in self.domain:
            if low.free_symbols | high.free_symbols or not (high - low).is_positive:
                raise ValueError(f"{self.name}: [{low}, {high}] is not an interval of numbers")
        along_u, along_v = self.boundary
        for low, high in self.boundary:
            if unknown := {low, high} - set(get_args(BoundaryCondition)):
                raise ValueError(f"{self.name}: unknown boundary conditions {sorted(unknown)}")
            if low != high and not {low, high} <= {"open", "pole"}:
                raise ValueError(f"{self.name}: {low!r} cannot stand opposite {high!r}")
        if "pole" in along_u or ("pole" in along_v and along_u != PERIODIC):
            raise ValueError(
                f"{self.name}: a pole needs to be at an end of v, and u to be periodic"
            )

    @property
    def defaults(self) -> dict[sp.Symbol, sp.Expr]:
        """The default value of each parameter."""
        return {parameter.symbol: parameter.default for parameter in self.parameters}

    def derivative(self, *by: sp.Symbol) -> sp.Matrix:
        """Return the derivative of the position by the symbols `by`; without any, the position."""
        return sp.Matrix([sp.diff(x, *by) if by else x for x in self.position])

    @cached_property
    def normal_field(self) -> Triple:
        """The normal x_u × x_v, not normalized."""
        x, y, z = self.derivative(self.u).cross(self.derivative(self.v))
        return x, y, z

    @property
    def gaussian_curvature(self) -> sp.Expr:
        """The Gaussian curvature K = (L N − M²)/(E G − F²), not simplified."""
        return self._at_jet["K"]

    @property
    def mean_curvature(self) -> sp.Expr:
        """The mean curvature, positive on a sphere with outward normals, not simplified."""
        return self._at_jet["H"]

    @cached_property
    def _at_jet(self) -> dict[str, sp.Expr]:
        """The outputs of the formula `at_jet` for the derivatives of the position."""
        u, v = self.u, self.v
        jet = [self.derivative(*by) for by in ((u, u), (u, v), (v, v), (u,), (v,))]
        values = {
            symbol: value
            for vector, derivative in zip(VECTORS, jet, strict=True)
            for symbol, value in zip(vector.components, derivative.flat(), strict=True)
        }
        return {name: substitute(x, values) for name, x in AT_JET.expanded().items()}


# --- the catalogue --------------------------------------------------------------------------------

TURN = (sp.Integer(0), 2 * sp.pi)
UNIT = (sp.Integer(0), sp.Integer(1))
SYMMETRIC = (sp.Integer(-1), sp.Integer(1))

a, b, c, d = sp.symbols("a b c d", positive=True)
major, minor, radius, bottom, top = sp.symbols("major minor radius bottom top", positive=True)
height, half_width, pitch, scale = sp.symbols("height half_width pitch scale", positive=True)
amplitude, frequency, slope_u, slope_v = sp.symbols(
    "amplitude frequency slope_u slope_v", real=True
)

TORUS = ParametricSurface(
    name="torus",
    sentence="The torus around the z axis; u is the angle around the axis, v the angle around the "
    "tube, from its outer equator upwards. Normals point out of the tube.",
    position=(
        (major + minor * sp.cos(v)) * sp.cos(u),
        (major + minor * sp.cos(v)) * sp.sin(u),
        minor * sp.sin(v),
    ),
    u=u,
    v=v,
    parameters=(
        Parameter(major, sp.Rational(1), "The radius of the circle in the middle of the tube."),
        Parameter(
            minor,
            sp.Rational(7, 20),
            "The radius of the tube; from major on, the torus meets itself on the axis, where it "
            "has singular points.",
        ),
    ),
    domain=(TURN, TURN),
    boundary=(PERIODIC, PERIODIC),
)

SEMI_AXES = (
    Parameter(a, sp.Rational(1), "The semi-axis along x."),
    Parameter(b, sp.Rational(3, 5), "The semi-axis along y."),
    Parameter(c, sp.Rational(3, 10), "The semi-axis along z."),
)

ELLIPSOID = ParametricSurface(
    name="ellipsoid",
    sentence="The whole ellipsoid x²/a² + y²/b² + z²/c² = 1 with the longitude u and the latitude "
    "v of the sphere that is stretched, poles at z = ±c, and outward normals.",
    position=(a * sp.cos(u) * sp.cos(v), b * sp.sin(u) * sp.cos(v), c * sp.sin(v)),
    u=u,
    v=v,
    parameters=SEMI_AXES,
    domain=(TURN, (-sp.pi / 2, sp.pi / 2)),
    boundary=(PERIODIC, POLES),
)

ELLIPSOID_PATCH = ParametricSurface(
    name="ellipsoid_patch",
    sentence="The belt of the ellipsoid between the latitudes v = ±π/3, without its poles, with "
    "the longitude u and outward normals.",
    position=ELLIPSOID.position,
    u=u,
    v=v,
    parameters=SEMI_AXES,
    domain=(TURN, (-sp.pi / 3, sp.pi / 3)),
    boundary=(PERIODIC, OPEN),
)

SPHERE = ParametricSurface(
    name="sphere",
    sentence="The whole sphere around the origin, with the longitude u, the latitude v, poles on "
    "the z axis, and outward normals.",
    position=(radius * sp.cos(u) * sp.cos(v), radius * sp.sin(u) * sp.cos(v), radius * sp.sin(v)),
    u=u,
    v=v,
    parameters=(Parameter(radius, sp.Rational(1), "The radius."),),
    domain=(TURN, (-sp.pi / 2, sp.pi / 2)),
    boundary=(PERIODIC, POLES),
)

HYPERBOLOID = ParametricSurface(
    name="hyperboloid",
    sentence="The hyperboloid of one sheet x²/a² + y²/b² − z²/c² = 1, cut off at z = ±c sinh 1; u "
    "goes around the z axis, v along it. Normals point away from the axis.",
    position=(a * sp.cosh(v) * sp.cos(u), b * sp.cosh(v) * sp.sin(u), c * sp.sinh(v)),
    u=u,
    v=v,
    parameters=(
        Parameter(a, sp.Rational(1), "The semi-axis of the waist along x."),
        Parameter(b, sp.Rational(4, 5), "The semi-axis of the waist along y."),
        Parameter(c, sp.Rational(1), "The semi-axis along z, imaginary: the waist is at z = 0."),
    ),
    domain=(TURN, SYMMETRIC),
    boundary=(PERIODIC, OPEN),
)

ELLIPTIC_PARABOLOID = ParametricSurface(
    name="elliptic_paraboloid",
    sentence="The graph z = x²/a² + y²/b² of x = u and y = v, with upward normals, which point to "
    "its inside.",
    position=(u, v, u**2 / a**2 + v**2 / b**2),
    u=u,
    v=v,
    parameters=(
        Parameter(a, sp.Rational(1), "The semi-axis along x of the ellipse at z = 1."),
        Parameter(b, sp.Rational(3, 2), "The semi-axis along y of the ellipse at z = 1."),
    ),
    domain=(SYMMETRIC, SYMMETRIC),
    boundary=(OPEN, OPEN),
)

HYPERBOLIC_PARABOLOID = ParametricSurface(
    name="hyperbolic_paraboloid",
    sentence="The saddle z = x²/a² − y²/b², a graph of x = u and y = v with upward normals.",
    position=(u, v, u**2 / a**2 - v**2 / b**2),
    u=u,
    v=v,
    parameters=(
        Parameter(a, sp.Rational(1), "The semi-axis along x of the hyperbola at z = 1."),
        Parameter(b, sp.Rational(3, 2), "The semi-axis along y of the hyperbola at z = −1."),
    ),
    domain=(SYMMETRIC, SYMMETRIC),
    boundary=(OPEN, OPEN),
)

MONKEY_SADDLE = ParametricSurface(
    name="monkey_saddle",
    sentence="The monkey saddle z = scale (x³ − 3 x y²), a graph of x = u and y = v with upward "
    "normals and a flat point at the origin.",
    position=(u, v, scale * (u**3 - 3 * u * v**2)),
    u=u,
    v=v,
    parameters=(Parameter(scale, sp.Rational(1, 2), "The factor of the heights."),),
    domain=(SYMMETRIC, SYMMETRIC),
    boundary=(OPEN, OPEN),
)

ENNEPER = ParametricSurface(
    name="enneper",
    sentence="Enneper's minimal surface, without the self-intersections that it has farther out, "
    "in conformal parameters, with its normal at the origin pointing upwards.",
    position=(
        scale * (u - u**3 / 3 + u * v**2),
        scale * (v - v**3 / 3 + v * u**2),
        scale * (u**2 - v**2),
    ),
    u=u,
    v=v,
    parameters=(Parameter(scale, sp.Rational(1), "The factor of the size."),),
    domain=(SYMMETRIC, SYMMETRIC),
    boundary=(OPEN, OPEN),
)

CATENOID = ParametricSurface(
    name="catenoid",
    sentence="The minimal surface √(x² + y²) = radius cosh(z/radius), cut off at z = ±radius; u is "
    "the angle around the z axis, v = z/radius. Normals point away from the axis.",
    position=(radius * sp.cosh(v) * sp.cos(u), radius * sp.cosh(v) * sp.sin(u), radius * v),
    u=u,
    v=v,
    parameters=(Parameter(radius, sp.Rational(1), "The radius of the waist."),),
    domain=(TURN, SYMMETRIC),
    boundary=(PERIODIC, OPEN),
)

HELICOID = ParametricSurface(
    name="helicoid",
    sentence="One turn of the right-handed helicoid; u is the signed distance from the z axis, v "
    "the angle. Normals point upwards where u > 0 and downwards where u < 0.",
    position=(u * sp.cos(v), u * sp.sin(v), pitch * v),
    u=u,
    v=v,
    parameters=(Parameter(pitch, sp.Rational(1, 2), "The rise per radian."),),
    domain=(SYMMETRIC, (-sp.pi, sp.pi)),
    boundary=(OPEN, OPEN),
)

MOEBIUS_BAND = ParametricSurface(
    name="moebius_band",
    sentence="The Möbius band around the z axis; u is the angle around the axis, v runs across. It "
    "is upright at u = 0, where its normal points away from the axis; after one turn the normal is "
    "opposite.",
    position=(
        (radius + half_width * v * sp.sin(u / 2)) * sp.cos(u),
        (radius + half_width * v * sp.sin(u / 2)) * sp.sin(u),
        half_width * v * sp.cos(u / 2),
    ),
    u=u,
    v=v,
    parameters=(
        Parameter(radius, sp.Rational(1), "The radius of the circle in the middle of the band."),
        Parameter(half_width, sp.Rational(2, 5), "Half the width of the band, less than radius."),
    ),
    domain=(TURN, SYMMETRIC),
    boundary=(MIRRORED, OPEN),
)

_focus = sp.sqrt(a**2 - b**2)
_weight = a - _focus * sp.cos(u) * sp.cos(v)

DUPIN_CYCLIDE = ParametricSurface(
    name="dupin_cyclide",
    sentence="The ring cyclide round the ellipse x²/a² + y²/b² = 1, on which spheres of radius d − "
    "x √(a² − b²)/a are centred, in lines of curvature u, v, with normals pointing outwards.",
    position=(
        (d * (_focus - a * sp.cos(u) * sp.cos(v)) + b**2 * sp.cos(u)) / _weight,
        b * sp.sin(u) * (a - d * sp.cos(v)) / _weight,
        b * sp.sin(v) * (_focus * sp.cos(u) - d) / _weight,
    ),
    u=u,
    v=v,
    parameters=(
        Parameter(a, sp.Rational(1), "The semi-axis of the ellipse along x."),
        Parameter(b, sp.Rational(24, 25), "The semi-axis of the ellipse along y, at most a."),
        Parameter(
            d, sp.Rational(1, 2), "The mean radius of the tube, √(a² − b²) < d < a for a ring."
        ),
    ),
    domain=(TURN, TURN),
    boundary=(PERIODIC, PERIODIC),
)

WAVY_GRAPH = ParametricSurface(
    name="wavy_graph",
    sentence="The graph z = amplitude sin(frequency x) cos(frequency y) of x = u and y = v, with "
    "upward normals.",
    position=(u, v, amplitude * sp.sin(frequency * u) * sp.cos(frequency * v)),
    u=u,
    v=v,
    parameters=(
        Parameter(amplitude, sp.Rational(1, 5), "The height of the waves.", positive=False),
        Parameter(frequency, sp.Rational(3), "Radians per unit of length.", positive=False),
    ),
    domain=(SYMMETRIC, SYMMETRIC),
    boundary=(OPEN, OPEN),
)

CYLINDER = ParametricSurface(
    name="cylinder",
    sentence="The circular cylinder around the z axis; u is the angle, v = z/height. Normals point "
    "away from the axis.",
    position=(radius * sp.cos(u), radius * sp.sin(u), height * v),
    u=u,
    v=v,
    parameters=(
        Parameter(radius, sp.Rational(1), "The radius."),
        Parameter(height, sp.Rational(2), "The height."),
    ),
    domain=(TURN, UNIT),
    boundary=(PERIODIC, OPEN),
)

_distance = bottom + (top - bottom) * v

CONE = ParametricSurface(
    name="cone",
    sentence="The frustum of a circular cone around the z axis, without its apex; u is the angle, "
    "v = z/height. Normals point away from the axis.",
    position=(_distance * sp.cos(u), _distance * sp.sin(u), height * v),
    u=u,
    v=v,
    parameters=(
        Parameter(bottom, sp.Rational(1), "The radius at z = 0."),
        Parameter(top, sp.Rational(1, 2), "The radius at z = height."),
        Parameter(height, sp.Rational(1), "The height."),
    ),
    domain=(TURN, UNIT),
    boundary=(PERIODIC, OPEN),
)

PLANE = ParametricSurface(
    name="plane",
    sentence="The plane z = slope_u x + slope_v y, a graph of x = u and y = v with upward normals.",
    position=(u, v, slope_u * u + slope_v * v),
    u=u,
    v=v,
    parameters=(
        Parameter(slope_u, sp.Rational(0), "The slope along x.", positive=False),
        Parameter(slope_v, sp.Rational(0), "The slope along y.", positive=False),
    ),
    domain=(SYMMETRIC, SYMMETRIC),
    boundary=(OPEN, OPEN),
)

CATALOGUE: dict[str, ParametricSurface] = {
    surface.name: surface
    for surface in (
        TORUS,
        ELLIPSOID,
        ELLIPSOID_PATCH,
        SPHERE,
        HYPERBOLOID,
        ELLIPTIC_PARABOLOID,
        HYPERBOLIC_PARABOLOID,
        MONKEY_SADDLE,
        ENNEPER,
        CATENOID,
        HELICOID,
        MOEBIUS_BAND,
        DUPIN_CYCLIDE,
        WAVY_GRAPH,
        CYLINDER,
        CONE,
        PLANE,
    )
}
