"""Whatever a public callable is given, it answers, or says in one sentence why it does not.

Functions, methods and classes are found, and not listed: each needs usable arguments only, below.
One of them at a time, or the first entry of a pair, is replaced by whatever users may hand over.
"""

import inspect
from collections.abc import Callable, Iterator
from contextlib import suppress
from fractions import Fraction
from functools import reduce
from itertools import islice
from pathlib import Path
from typing import Any
from zlib import crc32

import gaussmap as gm
import numpy as np
import pytest
import sympy
from gaussmap.tools.cad.examples import box

from .interface import CALLABLES, CLASSES
from .shapes import SQUARE

LONGEST_MESSAGE = 300
# Quick tests try one of so many values, other ones for each parameter.
STEP = 26

# Warnings are answers, too.
pytestmark = pytest.mark.filterwarnings("ignore::gaussmap.GaussmapWarning")


# --- what users may hand over ---------------------------------------------------------------------


def deep_list() -> list[Any]:
    """Return a list that recursion does not get to the end of."""
    deep: list[Any] = []
    for _ in range(2000):
        deep = [deep]
    return deep


class Odd:
    """An object some of whose methods raise an error."""


def odd(error: type[Exception], *methods: str) -> Odd:
    """Return an object whose methods of these names raise an error."""

    def fail(*_: object, **__: object) -> None:
        raise error("odd")

    return type("Odd", (Odd,), dict.fromkeys(methods, fail))()


class ArrayLike:
    """An object that says that it is an array, and becomes another one."""

    shape, ndim, dtype = (3,), 1, np.dtype(np.float64)

    def __init__(self, value: object) -> None:
        self.value = value

    def __array__(self, *_: object, **__: object) -> Any:
        return self.value


LARGE = (10**10,), (10**10, 2), (10**10, 3), (3, 10**10), (10**10, 3, 3), (2, 2, 10**10)
HOSTILE: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 3.0, float("nan"), float("inf"), -float("inf"), 1e300, 1e-320,
    10**12, 10**5000, -(10**5000), 1j, "a", "", " ", "\0", "\udc80", "x" * 5000, b"x",
    Fraction(1, 3), sympy.Symbol("x"), sympy.zoo, Path("nowhere/x"),
    [], [[]], (), {}, set(), {"a": 1}, {1, 2}, [1], [None], ["a"], [1, "a"], (0, 1), [1, 0],
    [1, 2, 3], [[1, 2], [3]], [[1], [2, [3]]], [[1, 2, 3]], [[0, 0, 0]], [[float("nan")] * 3],
    [[float("inf")] * 3], [[1e300] * 3] * 6, [[1e-320] * 3] * 6, [[10**400] * 3],
    np.array([1, None], object), np.array([[1, 2, 3]], object), np.array([1j]), np.array(3),
    np.zeros((0, 3)), np.zeros((3, 3, 3)), np.zeros((6, 3)), np.array(["a"]), np.array([True]),
    np.float32(2.0), np.int8(-1), np.str_("a"), np.datetime64("2020-01-01"), np.datetime64("NaT"),
    np.zeros(2, dtype=[("a", "f8")]), np.zeros((1,) * 30), np.ma.masked_equal([1, 2, 3], 2),
    np.ma.masked, object(), len, int, np, slice(0, 2), range(3), Ellipsis, iter([1, 2]),
    deep_list(), gm.surfaces.torus(),
    odd(OSError, "__repr__"),
    odd(RuntimeError, "__array__"),  # as tensors that require gradients
    odd(RuntimeError, "__float__", "__int__", "__index__"),
    odd(TypeError, "__iter__", "__len__"),  # as arrays without dimension
    odd(ValueError, "__bool__", "__eq__"),  # as arrays
    odd(TypeError, "__hash__"),
    ArrayLike("text"),
    ArrayLike(np.array([None, "a"], object)),
    # What Python holds in a few bytes, and arrays of it in none of the memory that is free.
    np.zeros((3, 3)).data, np.eye(2).data, Fraction(10**400), [Fraction(10**400)] * 3,
    range(10**18), range(10**9), *(np.broadcast_to(1.0, x) for x in LARGE),
)  # fmt: skip


# --- usable arguments -----------------------------------------------------------------------------


