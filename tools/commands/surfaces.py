"""The command `gaussmap surfaces`."""

from types import SimpleNamespace

from ...runtime.base.checks import known_name
from ...runtime.surface.surfaces import CATALOGUE, describe, names
from .console import say, table


def run(options: SimpleNamespace) -> None:
    """List all surfaces, or explain one."""
    if options.name is not None:
        say(describe(known_name(options.name, names(), "surface", "gaussmap surfaces")))
    else:
        table((name, CATALOGUE[name]["sentence"]) for name in names())
