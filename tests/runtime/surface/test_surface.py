"""Surfaces of callables and of SymPy expressions; what is no surface is refused in one sentence."""

import pickle
import subprocess
import sys
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.runtime.surface.derivatives import NAMES
from gaussmap.symbolic.reading import FUNCTIONS

from ...products import covering
from ...refusals import refused
from ...shapes import SQUARE, saddle, tube

TURN = ((0.0, 2 * np.pi), (0.0, 2 * np.pi))


def bowl(u, v):
    """Return the northern half of the unit sphere, whose pole is at v = 1."""
    angle = v * np.pi / 2
    return np.stack([np.cos(u) * np.cos(angle), np.sin(u) * np.cos(angle), np.sin(angle)], axis=-1)


def turned(f):
    """Return a surface with exchanged parameters."""
    return lambda u, v: f(v, u)


# --- domain and ends ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "domain",
    [[[0, 1], [0, 2]], np.array([[0, 1], [0, 2]]), (pair for pair in ((0, 1), iter((0, 2)))),
     ((sp.Integer(0), sp.Integer(1)), (0, sp.sqrt(4)))], ids=lambda x: type(x).__name__,
)  # fmt: skip
def test_domains(domain):
    assert gm.Surface.from_callable(saddle, domain).domain == ((0.0, 1.0), (0.0, 2.0))


@pytest.mark.parametrize(
    ("periodic", "ends"),
    [
        ((False, False), (("open", "open"), ("open", "open"))),
        (True, (("periodic", "periodic"), ("periodic", "periodic"))),
        (np.False_, (("open", "open"), ("open", "open"))),
        ((True, False), (("periodic", "periodic"), ("open", "open"))),
        ((np.True_, "open"), (("periodic", "periodic"), ("open", "open"))),
        ([False, "mirrored"], (("open", "open"), ("mirrored", "mirrored"))),
        ((True, "pole"), (("periodic", "periodic"), ("pole", "pole"))),
        (("periodic", ["open", "pole"]), (("periodic", "periodic"), ("open", "pole"))),
        (("periodic", ("pole", "open")), (("periodic", "periodic"), ("pole", "open"))),
        ((("open", "pole"), True), (("open", "pole"), ("periodic", "periodic"))),
    ],
)
def test_ends(periodic, ends):
    assert gm.Surface.from_callable(tube, TURN, periodic).boundary == ends


# What is given instead of a torus with open ends.
NO_CALLABLES = [
    *(({"domain": x}, f"domain of {name} is empty or infinite") for x, name in (
        (((0, 0), (0, 1)), "u"), (((0, 1), (1, 0)), "v"), (((-np.inf, 0), (0, 1)), "u"),
        (((0, 1), (0, np.nan)), "v"), (((-1e308, 1e308), (0, 1)), "u"),  # so is its length
    )),
    *(({"domain": x}, "domain must be") for x in (
        ((0, 10**400), (0, 1)), ((0, 1),), ((0, 1, 2), (0, 1)), (0, 1), "abcd", None,
        (("a", 1), (0, 1)), ((0j, 1), (0, 1)),
    )),
    *(({"periodic": x}, "must be a pair") for x in (None, "periodic", (True,))),
    *(({"periodic": x}, f"periodic for {name} must be True, False") for x, name in (
        ((1, 0), "u"), ((None, False), "u"), ((False, "poles"), "v"), ((("periodic",), False), "u"),
    )),
    *(({"periodic": x}, f"both ends of {name}") for x, name in (
        ((("periodic", "open"), False), "u"), ((True, ("periodic", "pole")), "v"),
        ((("periodic", "mirrored"), False), "u"),
    )),
    *(({"periodic": x}, 'a "pole" of u needs v to be periodic') for x in (
        ("pole", "pole"), ("pole", False),
    )),
    *(({"periodic": x}, "needs u to be periodic") for x in (
        (False, "pole"), ("mirrored", ("pole", "open")),
    )),
    *(({"f": x}, "the function of a surface must be callable") for x in (
        None, 5, "saddle", np.zeros((5, 5, 3)),
    )),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "complaint"), NO_CALLABLES)
def test_arguments_of_from_callable_that_are_refused(changes, complaint):
    arguments = {"f": tube, "domain": TURN} | changes
    refused(complaint, gm.Surface.from_callable, **arguments)


# --- callables ------------------------------------------------------------------------------------


