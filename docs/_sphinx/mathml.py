"""Formulas as MathML: no scripts, and nothing to load."""

from __future__ import annotations

import re
from functools import cache
from html import unescape
from xml.etree import ElementTree

from docutils import nodes
from math_core import LatexToMathML
from sphinx.application import Sphinx
from sphinx.util.math import get_node_equation_number
from sphinx.writers.html5 import HTML5Translator

BRACKETS = {"(": "prefix", "[": "prefix", ")": "postfix", "]": "postfix"}
TALL = {"mfrac", "mtable"}
SCRIPTED = {"msub", "msup", "msubsup"}
HEIGHTS = {"mi": {"depth": "0"}, "mo": {"height": "0.6em", "depth": "0"}}
STRUT = {"height": "0.75em", "depth": "0.3em"}


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(writer: HTML5Translator, node: nodes.math) -> None:
    # On GitHub, $`x`$ is written for $x$.
    source = node.astext().removeprefix("`").removesuffix("`")
    writer.body.append(f'<span class="math">{mathml(source)}</span>')
    raise nodes.SkipNode


def _block(writer: HTML5Translator, node: nodes.math_block) -> None:
    number = ""
    if node["number"]:
        number = f'<span class="eqno">({get_node_equation_number(writer, node)})</span>'
    formula = mathml(node.astext(), display=True)
    writer.body.append(writer.starttag(node, "div", CLASS="math") + formula + number + "</div>\n")
    raise nodes.SkipNode


@cache
def mathml(source: str, *, display: bool = False) -> str:
    """Return LaTeX as MathML that is well-formed XML."""
    # math-core knows no distances between rows: the stylesheet sets them.
    rows = re.sub(r"\\\\\[\w+\]", r"\\\\", source)
    converted = _converter().convert_with_local_state(rows, displaystyle=display)
    # XML has no named characters but these.
    root = ElementTree.fromstring(
        re.sub(r"&(?!(?:amp|lt|gt);)\w+;", lambda x: unescape(x[0]), converted)
    )
    for element in list(root.iter()):
        _set_like_tex(element)
    return ElementTree.tostring(root, encoding="unicode")


def _set_like_tex(element: ElementTree.Element) -> None:
    """Correct the positions that browsers set worse than TeX does."""
    grows = any(part.tag in TALL for part in element.iter())
    for bracket in element.findall("mo"):
        if bracket.text in BRACKETS:
            # Without a form, a bracket inside a row is a binary operator, with space around it. A
            # bracket that may grow is as wide as its widest variant.
            bracket.set("form", BRACKETS[bracket.text])
            if bracket.attrib.pop("minsize", None) or not grows:
                bracket.attrib.pop("maxsize", None)
                bracket.set("stretchy", "false")
    if element.tag in SCRIPTED and element[0].tag in HEIGHTS:
        # A subscript is placed relative to the baseline, not to the descender of a letter such as
        # p, and a superscript does not rise with the height of a bracket.
        base = ElementTree.Element("mpadded", HEIGHTS[element[0].tag])
        base.append(element[0])
        element[0] = base
    if element.tag == "mrow" and element.find("mtable") is not None:
        # Only fonts for mathematics have tall brackets; the stylesheet draws those of columns.
        for bracket in element.findall("mo"):
            element.remove(bracket)
    if element.tag == "mtr":
        # Rows are at equal distances, whether they hold powers or not.
        element[0].insert(0, ElementTree.Element("mspace", STRUT))


@cache
def _converter() -> LatexToMathML:
    return LatexToMathML(fancy_error=False)
