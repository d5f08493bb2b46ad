"""Pages of the site: lists that are written by hand are complete; formulas are MathML."""

import re
import runpy
import sys
from pathlib import Path
from xml.etree import ElementTree

import math_core
import pytest
from gaussmap.symbolic import latex
from gaussmap.tools.commands.parser import parser
from sphinx.errors import ConfigError

ROOT = Path(__file__).parents[2]


def test_every_command_has_a_heading_and_its_help() -> None:
    page = (ROOT / "docs" / "reference" / "command_line.md").read_text(encoding="utf-8")
    commands = [*parser().commands]
    assert re.findall(r"^## `gaussmap (.*)`$", page, re.MULTILINE) == commands
    assert re.findall(r"-m gaussmap (\w+) --help$", page, re.MULTILINE) == commands


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"])
def test_relative_links_lead_to_files(name: str) -> None:
    links = re.findall(r"\]\(([^)#\s]+)", (ROOT / name).read_text(encoding="utf-8"))
    relative = [x for x in links if not re.match(r"https?://", x)]
    assert [x for x in relative if not (ROOT / x).exists()] == []


def test_every_page_of_docs_is_in_the_site() -> None:
    """Sphinx refuses pages outside its trees of contents; here these trees name what exists."""
    docs = ROOT / "docs"
    for page in ("index", "measurements", "project", "gallery/index", "reference/index"):
        text = (docs / f"{page}.md").read_text(encoding="utf-8")
        (block,) = re.findall(r"```{toctree}\n((?:.*\n)*?)```", text)
        names = [x for x in block.splitlines() if x and not x.startswith(":")]
        for name in names:
            path = docs / Path(page).parent / name
            assert any(path.with_suffix(x).exists() for x in (".md", ".ipynb")), path


def test_a_command_that_pages_call_is_missed_at_once(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ConfigError, match="the command dask is not on PATH"):
        runpy.run_path(str(ROOT / "docs" / "conf.py"))


# --- formulas as MathML ---------------------------------------------------------------------------

sys.path.append(str(Path(__file__).parents[2] / "docs" / "_sphinx"))
mathml = __import__("mathml").mathml

ENTRIES = [x for entries in latex.sections().values() for x in entries]


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda x: x.name)
def test_mathml_has_no_foreign_characters(entry):
    """No remains of LaTeX, and no styles of letters that browsers do not know."""
    root = ElementTree.fromstring(mathml(entry.aligned, display=True))
    assert not re.search(r"[\\&${}]", "".join(root.itertext()))
    assert {x.get("mathvariant", "normal") for x in root.iter()} == {"normal"}


def test_an_index_that_is_a_word_is_one_upright_word():
    """An <mi> of several letters is upright; one for each letter would be their product."""
    (entry,) = (x for x in ENTRIES if x.name == "offset_curvature")
    display = ElementTree.fromstring(mathml(entry.aligned, display=True))
    assert [x.text for x in display.iter("mi")].count("offset") == 2


def test_unknown_latex_is_an_error():
    with pytest.raises(math_core.LatexError):
        mathml(r"\unheardof{x}")