@covering(
    shape=[(), (1,), (5,), (2, 3), (0,), (2, 0, 3)],
    name=["callable", "sympy", "catalogue", "grid", "spline"],
)
def test_evaluate_keeps_the_shape(name, shape):
    made = {
        "callable": gm.Surface.from_callable(saddle, SQUARE),
        "sympy": gm.Surface.from_sympy(("u", "v", "u*v + u**2"), "uv", SQUARE),
        "catalogue": gm.surfaces.plane(),
        "grid": gm.Surface.from_grid(saddle(*np.indices((5, 6)) * 1.0)),
        "spline": gm.fit(gm.Surface.from_callable(saddle, SQUARE), (3, 4)),
    }[name]
    u, v = np.full(shape, 0.25), np.full(shape, 0.5)
    assert made.evaluate(u, v).shape == (*shape, 3)
    if u.size:
        single = made.evaluate(0.25, 0.5)
        assert single.shape == (3,)
        assert (made.evaluate(u, v) == single).all()


def test_the_callable_gets_arrays_of_its_own():
    """It may change them, and return the same array each time."""
    memory = {}

    def careless(u, v):
        assert u.shape == v.shape
        assert u.dtype == v.dtype == np.float64
        assert u.ndim >= 1
        points = memory.setdefault(u.shape, saddle(u, v))
        u[...] = v[...] = np.nan
        return points

    surface = gm.Surface.from_callable(careless, SQUARE, name="careless")
    u, v = np.linspace(0, 1, 5), np.linspace(0, 1, 5)
    np.testing.assert_array_equal(surface.evaluate(u, v), saddle(u, v))
    np.testing.assert_array_equal(u, np.linspace(0, 1, 5))
    np.testing.assert_array_equal(surface.evaluate(0.5, 0.25), saddle(0.5, 0.25))
    first, second = gm.fit(surface, (4, 5)), gm.fit(surface, (4, 5))
    plain = gm.fit(gm.Surface.from_callable(saddle, SQUARE), (4, 5))
    np.testing.assert_array_equal(first.coefficients, plain.coefficients)
    np.testing.assert_array_equal(second.coefficients, plain.coefficients)


@pytest.mark.parametrize(
    ("returned", "complaint"),
    [
        (lambda u, v: (u, v, u), r"returned the shape \(3, 16\).*must return \(16, 3"),
        (lambda u, v: saddle(u, v)[..., :2], r"returned the shape \(16, 2\)"),
        (lambda u, v: saddle(u, v).reshape(-1, 3), r"returned the shape \(20, 3\)"),
        (lambda u, v: np.zeros(3), r"returned the shape \(3,\)"),
        (lambda u, v: (u, v, 0), r"coordinates of the shapes .* join them by numpy\.stack"),
        (lambda u, v: None, "array of real numbers, not of type object"),
        (lambda u, v: saddle(u, v) + 0j, "not of type complex128"),
        (lambda u, v: np.ma.masked_less(saddle(u, v), 0.5), "masked entries"),
        (lambda u, v: 1 / 0, "raised ZeroDivisionError: division by zero"),
        (lambda u, v: int("several\nlines"), "raised ValueError: .*several"),
        (lambda u, v: saddle(np.where(u < 0.5, u, np.nan), v), "not finite at u = 0.625, v = 0.1:"),
        (lambda u, v: saddle(u, np.where(v < 0.5, v, np.inf)), "not finite at u = 0.125, v = 0.5:"),
        (lambda u, v: saddle(u, v) / 0.0, "not finite at u = 0.125, v = 0.1:"),
        (lambda u, v: 1e305 * saddle(u, v), "too large"),
        ("sqrt(u - 2)", "not finite at u = "),
        ("log(u - 1)", "not finite at u = "),
        (sp.I * sp.Symbol("u"), "not of type complex128"),
        ("1/(u - 5/8)", "not finite at u = 0.625"),
    ],
)
def test_functions_and_expressions_that_are_no_surface(returned, complaint):
    if isinstance(returned, str | sp.Expr):
        surface = gm.Surface.from_sympy(("u", "v", returned), "uv", SQUARE, name="mine")
    else:
        surface = gm.Surface.from_callable(returned, SQUARE, name="mine")
    refused(complaint, gm.fit, surface, (4, 5), error=gm.errors.SurfaceError)
    refused("mine", gm.sample, surface, count=10, cells=(4, 5), error=gm.errors.SurfaceError)


def test_errors_of_a_callable_are_kept_and_interrupts_go_through():
    def interrupted(u, v):
        raise KeyboardInterrupt

    with pytest.raises(gm.errors.SurfaceError) as caught:
        gm.fit(gm.Surface.from_callable(lambda u, v: 1 / 0, SQUARE))
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    with pytest.raises(KeyboardInterrupt):
        gm.fit(gm.Surface.from_callable(interrupted, SQUARE))


