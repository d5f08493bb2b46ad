"""`gaussmap view`."""

from __future__ import annotations

from types import SimpleNamespace

from ..viewer.view import COUNT, check_target, view_to_file
from .console import summarize
from .inputs import arguments

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Write a page with a surface, its samples and their normals, linked."""
    check_target(options.output)
    samples = view_to_file(path=options.output, **arguments(options, default_count=COUNT))
    summarize(samples, options)
