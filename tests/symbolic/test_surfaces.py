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


def values(surface: ParametricSurface, expressions, places, symbols=(u, v)) -> np.ndarray:
    """Return the expressions, with default parameters, at places: values of the symbols."""
    exact = [sp.sympify(e).subs(surface.defaults) for e in expressions]
    computed = sp.lambdify(symbols, exact, "numpy", cse=True)(*places)
    return np.array([np.broadcast_to(x, places[0].shape) for x in computed], float)


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


# --- normals and curvatures -----------------------------------------------------------------------


@each_surface()
def test_no_singular_points(surface):
    lengths = np.linalg.norm(values(surface, surface.normal_field, grid(surface)), axis=0)
    assert lengths.min() > 0.01 * lengths.max()


@each_surface(list(ORIENTED_EQUATIONS))
def test_normals_and_curvatures_are_those_of_the_equation(surface):
    """With gradient g and Hessian F of f, K = g·adj(F) g / |g|⁴ and 2 H = div(g / |g|)."""
    equation, places = ORIENTED_EQUATIONS[surface.name], grid(surface)
    g, F = sp.Matrix([equation]).jacobian((x, y, z)).T, sp.hessian(equation, (x, y, z))
    K = g.dot(F.adjugate() * g) / g.dot(g) ** 2
    H = (g.dot(g) * F.trace() - g.dot(F * g)) / (2 * g.norm() ** 3)
    points = values(surface, surface.position, places)
    *gradients, K, H = values(surface, (*g, K, H), points, (x, y, z))
    normals = values(surface, surface.normal_field, places)
    normals, gradients = (n / np.linalg.norm(n, axis=0) for n in (normals, np.array(gradients)))
    np.testing.assert_allclose(normals, gradients, rtol=0, atol=1e-12)
    curvatures = values(surface, (surface.gaussian_curvature, surface.mean_curvature), places)
    np.testing.assert_allclose(curvatures, [K, H], rtol=1e-9, atol=1e-12)


def test_the_surface_of_enneper_is_minimal():
    surface = CATALOGUE["enneper"]
    K = -4 / (scale**2 * (1 + u**2 + v**2) ** 4)
    assert same(sp.Matrix([surface.gaussian_curvature, surface.mean_curvature]), sp.Matrix([K, 0]))
