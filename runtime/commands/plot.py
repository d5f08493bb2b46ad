"""`gaussmap plot`."""

from __future__ import annotations

from types import SimpleNamespace

from ..pictures import plot
from .console import summarize
from .inputs import arguments

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Draw a surface and its samples."""
    plot.check_target(options.output)
    samples = plot.plot(path=options.output, **arguments(options, default_count=2_000))
    summarize(samples, options)
