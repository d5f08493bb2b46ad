"""The catalogue keeps what it promises: equations, ends, orientation, curvature."""

import keyword
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from gaussmap.symbolic.surfaces import CATALOGUE, ParametricSurface, u, v

from ..refusals import refused

NAMES = list(CATALOGUE)

a, b, c, d = sp.symbols("a b c d", positive=True)
major, minor, radius, bottom, top = sp.symbols("major minor radius bottom top", positive=True)
height, pitch, scale = sp.symbols("height pitch scale", positive=True)
amplitude, frequency = sp.symbols("amplitude frequency", real=True)
slope_u, slope_v = sp.symbols("slope_u slope_v", real=True)
s, x, y, z = sp.symbols("s x y z", real=True)

ELLIPSOID = (x / a) ** 2 + (y / b) ** 2 + (z / c) ** 2 - 1
CYCLIDE = (
    (x**2 + y**2 + z**2 + b**2 - d**2) ** 2
    - 4 * (a * x - sp.sqrt(a**2 - b**2) * d) ** 2
    - 4 * b**2 * y**2
)

# f = 0 on the surface, and f grows to the side to which the normal is to point
ORIENTED_EQUATIONS = {
    "torus": (x**2 + y**2 + z**2 + major**2 - minor**2) ** 2 - 4 * major**2 * (x**2 + y**2),
    "ellipsoid": ELLIPSOID,
    "ellipsoid_patch": ELLIPSOID,
    "sphere": x**2 + y**2 + z**2 - radius**2,
    "hyperboloid": (x / a) ** 2 + (y / b) ** 2 - (z / c) ** 2 - 1,
    "elliptic_paraboloid": z - (x / a) ** 2 - (y / b) ** 2,
    "hyperbolic_paraboloid": z - (x / a) ** 2 + (y / b) ** 2,
    "monkey_saddle": z - scale * (x**3 - 3 * x * y**2),
    "catenoid": x**2 + y**2 - radius**2 * sp.cosh(z / radius) ** 2,
    "helicoid": x * sp.sin(z / pitch) - y * sp.cos(z / pitch),
    "dupin_cyclide": CYCLIDE,
    "wavy_graph": z - amplitude * sp.sin(frequency * x) * sp.cos(frequency * y),
    "cylinder": x**2 + y**2 - radius**2,
    "cone": x**2 + y**2 - (bottom + (top - bottom) * z / height) ** 2,
    "plane": z - slope_u * x - slope_v * y,
}

EQUATIONS = ORIENTED_EQUATIONS | {
    "enneper": (
        ((y**2 - x**2) / (2 * scale * z) + 2 * z**2 / (9 * scale**2) + sp.Rational(2, 3)) ** 3
        - 6
        * (
            (y**2 - x**2) / (4 * scale * z)
            - (x**2 + y**2 + 8 * z**2 / 9) / (4 * scale**2)
            + sp.Rational(2, 9)
        )
        ** 2
    ),
    "moebius_band": y * (radius**2 - x**2 - y**2 - z**2) + 2 * z * (x**2 + y**2 - radius * x),
}

CYCLIDE_CURVATURES = (
    1 / (d - sp.sqrt(a**2 - b**2) * sp.cos(u)),
    sp.cos(v) / (d * sp.cos(v) - a),
)

GAUSSIAN_CURVATURE = {
    "torus": sp.cos(v) / (minor * (major + minor * sp.cos(v))),
    "ellipsoid": 1 / (a * b * c * (x**2 / a**4 + y**2 / b**4 + z**2 / c**4)) ** 2,
    "sphere": 1 / radius**2,
    "hyperboloid": -1 / (a * b * c * (x**2 / a**4 + y**2 / b**4 + z**2 / c**4)) ** 2,
    "enneper": -4 / (scale**2 * (1 + u**2 + v**2) ** 4),
    "catenoid": -1 / (radius**2 * sp.cosh(v) ** 4),
    "helicoid": -(pitch**2) / (pitch**2 + u**2) ** 2,
    "dupin_cyclide": CYCLIDE_CURVATURES[0] * CYCLIDE_CURVATURES[1],
    "cylinder": sp.Integer(0),
    "cone": sp.Integer(0),
    "plane": sp.Integer(0),
}

SLANT = sp.sqrt(height**2 + (top - bottom) ** 2)
MEAN_CURVATURE = dict.fromkeys(("enneper", "catenoid", "helicoid", "plane"), sp.Integer(0)) | {
    "torus": (major + 2 * minor * sp.cos(v)) / (2 * minor * (major + minor * sp.cos(v))),
    "sphere": 1 / radius,
    "dupin_cyclide": (CYCLIDE_CURVATURES[0] + CYCLIDE_CURVATURES[1]) / 2,
    "cylinder": 1 / (2 * radius),
    "cone": height / (2 * SLANT * (bottom + (top - bottom) * v)),
}


def each_surface(names=NAMES):
    return pytest.mark.parametrize("surface", [CATALOGUE[name] for name in names], ids=names)


def place(surface: ParametricSurface, at_u, at_v) -> sp.Matrix:
    """Return x(at_u, at_v)."""
    return sp.Matrix(surface.position).subs({u: at_u, v: at_v}, simultaneous=True)


def on_surface(equation, surface: ParametricSurface):
    return equation.subs(dict(zip((x, y, z), surface.position, strict=True)), simultaneous=True)


def same(left: sp.Matrix, right: sp.Matrix) -> bool:
    """Compare exactly; what SymPy does not cancel at once is compared to 25 digits at one point."""
    difference = left - right
    symbols = sorted(difference.free_symbols, key=str)
    point = {symbol: sp.Rational(k + 2, 2 * k + 5) for k, symbol in enumerate(symbols)}
    return all(abs(e.xreplace(point).evalf(30)) < 1e-25 for e in difference if e != 0)


