"""`gaussmap formulas`."""

from __future__ import annotations

from types import SimpleNamespace

from ...runtime.base.bridge import formula_page
from ...runtime.base.errors import InputError
from ...runtime.base.extras import check_extra
from ...runtime.surface.surfaces import names
from ..files.paths import atomic_path, check_target
from .console import say, table
from .formula_texts import formulas

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """List all formulas, show one, or write a page of all."""
    if options.html is not None:
        _write(options)
    elif options.name is not None:
        formula = formulas[options.name]
        head = f"{formula.name}: {formula.sentence}\nSource: {formula.source}.\n\n"
        say(formula.latex() if options.latex else head + formula.text())
    elif options.latex:
        say("\n\n".join(f"% {name}\n{formula.latex()}" for name, formula in formulas.items()))
    else:
        table((name, f"{f.sentence} [{f.source}]") for name, f in formulas.items())


def _write(options: SimpleNamespace) -> None:
    if options.name is not None:
        raise InputError("--html writes all formulas to one page; leave out the name.")
    check_target(options.html, (".html",))
    check_extra("math_core", "html", "the page")
    page = formula_page()
    with atomic_path(options.html) as temporary:
        temporary.write_text(page, encoding="utf-8", newline="\n")
    say(f"{options.html}: {len(formulas)} formulas and {len(names())} surfaces")
