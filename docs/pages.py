"""`prepare`, which pages of the site call in their first cell, for small pictures."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import matplotlib.pyplot as plt
from IPython.core.getipython import get_ipython
from matplotlib.figure import Figure
from PIL import Image

INCH = 75  # pixels of the page; pictures have twice as many, for sharp screens
COLOURS = 96


def prepare() -> None:
    """Make figures small."""
    shell: Any = get_ipython()
    plt.close(plt.figure())  # the first figure makes the backend register its own formatter
    shell.display_formatter.formatters["image/png"].for_type(Figure, small_png)


def small_png(figure: Figure) -> tuple[bytes, dict[str, int]]:
    """Return a figure as PNG with few colours, a fifth of the bytes, and the width to show."""
    written = BytesIO()
    figure.savefig(written, format="png", dpi=2 * INCH)
    image = Image.open(written).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    smaller = BytesIO()
    image.save(smaller, "PNG", optimize=True)
    return smaller.getvalue(), {"width": image.width // 2}
