"""What commands and options are made of: help in groups, exclusive options, kinds of numbers."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import click
from click.core import ParameterSource
from click.shell_completion import CompletionItem

__all__ = ["Command", "Density", "Number", "Option", "Program", "Setting", "SurfaceName", "Whole"]


class Option(click.Option):
    """An option that stands in a group of the help; only one of the exclusive ones may be given."""

    def __init__(
        self,
        declarations: list[str],
        *,
        group: str = "options",
        exclusive: bool = False,
        **settings: Any,  # noqa: ANN401
    ) -> None:
        super().__init__(declarations, **settings)
        self.group, self.exclusive = group, exclusive


class Command(click.Command):
    """A command whose work is `run` in the module of its name, imported when it is called.

    So help, errors of usage and completion need neither NumPy nor Numba. `ctx.obj` is
    called when the imports are done.
    """

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse, and refuse two exclusive options."""
        try:
            rest = super().parse_args(ctx, args)
        except click.UsageError as error:
            error.ctx = error.ctx or ctx
            raise
        given = [
            x.opts[-1]
            for x in self.params
            if isinstance(x, Option)
            and x.exclusive
            and ctx.get_parameter_source(x.name or "") is ParameterSource.COMMANDLINE
        ]
        if len(given) > 1:
            raise click.UsageError(f"{given[1]} is not allowed with {given[0]}", ctx)
        return rest

    def invoke(self, ctx: click.Context) -> None:
        """Import the module that does the work, and have it done."""
        module = import_module(f".{self.name}", __package__)
        ready: Callable[[], object] = ctx.obj
        ready()
        module.run(SimpleNamespace(**ctx.params))

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options under the headings of their groups."""
        groups: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None and isinstance(parameter, click.Option):
                group = parameter.group if isinstance(parameter, Option) else "options"
                groups.setdefault(group, []).append(record)
        for group, records in groups.items():
            with formatter.section(group):
                formatter.write_dl(records)


class Program(click.Group):
    """A program whose help lists commands in the order in which they were added."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of the commands."""
        return [*self.commands]


class Number(click.ParamType):
    """A number of any size, infinite or not: what is sensible is known where it is used."""

    name = "number"

    def convert(self, value: Any, param: Any, ctx: Any) -> float:  # noqa: ANN401
        """Return the number."""
        try:
            return float(value)
        except ValueError:
            self.fail(f"it must be a number, not {value!r}", param, ctx)


class Whole(click.ParamType):
    """A whole number within bounds."""

    name = "whole number"

    def __init__(self, most: int, least: int = 1) -> None:
        self.most, self.least = most, least

    def convert(self, value: Any, param: Any, ctx: Any) -> int:  # noqa: ANN401
        """Return the number."""
        try:
            number = int(value)
        except ValueError:
            number = self.least - 1
        if not self.least <= number <= self.most:
            bounds = f"from {self.least} to {self.most:,}"
            self.fail(f"it must be a whole number {bounds}, not {value!r}", param, ctx)
        return number


class Setting(click.ParamType):
    """NAME=VALUE."""

    name = "setting"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[str, float]:  # noqa: ANN401
        """Return the name and the value."""
        name, _, number = value.partition("=")
        if not (name and number):
            self.fail(f"it must be NAME=VALUE, such as minor=0.2, not {value!r}", param, ctx)
        return name, Number().convert(number, param, ctx)


class Density(click.ParamType):
    """A name, or the power of |K|."""

    name = "density"

    def convert(self, value: Any, param: Any, ctx: Any) -> str | float:  # noqa: ANN401
        """Return a number if it is one."""
        try:
            return float(value)
        except ValueError:
            return value

    def shell_complete(self, ctx: Any, param: Any, incomplete: str) -> list[CompletionItem]:  # noqa: ANN401
        """Return the names."""
        return _completed(("balanced", "gauss", "uniform"), incomplete)


class SurfaceName(click.ParamType):
    """The name of a surface of the catalogue, or with `files` also a file."""

    name = "surface"

    def __init__(self, files: bool) -> None:
        self.files = files

    def shell_complete(self, ctx: Any, param: Any, incomplete: str) -> list[CompletionItem]:  # noqa: ANN401
        """Return the names, and leave files to the shell."""
        from ..surfaces import names

        file = [CompletionItem(incomplete, type="file")]
        return _completed(names(), incomplete) + (file if self.files else [])


def _completed(names: tuple[str, ...], incomplete: str) -> list[CompletionItem]:
    return [CompletionItem(name) for name in names if name.startswith(incomplete)]
