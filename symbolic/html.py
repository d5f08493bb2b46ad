"""All formulas and surfaces as one page for browsers: MathML, no scripts, nothing to load."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from html import escape, unescape
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import sympy as sp

from . import latex, surfaces
from .display import latex_of
from .emit import render
from .files import GENERATED, existing
from .uses import callers, functions

if TYPE_CHECKING:
    from math_core import LatexToMathML

__all__ = ["mathml", "page"]

# The text of the kernels is read to say which of them call a formula.
KERNELS = tuple(GENERATED.parent / place / "kernels" for place in ("runtime", "tools"))
GENERATOR = f"Written by `gaussmap formulas --html` with SymPy {sp.__version__}."
WORD_JOINER = "\u2060"  # no line ends here
BRACKETS = {"(": "prefix", "[": "prefix", ")": "postfix", "]": "postfix"}
TALL = {"mfrac", "mtable"}
SCRIPTED = {"msub", "msup", "msubsup"}
HEIGHTS = {"mi": {"depth": "0"}, "mo": {"height": "0.6em", "depth": "0"}}
STRUT = {"height": "0.75em", "depth": "0.3em"}


def page() -> str:
    """Return the page; raises ImportError if math-core, of the extra `html`, is not installed.

    It is HTML and well-formed XML, and depends on nothing but the formulas and generated/.
    """
    sections = latex.sections()
    return render(
        "formulas.html",
        {
            "generator": f'<meta name="generator" content="{escape(GENERATOR)}"/>',
            "contents": _contents(sections),
            "sections": "\n".join(_section(title, sections[title]) for title in sections),
        },
    )


# --- the parts of the page ------------------------------------------------------------------------


def _contents(sections: dict[str, list[latex.Entry]]) -> str:
    items = (
        f'<li><a href="#{_anchor(title)}">{escape(title)}</a>\n'
        + _list(_link(x.name) for x in entries)
        + "</li>"
        for title, entries in sections.items()
    )
    return "<ul>\n" + "\n".join(items) + "\n</ul>"


def _section(title: str, entries: list[latex.Entry]) -> str:
    anchor = _anchor(title)
    head = f'<section aria-labelledby="{anchor}">\n<h2 id="{anchor}">{escape(title)}</h2>'
    return "\n".join([head, *map(_article, entries), "</section>"])


def _article(entry: latex.Entry) -> str:
    """Return one formula or surface."""
    rows = "\n".join(f"<dt>{term}</dt><dd>{value}</dd>" for term, value in _rows(entry))
    source = f'\n<p class="source">{escape(entry.formula.source)}</p>'
    return (
        f'<article id="{entry.name}">\n'
        f"<header>\n<h3>{_link(entry.name)}</h3>"
        f"{'' if entry.name in surfaces.CATALOGUE else source}\n</header>\n"
        f"<p>{_text(entry.sentence)}</p>\n"
        f'<div class="formula">{mathml(entry.aligned, display=True)}</div>\n'
        f"<dl>\n{rows}\n</dl>\n"
        "</article>"
    )


def _rows(entry: latex.Entry) -> Iterator[tuple[str, str]]:
    """Yield what is said about a formula or surface: a word, and the rest."""
    for fact in entry.facts:
        term, colon, value = fact.removesuffix(".").partition(": ")
        if not colon:
            yield "Ends", _text(term)
        elif term != "Source":  # it stands beside the name
            yield _text(term), _text(value)
        if term == "Inputs":
            outputs = entry.formula.outputs
            yield "Outputs", _text(", ".join(f"${latex_of(x)}$" for x in outputs))
    own = functions(_texts(GENERATED)).get(entry.name, [])
    yield "Functions", _names(own)
    if parts := latex.parts_of(entry.formula):
        yield "Part of", ", ".join(map(_link, parts))
    if kernels := [x for name in own for x in _callers().get(name, ())]:
        yield "Kernels", _names(kernels)


def _names(names: list[str]) -> str:
    return ", ".join(f"<code>{x}</code>" for x in names) or "none"


@cache
def _callers() -> dict[str, list[str]]:
    texts = {x: y for folder in KERNELS for x, y in _texts(folder).items()}
    return callers({x: y for x, y in sorted(texts.items()) if x.endswith(".py")})


@cache
def _texts(folder: Path) -> dict[str, str]:
    return existing(folder)


def _list(items: Iterable[str]) -> str:
    return "<ul>\n" + "\n".join(f"<li>{item}</li>" for item in items) + "\n</ul>"


def _link(name: str) -> str:
    return f'<a href="#{name}"><code>{name}</code></a>'


def _anchor(title: str) -> str:
    return re.sub(r"\W+", "-", title.lower())


# --- mathematics ----------------------------------------------------------------------------------


def _text(sentence: str) -> str:
    """Return a sentence, with LaTeX between dollar signs and names of formulas in backquotes."""
    parts = sentence.split("$")
    parts[::2] = (re.sub(r"`(\w+)`", lambda x: _link(x[1]), escape(x)) for x in parts[::2])
    parts[1::2] = map(mathml, parts[1::2])
    return "".join(parts).replace("(<math", f"({WORD_JOINER}<math")


@cache
def mathml(source: str, *, display: bool = False) -> str:
    """Return LaTeX as MathML that is well-formed XML."""
    # math-core knows no distances between rows: the stylesheet sets them.
    rows = re.sub(r"\\\\\[\w+\]", r"\\\\", source)
    converted = _converter().convert_with_local_state(rows, displaystyle=display)
    # XML has no other named characters than these.
    root = ElementTree.fromstring(
        re.sub(r"&(?!(?:amp|lt|gt);)\w+;", lambda x: unescape(x[0]), converted)
    )
    for element in list(root.iter()):
        _set_like_tex(element)
    return ElementTree.tostring(root, encoding="unicode")


def _set_like_tex(element: ElementTree.Element) -> None:
    """Change what browsers set worse than TeX does."""
    grows = any(part.tag in TALL for part in element.iter())
    for bracket in element.findall("mo"):
        if bracket.text in BRACKETS:
            # In the middle of a row it would be a binary operator, with space round it; and one
            # that may grow gets the room of the widest that there is.
            bracket.set("form", BRACKETS[bracket.text])
            if bracket.attrib.pop("minsize", None) or not grows:
                bracket.attrib.pop("maxsize", None)
                bracket.set("stretchy", "false")
    if element.tag in SCRIPTED and element[0].tag in HEIGHTS:
        # An index hangs from the baseline, not from the tail of a letter such as p, and a power
        # stands no higher for a bracket.
        base = ElementTree.Element("mpadded", HEIGHTS[element[0].tag])
        base.append(element[0])
        element[0] = base
    if element.tag == "mrow" and element.find("mtable") is not None:
        # Only fonts made for mathematics have tall brackets: the stylesheet draws those of columns.
        for bracket in element.findall("mo"):
            element.remove(bracket)
    if element.tag == "mtr":
        # Rows are at equal distances, whether they hold powers or not.
        element[0].insert(0, ElementTree.Element("mspace", STRUT))


@cache
def _converter() -> LatexToMathML:
    from math_core import LatexToMathML

    return LatexToMathML(fancy_error=False)
