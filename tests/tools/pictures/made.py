"""What can be read in figures."""

import warnings
from typing import Any

from matplotlib.figure import Figure
from matplotlib.text import Text


def texts(figure: Figure) -> set[str]:
    """Return the visible texts of a figure, as they are drawn."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph")
        figure.canvas.draw()
    found: Any = figure.findobj(Text)
    return {x.get_text() for x in found if x.get_text() and x.get_visible()}
