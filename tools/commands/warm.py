"""`gaussmap warm`."""

from __future__ import annotations

from types import SimpleNamespace

from .console import say
from .warming import warm

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Compile all kernels that are not compiled yet."""
    kernels, seconds, folder = warm(progress=not options.quiet)
    if not options.quiet:
        done = f"{kernels} compiled in {seconds:.0f} s" if kernels else "all were compiled already"
        say(f"kernels in {folder}: {done}")
