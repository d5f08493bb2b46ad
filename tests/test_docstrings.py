"""What public functions say of themselves: in the form of numpydoc, with examples that run."""

import doctest
from collections.abc import Callable
from typing import Any

import gaussmap as gm
import pytest
from numpydoc.validate import validate

# Parameters that are missing, unknown or untyped; no section of what is returned or yielded; no
# summary; no example.
SERIOUS = {"GL08", "PR01", "PR02", "PR04", "RT01", "YD01", "SS01", "EX01"}


def functions() -> dict[str, Callable[..., Any]]:
    """Return the public functions by their names."""
    found = {
        f"{space}.{name}": getattr(getattr(gm, space), name)
        for space, names in {
            "curves": ["fit", "polygon_distance", "sample"],
            "directions": gm.directions.__all__,
            "gauss_map": ["classify_patches", "parabolic_lines", "parabolic_points", "split_patch"],
            "surfaces": [*gm.surfaces.__all__, *gm.surfaces.names()],
        }.items()
        for name in names
    }
    names = [
        "fit",
        "sample",
        "sample_many",
        "sample_stream",
        "read_samples",
        "convolve",
        "silhouette",
    ]
    return found | {name: getattr(gm, name) for name in names}


FUNCTIONS = functions()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_docstrings_have_the_sections_of_numpydoc(name: str, monkeypatch) -> None:
    function = FUNCTIONS[name]
    # The validator looks a function up by module and name, and does not see some of ours there.
    monkeypatch.setattr("numpydoc.validate.Validator._load_obj", lambda _: function)
    errors = validate(f"gaussmap.{name}")["errors"]
    assert [(code, text) for code, text in errors if code in SERIOUS] == []


@pytest.mark.compiled
@pytest.mark.parametrize("name", FUNCTIONS)
def test_examples_run(name: str, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    function = FUNCTIONS[name]
    examples = doctest.DocTestFinder(recurse=False).find(function, name, globs={})
    assert sum(len(x.examples) for x in examples) > 1
    for example in examples:
        assert doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example).failed == 0
