"""Which generated functions a formula is, what it is a part of, and which kernels call it."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache

from .formula import Formula

__all__ = ["callers", "functions", "wholes"]


def functions(sources: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the functions `file.name` of each name; `sources` are texts by names of files."""
    result: dict[str, list[str]] = {}
    for file in sorted(x for x in sources if x.endswith(".py")):
        for name in _functions_in(sources[file]):
            result.setdefault(name, []).append(f"{file.removesuffix('.py')}.{name}")
    return result


@lru_cache(maxsize=128)
def _functions_in(source: str) -> tuple[str, ...]:
    """Return the names of the functions of a module; pages ask again for each formula."""
    return tuple(x.name for x in ast.parse(source).body if isinstance(x, ast.FunctionDef))


def wholes(formula: Formula, formulas: Iterable[Formula]) -> list[str]:
    """Return the names of the formulas that do what this one does, and more.

    They may leave out a few of the outputs: `compose` drops what is not needed.
    """
    mine = dict(formula.definitions)

    def is_whole(other: Formula) -> bool:
        theirs = dict(other.definitions)
        if any(theirs.get(x, y) != y or x in other.inputs for x, y in mine.items()):
            return False
        shared = [x for x in formula.outputs if x in mine and x in theirs]
        return not theirs.keys() <= mine.keys() and 2 * len(shared) > len(formula.outputs)

    return [x.name for x in formulas if is_whole(x)]


def callers(sources: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the kernels `file.name` that call generated functions, by the names of these.

    `sources` are the texts of the files of kernels by their names.
    """
    result: dict[str, list[str]] = {}
    for file in sorted(sources):
        tree = ast.parse(sources[file])
        known = dict(_imported(tree))
        for node in tree.body:
            if name := _defined(node):
                for called in dict.fromkeys(_read(node, known)):
                    result.setdefault(called, []).append(f"{file.removesuffix('.py')}.{name}")
    return result


def _imported(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Yield the names by which a file knows what it imports from generated/, and what that is."""
    for node in tree.body:
        folder, _, module = (getattr(node, "module", None) or "").partition(".")
        if isinstance(node, ast.ImportFrom) and folder == "generated":
            for x in node.names:
                yield x.asname or x.name, f"{module}.{x.name}" if module else x.name


def _defined(node: ast.stmt) -> str | None:
    """Return the name that a statement gives to a function, if it does."""
    if isinstance(node, ast.FunctionDef):
        return node.name
    if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
        return node.targets[0].id
    return None


def _read(node: ast.stmt, known: Mapping[str, str]) -> Iterator[str]:
    """Yield the generated functions in a statement, alone or as parts of their modules."""
    for x in ast.walk(node):
        if isinstance(x, ast.Attribute) and isinstance(x.value, ast.Name) and x.value.id in known:
            yield f"{known[x.value.id]}.{x.attr}"
        elif isinstance(x, ast.Name) and x.id in known:
            yield known[x.id]
