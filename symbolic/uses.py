"""The generated functions of a formula, and the formulas that contain it."""

import ast
from collections.abc import Iterable, Mapping
from functools import lru_cache

from .formula import Formula


def functions(sources: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the generated functions of each formula, as `file.name`, by the formula's name.

    `sources` are the contents of generated files, by file name.
    """
    result: dict[str, list[str]] = {}
    for file in sorted(x for x in sources if x.endswith(".py")):
        for name in _functions_in(sources[file]):
            result.setdefault(name, []).append(f"{file.removesuffix('.py')}.{name}")
    return result


@lru_cache(maxsize=128)
def _functions_in(source: str) -> tuple[str, ...]:
    """Return the names of the functions of a module, cached for the pages of many formulas."""
    return tuple(x.name for x in ast.parse(source).body if isinstance(x, ast.FunctionDef))


def wholes(formula: Formula, formulas: Iterable[Formula]) -> list[str]:
    """Return the names of those `formulas` that contain `formula`.

    A formula counts as containing `formula` if it has further definitions, if all definitions that
    both have are equal, if none of its inputs is defined by `formula`, and if more than half of the
    outputs of `formula` are among its definitions. Not all outputs are required, since `compose`
    drops outputs that are not needed.
    """
    mine = dict(formula.definitions)

    def is_whole(other: Formula) -> bool:
        theirs = dict(other.definitions)
        if any(theirs.get(x, y) != y or x in other.inputs for x, y in mine.items()):
            return False
        shared = [x for x in formula.outputs if x in mine and x in theirs]
        return not theirs.keys() <= mine.keys() and 2 * len(shared) > len(formula.outputs)

    return [x.name for x in formulas if is_whole(x)]
