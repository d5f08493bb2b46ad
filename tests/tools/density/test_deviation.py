"""The largest angles between the normals of a surface and those of its samples."""

import gaussmap as gm
import numpy as np
import pytest

pytestmark = pytest.mark.compiled

CELLS = (24, 24)
RIGHT = gm.surfaces.cylinder(1.0, 1.0)


def independent(samples, count=200):
    """Return both angles by brute force on a regular grid of places."""
    (u0, u1), (v0, v1) = samples.spline.domain
    u, v = np.linspace(u0, u1, count)[:, None], np.linspace(v0 + 1e-9, v1 - 1e-9, count)
    normals = samples.spline.normals(u, v).reshape(-1, 3)
    points = samples.spline.evaluate(u, v).reshape(-1, 3)
    cosines = normals @ samples.normals.T
    nearest = ((points[:, None] - samples.points) ** 2).sum(axis=2).argmin(axis=1)
    in_space = np.take_along_axis(cosines, nearest[:, None], axis=1)
    angles = cosines.max(axis=1).min(), in_space.min()
    return [np.degrees(np.arccos(np.clip(x, -1.0, 1.0))) for x in angles]


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "moebius_band"])
@pytest.mark.quick_for("wavy_graph")
def test_no_place_of_a_grid_has_a_larger_angle(name):
    samples = gm.sample(gm.fit(name, CELLS), 150)
    found, least = samples.normal_deviation(), independent(samples)
    # The places of both are finite: normals turn by less than half a degree between them.
    assert least[0] - 0.5 <= found.normal_space <= 1.1 * least[0] + 0.5
    assert least[1] - 0.5 <= found.space <= 1.1 * least[1] + 1.0


def test_what_was_asked_is_kept():
    samples = gm.sample(gm.fit("torus", CELLS), angle=12.0)
    assert 6.0 < samples.normal_deviation().normal_space <= 12.0


def test_a_known_angle():
    count = 12
    angles = 2 * np.pi * np.arange(count) / count
    normals = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    spline = gm.fit(RIGHT, (96, 4))
    points = normals + np.array([0, 0, 0.5])
    samples = gm.Samples(
        points=points, normals=normals, report=gm.sample(spline, 5).report, spline=spline
    )
    deviation = samples.normal_deviation()
    assert deviation.normal_space == pytest.approx(15.0, abs=0.2)
    assert deviation.space == pytest.approx(15.0, abs=0.2)


def test_no_samples_are_far_from_everything():
    samples = gm.sample(gm.fit("torus", CELLS), 100)[:0]
    assert samples.normal_deviation() == (180.0, 180.0)


def test_many_places_are_searched_block_by_block(monkeypatch):
    """Fewer places at first, whose cells are cut once more, find about the same angles."""
    samples = gm.sample(gm.fit("torus", (12, 12)), 60, density="gauss")
    expected = samples.normal_deviation()
    for name, value in (("MOST", 5000), ("BLOCK", 1000)):
        monkeypatch.setattr(f"gaussmap.tools.density.deviation.{name}", value)
    np.testing.assert_allclose(samples.normal_deviation(), expected, rtol=0.01)