def grid(surface: ParametricSurface, cells: int = 36) -> tuple[np.ndarray, np.ndarray]:
    """Return a grid of the domain: its ends belong to it, but for the poles."""
    lines = []
    for interval, ends in zip(surface.domain, surface.boundary, strict=True):
        low, high = map(float, interval)
        line = np.linspace(low, high, cells + 1)
        lines.append(line[int(ends[0] == "pole") : cells + 1 - int(ends[1] == "pole")])
    U, V = np.meshgrid(*lines, indexing="ij")
    return U, V


def values(surface: ParametricSurface, expressions, U, V) -> np.ndarray:
    """Return the expressions, with default parameters, at points of the domain."""
    exact = [sp.sympify(e).subs(surface.defaults) for e in expressions]
    computed = sp.lambdify((surface.u, surface.v), exact, "numpy", cse=True)(U, V)
    return np.array([np.broadcast_to(component, U.shape) for component in computed], float)


# --- the catalogue --------------------------------------------------------------------------------


@each_surface()
def test_parameters(surface):
    names = [parameter.symbol.name for parameter in surface.parameters]
    assert len({"u", "v", *names}) == len(names) + 2
    assert all(name.isidentifier() and not keyword.iskeyword(name) for name in names)
    assert sp.Tuple(*surface.position).free_symbols == {u, v, *surface.defaults}
    for parameter in surface.parameters:
        assert parameter.default.is_Rational
        assert bool(parameter.symbol.is_positive) == parameter.positive
        assert parameter.default > 0 or not parameter.positive


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"name": "a torus"}, "not an identifier"),
        ({"parameters": ()}, "unknown symbols"),
        ({"domain": ((0, 1), (1, 1))}, "not an interval"),
        ({"domain": ((0, 1), (0, major))}, "not an interval"),
        ({"boundary": (("periodic", "periodic"), ("loop", "loop"))}, "unknown boundary conditions"),
        ({"boundary": (("periodic", "open"), ("open", "open"))}, "cannot stand opposite"),
        ({"boundary": (("periodic", "mirrored"), ("open", "open"))}, "cannot stand opposite"),
        ({"boundary": (("pole", "pole"), ("periodic", "periodic"))}, "a pole needs"),
        ({"boundary": (("open", "open"), ("pole", "open"))}, "a pole needs"),
    ],
)
def test_what_is_no_surface_is_refused(change, complaint):
    if "domain" in change:
        change = {"domain": tuple(tuple(map(sp.sympify, ends)) for ends in change["domain"])}
    refused(complaint, replace, CATALOGUE["torus"], **change, error=ValueError)


# --- position -------------------------------------------------------------------------------------


@each_surface(list(EQUATIONS))
def test_the_equation_holds(surface):
    equation = on_surface(EQUATIONS[surface.name], surface)
    assert same(sp.Matrix([equation]), sp.zeros(1, 1))


@each_surface()
def test_what_lies_beyond_the_ends(surface):
    (u0, u1), (v0, v1) = surface.domain
    along_u, along_v = surface.boundary
    beyond_u, beyond_v = place(surface, u1 + s, v), place(surface, u, v1 + s)
    # Where nothing is said to be beyond an end, the surface does not close there in secret.
    assert same(beyond_u, place(surface, u0 + s, v)) == ("periodic" in along_u)
    assert same(beyond_v, place(surface, u, v0 + s)) == ("periodic" in along_v)
    assert same(beyond_u, place(surface, u0 + s, v0 + v1 - v)) == ("mirrored" in along_u)
    assert same(beyond_v, place(surface, u0 + u1 - u, v0 + s)) == ("mirrored" in along_v)
    for end, kind in zip((v0, v1), along_v, strict=True):
        opposite = place(surface, u + (u1 - u0) / 2, end + s)
        assert same(place(surface, u, end - s), opposite) == (kind == "pole")


# --- normals --------------------------------------------------------------------------------------


@each_surface()
def test_no_singular_points(surface):
    U, V = grid(surface)
    lengths = np.linalg.norm(values(surface, surface.normal_field, U, V), axis=0)
    assert lengths.min() > 0.01 * lengths.max()


@each_surface(list(ORIENTED_EQUATIONS))
def test_normals_point_where_the_sentence_says(surface):
    equation = ORIENTED_EQUATIONS[surface.name]
    gradient = [on_surface(equation.diff(axis), surface) for axis in (x, y, z)]
    U, V = grid(surface)
    normals = values(surface, surface.normal_field, U, V)
    gradients = values(surface, gradient, U, V)
    normals /= np.linalg.norm(normals, axis=0)
    gradients /= np.linalg.norm(gradients, axis=0)
    np.testing.assert_allclose(normals, gradients, rtol=0, atol=1e-12)


# --- curvature ------------------------------------------------------------------------------------


@each_surface(list(GAUSSIAN_CURVATURE))
def test_gaussian_curvature(surface):
    expected = on_surface(GAUSSIAN_CURVATURE[surface.name], surface)
    K, reference = values(surface, [surface.gaussian_curvature, expected], *grid(surface))
    np.testing.assert_allclose(K, reference, rtol=1e-9, atol=1e-12)


@each_surface(list(MEAN_CURVATURE))
def test_mean_curvature(surface):
    expected = MEAN_CURVATURE[surface.name]
    H, reference = values(surface, [surface.mean_curvature, expected], *grid(surface))
    np.testing.assert_allclose(H, reference, rtol=1e-9, atol=1e-12)
