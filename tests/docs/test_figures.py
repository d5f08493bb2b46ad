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
from gaussmap.tools.pictures.scene import quadrangles
from matplotlib import colormaps
from matplotlib.colors import to_rgb
from matplotlib.image import imread, imsave

pytestmark = [pytest.mark.compiled, pytest.mark.slow]

PAGE = figures.FOLDER.with_suffix(".md")
DPI = 200
# Inches, and the rows and columns of panels.
LAYOUT = {
    2: ((4.0, 3.5), (1, 1)),
    3: ((5.6, 8.4), (3, 2)),
    4: ((6.6, 2.9), (1, 2)),
    5: ((6.6, 2.75), (1, 2)),
    6: ((7.4, 4.7), (2, 3)),
    7: ((7.4, 2.8), (1, 3)),
    "search": ((7.4, 3.9), (1, 2)),
}
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


@EACH_FIGURE
def test_pictures_have_their_size_and_a_margin(drawn, number):
    image = pixels(drawn[0] / FILES[number])
    (width, height), _ = LAYOUT[number]
    assert image.shape == (round(DPI * height), round(DPI * width), 3)
    border = np.concatenate([image[:6], image[-6:], *np.hsplit(image, [6, -6])[::2]], axis=None)
    assert (border == 1.0).all(), "something is cut off"


@EACH_FIGURE
def test_no_panel_is_blank(drawn, number):
    image = pixels(drawn[0] / FILES[number])
    rows, columns = LAYOUT[number][1]
    for row in np.array_split(image, rows, axis=0):
        for panel in np.array_split(row, columns, axis=1):
            assert (panel < 0.98).any(axis=2).mean() > 0.02
            assert len(np.unique(np.round(8 * panel).reshape(-1, 3), axis=0)) > 4


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


def spherical_areas(normals: np.ndarray) -> np.ndarray:
    """Return the signed areas (Q,) of spherical quadrangles (Q, 4, 3), as two triangles each."""
    total = np.zeros(len(normals))
    for k in (1, 2):
        a, b, c = normals[:, 0], normals[:, k], normals[:, k + 1]
        volume = np.einsum("qx,qx->q", a, np.cross(b, c))
        dots = [np.einsum("qx,qx->q", x, y) for x, y in ((a, b), (b, c), (c, a))]
        total += 2 * np.arctan2(volume, 1.0 + sum(dots))
    return total


@pytest.mark.parametrize(
    ("name", "pattern"),
    [
        ("PATCH", r"triangle of ([\d.]+) sr"),
        ("BESIDE", r"biangle of ([\d.]+) sr"),
        ("ACROSS", r"bow tie, ([\d.]+) sr and ([\d.]+) sr"),
    ],
)
def test_solid_angles_are_those_of_polyhedra(captions, name, pattern):
    patch = getattr(patch_figures, name)
    s, t = np.meshgrid(*2 * [np.linspace(0.0, 1.0, 401)], indexing="ij")
    places = np.stack([s * (1 - t), s * t, 1 - s], axis=-1)
    normals = patch_figures.bezier(patch.control_normals, places)
    # at s = 0, and along an edge that is a parabolic line, quadrangles are triangles
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    areas = spherical_areas(quadrangles(normals))
    sums = [areas[areas > 0.0].sum(), -areas[areas < 0.0].sum()]
    found = re.search(pattern, captions[3])
    assert found is not None
    # half of the last digit; the polyhedron is off by 1/400²
    np.testing.assert_allclose(
        [float(x) for x in found.groups()], sums[: len(found.groups())], rtol=0, atol=0.00052
    )
    if len(found.groups()) == 1:
        assert sums[1] < 1e-12


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
    numbers = re.search(r"the (\d+) normals (\d+) belong to 1 and (\d+) belong to 3", captions[4])
    assert numbers is not None
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


def test_lengths_are_equal():
    places = curve_figures.by_length(24)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    lengths = []
    for first, last in itertools.pairwise(places):
        half = (last - first) / 2
        _, tangent, _ = curve_figures.derivatives(first + half * (nodes + 1))
        lengths.append(half * weights @ np.hypot(*tangent.T))
    np.testing.assert_allclose(lengths, np.mean(lengths), rtol=1e-6)
    np.testing.assert_allclose(places[[0, -1]], [0.0, 2 * np.pi], rtol=0, atol=1e-15)


