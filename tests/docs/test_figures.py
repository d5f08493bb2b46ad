"""The page of figures against a fresh one, the pictures, and the numbers in the captions."""

import itertools
import re
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.docs import curve_figures, figures, patch_figures
from gaussmap.docs.markdown import wrapped
from gaussmap.generated import patch as kernels
from gaussmap.runtime.base.formula_calls import python_function, vector
from gaussmap.tools.pictures.palette import ELLIPTIC, HYPERBOLIC
from matplotlib import colormaps
from matplotlib.colors import to_rgb
from matplotlib.image import imread, imsave

PAGE = figures.FOLDER.with_suffix(".md")
DPI = 200
# Inches.
LAYOUT = {
    2: (4.0, 3.5), 3: (5.6, 8.4), 4: (6.6, 2.9), 5: (6.6, 2.75), 6: (7.4, 4.7), 7: (7.4, 2.8),
    "search": (7.4, 3.9),
}  # fmt: skip
FILES = {x: f"figure_{x}.png" if isinstance(x, int) else f"{x}.png" for x in LAYOUT}
EACH_FIGURE = pytest.mark.parametrize("number", LAYOUT)
# Machado, Oliveira and Fernandes (2009): what is seen of linear RGB, for the strongest kinds.
BLINDNESS = {
    "none": np.eye(3),
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
               [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
               [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
               [0.004733, 0.691367, 0.303900]],
}  # fmt: skip


@pytest.fixture(scope="module")
def drawn(tmp_path_factory) -> tuple[Path, str]:
    """Return a folder with fresh figures, and their page."""
    folder = tmp_path_factory.mktemp("page") / "figures"
    return folder, figures.page(folder)


@pytest.fixture(scope="module")
def captions(drawn) -> dict[int, str]:
    parts = re.findall(r"\*\*Fig\. (\d)\.\*\* (.*?)(?=\n!|\Z)", drawn[1], flags=re.DOTALL)
    return {int(number): " ".join(text.split()) for number, text in parts}


def pixels(path: Path) -> np.ndarray:
    return imread(path)[..., :3]


def test_small_copies_keep_rare_colours(tmp_path, monkeypatch):
    rng = np.random.default_rng(1)
    picture = np.repeat(rng.uniform(size=(300, 400, 1)), 3, axis=2)  # greys, but for one row
    picture[150] = colormaps["viridis"](np.linspace(0.0, 1.0, 400))[:, :3]
    imsave(tmp_path / "made.png", picture)
    monkeypatch.setattr(figures, "DEMO", ("made",))
    (tmp_path / "copies").mkdir()
    figures.demo(tmp_path, tmp_path / "copies")
    copy = pixels(tmp_path / "copies" / "made.png")
    assert np.abs(copy - pixels(tmp_path / "made.png")).max() < 0.1


# --- the page and the pictures --------------------------------------------------------------------


def test_the_page_is_up_to_date(drawn):
    assert drawn[1] == PAGE.read_text(encoding="utf-8")


def test_every_figure_has_a_caption(captions):
    assert sorted(captions) == sorted(figures.FIGURES)
    assert set(figures.FIGURES) | set(figures.OTHERS) == set(LAYOUT)
    assert "…" not in "".join(captions.values())


@EACH_FIGURE
def test_committed_pictures_are_those_of_a_fresh_run(drawn, number):
    committed = figures.FOLDER / FILES[number]
    assert committed.stat().st_size < 600_000
    fresh = pixels(drawn[0] / committed.name)
    # another version of Matplotlib may draw letters and edges of lines a little differently
    assert np.abs(fresh - pixels(committed)).mean() < 0.01
    width, height = LAYOUT[number]
    assert fresh.shape == (round(DPI * height), round(DPI * width), 3)
    border = np.concatenate([fresh[:6], fresh[-6:], *np.hsplit(fresh, [6, -6])[::2]], axis=None)
    assert (border == 1.0).all(), "something is cut off"


def test_a_second_run_gives_the_same_bytes(drawn, tmp_path):
    assert figures.page(tmp_path / "figures") == drawn[1]
    for name in FILES.values():
        assert (tmp_path / "figures" / name).read_bytes() == (drawn[0] / name).read_bytes()


def test_formulas_are_not_broken():
    formula = "$`" + " + ".join(["x y"] * 30) + "`$"
    lines = wrapped("word " * 30 + formula + " word" * 30).split("\n")
    assert formula in lines
    assert all(len(line) <= 100 for line in lines if line != formula)


def cielab(colour: str, matrix: np.ndarray) -> np.ndarray:
    """Return a colour as it is seen, in CIELAB for the white D65."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    xyz = to_xyz @ np.clip(matrix @ linear, 0.0, 1.0) / np.sum(to_xyz, axis=1)
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("kind", BLINDNESS)
def test_colours_can_be_told_apart(kind):
    edges = [colour for _, colour in patch_figures.EDGES.values()]
    for pair in [*itertools.combinations(edges, 2), (ELLIPTIC, HYPERBOLIC)]:
        left, right = (cielab(x, np.array(BLINDNESS[kind])) for x in pair)
        assert np.linalg.norm(left - right) > 30.0


# --- Fig. 3 ---------------------------------------------------------------------------------------


def test_the_patches_are_what_their_titles_say():
    def parabolic(patch):
        return np.array(python_function(kernels.parabolic_cubic)(patch.vectors))

    patches = (patch_figures.PATCH, patch_figures.BESIDE, patch_figures.ACROSS)
    assert [x.image.kind for x in patches] == ["triangle", "biangle", "bow tie"]
    control = patch_figures.PATCH.control_normals
    assert (parabolic(patch_figures.PATCH) > 0.0).all()
    assert (control @ control.T > 0.0).all()
    # one normal along the edge v = 0; what is inside is elliptic
    edge = patch_figures.BESIDE.control_normals[[0, 4, 2]]
    assert np.abs(np.cross(edge, np.roll(edge, 1, axis=0))).max() < 1e-13 * np.abs(edge).max() ** 2
    inside = patch_figures.bezier(
        patch_figures.BESIDE.control_normals, np.array([[0.3, 0.3, 0.4], [0.1, 0.8, 0.1]])
    )
    assert (
        python_function(kernels.forms)(patch_figures.BESIDE.vectors, vector(inside))[0] > 0.0
    ).all()
    signs = np.sign(parabolic(patch_figures.ACROSS))
    assert {-1.0, 1.0} <= set(signs)


# --- Fig. 4 and Fig. 5 ----------------------------------------------------------------------------

TURN = np.linspace(0.0, 2 * np.pi, 200_001)


def test_the_points_that_normals_have(captions):
    """Count on the exact curve where n·x_t changes its sign and the normal is n, not −n."""
    _, tangent, bent = curve_figures.derivatives(TURN)
    counts, sums = [], []
    for x, y in gm.directions.circle(curve_figures.NORMALS):
        height = tangent @ [x, y]
        outward = x * tangent[:, 1] - y * tangent[:, 0] > 0.0
        steps = np.diff(np.sign(height))[outward[:-1]]
        counts.append(np.count_nonzero(steps))
        sums.append(-np.sign(steps).sum())  # κ > 0 where n·x has a maximum
    assert sums == [1] * curve_figures.NORMALS
    numbers = re.search(r"the (\d+) normals (\d+) have 1 and (\d+) have 3", captions[4])
    expected = [len(counts), counts.count(1), counts.count(3)]
    assert [int(x) for x in numbers.groups()] == expected
    changes = np.count_nonzero(
        np.diff(np.sign(tangent[:, 0] * bent[:, 1] - tangent[:, 1] * bent[:, 0]))
    )
    assert f"The curve has {changes} inflections" in captions[4]


def farthest(places: np.ndarray) -> tuple[float, float]:
    """Return the largest distance and angle between the chords and the arcs that they span."""
    distances, angles = [], []
    for first, last in itertools.pairwise(places):
        points, tangents, _ = curve_figures.derivatives(np.linspace(first, last, 2001))
        chord = (points[-1] - points[0]) / np.hypot(*(points[-1] - points[0]))
        distances.append(np.abs((points - points[0]) @ [-chord[1], chord[0]]).max())
        cosines = tangents @ chord / np.hypot(*tangents.T)
        angles.append(np.degrees(np.arccos(cosines.min())))
    return max(distances), max(angles)


def test_polygons(captions):
    normal = curve_figures.by_normals(curve_figures.VERTICES)
    parameter = curve_figures.by_parameter(len(normal))
    length = curve_figures.by_length(len(normal) - 1)
    assert f"Two polygons with {len(normal) - 1} vertices" in captions[5]
    found = re.findall(r"distance ([\d.]+), angle ([\d.]+)°", captions[5])
    assert len(found) == 3
    for (distance, angle), places in zip(found, (parameter, normal, length), strict=True):
        # three digits; no arc is so curved that its farthest point has another chord nearer
        assert (float(distance), float(angle)) == pytest.approx(farthest(places), rel=0.006)


# --- Fig. 6 and Fig. 7 ----------------------------------------------------------------------------

AXES = np.array([1.6, 1.2, 0.8])
DOMAIN = ((-1.9, 0.4), (-0.5, 1.25))


def test_normals_in_the_image_of_the_exact_ellipsoid(captions):
    found = re.findall(r"([\d,]+) of ([\d,]+) normals \(([\d.]+) %\)", captions[6])
    assert len(found) == 2
    for row, frequency in zip(found, (10, 20), strict=True):
        normals = gm.icosphere(frequency)
        x, y, z = (AXES * normals).T
        places = np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))
        inside = np.all(
            [(low <= w) & (w <= high) for w, (low, high) in zip(places, DOMAIN, strict=True)],
            axis=0,
        )
        expected = [f"{inside.sum():,}", f"{len(normals):,}", f"{100 * inside.mean():.2f}"]
        assert list(row) == expected
