"""Pictures in files, as `gaussmap plot` writes them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ...runtime.base.extras import check_extra
from ..files import paths
from .plot import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["SUFFIXES", "check_target", "write_figure"]

SUFFIXES = (".png", ".pdf", ".svg")
FINE = 300  # dots per inch
UNDATED = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def write_figure(figure: Figure, path: paths.PathLike) -> None:
    """Write a figure to a .png, .pdf or .svg file, without its date: the same one, the same bytes.

    Raises what `check_target` raises, and FileError if the file cannot be written.
    """
    check_target(path)
    suffix = Path(path).suffix.lower()
    with style(), paths.atomic_path(path) as temporary:
        # In .pdf and .svg files, quadrangles are rasterized: finer than a screen shows them.
        dots = figure.dpi if suffix == ".png" else FINE
        figure.savefig(temporary, format=suffix[1:], metadata=UNDATED[suffix], dpi=dots)


def check_target(path: paths.PathLike) -> None:
    """Raise now what writing would raise later, for a path or if matplotlib is missing."""
    paths.check_target(path, SUFFIXES)
    check_extra("matplotlib", "plot", "a picture")