@pytest.mark.parametrize(
    ("u", "v", "complaint"),
    [
        ("a", 0.1, "u must be an array of real numbers"),
        (0.1, None, "v must be an array of real numbers"),
        ([0.1, 0.2, 0.3], [0.1, 0.2], "do not broadcast together"),
    ],
)
def test_parameters_that_are_none(u, v, complaint):
    surface = gm.Surface.from_callable(saddle, SQUARE)
    refused(complaint, surface.evaluate, u, v)
    refused(complaint, gm.fit(surface, (3, 3)).evaluate, u, v)
    refused(complaint, gm.fit(surface, (3, 3)).normals, u, v)


# --- what the ends promise ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("f", "domain", "periodic", "complaint"),
    [
        (saddle, SQUARE, (True, False), "does not close along u"),
        (tube, ((0, 6.28), (0, 2 * np.pi)), (True, True), "does not close along u"),
        (tube, TURN, ("mirrored", False), "along u: .* the same, mirrored; they .*: .periodic. in"),
        (lambda u, v: tube(u, v / 2), TURN, (False, "mirrored"), "ed; they differ by 4[.]"),
        (lambda u, v: tube(u, (1 - u / np.pi) * (v - np.pi)), TURN, (True, True), "mirrored. in"),
        (tube, TURN, (True, "pole"), "has no pole at v = 0.0"),
        (bowl, ((0, 2 * np.pi), (0, 1)), (True, "pole"), "has no pole at v = 0.0"),
        (bowl, ((0, 2 * np.pi), (0, 0.9)), (True, ("open", "pole")), "has no pole at v = 0.9"),
        (turned(bowl), ((0, 0.9), (0, 2 * np.pi)), ("pole", True), "has no pole at u = 0.0"),
    ],
)
def test_ends_that_the_surface_does_not_have(f, domain, periodic, complaint):
    surface = gm.Surface.from_callable(f, domain, periodic)
    refused(complaint, gm.fit, surface, (8, 9), error=gm.errors.SurfaceError)


@pytest.mark.parametrize(("gap", "closes"), [(0.7e-6, True), (1.5e-6, False)])
def test_ends_close_up_to_a_millionth_of_the_size(gap, closes):
    torus = gm.surfaces.torus()

    def cut(u, v):
        points = np.array(torus.function(u, v))
        points[..., 0] += 2.7 * gap * (u / (2 * np.pi) - 0.5)
        return points

    surface = gm.Surface.from_callable(cut, torus.domain, (True, True))
    if closes:
        assert gm.fit(surface, (8, 9)).boundary[0] == ("periodic", "periodic")
    else:
        refused("does not close along u", gm.fit, surface, (8, 9), error=gm.errors.SurfaceError)


@covering(factor=[1.0, 1e-200, 1e200], shift=[0.0, 1e6, 1e12])
def test_ends_close_up_to_rounding(factor, shift):
    half: Any = bowl, ((0, 2 * np.pi), (0, 1)), (True, ("open", "pole"))
    for f, domain, ends in ((tube, TURN, (True, True)), half):
        surface = gm.Surface.from_callable(
            lambda u, v, f=f: factor * (f(u, v) + shift), domain, ends
        )
        gm.fit(surface, (8, 9))


def test_ends_close_up_to_the_last_bit_of_points():
    shift = 1e14  # whose last bit is 1/64

    def unlucky(u, v):
        return tube(u, v) + np.where(u == 2 * np.pi, shift + 1 / 64, shift)[..., None]

    def single(u, v):
        return tube(u.astype(np.float32), v.astype(np.float32))

    gm.fit(gm.Surface.from_callable(unlucky, TURN, (True, True)), (8, 9))
    points = gm.fit(gm.Surface.from_callable(single, TURN, (True, True)), (64, 64)).evaluate(1, 2)
    np.testing.assert_allclose(points, tube(1.0, 2.0), rtol=0, atol=2e-5)


# --- SymPy ----------------------------------------------------------------------------------------

u, v = sp.symbols("u v")