PATCH = ((3, 0, 0), (0, 3, 0), (0, 0, 3), (2, 2, 1), (2, 1, 2), (1, 2, 2))
MAKERS: dict[str, Callable[[], Any]] = {
    "torus": gm.surfaces.torus,
    "spline": lambda: gm.fit(USABLE.torus, (8, 8)),
    "map": lambda: gm.GaussMap(USABLE.spline),
    "samples": lambda: gm.sample(USABLE.torus, count=60, cells=(8, 8)),
    "mesh": lambda: USABLE.samples.mesh(),
    "circle": lambda: gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True),
    "curve_spline": lambda: gm.curves.fit(USABLE.circle, 16),
    "curve_samples": lambda: gm.curves.sample(USABLE.curve_spline, 10),
    "curve_support": lambda: gm.curves.SupportFunction.of_spline(USABLE.curve_spline),
    "support": lambda: gm.SupportFunction.from_sympy("1"),
    "sums": lambda: gm.convolve(USABLE.support, USABLE.support, gm.icosphere(2)),
    "image": lambda: gm.gauss_map.GaussianImage.of_patch(PATCH),
    "images": lambda: gm.gauss_map.GaussianImages(USABLE.spline),
    "arc": lambda: USABLE.image.arcs[0],
    "part": box,
    "part_samples": lambda: gm.sample(USABLE.part, 20),
    "dataset": lambda: gm.open_dataset("dataset"),
}


class Usable:
    """Things of all kinds that are as they should be, made when they are first needed."""

    def __getattr__(self, name: str) -> Any:
        setattr(self, name, MAKERS[name]())
        return getattr(self, name)


USABLE = Usable()


class Of:
    """One of the usable things, or an attribute of it, once it is needed."""

    def __init__(self, *names: str) -> None:
        self.names = names

    def __call__(self) -> Any:
        return reduce(getattr, self.names, USABLE)


class Listed(Of):
    """A list of it."""

    def __call__(self) -> Any:
        return [super().__call__()]


def saddle(u: Any, v: Any) -> Any:
    """Return points of a surface."""
    return np.stack([u, v, u * v], axis=-1)


def parabola(t: Any) -> Any:
    """Return points of a curve."""
    return np.stack([t, t**2], axis=-1)


NORMALS, PLANE_NORMALS = gm.icosphere(1)[:7], gm.directions.circle(5)
HEIGHTS = np.hypot(*np.meshgrid(np.arange(6.0), np.arange(5.0)))
KNOTS = ((0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 1.0, 1.0))
FLAT = np.array([[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.5]]])
# What `self` is, by the class.
SELF = {
    "Convolution": Of("sums"), "Dataset": Of("dataset"), "GaussMap": Of("map"),
    "Mesh": Of("mesh"), "Part": Of("part"),
    "Samples": Of("samples"), "Spline": Of("spline"), "SupportFunction": Of("support"),
    "Surface": Of("torus"), "curves.Curve": Of("circle"),
    "curves.CurveSamples": Of("curve_samples"), "curves.CurveSpline": Of("curve_spline"),
    "curves.SupportFunction": Of("curve_support"), "gauss_map.BoundaryArc": Of("arc"),
    "gauss_map.GaussianImage": Of("image"), "gauss_map.GaussianImages": Of("images"),
}  # fmt: skip
# Usable arguments by the name of the parameter, where callables mean the same by it.
COMMON: dict[str, Any] = {
    "order": "path",
    "surface": Of("spline"), "first": Of("spline"), "second": Of("support"), "spline": Of("spline"),
    "surfaces": Listed("spline"), "parts": Listed("samples"), "curve": Of("circle"),
    "normals": NORMALS, "directions": NORMALS, "count": 10, "counts": [40, 60],
    "frequency": 2, "nside": 2, "angle": 10.0, "direction": (0.0, 0.0, 1.0),
    "axis": (0.0, 0.0, 1.0), "corners": np.eye(3),
    "control_points": PATCH, "path": "nothing.npz", "part": 0, "distance": 0.1,
    "shift": (1.0, 2.0, 3.0), "factor": 2.0,
    "rotation": np.eye(3), "matrix": np.eye(3), "u": 0.5, "v": 0.5, "t": 0.5, "h": "1 + n_x",
    "domain": SQUARE, "f": saddle, "name": "torus", "source": HEIGHTS,
}  # fmt: skip


def fields(name: str, names: str) -> list[dict[str, Any]]:
    """Return the fields of a usable thing as arguments of its class."""
    return [{x: Of(name, x) for x in names.split()}]


