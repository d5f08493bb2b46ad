"""The command `gaussmap view`."""

from types import SimpleNamespace

from ..viewer.view import COUNT, check_count, check_target, view
from .console import summarize
from .sampled import sampled


def run(options: SimpleNamespace) -> None:
    """Write a page with a surface, its samples and their normals, linked."""
    check_target(options.output)
    check_count(options.count or 0)
    samples, _ = sampled(options, COUNT)
    view(samples, options.output)
    summarize(samples, options)
