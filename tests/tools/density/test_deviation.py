"""The largest angles between the normals of a surface and those of its samples."""

import gaussmap as gm
import numpy as np
import pytest
from scipy.spatial import KDTree

from ...shapes import widest_angle
from .test_guarantee import places

pytestmark = pytest.mark.compiled

CELLS = (24, 24)


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "moebius_band"])
@pytest.mark.quick_for("wavy_graph")
def test_no_place_of_a_grid_has_a_larger_angle(name):
    spline = gm.fit(name, CELLS)
    samples, (points, normals) = gm.sample(spline, 150), places(spline)
    found, least = samples.normal_deviation(), widest_angle(samples, normals)
    # The places of both are finite: normals turn by less than half a degree between them.
    assert least - 0.5 <= found.normal_space <= 1.1 * least + 0.5
    nearest = samples.normals[KDTree(samples.points).query(points)[1]]
    least = np.degrees(np.arccos((nearest * normals).sum(axis=1).min()))
    assert least - 0.5 <= found.space <= 1.1 * least + 1.0


def test_what_was_asked_is_kept():
    samples = gm.sample(gm.fit("torus", CELLS), angle=12.0)
    assert 6.0 < samples.normal_deviation().normal_space <= 12.0


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
