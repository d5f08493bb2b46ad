"""The page of `samples.view` in headless Chromium: real clicks, drags and taps."""

from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

pytestmark = pytest.mark.slow
ON_SCREEN = """(() => {{
    const plot = byId("{plot}"), box = plot.getBoundingClientRect();
    const [x, y] = onScreen(camera(plot), box, {place});
    return [box.left + x, box.top + y];
}})()"""

PIXEL = """(() => {{
    const canvas = byId("surface").querySelector("canvas.over");
    const box = canvas.getBoundingClientRect();
    const pixel = canvas.getContext("2d").getImageData({x} - box.left, {y} - box.top, 1, 1);
    return pixel.data.slice(0, 3).join();
}})()"""


@pytest.fixture(scope="module")
def samples() -> gm.Samples:
    return gm.sample("torus", normals=gm.icosphere(8))


@pytest.fixture(scope="module")
def pages(samples: gm.Samples, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pages")
    samples.view(folder / "torus.html")
    return folder


def place_of(browser: Any, plot: str, place: np.ndarray) -> tuple[float, float]:
    text = ON_SCREEN.format(plot=plot, place=",".join(map(str, place.tolist())))
    x, y = browser.value(text)
    return x, y


def scaled(browser: Any, sample: int) -> np.ndarray:
    """Return the point of a sample in the coordinates of the page."""
    return np.array(browser.value(f"[0, 1, 2].map((k) => points[3 * {sample} + k])"))


def picked(browser: Any) -> dict[str, Any]:
    browser.settle()
    return browser.value("window.picked")


def test_a_normal_and_all_its_preimages(browser: Any, pages: Path, samples: gm.Samples) -> None:
    browser.open(pages / "torus.html", 1280, 860)
    normal = gm.icosphere(8)[np.argmax(gm.icosphere(8) @ [0.45, -0.7, 0.55])]  # in front
    browser.click(*place_of(browser, "sphere", normal))
    which = np.flatnonzero(np.abs(samples.normals - normal).max(axis=1) < 1e-9)
    assert sorted(picked(browser)["best"]) == which.tolist()
    text = browser.value("byId('result').textContent")
    assert "2 samples have exactly this normal: 1 elliptic, 1 hyperbolic." in text
    for k in which.tolist():
        if samples.normals[k] @ [0.5, -0.7, 0.45] > 0:  # not hidden
            colour = "213,94,0" if samples.hyperbolic[k] else "0,114,178"
            x, y = place_of(browser, "surface", scaled(browser, k))
            assert browser.value(PIXEL.format(x=x, y=y)) == colour


def test_a_region_and_its_image(browser: Any, pages: Path, samples: gm.Samples) -> None:
    browser.open(pages / "torus.html", 1280, 860)
    front = int(np.argmax(samples.points @ [0.5, -0.8, 0.4]))
    start = place_of(browser, "surface", scaled(browser, front))
    browser.click(*start)
    first = picked(browser)
    assert first["best"] == [front]
    diameter, share = browser.value("[data.diameter, radius()]")
    apart = np.linalg.norm(samples.points - samples.points[front], axis=1)
    assert set(first["members"]) <= set(np.flatnonzero(apart <= 1.001 * share * diameter))
    assert len(first["members"]) > 10
    browser.value("byId('brush').click()")
    browser.drag(start, (start[0] + 60, start[1]))
    assert picked(browser)["best"] != [front]
    assert "Gaussian image" in browser.value("byId('result').textContent")


def test_a_drag_turns_and_picks_nothing(browser: Any, pages: Path) -> None:
    browser.open(pages / "torus.html", 1280, 860)
    before = browser.value("Array.from(camera(byId('sphere')))")
    x, y = place_of(browser, "sphere", np.array([0.45, -0.7, 0.55]))
    browser.drag((x, y), (x + 80, y + 10))
    assert browser.value("Array.from(camera(byId('sphere')))") != before
    assert not picked(browser)["best"]


def test_a_face_of_a_part(browser: Any, tmp_path: Path, parts: Any) -> None:
    part = parts.box(1.0, 2.0, 3.0)
    samples = gm.sample(part, 300)
    samples.view(tmp_path / "part.html")
    browser.open(tmp_path / "part.html", 1280, 860)
    top = next(x.index for x in part.faces if x.dimensions["normal"][2] > 0.5)
    here = np.flatnonzero(samples.face_index == top)
    inner = here[np.argmin(np.linalg.norm(samples.points[here] - [0.5, 1.0, 3.0], axis=1))]
    browser.click(*place_of(browser, "surface", scaled(browser, int(inner))))
    assert picked(browser)["face"] == top
    assert picked(browser)["members"] == here.tolist()
    assert f"Face {top} 'side': plane: {len(here)} samples" in browser.value(
        "byId('result').textContent"
    )
    browser.click(*place_of(browser, "sphere", np.array([0.0, 0.0, 1.0])))
    assert set(picked(browser)["best"]) == set(here.tolist())


def test_hidden_samples_do_not_light_up(browser: Any, tmp_path: Path) -> None:
    """Two squares, one above the other: of the lower one, what the upper one hides is not drawn."""
    raised = np.eye(4)
    raised[2, 3] = 1.0
    sheets = [gm.surfaces.plane(), gm.surfaces.plane().transformed(raised)]
    samples = gm.sample(gm.Part(sheets), 300)
    samples.view(tmp_path / "sheets.html")
    browser.open(tmp_path / "sheets.html", 1280, 860)
    lower = np.flatnonzero(samples.face_index == 0)
    viewer = np.array(browser.value("towardsViewer(camera(byId('surface')))"))
    where = samples.points + viewer / viewer[2]  # what is drawn over them, at z = 1
    outside = np.abs(where[lower, :2]).max(axis=1)
    browser.click(*place_of(browser, "surface", scaled(browser, int(lower[outside.argmax()]))))
    assert picked(browser)["members"] == lower.tolist()
    ends = {True: lower[outside > 1.15], False: lower[outside < 0.85]}
    for is_seen, rows in ends.items():
        assert len(rows) > 5
        for k in rows.tolist():
            x, y = place_of(browser, "surface", scaled(browser, k))
            assert (browser.value(PIXEL.format(x=x, y=y)) != "0,0,0") == is_seen
    middle = "camera(plot), plot.getBoundingClientRect(), 0, 0, 0"
    front = (
        f"(() => {{ const plot = byId('surface'); return faceAt(plot, ...onScreen({middle})); }})()"
    )
    assert browser.value(front) == 1


def test_a_phone(browser: Any, pages: Path, samples: gm.Samples) -> None:
    browser.open(pages / "torus.html", 390, 844, phone=True)
    assert browser.value("document.documentElement.scrollWidth") == 390
    browser.value("byId('sphere').scrollIntoView({ block: 'center' })")
    normal = gm.icosphere(8)[np.argmax(gm.icosphere(8) @ [0.45, -0.7, 0.55])]
    browser.tap(*place_of(browser, "sphere", normal))
    found = picked(browser)["best"]
    np.testing.assert_allclose(samples.normals[found], [normal, normal], rtol=0, atol=1e-9)