# Further arguments, and others, by the callable: several of them where one set does not reach all.
SPECIAL: dict[str, list[dict[str, Any]]] = {
    "Mesh": fields("mesh", "vertices normals uv triangles sample_index name sides"),
    "Mesh.write": [{"path": "new.ply"}],
    "Part": [{"surfaces": Listed("torus")}],
    "Part.plot": [{"samples": Of("part_samples")}],
    "Part.save": [{"path": "new part.npz"}],
    "Samples": fields("samples", "points normals report spline surface"),
    "silhouette": [{"direction": (0.0, 0.0, 1.0)}],
    "Samples.view": [{"path": "new.html"}],
    "Samples.write": [{"path": "new.npz"}],
    "Samples[…]": [{"key": 0}],
    "Spline": fields("spline", "coefficients domain boundary name"),
    "Spline.from_nets": [{"nets": np.array([PATCH])}],
    "Spline.in_cells": [{"places": np.array([[0.5, 0.5]])}],
    "Spline.normals_in_cells": [{"cells": np.array([[0.5, 0.5]])}],
    "SupportFunction": [{"_source": Of("support", "_source")}],
    "SupportFunction.of_spline": [{"surface": Of("torus"), "cells": (8, 8)}],
    "Surface": fields("torus", "name function domain boundary"),
    "Surface.from_grid": [
        {"points": HEIGHTS, "spacing": (1.0, 1.0)},
        {"points": saddle(*np.mgrid[:5.0, :5.0]), "periodic": (False, False)},
    ],
    "Surface.from_nurbs": [{"degrees": (1, 1), "knots": KNOTS, "control_points": FLAT}],
    "Surface.from_sympy": [{"position": ("u", "v", "u*v"), "parameters": ("u", "v")}],
    "Surface.jets": [{"u": np.zeros(3), "v": np.zeros(3)}],
    "Surface.trimmed": [{"loops": [[(1, 1), (2, 1), (1, 2)]]}],
    "convolve": [{}, {"first": Of("torus"), "cells": (8, 8)}],
    "curves.Curve": [{"name": "c", "function": parabola, "domain": (0.0, 1.0), "periodic": False}],
    "curves.Curve.from_callable": [{"f": parabola, "domain": (0.0, 1.0)}],
    "curves.Curve.from_points": [{"points": parabola(np.arange(6.0))}],
    "curves.Curve.from_sympy": [{"position": ("t", "t**2"), "parameter": "t", "domain": (0, 1)}],
    "curves.CurveSpline": fields("curve_spline", "coefficients domain periodic name"),
    "curves.SupportFunction.branches": [{"normals": PLANE_NORMALS}],
    "curves.SupportFunction.translated": [{"shift": (1.0, 2.0)}],
    "curves.fit": [{"pieces": 16}],
    "curves.sample": [{"count": 10, "pieces": 16}, {"normals": PLANE_NORMALS, "count": None}],
    "fit": [{"surface": Of("torus"), "cells": (8, 8)}],
    "formulas[…]": [{"name": "envelope"}],
    "gauss_map.GaussianImages.of_spline": [{}, {"spline": Of("torus"), "cells": (8, 8)}],
    "gauss_map.classify_patches": [{"patches": np.zeros((1, 6, 3))}, {"patches": Of("spline")}],
    "gauss_map.parabolic_points": [{"tolerance": 1e-2}],
    "open_dataset": [{"folder": "dataset"}],
    "plot": [{"samples": Of("samples")}],
    "points of f(u, v)": [{"returned": [[1.0, 2.0, 3.0]]}],
    "read_cad": [{"path": "nothing.step"}],
    "read_samples": [{"path": "samples.npz"}],
    "sample": [
        {"count": 10},
        {"surface": Of("torus"), "count": 20, "cells": (8, 8)},
        {"surface": Of("torus"), "normals": NORMALS, "cells": (8, 8)},
        {"surface": Of("part"), "count": 20, "edges": True},
        {"surface": Of("torus"), "count": 20, "cells": (8, 8), "reach": ((0, 0, 1), 40.0)},
    ],
    "sample_many": [x | {"count": 10, "progress": False} for x in ({}, {"out": "taken"})],
    "sample_stream": [{"count": 10}, {"surface": Of("torus"), "normals": NORMALS, "cells": (8, 8)}],
    "terrain": [
        {"spacing": (1.0, 1.0)},
        {"x": np.arange(6.0), "y": np.arange(5.0), "origin": (0.0, 0.0)},
    ],
}
# What is called by brackets and by calls of objects, and what a user's function returns.
UNNAMED: dict[str, Callable[..., Any]] = {
    "Samples[…]": lambda key: USABLE.samples[key],
    "SupportFunction(…)": lambda normals: USABLE.support(normals),
    "formulas[…]": lambda name: gm.formulas[name],
    "points of f(u, v)": lambda returned: gm.Surface.from_callable(
        lambda u, v: returned, SQUARE
    ).evaluate(0.5, 0.5),
}
# What is tried on files that cannot be used: others need a library for CAD, or several processes.
UNUSABLE_FILES = {"read_cad", "read_part", "sample_many"}
# What would start processes for a new data set, or load Dask.
UNTRIED = {("sample_many", "out"): str | Path, ("sample_many", "scheduler"): object}
# The classes whose objects users may make by themselves.
MADE = (
    "GaussMap", "Mesh", "Part", "Samples", "Spline", "SupportFunction", "Surface", "curves.Curve",
    "curves.CurveSpline", "gauss_map.GaussianImage", "gauss_map.GaussianImages",
)  # fmt: skip
ALL = {
    name: x
    for name, x in (CALLABLES | UNNAMED | {name: CLASSES[name] for name in MADE}).items()
    if {*inspect.signature(x).parameters} - {"self"}
}


