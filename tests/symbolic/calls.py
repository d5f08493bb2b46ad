"""Formulas for given values, and arguments and results of the functions made of them."""

from typing import Any

import sympy as sp
from gaussmap.generated import vectors
from gaussmap.symbolic import emit
from gaussmap.symbolic.notation import VectorSymbol, scalar, substitute


def components(**named: Any) -> dict[sp.Expr, Any]:
    """Return the components of vectors of the plane or of space, by their symbols."""
    return {
        scalar(f"{name}_{axis}"): x
        for name, vector in named.items()
        for axis, x in zip("xyz"[: len(vector)], vector, strict=True)
    }


def evaluated(formula: Any, values: dict[Any, Any]) -> dict[str, Any]:
    """Return the outputs of a formula by their names, with values in the place of symbols."""
    return {name: substitute(x, values) for name, x in formula.expanded().items()}


TYPES = {"patch": vectors.Patch, "arc": vectors.Arc, "hessian": vectors.Hessian}


def grouped(formula: Any, inputs: dict[str, Any]) -> dict[str, Any]:
    """Return the arguments of the function of a formula: named tuples, vectors and numbers.

    A point that a patch does not need is its vector a.
    """

    def value(symbol: sp.Symbol) -> Any:
        if not isinstance(symbol, VectorSymbol):
            return inputs[symbol.name]
        kind = getattr(vectors, emit.KINDS[type(symbol)][0])
        return kind(*(inputs[x.name] for x in symbol.components))

    result = {}
    for name, symbols in emit.arguments(formula).items():
        found = {x.name: value(x) for x in symbols}
        if name in TYPES:
            others = dict.fromkeys(TYPES[name]._fields, found.get("a"))
            result[name] = TYPES[name](**others | found)
        else:
            (result[name],) = found.values()
    return result


def flat(result: Any) -> list[Any]:
    """Return the numbers in nested tuples, one after the other."""
    return [x for y in result for x in flat(y)] if isinstance(result, tuple) else [result]
