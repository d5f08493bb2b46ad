"""Pictures in files, as `gaussmap plot` writes them."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ...runtime.base.extras import check_extra
from ...runtime.base.progress import busy
from ...runtime.fitting.fit import spline_of
from ...runtime.sample import sample_and_normals
from ...runtime.samples.request import checked_request
from ...runtime.samples.samples import Samples
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ..cad.part import Part
from ..files import paths
from .palette import STYLE
from .plot import checked_normals, draw, scene_of

__all__ = ["SUFFIXES", "check_target", "plot_to_file", "write_plot"]

SUFFIXES = (".png", ".pdf", ".svg")
DOTS_PER_INCH = {".png": 200, ".pdf": 300, ".svg": 300}


def plot_to_file(
    surface: Surface | Spline | Part,
    path: str | os.PathLike[str],
    normals: ArrayLike | None = None,
    *,
    count: int | None = None,
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    relax: int = 0,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> Samples:
    """Sample a surface, draw it with its samples to a .png, .pdf or .svg file, return the samples.

    The other arguments are those of `sample`. Raises what `sample` and `write_plot` raise; the
    path is checked before any work is done.
    """
    check_target(path)
    request = checked_request(normals, count, angle, coverage, density, relax, threads)
    with busy("sampling", progress):
        samples, directions = sample_and_normals(
            surface, request, cells=cells, on=on, threads=threads, progress=progress
        )
    if samples.spline is None and not isinstance(surface, Part):
        surface = spline_of(surface, cells)
    with busy("drawing", progress):
        write_plot(samples, samples.spline or surface, directions, path)
    return samples


def write_plot(
    samples: Samples,
    surface: Surface | Spline | Part,
    normals: ArrayLike,
    path: str | os.PathLike[str],
) -> None:
    """Write what `plot` draws, with the prescribed normals, to a .png, .pdf or .svg file.

    Raises UnknownNameError for another suffix, FileError if the file cannot be written, InputError
    if the samples do not belong to the normals, and MissingExtraError if matplotlib is not
    installed.
    """
    check_target(path)
    directions = checked_normals(samples, normals)
    import matplotlib.style

    suffix = Path(path).suffix.lower()
    undated = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}[suffix]
    figure = draw(samples, scene_of(surface), directions, dots_per_inch=DOTS_PER_INCH[suffix])
    with (
        matplotlib.style.context(["default", STYLE]),
        warnings.catch_warnings(),
        np.errstate(all="ignore"),
        paths.atomic_path(path) as temporary,
    ):
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # in the name of a surface
        figure.savefig(temporary, format=suffix[1:], metadata=undated)


def check_target(path: str | os.PathLike[str]) -> None:
    """Raise what `write_plot` would raise later, for its path or if matplotlib is missing."""
    paths.check_target(path, SUFFIXES)
    check_extra("matplotlib", "plot", "a picture")
