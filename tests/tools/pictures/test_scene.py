"""Parts of figures: the surface, spheres of normals, marks, globes and colours."""

from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures.colours import Colours, colours_of
from gaussmap.tools.pictures.marked import Marked, marked
from gaussmap.tools.pictures.scene import divided, height_factor, scene_of, view
from gaussmap.tools.pictures.sphere_half import draw_sphere, view_of
from gaussmap.tools.pictures.support_globes import branches_of, values_on_globe


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


# --- the sphere of normals ------------------------------------------------------------------------


@pytest.mark.parametrize("mean", [(0, 0, 1), (1, 0, 0), (0, 0, 0), (0, 0, -1), None])
def test_the_view_of_the_sphere(mean: tuple[float, float, float] | None) -> None:
    vectors = np.array([-view()[2] if mean is None else mean], dtype=float)
    seen_from = view_of(vectors)
    np.testing.assert_allclose(seen_from @ seen_from.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(seen_from) == pytest.approx(1.0)
    np.testing.assert_allclose(seen_from[2], vectors[0] if vectors.any() else view()[2], atol=1e-12)


def test_the_legend_counts_normals_of_each_kind() -> None:
    from matplotlib.figure import Figure

    def labels(samples: gm.Samples, normals: np.ndarray) -> list[object]:
        axes = Figure().add_subplot()
        return [handle.get_label() for handle in draw_sphere(axes, samples, normals, view())]

    torus = gm.fit(gm.surfaces.torus(), cells=(24, 24))
    balanced = gm.sample(torus, 300)
    searched = len(np.unique(balanced.normal_index)) - 1
    filling = int(np.count_nonzero(balanced.kind == "filling"))
    none = np.empty((0, 3))
    assert labels(balanced, none) == [f"filling gaps ({filling})", f"prescribed ({searched})"]
    aligned = gm.sample(torus, 300, density="aligned")
    assert f"on a grid ({np.count_nonzero(aligned.kind == 'grid')})" in labels(aligned, none)
    bowl = gm.fit(gm.surfaces.elliptic_paraboloid(), cells=(16, 16))
    normals = gm.fibonacci(100)
    found = len(gm.sample(bowl, normals=normals))
    assert labels(gm.sample(bowl, normals=normals), normals) == [
        f"prescribed, no sample ({100 - found})",
        f"prescribed ({found})",
    ]


# --- one normal and its points --------------------------------------------------------------------


def test_both_points_of_a_torus_are_visible() -> None:
    torus = gm.fit(gm.surfaces.torus(), cells=(24, 24))
    samples = gm.sample(torus, normals=gm.fibonacci(300))
    found = marked(samples, scene_of(torus).visible(samples.points), view())
    assert np.count_nonzero(found.visible) == np.count_nonzero(found.samples) == 2
    assert (samples.normals[found.samples] == found.normal).all()
    assert 0.3 < np.linalg.norm(view()[:2] @ found.normal) < 0.95  # an arrow that is seen
    assert found.label == "one normal and its points (2)"


def test_rare_samples_are_not_marked() -> None:
    samples = gm.sample("torus", normals=gm.fibonacci(40), cells=(16, 16))
    few = samples.normal_index == samples.normal_index[np.argmax(samples.normals @ view()[2])]
    visible = ~few
    visible[np.flatnonzero(few)[0]] = True  # one visible sample, where the others have two
    found = marked(samples, visible, view())
    assert not (found.samples & few).any()


def test_nothing_is_marked_without_prescribed_normals() -> None:
    samples = gm.sample("torus", 50, density="uniform", cells=(16, 16))
    assert marked(samples, np.ones(len(samples), dtype=bool), view()) is None


@pytest.mark.parametrize(
    ("count", "seen", "label"),
    [
        (1, 1, "one normal and its point"),
        (2, 1, "one normal and its points (2, 1 visible)"),
        (1200, 1200, "one normal and its points (1,200)"),
    ],
)
def test_the_label(count: int, seen: int, label: str) -> None:
    rows = np.arange(2000)
    assert Marked(np.array([0.0, 0.0, 1.0]), rows < count, rows < seen).label == label


# --- globes of the support function ---------------------------------------------------------------


def test_a_torus_has_two_branches() -> None:
    samples = gm.sample("torus", 400, cells=(16, 16))
    elliptic, hyperbolic = branches_of(samples)
    assert (elliptic.name, hyperbolic.name) == ("K > 0", "K < 0")
    assert (samples.kind[elliptic.samples | hyperbolic.samples] == "normal").all()
    assert (samples.gaussian_curvature[elliptic.samples] > 0).all()
    assert (samples.gaussian_curvature[hyperbolic.samples] < 0).all()


def test_more_branches_are_not_drawn() -> None:
    waves = gm.surfaces.surface("wavy_graph")
    assert branches_of(gm.sample(waves, normals=gm.fibonacci(200))) == []
    assert branches_of(gm.sample("torus", 50, density="uniform", cells=(16, 16))) == []
    fields = ("points", "normals", "gaussian_curvature", "normal_index")
    assert branches_of(gm.sample("torus", normals=gm.icosphere(2), fields=fields)) == []


def globe_of(samples: gm.Samples) -> tuple[np.ndarray, ...]:
    """Return the values on the globe of the samples with K > 0, and x, y of its pixels."""
    branch = branches_of(samples)[0].samples
    values = values_on_globe(samples.normals[branch], samples.points[branch], view())
    return values, *np.meshgrid(*2 * [np.linspace(-1.0, 1.0, len(values))])


def test_colours_are_the_support_function() -> None:
    """That of the torus with K > 0 is R·|(n_x, n_y)| + r; errors are squares of angles."""
    values, x, y = globe_of(gm.sample("torus", normals=gm.fibonacci(2000)))
    inside = np.hypot(x, y) < 1.0
    z = np.sqrt(np.where(inside, 1.0 - x * x - y * y, 0.0))
    across = np.linalg.norm((np.stack([x, y, z], axis=2) @ view())[..., :2], axis=2)
    exact = 1.0 * across + 0.35
    assert np.abs(values - exact)[inside & (across > 0.1)].max() < 0.02
    assert np.abs(values - exact)[inside].max() < 0.06  # at the pole h has no gradient


def test_far_from_all_normals_nothing_is_drawn() -> None:
    near = gm.directions.cap(gm.fibonacci(2000), view()[2], 30)
    values, x, y = globe_of(gm.sample("torus", normals=near))
    r = np.hypot(x, y)
    assert np.isfinite(values[r < 0.45]).all()
    assert np.isnan(values[(r > 0.65) & (r < 1.0)]).all()


# --- ends of the scale of colours -----------------------------------------------------------------


def colours(curvatures: np.ndarray) -> Colours:
    """The colours of samples of given Gaussian curvatures."""
    samples = gm.sample("torus", normals=gm.icosphere(4), cells=(8, 8), on="spline")[
        : len(curvatures)
    ]
    return colours_of(replace(samples, gaussian_curvature=curvatures), "gaussian_curvature")


def test_few_large_curvatures_are_beyond_the_scale() -> None:
    found = colours(np.r_[np.linspace(-0.96, 0.96, 97), 9.0, 90.0, np.inf])
    assert found.clipped
    assert found.norm.vmax == -found.norm.vmin
    assert 0.91 < -found.norm.vmin < 0.95


@pytest.mark.parametrize(("largest", "clipped"), [(1.2, False), (1.3, True)])
def test_a_scale_ends_at_the_largest_curvature_if_that_is_near(largest, clipped) -> None:
    found = colours(np.r_[np.ones(99), -largest])
    assert found.clipped == clipped
    assert found.norm.vmax == (1.0 if clipped else largest)
