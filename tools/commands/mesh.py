"""`gaussmap mesh`."""

from __future__ import annotations

from types import SimpleNamespace

from ...runtime.sample import sample
from ..files.formats import check_mesh_target
from .console import summarize
from .inputs import arguments

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Sample a surface and write a mesh of the samples to a file."""
    check_mesh_target(options.output)
    samples = sample(**arguments(options, default_count=10_000))
    mesh = samples.mesh(angle=options.deviation, prefer=options.prefer, progress=not options.quiet)
    mesh.write(options.output)
    summarize(mesh, options)
