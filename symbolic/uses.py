"""Which functions of the generated files run a formula."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from .formula import Formula

__all__ = ["Kernels", "Uses"]

# The first line of a formula in a loop, as `emit.block` writes it.
BLOCK = re.compile(r"^ *# (\w+) \(.+\): \d+ operations", re.MULTILINE)


@dataclass(frozen=True)
class Function:
    """A function of a generated file: which formulas stand in it, and which functions it calls."""

    module: str
    name: str
    formulas: frozenset[str]
    calls: frozenset[str]


@dataclass(frozen=True)
class Uses:
    """The functions of a file in which a formula stands, and those that call them.

    `inside` also says as what it stands there: as itself, or as a part of another formula.
    """

    inside: dict[str, str]
    callers: tuple[str, ...]

    def items(self, formula: Formula) -> list[tuple[str, str | None]]:
        """Return the functions inside, each with the formula of which this one is a part there."""
        return [
            (name, None if whole in (formula.name, name) else whole)
            for name, whole in self.inside.items()
        ]


class Kernels:
    """The functions of generated files, given as their texts, and the formulas in them."""

    def __init__(
        self, sources: Mapping[str, str], formulas: Iterable[Formula], alone: Iterable[str]
    ) -> None:
        """Read the files; `alone` are names of formulas that are never part of one another."""
        self.formulas = {x.name: x for x in formulas}
        self.names = {*self.formulas, *alone}
        self.functions = [
            function
            for module in sorted(x for x in sources if x.endswith(".py"))
            for function in self._functions(module, sources[module])
        ]

    def uses(self, formula: Formula) -> dict[str, Uses]:
        """Return where a formula stands and is called from, by the names of the files."""
        composed = (x.name for x in self.formulas.values() if _is_part(formula, x))
        wholes = [formula.name, *composed]
        result = {}
        for module in dict.fromkeys(x.module for x in self.functions):
            functions = [x for x in self.functions if x.module == module]
            inside = {
                x.name: next(whole for whole in wholes if whole in x.formulas)
                for x in functions
                if not x.formulas.isdisjoint(wholes)
            }
            reached = set(inside)
            while more := {x.name for x in functions if not x.calls.isdisjoint(reached)} - reached:
                reached |= more
            if inside:
                callers = (x.name for x in functions if x.name in reached - inside.keys())
                result[module] = Uses(inside, tuple(callers))
        return result

    def sentence(self, formula: Formula) -> str:
        """Return the uses in words, names in backquotes: "none" or one part for each file."""
        parts = []
        for module, uses in self.uses(formula).items():
            inside = ", ".join(
                f"`{name}`" + (f" (in `{whole}`)" if whole else "")
                for name, whole in uses.items(formula)
            )
            callers = ", ".join(f"`{name}`" for name in uses.callers)
            parts.append(f"`{module}`: {inside}" + (f", called by {callers}" if callers else ""))
        return "; ".join(parts) or "none"

    def _functions(self, module: str, source: str) -> Iterable[Function]:
        for node in ast.parse(source).body:
            if isinstance(node, ast.FunctionDef):
                blocks = BLOCK.findall(ast.get_source_segment(source, node) or "")
                inside = frozenset({node.name, *blocks} & self.names)
                calls = (x.func for x in ast.walk(node) if isinstance(x, ast.Call))
                called = frozenset(x.id for x in calls if isinstance(x, ast.Name))
                yield Function(module, node.name, inside, called)


def _is_part(formula: Formula, whole: Formula) -> bool:
    """Say whether another formula does what this one does, and more.

    It may leave out a few of the outputs: `compose` drops what is not needed.
    """
    outputs = {pair for pair in formula.definitions if pair[0] in formula.outputs}
    shared, more = outputs & {*whole.definitions}, {*whole.definitions} - {*formula.definitions}
    return bool(more) and 2 * len(shared) > len(outputs)
