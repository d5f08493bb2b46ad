"""What the public interface says of itself: in the form of numpydoc, with examples that run."""

import doctest
import inspect
import re
from collections.abc import Callable
from enum import Enum
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.runtime.spline.misfit import Misfit
from gaussmap.tools.cad.part import Part
from gaussmap.tools.support.branches import Branches
from gaussmap.tools.support.convolution import Convolution
from numpydoc.docscrape import NumpyDocString
from numpydoc.validate import validate

# Parameters that are missing, unknown or untyped; no section of what is returned or yielded; no
# summary; no example.
SERIOUS = {"GL08", "PR01", "PR02", "PR04", "RT01", "YD01", "SS01", "EX01"}
# Of classes: their attributes are the parameters, and are checked below.
OF_CLASSES = SERIOUS - {"PR01", "PR02", "PR04"}
NAMESPACES = {"curves", "directions", "errors", "gauss_map", "surfaces"}
# Classes that the functions return, beside those that have public names.
RETURNED = {
    "Branches": Branches,
    "Convolution": Convolution,
    "Misfit": Misfit,
    "Part": Part,
    "SamplingReport": SamplingReport,
}


def public() -> dict[str, Any]:
    """Return all public objects by their names; `symbolic` documents its formulas itself."""
    spaces = {name: getattr(gm, name) for name in sorted(NAMESPACES)}
    top = [name for name in dir(gm) if not name.startswith("_")]
    modules = {name for name in top if isinstance(getattr(gm, name), ModuleType)}
    assert modules == NAMESPACES | {"symbolic"}
    found = {name: getattr(gm, name) for name in top if name not in modules}
    for space, module in spaces.items():
        found |= {f"{space}.{name}": getattr(module, name) for name in module.__all__}
    found |= {f"surfaces.{name}": getattr(gm.surfaces, name) for name in gm.surfaces.names()}
    return found | RETURNED


PUBLIC = public()
CLASSES = {name: x for name, x in PUBLIC.items() if inspect.isclass(x)}
OBJECTS = {"formulas": gm.formulas}  # an instance, whose class is not public
FUNCTIONS = {name: x for name, x in PUBLIC.items() if name not in {*CLASSES, *OBJECTS}}


def members(cls: type) -> dict[str, Any]:
    """Return the public members of a class that gaussmap defines, and the names of its fields."""
    found: dict[str, Any] = dict.fromkeys(getattr(cls, "__dataclass_fields__", ()))
    for base in reversed(cls.__mro__):
        if base.__module__.startswith("gaussmap"):
            names = [x for x in vars(base) if x not in found]
            for x in names:
                getattr(cls, x)  # some methods are put into the class when first asked for
            found |= {x: vars(base)[x] for x in names}
    return {name: x for name, x in found.items() if not name.startswith("_")}


def methods_of(cls: type) -> dict[str, Callable[..., Any]]:
    """Return the public methods, class methods included, by their names."""
    kinds = (classmethod, staticmethod)
    return {
        name: getattr(cls, name)
        for name, x in members(cls).items()
        if inspect.isfunction(x) or isinstance(x, kinds)
    }


METHODS = {f"{x}.{name}": f for x, cls in CLASSES.items() for name, f in methods_of(cls).items()}
CALLABLES = FUNCTIONS | METHODS
DOCUMENTED = CALLABLES | CLASSES


def errors_of(name: str, monkeypatch) -> list[tuple[str, str]]:
    # The validator looks an object up by module and name, and does not see some of ours there.
    monkeypatch.setattr("numpydoc.validate.Validator._load_obj", lambda _: DOCUMENTED[name])
    return validate(f"gaussmap.{name}")["errors"]


def examples_of(name: str, documented: Any) -> list[doctest.DocTest]:
    return doctest.DocTestFinder(recurse=False).find(documented, name, globs={})


def test_all_that_is_public_is_looked_at():
    assert {"sample", "curves.fit", "surfaces.torus", "directions.cap"} <= {*FUNCTIONS}
    assert {"Samples", "curves.Curve", "gauss_map.GaussianImage"} <= {*CLASSES}
    assert {"Samples.mesh", "Surface.from_grid", "Samples.to_trimesh"} <= {*METHODS}
    assert {"points", "spline", "kind", "mesh"} <= {*members(gm.Samples)}
    assert all(callable(x) for x in FUNCTIONS.values())


@pytest.mark.parametrize("name", CALLABLES)
def test_functions_have_the_sections_of_numpydoc(name: str, monkeypatch) -> None:
    errors = errors_of(name, monkeypatch)
    assert [(code, text) for code, text in errors if code in SERIOUS] == []


@pytest.mark.parametrize("name", CLASSES)
def test_classes_have_the_sections_of_numpydoc(name: str, monkeypatch) -> None:
    errors = errors_of(name, monkeypatch)
    assert [(code, text) for code, text in errors if code in OF_CLASSES] == []


@pytest.mark.parametrize("name", CLASSES)
def test_attributes_are_documented_and_used_in_an_example(name: str) -> None:
    cls = CLASSES[name]
    attributes = {x: y for x, y in members(cls).items() if x not in methods_of(cls)}
    own = {x for x, y in attributes.items() if isinstance(y, property | cached_property)}
    section = NumpyDocString(inspect.getdoc(cls) or "")["Attributes"]
    described = {part: x for x in section for part in x.name.split(", ")}
    assert {*described} == {*attributes} - own
    assert [x.name for x in section if not x.desc or not (x.type or issubclass(cls, Enum))] == []
    assert [x for x in own if not inspect.getdoc(attributes[x])] == []
    documented = [cls, *methods_of(cls).values(), *(attributes[x] for x in own)]
    examples = [x for y in documented for x in examples_of(name, y)]
    source = "".join(example.source for x in examples for example in x.examples)
    assert [x for x in attributes if not re.search(rf"\.{x}\b", source)] == []


@pytest.fixture(scope="module")
def dataset(tmp_path_factory) -> Path:
    """Return the folder of a data set."""
    path = tmp_path_factory.mktemp("data") / "dataset"
    surfaces = ["torus", "sphere", "ellipsoid"]
    gm.sample_many(surfaces, 500, cells=(16, 16), out=path, workers=1, progress=False)
    return path


@pytest.mark.compiled
@pytest.mark.parametrize("name", DOCUMENTED)
def test_examples_run(name: str, tmp_path, monkeypatch, request) -> None:
    monkeypatch.chdir(tmp_path)
    if name == "open_dataset" or name.startswith("Dataset"):
        (tmp_path / "dataset").symlink_to(request.getfixturevalue("dataset"))
    cls = CLASSES.get(name)
    parts = [] if cls is None else [x for x in members(cls).values() if hasattr(x, "__get__")]
    properties = [x for x in parts if isinstance(x, property | cached_property)]
    examples = [x for y in (DOCUMENTED[name], *properties) for x in examples_of(name, y)]
    assert sum(len(x.examples) for x in examples) > 1
    for example in examples:
        assert doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example).failed == 0
