"""The command `gaussmap formulas`."""

from types import SimpleNamespace

from .console import say, table
from .formula_texts import formulas


def run(options: SimpleNamespace) -> None:
    """List all formulas, or show one."""
    if options.name is not None:
        formula = formulas[options.name]
        head = f"{formula.name}: {formula.sentence}\nSource: {formula.source}.\n\n"
        say(formula.latex() if options.latex else head + formula.text())
    elif options.latex:
        say("\n\n".join(f"% {name}\n{formula.latex()}" for name, formula in formulas.items()))
    else:
        table((name, f"{f.sentence} [{f.source}]") for name, f in formulas.items())
