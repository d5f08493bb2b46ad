"""The command `gaussmap mesh`."""

from types import SimpleNamespace

from ..files.formats import check_mesh_target
from .console import summarize
from .sampled import sampled


def run(options: SimpleNamespace) -> None:
    """Sample a surface and write a mesh of the samples to a file."""
    check_mesh_target(options.output)
    samples, _ = sampled(options, 10_000)
    mesh = samples.mesh(angle=options.deviation, prefer=options.prefer, progress=not options.quiet)
    mesh.write(options.output)
    summarize(mesh, options)