def bound(name: str) -> Callable[..., Any]:
    """Return a callable, of a method one that needs no `self`."""
    cls, _, method = name.rpartition(".")
    return getattr(SELF[cls](), method) if cls in SELF else ALL[name]


def usable_arguments(name: str) -> Iterator[dict[str, Any]]:
    """Yield usable arguments of a callable, by their names."""
    needed = [
        x.name
        for x in inspect.signature(bound(name)).parameters.values()
        if x.default is x.empty and x.kind is not x.VAR_KEYWORD
    ]
    for more in SPECIAL.get(name, [{}]):
        found = {x: COMMON[x] for x in needed if x not in more} | more
        yield {x: y() if isinstance(y, Of) else y for x, y in found.items()}


# --- calls ----------------------------------------------------------------------------------------


def call(name: str, arguments: dict[str, Any]) -> None:
    """Call something, and go through what it returns."""
    function = bound(name)
    kinds = inspect.signature(function).parameters
    first = [arguments[x] for x, y in kinds.items() if y.kind is y.POSITIONAL_ONLY]
    rest = {x: y for x, y in arguments.items() if kinds[x].kind is not kinds[x].POSITIONAL_ONLY}
    found = function(*first, **rest)
    if isinstance(found, Iterator):
        for _ in islice(found, 3):
            pass
    repr(found)


def answer(name: str, arguments: dict[str, Any]) -> None:
    """Check that a call returns, or raises a GaussmapError of one line that is not too long."""
    try:
        call(name, arguments)
    except gm.GaussmapError as error:
        message = str(error)
        assert "\n" not in message
        assert 10 < len(message) <= LONGEST_MESSAGE


def try_values(name: str, step: int) -> None:
    for arguments in usable_arguments(name):
        for parameter in inspect.signature(bound(name)).parameters.values():
            if parameter.kind is parameter.VAR_KEYWORD:
                continue
            usual = arguments.get(parameter.name, parameter.default)
            first = crc32(f"{name} {parameter.name}".encode()) % step
            for value in HOSTILE[first::step]:
                if isinstance(value, UNTRIED.get((name, parameter.name), ())):
                    continue
                answer(name, arguments | {parameter.name: value})
                if isinstance(usual, tuple | list) and usual:
                    inner = type(usual)([value, *usual[1:]])
                    answer(name, arguments | {parameter.name: inner})


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Run in a folder of its own."""
    path = tmp_path_factory.mktemp("any")
    (path / "taken").touch()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(path)
        USABLE.samples.write("samples.npz")
        yield path


@pytest.fixture
def name(request: pytest.FixtureRequest, folder: Path) -> str:
    """The name of a callable, with the data set that it needs."""
    if "ataset" in request.param and not (folder / "dataset").exists():
        (folder / "dataset").symlink_to(request.getfixturevalue("dataset"))
    return request.param


@pytest.fixture(autouse=True)
def no_figures() -> Iterator[None]:
    yield
    import matplotlib.pyplot as plt

    plt.close("all")


@pytest.mark.parametrize("name", ALL, indirect=True)
def test_usable_and_some_other_arguments(name: str) -> None:
    """What is tried beside usable ones is not reached if these are not usable."""
    for arguments in usable_arguments(name):
        with suppress(*[gm.errors.FileError] * (name in UNUSABLE_FILES)):
            call(name, arguments)
    try_values(name, STEP)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL, indirect=True)
def test_any_other_arguments(name: str) -> None:
    try_values(name, 1)


@pytest.mark.parametrize("name", SELF, indirect=True)
def test_objects_are_shown_on_one_line(name: str) -> None:
    shown = repr(SELF[name]())
    assert "\n" not in shown
    assert len(shown) < 120
