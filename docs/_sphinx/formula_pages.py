"""A page for each section of the formulas, with the texts of generated/formulas.md.

Each formula has its description, its LaTeX, and the source of the functions printed from it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from gaussmap.symbolic import latex
from gaussmap.symbolic.files import GENERATED, existing
from gaussmap.symbolic.uses import functions
from sphinx.application import Sphinx


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before Sphinx looks for them."""
    app.connect("builder-inited", _write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _write(app: Sphinx) -> None:
    folder = Path(app.srcdir) / "formulas"
    found = functions(existing(GENERATED))
    for title, entries in latex.sections().items():
        path = folder / (title.lower().replace(" ", "_") + ".md")
        text = "\n\n".join([f"# {title}", *(x for y in entries for x in _entry(y, found))]) + "\n"
        # Sphinx reads only files that have changed.
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8", newline="\n")


def _entry(entry: latex.Entry, found: dict[str, list[str]]) -> Iterator[str]:
    names = {x.name for section in latex.sections().values() for x in section}

    def link(name: re.Match[str]) -> str:
        return f"[{name[0]}](#formula-{name[1]})" if name[1] in names else name[0]

    sentence, formula, facts = latex.passages(entry, found)
    yield f"(formula-{entry.name})=\n## `{entry.name}`"
    yield re.sub(r"(?<!\$)`(\w+)`(?!\$)", link, sentence)
    yield formula
    yield re.sub(r"(?<!\$)`(\w+)`(?!\$)", link, facts)
    for name in found.get(entry.name, ()):
        module, _, function = name.partition(".")
        yield (
            f":::{{dropdown}} Source of `{name}`\n"
            f"```{{literalinclude}} ../../generated/{module}.py\n:pyobject: {function}\n```\n:::"
        )
