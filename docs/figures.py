"""Draw Figs. 2-7 of the paper and the animation into docs/figures/; print docs/figures.md.

Every number on the page is measured here.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable
from pathlib import Path

import matplotlib.style
from gaussmap.docs import animation
from gaussmap.docs.curve_figures import figure_4, figure_5
from gaussmap.docs.patch_figures import figure_2, figure_3
from gaussmap.docs.surface_figures import figure_6, figure_7
from gaussmap.tools.files.paths import atomic_path
from gaussmap.tools.pictures.palette import STYLE
from matplotlib.figure import Figure

FOLDER = Path(__file__).parent / "figures"
FIGURES: dict[int, Callable[[], tuple[Figure, str]]] = {
    2: figure_2,
    3: figure_3,
    4: figure_4,
    5: figure_5,
    6: figure_6,
    7: figure_7,
}
HEAD = """# The figures of the paper

Written by `make figures`: do not edit. Blue is elliptic (on curves κ > 0), orange hyperbolic
(κ < 0). Fig. 1 of the paper is a sketch of the definition and is left out.
"""


def page(folder: Path) -> str:
    """Draw the figures into a folder, and return the page that shows them."""
    folder.mkdir(exist_ok=True)
    parts = [HEAD]
    for number, draw in FIGURES.items():
        with matplotlib.style.context(["default", STYLE, {"mathtext.fontset": "stix"}]):
            figure, caption = draw()
            with atomic_path(folder / f"figure_{number}.png") as temporary:
                figure.savefig(temporary, format="png", metadata={"Software": None})
        text = filled(f"**Fig. {number}.** {caption}")
        parts.append(f"\n![Fig. {number}](figures/figure_{number}.png)\n\n{text}\n")
    return "".join(parts)


def filled(text: str) -> str:
    """Break a text at 100 characters, but not in formulas or links."""
    whole = re.sub(r"\$`.*?`\$", lambda found: found[0].replace(" ", "\0"), text)
    lines = textwrap.fill(whole, 100, break_long_words=False, break_on_hyphens=False)
    return lines.replace("\0", " ")


if __name__ == "__main__":
    animation.draw(animation.FILE)
    print(page(FOLDER), end="")
