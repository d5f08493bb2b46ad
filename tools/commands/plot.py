"""`gaussmap plot`."""

from __future__ import annotations

from types import SimpleNamespace

from ..pictures.to_file import check_target, plot_to_file
from .console import summarize
from .inputs import arguments

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Draw a surface and its samples."""
    check_target(options.output)
    samples = plot_to_file(path=options.output, **arguments(options, default_count=2_000))
    summarize(samples, options)
