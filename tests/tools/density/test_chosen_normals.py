"""The normals for a count of samples."""

import gaussmap as gm
import pytest
from gaussmap.tools.density import chosen_normals

from ...products import covering
from ...shapes import same


@covering(
    name=["torus", "wavy_graph", "moebius_band", "enneper", "helicoid"], count=[1000, 1700, 3000]
)
def test_a_count_is_met_within_a_hundredth(name, count):
    samples = gm.sample(name, count, density="gauss", cells=(24, 24), on="spline")
    assert abs(len(samples) - count) <= count / 100


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "moebius_band"])
def test_a_count_is_concluded_from_a_smaller_one(name, monkeypatch):
    spline = gm.fit(gm.surfaces.surface(name))
    monkeypatch.setattr(chosen_normals, "PILOT", 2000)
    tried, find = [], chosen_normals.find

    def recorded(spline, normals, *rest):
        tried.append(len(normals))
        return find(spline, normals, *rest)

    monkeypatch.setattr(chosen_normals, "find", recorded)
    samples = gm.sample(spline, count=50_000, density="gauss")
    assert abs(len(samples) - 50_000) <= 2500
    assert 10 * max(tried) < (samples.report.normals or 0)
    chunks = gm.sample_stream(spline, count=50_000, chunk=9999)
    same(gm.Samples.concatenate(chunks), samples)
