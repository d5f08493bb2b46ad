"""Formulas as MathML, by the same code as the page of `gaussmap formulas --html`: no scripts."""

from __future__ import annotations

from docutils import nodes
from gaussmap.symbolic.html import mathml
from sphinx.application import Sphinx
from sphinx.util.math import get_node_equation_number
from sphinx.writers.html5 import HTML5Translator


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(writer: HTML5Translator, node: nodes.math) -> None:
    # GitHub writes $`x`$ for what is $x$ elsewhere.
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
