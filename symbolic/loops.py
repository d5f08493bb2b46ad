"""Formulas as loops over arrays with a row for each set of inputs; the formula is written out.

The loops are plain Python, which `runtime` compiles. A loop is self-contained: it can be read and
reused alone.
"""

import textwrap
from collections.abc import Collection, Mapping, Sequence
from typing import cast

import sympy as sp

from .emit import WIDTH, arguments, assignments, counts, described, grouped, unpacked
from .formula import Formula
from .notation import VectorSymbol
from .printer import source_of
from .simplify import straight_line

Symbols = Sequence[sp.Symbol]

# The names of the arrays of some arguments; the array of any other argument is named after it.
ARRAYS = {"n": "normals", "x": "points", "hessian": "hessians"}


def array_function(formula: Formula, over: Collection[sp.Symbol]) -> str:
    """Return a formula as a function of arrays, which fills the arrays of its outputs.

    The inputs in `over` are arrays with a row for each evaluation; all other inputs are arguments
    as in `emit.function`.
    """
    given = {x: y for x, y in arguments(formula).items() if not {*y} <= {*over}}
    inputs = {x: y for x, y in arguments(formula).items() if x not in given}
    outputs = {g[0] if g else x[0].name: x for g, x in grouped(formula.outputs)}
    arrays = {_array(name): _shape(name, x) for name, x in (inputs | outputs).items()}
    body = [
        *described(formula),
        *textwrap.wrap(f"Arrays: {', '.join(f'{x} {y}' for x, y in arrays.items())}.", WIDTH),
        '"""',
        *(line for item in given.items() for line in unpacked(*item)),
        row_loop(formula, inputs, outputs),
    ]
    definition = f"def {formula.name}({', '.join([*given, *arrays])}):\n"
    return definition + textwrap.indent("\n".join(body), "    ")


def jet_function(formula: Formula) -> str:
    """Return the 2-jet of a surface, a formula of u, v and parameters, as a function of arrays.

    Each of the 18 coordinates is assigned to its entry of the array, without a variable of its own.
    """
    u, v, *parameters = formula.inputs
    places = {
        y: sp.Symbol(f"jets[row, {i}, {j}]")
        for i, x in enumerate(formula.outputs)
        for j, y in enumerate(cast(VectorSymbol, x).components)
    }
    body = [
        f'"""{formula.sentence}',
        "",
        f"Source: {formula.source}; {counts(formula)}.",
        f"Arrays: {u}_values (k,), {v}_values (k,), jets (k, 6, 3).",
        '"""',
        f"for row in range({u}_values.shape[0]):",
        *(f"    {x} = {x}_values[row]" for x in (u, v)),
        *(
            f"    {places.get(x, x)} = {source_of(value)}"
            for x, value in straight_line(formula).assignments
        ),
    ]
    arguments = ", ".join([*map(str, parameters), f"{u}_values", f"{v}_values", "jets"])
    return f"def {formula.name}({arguments}):\n" + textwrap.indent("\n".join(body), "    ")


def row_loop(
    formula: Formula, inputs: Mapping[str, Symbols], outputs: Mapping[str, Symbols]
) -> str:
    """Return the loop that reads each row of the inputs and writes the row of the outputs.

    The keys of `inputs` and `outputs` are names of arguments. Raises ValueError if the formula uses
    a name that the loop uses.
    """
    taken = {"row", *map(_array, inputs), *map(_array, outputs)}
    names = {x.name for x, _ in straight_line(formula).assignments}
    if clash := taken & (names | {x.name for x in formula.in_components().inputs}):
        raise ValueError(f"{formula.name} and its loop both name {sorted(clash)}")
    lines = [
        *(f"{x} = {y}" for item in inputs.items() for x, y in _entries(*item)),
        *assignments(formula),
        *(f"{y} = {x}" for item in outputs.items() for x, y in _entries(*item)),
    ]
    count = f"{_array(next(iter(inputs)))}.shape[0]"
    return f"for row in range({count}):\n" + textwrap.indent("\n".join(lines), "    ")


def _array(argument: str) -> str:
    return ARRAYS.get(argument, f"{argument}_values")


def _entries(argument: str, symbols: Symbols) -> list[tuple[str, str]]:
    """Return pairs of the name of a number in an argument and its entry in the argument's array."""
    array = _array(argument)
    if argument == "hessian":
        return [
            (f"H_{''.join(sorted((x, y)))}", f"{array}[row, {i}, {j}]")
            for i, x in enumerate("xyz")
            for j, y in enumerate("xyz")
        ]
    (symbol,) = symbols
    if isinstance(symbol, VectorSymbol):
        return [(x.name, f"{array}[row, {i}]") for i, x in enumerate(symbol.components)]
    return [(symbol.name, f"{array}[row]")]


def _shape(argument: str, symbols: Symbols) -> str:
    row = _row_shape(argument, symbols)
    return f"(k, {', '.join(map(str, row))})" if row else "(k,)"


def _row_shape(argument: str, symbols: Symbols) -> tuple[int, ...]:
    if argument == "hessian":
        return 3, 3
    (symbol,) = symbols
    return (len(symbol.components),) if isinstance(symbol, VectorSymbol) else ()


def row_shapes(formula: Formula) -> tuple[dict[str, tuple[int, ...]], dict[str, tuple[int, ...]]]:
    """Return the shape of a row of each array of `array_function`: for inputs, and for outputs.

    Raises ValueError for a formula that takes or returns all vectors of a patch or an arc, since
    these are not in an array.
    """
    inputs = arguments(formula)
    outputs = {g[0] if g else x[0].name: x for g, x in grouped(formula.outputs)}
    for name, symbols in (inputs | outputs).items():
        if len(symbols) > 1 and name != "hessian":
            raise ValueError(
                f"{formula.name} has all vectors of one {name}, which is no array: name some of "
                f"{', '.join(map(str, symbols))} otherwise."
            )
    first, second = ({x: _row_shape(x, y) for x, y in part.items()} for part in (inputs, outputs))
    return first, second
