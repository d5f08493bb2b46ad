"""`gaussmap formulas`."""

from __future__ import annotations

from types import SimpleNamespace

from ...runtime.base.checks import known_name
from ...runtime.base.errors import InputError
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import names, surface
from .console import say, table
from .formula_texts import formulas
from .tape_texts import tape_text

__all__ = ["run"]

ANYWHERE = ((0.0, 1.0), (0.0, 1.0))  # tapes do not depend on the domain


def run(options: SimpleNamespace) -> None:
    """List all formulas, or show one; or show the tape of a surface."""
    if options.formula is not None and not options.tape:
        raise InputError("--formula is for --tape, which is not there.")
    if options.tape:
        _show_tape(options)
    elif options.name is not None:
        formula = formulas[options.name]
        head = f"{formula.name}: {formula.sentence}\nSource: {formula.source}.\n\n"
        say(formula.latex() if options.latex else head + formula.text())
    elif options.latex:
        say("\n\n".join(f"% {name}\n{formula.latex()}" for name, formula in formulas.items()))
    else:
        table((name, f"{f.sentence} [{f.source}]") for name, f in formulas.items())


def _show_tape(options: SimpleNamespace) -> None:
    if (options.name is None) == (options.formula is None):
        raise InputError("--tape needs the name of a surface, or --formula X Y Z.")
    if options.formula is None:
        found = surface(known_name(options.name, names(), "surface", "gaussmap surfaces"))
    else:
        found = Surface.from_sympy(options.formula, ("u", "v"), ANYWHERE)
    if found.tape is None:
        raise InputError("this formula has no tape: its functions are no operations of tapes.")
    say(tape_text(found.tape))
