"""`gaussmap view`."""

from __future__ import annotations

from types import SimpleNamespace

from ...runtime.sample import sample
from ..viewer.view import COUNT, check_count, check_target, view
from .console import summarize
from .inputs import arguments

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Write a page with a surface, its samples and their normals, linked."""
    check_target(options.output)
    given = arguments(options, default_count=COUNT)
    check_count(given["count"] or 0)
    samples = sample(**given)
    view(samples, options.output, samples.spline or given["surface"])
    summarize(samples, options)