@pytest.mark.parametrize(
    ("position", "parameters"),
    [
        (("u", "v", "u*v + u**2"), ("u", "v")),
        (("u", "v", "u*v + u**2"), "uv"),
        ((u, v, u * v + u**2), (u, v)),
        (sp.Matrix([u, v, u * v + u**2]), (u, v)),
        ((u, "v", u * v + u**2), (u, "v")),
        (("u", "v", "u*v + u**2"), sp.symbols("u v", real=True)),
        ((*sp.symbols("u v", positive=True), u * v + u**2), ("u", "v")),
        (("beta", "gamma", "beta*gamma + beta**2"), ("beta", "gamma")),  # SymPy has such functions
        (("S", "N", "S*N + S**2"), ("S", "N")),
        (("E", "I", "E*I + E**2"), ("E", "I")),
        ((x for x in ("u", "v", "u*v + u**2")), iter("uv")),
    ],
)
def test_expressions_are_what_a_callable_is(position, parameters):
    surface = gm.Surface.from_sympy(position, parameters, SQUARE)
    at_u, at_v = np.random.default_rng(0).random((2, 7, 5))
    np.testing.assert_allclose(surface.evaluate(at_u, at_v), saddle(at_u, at_v), rtol=1e-15)


def test_constants_and_functions_of_one_parameter():
    surface = gm.Surface.from_sympy((1, "pi", "u**-1"), "uv", ((1, 2), (0, 1)))
    points = surface.evaluate([1.0, 2.0], 0.0)
    np.testing.assert_allclose(points, [[1, np.pi, 1], [1, np.pi, 0.5]], rtol=1e-16)


HOLDS_ITSELF: list[object] = []
HOLDS_ITSELF.append(HOLDS_ITSELF)
# What is given instead of a saddle over the unit square.
NO_EXPRESSIONS = [
    *(({"position": x}, "position must be three SymPy expressions") for x in (
        ("u", "v"), (*"uvuv",), 5,
    )),
    *(({"position": ("u", *x)}, f"neither parameter nor number: {names}") for x, names in (
        (("a*v", "b"), "a, b"), (("v", "gamma"), "gamma"), (("v", "x" * 10_000), "x+…"),
    )),
    *(({"position": ("u", "v", x)}, complaint) for x, complaint in (
        ("u +", "'u [+]' is not a SymPy expression"),
        *((x, "is not a SymPy expression") for x in (
            "u(", "u.x", "", "lambda", "u < 1", sp.Matrix([u]), [u], None, saddle,
        )),
        ("1/0", "not real or not finite"), (sp.nan, "it is not finite"),
        (sp.elliptic_k(u), "uses elliptic_k, which kernels cannot compute"),
        (sp.Function("f")(u), "uses f, which kernels cannot compute"),
    )),
    *(({"parameters": x}, "parameters must be two SymPy symbols") for x in (
        ("u",), ("u", "u"), ("u", "v", "w"), (1, 2), None, ("u v", "v"), ("", "v"), (u + v, v),
        (u, sp.Symbol("u", real=True)),
    )),
    *(({"domain": ((0, x), (0, 1))}, "domain must be") for x in (
        "x", "I", "zoo", "1 +", "a.b", None, "oo", sp.oo, "acsch(2 < 3)",
        "atan2(E, 10**50) + (3 < 3)",
    )),
    ({"domain": ((0, "10**400"), (0, 1))}, "empty or infinite|domain must be"),
    ({"domain": ((0, "pi"), ("pi", "pi"))}, "domain of v is empty or infinite"),
    ({"domain": HOLDS_ITSELF}, "domain must be"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "complaint"), NO_EXPRESSIONS)
def test_arguments_of_from_sympy_that_are_refused(changes, complaint):
    arguments = {"position": ("u", "v", "u*v"), "parameters": "uv", "domain": SQUARE} | changes
    refused(complaint, gm.Surface.from_sympy, **arguments)


def test_all_functions_of_texts_are_evaluated_as_in_sympy():
    """Those of one number, by NumPy and SciPy, against SymPy's own digits."""
    for name, function in FUNCTIONS.items():
        if function.takes is not sp.Expr or 1 not in function.counts:
            continue
        for at in (0.3, 2.5):  # outside the range of acosh and asec, or of acos and atanh
            exact = function.of(sp.Float(at, 30))
            if exact.is_real:
                surface = gm.Surface.from_sympy((f"{name}(u)", "v", "0"), "uv", ((0.1, 3), (0, 1)))
                value = surface.evaluate(at, 0.5)[0]
                assert value == pytest.approx(float(exact), rel=4e-16, abs=4e-16), name


def test_symbols_are_real():
    """Whatever they are in the expressions of a user: those of a surface stand for real numbers."""
    w = sp.Symbol("u", positive=True)
    surface = gm.Surface.from_sympy(
        (u, "sqrt(u**2)", sp.Abs(u + v) + w), (w, "v"), ((-1, 1), (0, 1))
    )
    assert surface.evaluate(-0.5, 0.25).tolist() == [-0.5, 0.5, -0.25]
    assert surface.derivatives(-0.5, 0.25)[1].tolist() == [1.0, -1.0, 0.0]


# --- names ----------------------------------------------------------------------------------------


