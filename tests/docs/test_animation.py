"""The animation and the pictures of the README: what they show, light and dark."""

import re
from pathlib import Path

import numpy as np
import pytest
from gaussmap.docs import animation, figures
from gaussmap.docs.dark import BACKGROUND, dark
from gaussmap.docs.dark import dark as dark_of
from gaussmap.tools.pictures.palette import ELLIPTIC, HYPERBOLIC, INK, MARK
from matplotlib.colors import rgb_to_hsv, to_hex, to_rgb
from PIL import Image


def frames(path: Path) -> tuple[list[np.ndarray], list[int]]:
    """Return the pixels of all pictures, and their times in milliseconds."""
    pictures, times = [], []
    with Image.open(path) as image:
        for k in range(getattr(image, "n_frames", 1)):
            image.seek(k)
            pictures.append(np.asarray(image.convert("RGB")))
            times.append(image.info["duration"])
    return pictures, times


def count(picture: np.ndarray, colour: str) -> int:
    """Return how many pixels have exactly a colour."""
    return int((picture == np.round(255 * np.array(to_rgb(colour)))).all(axis=2).sum())


def test_a_dozen_seconds_in_two_megabytes() -> None:
    assert animation.FILE.stat().st_size <= 2_000_000
    pictures, times = frames(animation.FILE)
    assert 10_000 < sum(times) < 14_000
    assert pictures[0].shape == (360, 820, 3)
    assert (pictures[0][:2] == 255).all()  # white, also beside the text


def test_the_dark_one_differs_by_its_colours_only() -> None:
    light, dark = (frames(x) for x in (animation.FILE, animation.DARK))
    assert light[1] == dark[1]
    for before, after in zip(light[0][::14], dark[0][::14], strict=True):
        assert (after[:2] == [13, 17, 23]).all()
        found, which = np.unique(before.reshape(-1, 3), axis=0, return_inverse=True)
        assert (dark_of(found)[which.ravel()] == after.reshape(-1, 3)).all()


def test_normals_leave_the_sphere_and_land_on_the_torus() -> None:
    pictures, _ = frames(animation.FILE)
    left, right = np.s_[40:, :280], np.s_[40:, 400:]
    assert count(pictures[0][left], INK) > 5_000
    assert count(pictures[-2][left], INK) < 500
    for colour in (ELLIPTIC, HYPERBOLIC):
        assert count(pictures[0], colour) == 0
        assert count(pictures[-2][right], colour) > 4_000
    before, after = (count(picture[right], MARK) for picture in pictures[-2:])
    assert count(pictures[-2][left], MARK) == 0
    assert count(pictures[-1][left], MARK) > 40
    assert after - before > 80  # two points


def test_the_committed_one_is_that_of_a_fresh_run(tmp_path: Path) -> None:
    animation.draw(tmp_path / "a.gif", tmp_path / "b.gif")
    fresh, committed = (frames(x) for x in (tmp_path / "a.gif", animation.FILE))
    assert fresh[1] == committed[1]
    for left, right in zip(fresh[0], committed[0], strict=True):
        # another version of Matplotlib may draw letters and discs a little differently
        assert np.abs(left.astype(float) - right).mean() < 2.0


# --- pictures of the README, light and dark -------------------------------------------------------

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
