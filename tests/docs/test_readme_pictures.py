"""The pictures of the README: light and dark ones, and where they are."""

import re
from pathlib import Path

import numpy as np
import pytest
from gaussmap.docs import figures
from gaussmap.docs.dark import BACKGROUND, dark
from gaussmap.tools.pictures.palette import ELLIPTIC, HYPERBOLIC, INK, MARK
from matplotlib.colors import rgb_to_hsv, to_hex, to_rgb
from PIL import Image

ROOT = Path(__file__).parents[2]


def of(*colours: str) -> np.ndarray:
    return np.round(255 * np.array([to_rgb(x) for x in colours])).astype(np.uint8)


def test_light_and_dark_are_exchanged_and_hues_stay() -> None:
    white, black, mark, ink = dark(of("white", "black", MARK, INK))
    assert to_hex(white / 255) == BACKGROUND
    assert to_hex(black / 255) == "#ffffff"
    assert to_hex(mark / 255) == MARK
    assert ink.min() > 200
    colours = of(ELLIPTIC, HYPERBOLIC)
    before, after = (rgb_to_hsv(x / 255)[:, 0] for x in (colours, dark(colours)))
    assert np.abs(before - after).max() < 0.03


@pytest.mark.parametrize("name", figures.DEMO)
def test_small_copies_of_the_pictures_of_the_demo(name: str) -> None:
    files = [ROOT / "docs" / f"{name}{ending}.png" for ending in ("", "_dark")]
    light, in_dark = (np.asarray(Image.open(x).convert("RGB")) for x in files)
    assert max(x.stat().st_size for x in files) < 300_000
    found, which = np.unique(light.reshape(-1, 3), axis=0, return_inverse=True)
    assert len(found) > 100
    assert (dark(found)[which.ravel()] == in_dark.reshape(-1, 3)).all()


def test_each_picture_has_a_dark_one() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    pairs = re.findall(r'dark\)" srcset="([^"]*)"><img src="([^"]*)" alt="[^"]{20,}"', readme)
    assert len(pairs) == 3
    for in_dark, light in pairs:
        assert (ROOT / in_dark).exists()
        assert in_dark == light.replace(".", "_dark.")