def test_surfaces_without_a_name_have_distinct_ones():
    def hills(u, v):
        return saddle(u, v)

    made = [gm.Surface.from_callable(hills, SQUARE) for _ in range(3)]
    assert [x.name for x in made] == ["hills", "hills 2", "hills 3"]
    others = [
        *(gm.Surface.from_callable(lambda u, v: saddle(u, v), SQUARE) for _ in range(2)),
        gm.Surface.from_sympy(("u", "v", "u*v"), "uv", SQUARE),
        *(gm.Surface.from_grid(saddle(*np.indices((5, 6)) * 1.0)) for _ in range(2)),
    ]
    names = [x.name for x in others]
    assert len(set(names)) == len(names)
    assert all(x.startswith("surface") for x in names[:3])
    assert all(x.startswith("grid") for x in names[3:])
    assert gm.Surface.from_callable(hills, SQUARE, name="hills").name == "hills"


def test_periodic_is_for_both_parameters() -> None:
    """As `True` is understood at first; grids said that a truth value is not iterable."""
    u, v = np.mgrid[:6.0, :5.0]
    points = gm.surfaces.torus().evaluate(u * 2 * np.pi / 6, v * 2 * np.pi / 5)
    torus = gm.Surface.from_grid(points, periodic=True)
    assert torus.boundary == gm.surfaces.torus().boundary
    assert torus.assumed_open == (False, False)
    assert gm.Surface.from_callable(tube, TURN, False).assumed_open == (True, True)


def test_normals_are_exact() -> None:
    u, v = np.random.default_rng(0).uniform(0.1, 6.0, (2, 4, 50))
    exact = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1)
    for size in 1e-150, 1.0, 1e200:
        normals = gm.surfaces.torus(size, 0.35 * size).normals(u, v)
        assert np.abs(normals - exact).max() < 1e-15
    torus = gm.surfaces.torus()
    turned = torus.flipped().normals(2.0 * np.pi - u, v)
    assert np.abs(turned + exact).max() < 1e-14
    assert torus.normals(0.0, 0.0).shape == (3,)
    assert torus.normals([], 0.0).shape == (0, 3)


def test_singular_points_have_no_normal() -> None:
    cone = gm.Surface.from_sympy(("u*cos(v)", "u*sin(v)", "u"), "uv", ((0, 1), (0, "2*pi")), True)
    normals = cone.normals([0.0, 1e-9], 0.5)
    assert np.isnan(normals[0]).all()
    assert np.abs(normals[1] * np.sqrt(2) - [-np.cos(0.5), -np.sin(0.5), 1.0]).max() < 1e-14
    with pytest.raises(gm.errors.InputError, match="was given by points and has no derivatives"):
        gm.Surface.from_grid(np.ones((4, 4, 3))).normals(0.0, 0.0)


def test_surfaces_are_shown_on_one_line() -> None:
    """A trimmed one had all of its polygons, and one of points all of these."""
    loop = np.random.default_rng(0).uniform(1.0, 3.0, (500, 2))
    trimmed = gm.surfaces.torus().trimmed([loop])
    turn = "u 0 to 6.28319 periodic, v 0 to 6.28319 periodic"
    assert repr(trimmed) == f"Surface(torus: {turn}, trimmed)"
    assert repr(trimmed.trim) == f"Trim(Loops in {turn})"
    heights, name = np.arange(4e4).reshape(200, 200), "hills\nand more"
    hills = gm.Surface.from_grid(heights, spacing=(1.0, 2.0), name=name)
    assert str(hills) == (
        "Surface(hills and more: 200 × 200 points, u 0 to 199 open, v 0 to 398 open)"
    )
    assert "v -1.5708 to 1.5708 pole" in repr(gm.surfaces.sphere())


# --- SymPy expressions whose parts are shared -----------------------------------------------------

LEVELS = 60  # 2^60 parts, if shared ones are counted each time


def nested(levels: int, x: sp.Expr, factor: float) -> sp.Expr:
    """Return x → factor x² + 1/4, applied `levels` times without SymPy's simplification."""
    for _ in range(levels):
        square = sp.Mul(x, x, factor, evaluate=False)
        x = sp.Add(square, sp.Rational(1, 4), evaluate=False)
    return x


@pytest.mark.parametrize("levels", [3, LEVELS])
def test_points_and_tape_are_those_of_the_recursion(levels: int) -> None:
    u, v = sp.symbols("u v", real=True)
    surface = gm.Surface.from_sympy((u, v, nested(levels, u * v, 0.5)), (u, v), ((0, 1), (0, 1)))
    a, b = np.random.default_rng(2).uniform(size=(2, 20))
    z, along = a * b, b
    for _ in range(levels):
        z, along = 0.5 * z * z + 0.25, z * along
    np.testing.assert_allclose(surface.evaluate(a, b)[:, 2], z, rtol=1e-14)
    assert surface.tape is not None
    np.testing.assert_allclose(surface.jets(a, b)[:, 1, 2], along, rtol=1e-12, atol=1e-300)


