"""Building blocks of commands: modules imported late, options in groups, types of values."""

from collections.abc import Callable
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import click
from click.core import ParameterSource

from .completion import is_source

# The key in a context that requests the whole help, for --help-all.
ALL = "gaussmap.all"


class Option(click.Option):
    """An option, given as the help shows it: "--spacing DX DY". An option without values is a flag.

    "INDEX ..." stands for one index or several, which are joined with commas to one text. The help
    lists an option in its group, and the brief help explains it if it is a `main` option. At most
    one of the `exclusive` options of a command may be given.
    """

    def __init__(
        self,
        usage: str,
        text: str,
        kind: Callable[[str], object] | click.ParamType = str,
        *,
        group: str = "options",
        exclusive: bool = False,
        main: bool = False,
        **settings: Any,  # noqa: ANN401
    ) -> None:
        words = usage.split()
        names = [word for word in words if word.startswith("-")]
        values = words[len(names) :]
        count = len(values) - (values[-1:] == ["..."])
        valued = {"type": kind, "metavar": " ".join(values), "nargs": count}
        super().__init__(names, help=text, **(valued if values else {"is_flag": True}), **settings)
        self.group, self.exclusive, self.main = group, exclusive, main


class Command(click.Command):
    """A command that, when it is called, imports the module of the same name and calls its `run`.

    So help, errors of usage and completion need neither NumPy nor Numba. `ctx.obj` is called after
    the imports. If a command has a `brief` epilog, its help fits on a screen and explains the main
    options only; --help-all explains all options.
    """

    def __init__(self, *arguments: Any, brief: str = "", **settings: Any) -> None:  # noqa: ANN401
        super().__init__(*arguments, **settings)
        self.brief = brief
        if brief:
            text = "Explain all options, and exit."
            shown = Option("--help-all", text, main=True, is_eager=True, callback=_show_all,
                expose_value=False)  # fmt: skip
            self.params.append(shown)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments; UsageError if two exclusive options are given."""
        try:
            rest = super().parse_args(ctx, self._joined(args))
        except click.UsageError as error:
            error.ctx = error.ctx or ctx
            raise
        exclusive = [x for x in self.params if isinstance(x, Option) and x.exclusive]
        sources = [ctx.get_parameter_source(x.name or "") for x in exclusive]
        given = [
            x.opts[-1]
            for x, source in zip(exclusive, sources, strict=True)
            if source is ParameterSource.COMMANDLINE
        ]
        if len(given) > 1:
            raise click.UsageError(f"{given[1]} is not allowed with {given[0]}", ctx)
        return rest

    def _joined(self, args: list[str]) -> list[str]:
        """Return the arguments; several numbers after one option are joined by commas."""
        several = {x.opts[-1] for x in self.params if str(x.metavar).endswith("...")}
        joined: list[str] = []
        for x in args:
            if x.isdigit() and several.intersection(joined[-2:-1]):
                joined[-1] += f",{x}"
            else:
                joined.append(x)
        return joined

    def invoke(self, ctx: click.Context) -> None:
        """Import the module that does the work, and run it."""
        module = import_module(f".{self.name}", __package__)
        ctx.obj()
        module.run(SimpleNamespace(**ctx.params))

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options under the headings of their groups.

        The brief help explains the main options, and only names the other ones.
        """
        groups: dict[str, list[tuple[str, str]]] = {}
        named: dict[str, list[str]] = {}
        for option in self.get_params(ctx):
            record = option.get_help_record(ctx)
            if record is None or not isinstance(option, click.Option):
                continue
            group = getattr(option, "group", "options")
            if not self._is_brief(ctx):
                groups.setdefault(group, []).append(record)
            elif getattr(option, "main", True):
                groups.setdefault("options", []).append(record)
            else:
                named.setdefault(group.partition(" (")[0], []).append(option.opts[-1])
        for group, records in groups.items():
            with formatter.section(group):
                formatter.write_dl(records)
        if named:
            with formatter.section("more options, explained by --help-all"):
                formatter.write_dl([(group, " ".join(names)) for group, names in named.items()])

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the epilog; in the brief help, the brief one."""
        whole = self.epilog
        self.epilog = self.brief if self._is_brief(ctx) else whole
        super().format_epilog(ctx, formatter)
        self.epilog = whole

    def _is_brief(self, ctx: click.Context) -> bool:
        return bool(self.brief) and not ctx.meta.get(ALL)


def _show_all(ctx: click.Context, _: click.Parameter, asked: bool) -> None:
    """Print the help on all options."""
    if asked and not ctx.resilient_parsing:
        ctx.meta[ALL] = True
        click.echo(ctx.get_help())
        ctx.exit()


class Program(click.Group):
    """A program whose help lists commands in the order in which they were added."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of the commands."""
        return [*self.commands]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the named command; UsageError with a hint if the name is that of a surface."""
        if args[0] not in self.commands and not ctx.resilient_parsing and is_source(args[0]):
            raise click.UsageError(
                f"no such command '{args[0]}'; did you mean `gaussmap sample {args[0]}`?", ctx
            )
        return super().resolve_command(ctx, args)


def number(text: str) -> float:
    """Return a number of any size: its range is checked where it is used."""
    try:
        return float(text)
    except ValueError:
        raise click.BadParameter(f"it must be a number, not {text!r}") from None


def whole(most: int, least: int = 1) -> Callable[[str], int]:
    """Return a parser of whole numbers from `least` to `most`."""

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = least - 1
        if not least <= value <= most:
            bounds = f"from {least} to {most:,}"
            raise click.BadParameter(f"it must be a whole number {bounds}, not {text!r}")
        return value

    return read


def setting(text: str) -> tuple[str, float]:
    """Return the name and the value of NAME=VALUE."""
    name, _, value = text.partition("=")
    if not (name and value):
        raise click.BadParameter(f"it must be NAME=VALUE, such as minor=0.2, not {text!r}")
    return name, number(value)


def density(text: str) -> str | float:
    """Return the exponent of |K| if the text is a number, else the text, the name of a density."""
    try:
        return float(text)
    except ValueError:
        return text