# --- Fig. 6 and Fig. 7 ----------------------------------------------------------------------------

AXES = np.array([1.6, 1.2, 0.8])
DOMAIN = ((-1.9, 0.4), (-0.5, 1.25))


def test_share_of_the_sphere_on_the_exact_ellipsoid(captions):
    """The integral of cos v/(a b c |m|³), with m = (cos u cos v/a, sin u cos v/b, sin v/c)."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    (u0, u1), (v0, v1) = DOMAIN
    u = u0 + (u1 - u0) / 2 * (nodes[:, None] + 1)
    v = v0 + (v1 - v0) / 2 * (nodes + 1)
    m = np.stack(np.broadcast_arrays(np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)))
    m /= AXES[:, None, None]
    density = np.cos(v) / (AXES.prod() * np.linalg.norm(m, axis=0) ** 3)
    exact = (u1 - u0) * (v1 - v0) / 4 * (weights @ density @ weights) / (4 * np.pi)
    found = re.search(r"covers ([\d.]+) % of the sphere", captions[6])
    assert found is not None
    assert float(found[1]) == pytest.approx(100 * exact, abs=0.006)


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


def preimages(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return how many elliptic and hyperbolic points (2, k) have a normal, on the exact waves.

    With X = 3x and Y = 3y it is cos X cos Y = p and sin X sin Y = q, and K has the sign of
    sin(X − Y) sin(X + Y).
    """
    counts = np.zeros((2, len(p)), dtype=int)
    with np.errstate(invalid="ignore"):
        minus, plus = np.arccos(p + q), np.arccos(p - q)
    for s, r in itertools.product((-1, 1), repeat=2):
        for k, m in itertools.product(range(-2, 3), repeat=2):
            difference, total = s * minus + 2 * np.pi * k, r * plus + 2 * np.pi * m
            X, Y = (total + difference) / 2, (total - difference) / 2
            inside = (np.abs(X) <= 3.0) & (np.abs(Y) <= 3.0)
            counts[0] += inside & (s * r > 0)
            counts[1] += inside & (s * r < 0)
    return counts


def test_waves(captions):
    spline = gm.fit(gm.surfaces.wavy_graph(amplitude=0.35), cells=(16, 16))
    normals = gm.icosphere(12)
    samples = gm.sample(spline, normals=normals)
    counts = np.stack(
        [
            np.bincount(samples.normal_index[x], minlength=len(normals))
            for x in (samples.elliptic, samples.hyperbolic)
        ]
    )
    have = counts.sum(axis=0) > 0
    words = [f"{x[have].min()} to {x[have].max()}" for x in counts]
    text = (
        f"{len(samples):,} samples, {counts[0].sum()} elliptic and {counts[1].sum()} hyperbolic. "
        f"Right: their normals on the sphere, {have.sum()} of the {len(normals):,} of a refined "
        f"icosahedron, seen from higher. The image covers itself: each of these normals has "
        f"{words[0]} elliptic and {words[1]} hyperbolic points."
    )
    assert text in captions[7]

    # the same on the exact surface, where the error of the spline's slopes cannot change it
    slope = 3 * 0.35
    grid = np.linspace(-1.0, 1.0, 257)
    x, y = np.meshgrid(grid, grid, indexing="ij")
    field = spline.normals(x, y)
    p, q = np.cos(3 * x) * np.cos(3 * y), np.sin(3 * x) * np.sin(3 * y)
    error = max(
        np.abs(-field[..., 0] / field[..., 2] / slope - p).max(),
        np.abs(field[..., 1] / field[..., 2] / slope - q).max(),
    )
    up = normals[:, 2] > 0.1
    p, q = -normals[up, 0] / normals[up, 2] / slope, normals[up, 1] / normals[up, 2] / slope
    ways = [preimages(p + a, q + b) for a in (-error, 0, error) for b in (-error, 0, error)]
    sure = (np.stack(ways) == ways[0]).all(axis=(0, 1))
    assert (sure & have[up]).sum() > 0.5 * have.sum()
    np.testing.assert_array_equal(counts[:, up][:, sure], ways[0][:, sure])
    assert not have[~up].any()
