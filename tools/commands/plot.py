"""The command `gaussmap plot`."""

from types import SimpleNamespace

from ...runtime.base.progress import busy
from ..pictures.plot import COUNT, check_target, plot_samples, write_figure
from .console import summarize
from .sampled import sampled


def run(options: SimpleNamespace) -> None:
    """Draw a surface and its samples."""
    check_target(options.output)
    samples, normals = sampled(options, COUNT)
    with busy("drawing", not options.quiet):
        figure = plot_samples(samples, normals=normals, face_numbers=options.face_numbers)
        write_figure(figure, options.output)
    summarize(samples, options)