def test_symbols_of_the_same_name_are_replaced() -> None:
    u, v = sp.symbols("u v")  # not real
    surface = gm.Surface.from_sympy((u, v, nested(LEVELS, u, 0.5)), (u, v), ((0, 1), (0, 1)))
    assert surface.evaluate(0.5, 0.5).shape == (3,)
    with pytest.raises(gm.errors.InputError, match="neither parameter nor number: w"):
        gm.Surface.from_sympy((u, v, nested(LEVELS, sp.Symbol("w"), 0.5)), (u, v), ((0, 1), (0, 1)))


# --- surfaces in other processes ------------------------------------------------------------------


def plane(u, v):
    return np.stack([u, v, 0 * u], axis=-1)


def plane_derivatives(u, v):
    jets = np.zeros((*u.shape, 6, 3))
    jets[..., 0, :] = plane(u, v)
    jets[..., 1, 0] = jets[..., 2, 1] = 1.0
    return jets


def all_kinds():
    periodic = (True, True)
    made = {
        "catalogue": gm.surfaces.torus(minor=0.2),
        "sympy": gm.Surface.from_sympy(
            ("(2 + cos(v))*cos(u)", "(2 + cos(v))*sin(u)", "Piecewise((v, v < 1), (Abs(v), True))"),
            sp.symbols("u v", positive=True),
            TURN,
        ),
        "callable": gm.Surface.from_callable(tube, TURN, periodic),
        "given": gm.Surface.from_callable(plane, TURN, derivatives=plane_derivatives),
        "nurbs": gm.Surface.from_nurbs(
            (1, 1), ([0, 0, 4, 7, 7], [0, 0, 7, 7]), plane(*np.indices((3, 2)) * 1.0)
        ),
        "trimmed": gm.surfaces.torus().trimmed([[(1, 1), (3, 1), (1, 3)]]),
        "grid": gm.Surface.from_grid(tube(*np.indices((5, 6)) / 2)),
    }
    return made | {f"flipped {name}": surface.flipped() for name, surface in made.items()}


@covering(name=all_kinds(), used=[False, True])
def test_pickling(name, used):
    surface = all_kinds()[name]
    u, v = np.random.default_rng(0).uniform(0.5, 3.0, (2, 20))
    if used and surface.grid is None:  # what is compiled is left out
        surface.derivatives(u, v)
    copy = pickle.loads(pickle.dumps(surface))
    assert (copy.name, copy.domain, copy.boundary) == (
        surface.name,
        surface.domain,
        surface.boundary,
    )
    assert np.array_equal(copy.evaluate(u, v), surface.evaluate(u, v))
    if surface.grid is None:
        assert np.array_equal(copy.derivatives(u, v), surface.derivatives(u, v))


def test_curves_pickle():
    curve = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True)
    assert np.array_equal(pickle.loads(pickle.dumps(curve)).evaluate(1.0), curve.evaluate(1.0))


SCRIPT = """
import multiprocessing
import joblib
import gaussmap as gm


def height(surface):
    jets = surface.derivatives(0.5, 0.75)
    return surface.name, jets.tolist(), gm.fit(surface, (8, 8)).evaluate(0.5, 0.5).tolist()


if __name__ == "__main__":
    surfaces = [
        gm.surfaces.torus(minor=0.2),
        gm.Surface.from_sympy(("u", "v", "Abs(u*v)"), "uv", ((0, 1), (0, 1))),
        gm.surfaces.moebius_band().flipped(),
    ]
    expected = [height(x) for x in surfaces]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map(height, surfaces) == expected
    assert joblib.Parallel(n_jobs=2)(joblib.delayed(height)(x) for x in surfaces) == expected
    print("equal")
"""


