"""Draw the pictures of the README, and Figs. 2-7 of the paper; print docs/figures.md.

Every number on the page is measured here.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import matplotlib.style
import numpy as np
from gaussmap.docs import animation
from gaussmap.docs.animation import palette_of, reduced, with_palette
from gaussmap.docs.curve_figures import figure_4, figure_5
from gaussmap.docs.dark import dark
from gaussmap.docs.markdown import wrapped
from gaussmap.docs.patch_figures import figure_2, figure_3
from gaussmap.docs.search_figure import search_figure
from gaussmap.docs.surface_figures import figure_6, figure_7
from gaussmap.tools.files.paths import atomic_path
from gaussmap.tools.pictures.palette import STYLE
from matplotlib.figure import Figure
from PIL import Image

FOLDER = Path(__file__).parent / "figures"
FIGURES: dict[int, Callable[[], tuple[Figure, str]]] = {
    2: figure_2,
    3: figure_3,
    4: figure_4,
    5: figure_5,
    6: figure_6,
    7: figure_7,
}
# The figures of other pages, by name.
OTHERS: dict[str, Callable[[], Figure]] = {"search": search_figure}
# The pictures that `make demo` draws, and that the README shows with fewer colours.
DEMO, COLOURS = ("torus", "terrain"), 250
HEAD = """# The figures of the paper

Written by `make figures`: do not edit. Blue is elliptic (on curves κ > 0), orange hyperbolic
(κ < 0). Fig. 1 of the paper is a sketch of the definition and is left out.
"""


def page(folder: Path) -> str:
    """Draw the figures into a folder, and return the page that shows those of the paper."""
    folder.mkdir(exist_ok=True)
    parts = [HEAD]
    style = ["default", STYLE, {"mathtext.fontset": "stix"}]
    for name, draw_other in OTHERS.items():
        with matplotlib.style.context(style):
            save(draw_other(), folder / f"{name}.png")
    for number, draw in FIGURES.items():
        with matplotlib.style.context(style):
            figure, caption = draw()
            save(figure, folder / f"figure_{number}.png")
        text = wrapped(f"**Fig. {number}.** {caption}")
        parts.append(f"\n![Fig. {number}](figures/figure_{number}.png)\n\n{text}")
    return "".join(parts)


def save(figure: Figure, path: Path) -> None:
    """Write a picture."""
    with atomic_path(path) as temporary:
        figure.savefig(temporary, format="png", metadata={"Software": None})


def demo(made: Path, folder: Path) -> None:
    """Write small copies of the pictures of `make demo` to a folder, light and dark."""
    for name in DEMO:
        with Image.open(made / f"{name}.png") as image:
            picture = image.convert("RGB")
        # Half of the palette are frequent colours, half are near to all, as in colour bars.
        near = picture.quantize(COLOURS // 2, method=Image.Quantize.MAXCOVERAGE).getpalette()
        near_to_all = np.array(near, dtype=np.uint8)[: 3 * (COLOURS // 2)].reshape(-1, 3)
        palette = np.concatenate([palette_of([picture], COLOURS // 2), near_to_all])
        numbers = reduced(picture, palette)
        for ending, colours in (("", palette), ("_dark", dark(palette))):
            with atomic_path(folder / f"{name}{ending}.png") as temporary:
                with_palette(numbers, colours).save(temporary, format="PNG", optimize=True)


if __name__ == "__main__":
    demo(Path("out"), Path(__file__).parent)
    animation.draw(animation.FILE, animation.DARK)
    print(page(FOLDER), end="")
