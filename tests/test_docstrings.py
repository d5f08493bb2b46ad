"""What the public interface says of itself: in the form of numpydoc, with examples that run."""

import doctest
import inspect
import re
from enum import Enum
from functools import cached_property
from typing import Any

import gaussmap as gm
import pytest
from numpydoc.docscrape import NumpyDocString
from numpydoc.validate import validate

from .interface import CALLABLES, CLASSES, FUNCTIONS, METHODS, members, methods_of

# Parameters that are missing, unknown or untyped; no section of what is returned or yielded; no
# summary; no example.
SERIOUS = {"GL08", "PR01", "PR02", "PR04", "RT01", "YD01", "SS01", "EX01"}
# Of classes: their attributes are the parameters, and are checked below.
OF_CLASSES = SERIOUS - {"PR01", "PR02", "PR04"}
DOCUMENTED = CALLABLES | CLASSES


def examples_of(name: str, documented: Any) -> list[doctest.DocTest]:
    return doctest.DocTestFinder(recurse=False).find(documented, name, globs={})


def test_all_that_is_public_is_looked_at():
    assert {"sample", "curves.fit", "surfaces.torus", "directions.cap"} <= {*FUNCTIONS}
    assert {"Samples", "curves.Curve", "gauss_map.GaussianImage"} <= {*CLASSES}
    assert {"Samples.mesh", "Surface.from_grid", "Samples.to_trimesh"} <= {*METHODS}
    assert {"points", "spline", "kind", "mesh"} <= {*members(gm.Samples)}
    assert all(callable(x) for x in FUNCTIONS.values())


@pytest.mark.parametrize("name", DOCUMENTED)
def test_functions_and_classes_have_the_sections_of_numpydoc(name: str, monkeypatch) -> None:
    # The validator looks an object up by module and name, and does not see some of ours there.
    monkeypatch.setattr("numpydoc.validate.Validator._load_obj", lambda _: DOCUMENTED[name])
    serious = OF_CLASSES if name in CLASSES else SERIOUS
    errors = validate(f"gaussmap.{name}")["errors"]
    assert [(code, text) for code, text in errors if code in serious] == []


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