@pytest.mark.slow
def test_surfaces_in_other_processes(tmp_path):
    """With spawn, as on macOS and Windows, and with joblib's loky."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    run = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, timeout=300, check=False
    )
    assert run.stdout.strip() == "equal", run.stderr


# --- derivatives: generated, symbolic, given and numerical ----------------------------------------


def places(domain, count=40, seed=0):
    """Return random places, among them places next to each end and on it."""
    result = []
    for (low, high), turn in zip(domain, (0, 3), strict=True):
        t = np.random.default_rng(seed + turn).random(count)
        t[turn : turn + 6] = [0.0, 1.0, 1e-9, 1.0 - 1e-3, 0.006, 0.994]
        result.append(low + (high - low) * t)
    return result


def relative_errors(found, expected):
    """Return the largest difference of each derivative, relative to the largest of all."""
    return np.abs(found - expected).max(axis=(0, 2)) / np.abs(expected).max()


def test_derivatives_of_numbers_and_arrays():
    surface = gm.surfaces.torus()
    u, v = places(surface.domain)
    found = surface.derivatives(u, v)
    assert found.shape == (len(u), 6, 3)
    assert np.array_equal(found, surface.jets(u, v))
    assert surface.derivatives(u[:, None], v[:7]).shape == (len(u), 7, 6, 3)
    assert surface.derivatives(0.5, 0.25).shape == (6, 3)


@pytest.mark.parametrize(
    "name", ["torus", "sphere", "wavy_graph", "enneper", "moebius_band", "dupin_cyclide"]
)
def test_numerical_derivatives(name):
    """Open, periodic and mirrored ends, and poles; the function is never called outside."""
    surface = gm.surfaces.surface(name)
    (u0, u1), (v0, v1) = surface.domain

    def inside(u, v):
        assert u.min() >= u0
        assert u.max() <= u1
        assert v.min() >= v0
        assert v.max() <= v1
        return surface.evaluate(u, v)

    u, v = places(surface.domain)
    found = gm.Surface(name, inside, surface.domain, surface.boundary).derivatives(u, v)
    errors = relative_errors(found, surface.jets(u, v))
    assert errors[0] < 1e-15
    assert errors[1:3].max() < 2e-12
    assert errors[3:].max() < 1e-9


@pytest.mark.parametrize("waves", [3, 10, 100])
def test_steps_become_smaller_where_the_surface_varies_fast(waves):
    k = 2 * np.pi * waves
    surface = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, np.sin(k * u) * np.cos(k * v)], axis=-1), SQUARE
    )
    u, v = places(SQUARE, 100)
    z = f"sin(2*pi*{waves}*u) * cos(2*pi*{waves}*v)"
    exact = gm.Surface.from_sympy(("u", "v", z), "uv", SQUARE)
    found, expected = surface.jets(u, v)[..., 2], exact.jets(u, v)[..., 2]
    errors = np.abs(found - expected).max(axis=0) / np.abs(expected).max(axis=0)
    assert errors[1:3].max() < 1e-9
    assert errors[3:].max() < 1e-6


def test_derivatives_beside_a_fillet_and_beside_a_hole():
    def filleted(u, v):
        """Return a roof whose ridge is rounded over 1 % of the domain; no roof in a corner."""
        t = np.clip(100 * (u - 0.5), 0.0, 1.0)
        z = 0.01 * (t * t / 2 + np.maximum(100 * (u - 0.51), 0.0))
        return np.stack([u, v, np.where((u > 0.9) & (v > 0.9), np.nan, z)], axis=-1)

    surface = gm.Surface.from_callable(filleted, SQUARE)
    u, v = np.linspace(0.0, 1.0, 1001), np.full(1001, 0.3)
    z_u = surface.jets(u, v)[:, 1, 2]
    inside = np.abs(u - 0.5) * np.abs(u - 0.51) > 1e-8  # and not where the curvature jumps
    np.testing.assert_allclose(z_u[inside], np.clip(100 * (u - 0.5), 0, 1)[inside], atol=1e-9)
    u, v = np.full(100, 0.8999), np.linspace(0.9, 1.0, 100)
    assert np.isfinite(surface.jets(u, v)).all()
    assert np.isnan(surface.jets(u + 0.0002, 0.1 + 0.9 * v)).any()


@pytest.mark.parametrize(
    ("z", "z_u", "z_uu"),
    [
        ("Abs(u - 1/3)*v", lambda u, v: np.sign(u - 1 / 3) * v, 0.0),
        ("sign(u - 1/3)*u", lambda u, v: np.sign(u - 1 / 3), 0.0),
        ("Max(u, v, 1/3)", lambda u, v: u > np.maximum(v, 1 / 3), 0.0),
        ("Piecewise((u**2, u > v), (v, True))", lambda u, v: 2 * u * (u > v), None),
        ("floor(3*u)*u", lambda u, v: np.floor(3 * u), 0.0),
        ("(3*u) % 1", lambda u, v: 3.0, 0.0),
        ("Heaviside(u - 1/3)*u", lambda u, v: u > 1 / 3, 0.0),
        ("2", lambda u, v: 0.0, 0.0),
        ("Sum(u**k, (k, 0, 2))", lambda u, v: 1 + 2 * u, 2.0),
        ("sinc(u)", lambda u, v: np.cos(u) / u - np.sin(u) / u**2, None),
    ],
)
def test_symbolic_derivatives_with_kinks_and_jumps(z, z_u, z_uu):
    u, v = np.random.default_rng(0).random((2, 50))
    surface = gm.Surface.from_sympy(("u", "1", z), "uv", SQUARE)
    jets = surface.derivatives(u, v)
    np.testing.assert_allclose(jets[:, 1, 2], z_u(u, v) + 0 * u, rtol=1e-12, atol=1e-12)
    assert (jets[:, :2, 1] == [1.0, 0.0]).all()
    if z_uu is not None:
        np.testing.assert_allclose(jets[:, 3, 2], z_uu, rtol=0, atol=1e-14)


def test_symbolic_derivatives_are_filled_by_numerical_ones():
    surface = gm.Surface.from_sympy(("u", "v", "sinc(u)"), "uv", ((-1, 1), (-1, 1)))
    np.testing.assert_allclose(
        surface.derivatives(0.0, 0.5)[:, 2], [1, 0, 0, -1 / 3, 0, 0], rtol=0, atol=1e-10
    )


def saddle_derivatives(u, v):
    zero, one = np.zeros_like(u), np.ones_like(u)
    rows = [
        (u, v, u * v + u * u), (one, zero, v + 2 * u), (zero, one, u), (zero, zero, 2 * one),
        (zero, zero, one), (zero, zero, zero),
    ]  # fmt: skip
    return np.stack([np.stack(x, axis=-1) for x in rows], axis=-2)


def test_given_derivatives():
    given = gm.Surface.from_callable(saddle, SQUARE, derivatives=saddle_derivatives)
    u, v = places(SQUARE)
    assert np.array_equal(given.derivatives(u, v), saddle_derivatives(u, v))
    errors = relative_errors(
        gm.Surface.from_callable(saddle, SQUARE).derivatives(u, v), saddle_derivatives(u, v)
    )
    assert errors.max() < 2e-9


def wrong(row, factor=1.0, more=0.0):
    """Return derivatives of which one is wrong."""

    def derivatives(u, v):
        jets = saddle_derivatives(u, v)
        jets[..., row, :] = factor * jets[..., row, :] + more
        return jets

    return derivatives


@pytest.mark.parametrize(
    ("derivatives", "complaint"),
    [
        *((wrong(i, 1.001), f"contradict it: {NAMES[i]} at u = ") for i in range(5)),
        *((wrong(i, more=0.01), f"contradict it: {NAMES[i]} at u = ") for i in range(6)),
        (wrong(4, np.nan), "contradict it: x_uv at u = .* given as .nan nan nan., and differences"),
        (wrong(5, more=np.inf), "contradict it: x_vv"),
        (saddle, r"returned the shape \(48, 3\) .* must return \(48, 6, 3\)"),
        (lambda u, v: None, "array of real numbers"),
        (lambda u, v: 1 / 0, "derivatives of surface 'mine' raised ZeroDivisionError"),
    ],
)
def test_given_derivatives_that_are_wrong(derivatives, complaint):
    surface = gm.Surface.from_callable(saddle, SQUARE, derivatives=derivatives, name="mine")
    assert surface.evaluate(0.5, 0.5).shape == (3,)
    for call in (lambda: surface.derivatives(0.5, 0.5), lambda: surface.jets(*places(SQUARE))):
        refused(complaint, call, error=gm.errors.SurfaceError)


def test_derivatives_that_do_not_exist():
    surface = gm.Surface.from_callable(
        lambda u, v: saddle(np.where(u < 0.5, u, np.nan), v), SQUARE, name="half"
    )
    assert np.isfinite(surface.derivatives(0.4, 0.5)).all()
    with pytest.raises(
        gm.errors.SurfaceError, match=r"x of surface 'half' is not finite at u = 0[.]6"
    ):
        surface.derivatives([0.4, 0.6], 0.5)
    assert np.isnan(surface.jets(np.array([0.6]), np.array([0.5]))).any()
    with pytest.raises(gm.errors.InputError, match="derivatives of a surface must be callable"):
        gm.Surface.from_callable(saddle, SQUARE, derivatives=saddle(0.0, 0.0))  # pyright: ignore
    grid = gm.Surface.from_grid(saddle(*np.indices((5, 6)) * 1.0))
    refused("was given by points and has no derivatives", grid.derivatives, 0.0, 0.0)
    refused("u must be an array of real numbers", gm.surfaces.torus().derivatives, "a", 0.0)
