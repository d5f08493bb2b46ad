"""`gaussmap completion`, and the completions of shells; neither needs NumPy or Numba."""

from __future__ import annotations

import os
import re
from importlib.resources import files
from pathlib import PurePath
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import click
from click.shell_completion import CompletionItem, get_completion_class, shell_complete

if TYPE_CHECKING:
    from collections.abc import Iterable

PROGRAM = "gaussmap"
SHELLS = ("bash", "zsh", "fish")
# A shell that requests completions sets this variable to an instruction for Click.
VARIABLE = "_GAUSSMAP_COMPLETE"


def run(options: SimpleNamespace) -> None:
    """Print the script that a shell runs to enable completion."""
    from .console import say

    shell = get_completion_class(options.shell)
    assert shell is not None
    say(shell(click.Command(PROGRAM), {}, PROGRAM, VARIABLE).source())


def completed(program: click.Command) -> int | None:
    """Answer a shell that requests completions, and return the exit code; else return None."""
    if VARIABLE not in os.environ:
        return None
    return shell_complete(program, {}, PROGRAM, VARIABLE, os.environ[VARIABLE])


def densities(_: click.Context, __: click.Parameter, begun: str) -> list[str]:
    """Complete the name of a density."""
    return _begun(("aligned", "balanced", "gauss", "uniform"), begun)


def surface_names(_: click.Context, __: click.Parameter, begun: str) -> list[CompletionItem]:
    """Complete the name of a surface."""
    return [CompletionItem(name) for name in _begun(_catalogue(), begun)]


def surfaces_and_files(
    context: click.Context, parameter: click.Parameter, begun: str
) -> list[CompletionItem]:
    """Complete the name of a surface, or let the shell complete a file name."""
    names = surface_names(context, parameter, begun)
    return [*names, CompletionItem(begun, type="file")]


def settings(context: click.Context, _: click.Parameter, begun: str) -> list[str]:
    """Complete the name of a parameter of the surface named earlier on the line."""
    # Click leaves words in `args` while an option, here --set, has no value yet.
    words = [context.params.get("surface"), *context.args]
    surfaces = [x for word in words if (x := _catalogue().get(word or "")) is not None]
    return _begun([f"{name}=" for x in surfaces[:1] for name in x["parameters"]], begun)


def formula_names(_: click.Context, __: click.Parameter, begun: str) -> list[str]:
    """Complete the name of a formula, from the formulas page, because loading SymPy is slow."""
    page = (files("gaussmap.generated") / "formulas.md").read_text(encoding="utf-8")
    names = re.findall(r"^### `(\w+)`$", page, re.MULTILINE)
    return _begun([name for name in names if name not in _catalogue()], begun)


def is_source(word: str) -> bool:
    """Return whether a word names a surface of the catalogue, or, by its suffix, a file."""
    return word in _catalogue() or bool(PurePath(word).suffix)


def _catalogue() -> dict[str, dict[str, Any]]:
    from ...generated.surfaces import CATALOGUE

    return cast("dict[str, dict[str, Any]]", CATALOGUE)


def _begun(names: Iterable[str], begun: str) -> list[str]:
    return [name for name in names if name.startswith(begun)]
