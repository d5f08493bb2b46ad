import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures.scene import divided, height_factor, scene_of, view


def areas(triangles: np.ndarray) -> np.ndarray:
    """Return the areas (k,) of triangles (k, 3, 3)."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0


def test_a_convex_surface_hides_its_back() -> None:
    spline = gm.fit(gm.surfaces.sphere())
    samples = gm.sample(spline, count=2000)
    facing = samples.normals @ view()[2]
    visible = scene_of(spline).visible(samples.points)
    assert visible[facing > 0.05].all()
    assert not visible[facing < -0.15].any()


def test_waves_hide_what_faces_the_viewer() -> None:
    spline = gm.fit(gm.surfaces.wavy_graph(amplitude=0.5, frequency=5.0))
    samples = gm.sample(spline, count=3000)
    # March from each sample to the viewer: where does the way cross the waves?
    steps = np.linspace(0.01, 3.0, 1200)
    x, y, z = np.moveaxis(samples.points[:, None] + steps[:, None] * view()[2], 2, 0)
    above = z > 0.5 * np.sin(5 * x) * np.cos(5 * y)
    over = (np.abs(x) < 1) & (np.abs(y) < 1)
    crossing = (above[:, 1:] != above[:, :-1]) & over[:, 1:] & over[:, :-1]
    visible = scene_of(spline).visible(samples.points)
    hidden = (crossing & (steps[1:] > 0.06)).any(axis=1)
    assert not visible[hidden].any()
    assert visible[~crossing.any(axis=1)].mean() > 0.995  # but for some at an edge
    facing = samples.normals @ view()[2]
    assert np.count_nonzero(hidden & (facing > 0.2)) > 20
    assert np.count_nonzero(visible) > 1000


@pytest.mark.parametrize(
    ("extent", "factor"),
    [
        ((2, 2, 2), 1), ((2, 2, 0.2), 1), ((2, 2, 0.1), 5), ((1e4, 1e4, 500), 5),
        ((1e4, 2e4, 1e-3), 5e6), ((2, 2, 0), 1), ((2, 2, 1e-12), 1), ((1, 1, 9), 1),
        ((1, 1, 100), 0.02), ((0, 0, 1), 1), ((0, 0, 0), 1),
    ],
)  # fmt: skip
def test_height_factor(extent: tuple[float, float, float], factor: float) -> None:
    assert height_factor(np.array(extent, dtype=float)) == pytest.approx(factor)


def test_triangles_are_divided_and_keep_their_area():
    triangles = np.random.default_rng(3).random((20, 3, 3)) * [1.0, 5.0, 0.2]
    small = divided(triangles, 0.3)
    sides = np.linalg.norm(small - np.roll(small, -1, axis=1), axis=2)
    assert sides.max() <= 0.3
    assert areas(small).sum() == pytest.approx(areas(triangles).sum(), rel=1e-12)
    assert len(divided(triangles, 10.0)) == 20


def test_the_back_of_a_thin_plate_is_painted_first(parts):
    behind, before = scene_of(parts.box(1.0, 1.0, 1e-3)).in_layers()
    top, bottom = (
        [x.quadrangles[(x.quadrangles[..., 2] == z).all(axis=1)][:, :3] for x in (behind, before)]
        for z in (1e-3, 0.0)
    )
    assert len(bottom[1]) == 0
    assert areas(top[1]).sum() > 0.99
    assert len(top[0]) < 10  # at corners: no middle of a pixel is in them


def test_painted_pieces_are_a_fortieth_of_the_diameter(parts):
    """Pieces that are sorted by their mean depths are wrong by a side at most."""
    whole = scene_of(parts.box(1.0, 2.0, 2.0))
    diameter = np.linalg.norm(np.ptp(whole.triangles.reshape(-1, 3), axis=0))
    for layer in whole.in_layers():
        pieces = layer.quadrangles[:, :3]
        sides = np.linalg.norm(pieces - np.roll(pieces, -1, axis=1), axis=2)
        assert sides.max() <= diameter / 40.0


def test_triangles_fill_a_trimmed_square_and_have_an_area():
    angles = 2.0 * np.pi * np.arange(100) / 100
    circle = 1.0 + 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    square = [(0.0, 0.0), (0.0, 2.0), (2.0, 2.0), (2.0, 0.0)]
    sheet = gm.Surface.from_sympy(("u", "v", "0"), ("u", "v"), ((0, 2), (0, 2)))
    found = areas(scene_of(gm.Part([sheet.trimmed([circle, square])])).triangles)
    assert found.sum() == pytest.approx(4.0 - 12.5 * np.sin(2.0 * np.pi / 100), rel=1e-7)
    assert found.min() > 1e-6 * found.max()


def test_triangles_of_a_part_have_its_area():
    part = gm.read_part(f"{gm.__path__[0]}/docs/gallery/bracket.npz")
    found = areas(scene_of(part).quadrangles[:, :3]).sum()
    assert found == pytest.approx(part.area, rel=2e-3)


def test_a_surface_is_drawn_where_there_are_data_only() -> None:
    y, x = np.mgrid[:40, :50]
    heights = 5.0 * np.sin(x / 9.0) * np.cos(y / 7.0)
    missing = (x - 20) ** 2 + (y - 20) ** 2 < 50
    heights[missing] = np.nan
    drawn = scene_of(gm.Surface.from_grid(heights, spacing=(1, 1)))
    centres = drawn.quadrangles[..., :2].mean(axis=1)
    column, row = np.floor(centres).astype(int).T
    corners = np.stack([missing[row + a, column + b] for a in (0, 1) for b in (0, 1)])
    assert not corners.any()
    # A patch depends on points at a distance of two cells: the hole is at most that much larger.
    diagonals = (drawn.quadrangles[:, 2] - drawn.quadrangles[:, 0])[:, :2]
    hole = 39 * 49 - np.prod(diagonals, axis=1).sum()
    assert np.pi * 7**2 < hole < np.pi * (7 + 2 * np.sqrt(2)) ** 2
    for line in drawn.lines:
        assert np.hypot(*(line[:, :2] - 20).T).min() > 7.0
        assert np.linalg.norm(np.diff(line[:, :2], axis=0), axis=1).max() < 1.0


def test_a_small_part_of_a_domain_is_drawn_finely() -> None:
    corner = gm.surfaces.torus().trimmed([[(1.0, 1.0), (1.2, 1.0), (1.0, 1.2)]])
    drawn = scene_of(corner).quadrangles
    size = np.linalg.norm(np.ptp(drawn.reshape(-1, 3), axis=0))
    assert np.linalg.norm(drawn[:, 2] - drawn[:, 0], axis=1).max() < 0.05 * size
    assert len(drawn) > 1000
