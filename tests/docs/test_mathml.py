"""Formulas as MathML on the pages of the site."""

import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import math_core
import pytest
from gaussmap.symbolic import latex

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
