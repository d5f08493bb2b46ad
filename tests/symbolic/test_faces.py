"""Surfaces of revolution and offsets: their derivatives are those of what they describe."""

import mpmath
import sympy as sp
from gaussmap.symbolic.faces import OFFSET_JET, REVOLUTION_JET, TORUS_NORMAL

u, v = sp.symbols("u v", real=True)
PLACE = (mpmath.mpf(2) / 7, mpmath.mpf(-3) / 5)
# The orders of the derivatives of a 2-jet, by u and by v, and of third derivatives.
ORDERS = {"": (0, 0), "_u": (1, 0), "_v": (0, 1), "_uu": (2, 0), "_uv": (1, 1), "_vv": (0, 2)}
LETTERS = {"p": (0, 0), "d": (1, 0), "e": (0, 1), "a": (2, 0), "b": (1, 1), "c": (0, 2)}
THIRDS = {"x_uuu": (3, 0), "x_uuv": (2, 1), "x_uvv": (1, 2), "x_vvv": (0, 3)}


def derivatives(functions, orders):
    """Return the derivatives of three functions of u and v, by the names of their components."""
    return {
        f"{name}_{axis}": mpmath.diff(function, PLACE, order) if any(order) else function(*PLACE)
        for name, order in orders.items()
        for axis, function in zip("xyz", functions, strict=True)
    }


def compare(formula, inputs, wanted):
    plain = formula.in_components()
    found = {symbol: sp.Float(inputs[symbol.name]) for symbol in plain.inputs}
    for symbol, value in plain.definitions:
        found[symbol] = value.xreplace(found)
    assert {x.name for x in plain.outputs} == set(wanted)
    for symbol in plain.outputs:
        assert abs(found[symbol] - wanted[symbol.name]) < 1e-13 * max(1, abs(found[symbol]))


def functions_of(position):
    return [sp.lambdify((u, v), x, "mpmath") for x in position]


def test_the_revolution_of_a_twisted_curve():
    curve = sp.Matrix([2 + v**2, v - v**3, sp.exp(v)])
    inputs = derivatives(functions_of(curve), {"c": (0, 0), "c_v": (0, 1), "c_vv": (0, 2)})
    inputs |= {"x": mpmath.cos(PLACE[0]), "y": mpmath.sin(PLACE[0])}
    turned = functions_of(sp.rot_axis3(-u) * curve)
    orders = {f"x{name}" if name else "p": order for name, order in ORDERS.items()}
    compare(REVOLUTION_JET, inputs, derivatives(turned, orders))


def test_the_offset_of_a_surface_without_symmetries():
    position = sp.Matrix([u + v**2 / 3, v - u * v / 2, u**3 / 4 + u**2 * v - v**3 / 5 + u * v])
    field = sp.Matrix(position.diff(u)).cross(sp.Matrix(position.diff(v)))
    length, distance = sp.sqrt(field.dot(field)), sp.Rational(3, 10)
    inputs = derivatives(functions_of(position), LETTERS | THIRDS)
    inputs |= derivatives(functions_of(field / length), {"n": (0, 0)})
    inputs |= {"L": functions_of([length])[0](*PLACE), "R": distance}
    offset = functions_of(position + distance * field / length)
    compare(OFFSET_JET, inputs, derivatives(offset, {f"y{x}": y for x, y in ORDERS.items()}))


def test_the_normal_of_a_torus_that_meets_itself():
    """At the side of the tube that is across the axis, and at the other one."""
    for major in (mpmath.mpf(1) / 4, mpmath.mpf(-1) / 4, mpmath.mpf(0)):
        minor = mpmath.mpf(2) / 3
        distance = major + minor * sp.cos(v)
        position = [distance * sp.cos(u), distance * sp.sin(u), minor * sp.sin(v)]
        known = derivatives(functions_of(position), {"d": (1, 0), "e": (0, 1)})
        d, e = (sp.Matrix([known[f"{name}_{axis}"] for axis in "xyz"]) for name in "de")
        longitude, latitude = PLACE
        direction = sp.Matrix([
            mpmath.cos(longitude) * mpmath.cos(latitude),
            mpmath.sin(longitude) * mpmath.cos(latitude),
            mpmath.sin(latitude),
        ])  # fmt: skip
        inputs = {"R": major, "r": minor, "x": mpmath.cos(latitude)}
        compare(TORUS_NORMAL, inputs, {"q": d.cross(e).dot(direction)})
