"""Relaxing: what it gains, and what its samples for normals do."""

import gaussmap as gm
import pytest
from gaussmap.runtime.density import relaxation


def relaxed(name: str, count: int) -> gm.Samples:
    spline = gm.fit(gm.surfaces.surface(name), (32, 32))
    return gm.sample(spline, count, relax=2)


@pytest.mark.compiled
def test_relaxing_narrows_gaps_and_angles():
    """By 8 and 5 percent; they get wider if samples begin as close as they end."""
    plain = gm.sample(gm.fit("monkey_saddle", (32, 32)), 600)
    found = relaxed("monkey_saddle", 600)
    assert found.coverage() < 0.95 * plain.coverage()
    assert found.normal_deviation().space < 0.98 * plain.normal_deviation().space


@pytest.mark.compiled
def test_a_tenth_of_the_added_samples_goes_where_normals_are_missing(monkeypatch):
    """With half of them, the widest angle is 4.9° instead of 3.9°; with more, gaps get wider."""
    numbers, fill = [], relaxation.fill_widest_angles

    def recorded(cover, number, widest):
        numbers.append(number)
        fill(cover, number, widest)

    monkeypatch.setattr(relaxation, "fill_widest_angles", recorded)
    samples = relaxed("monkey_saddle", 1000)
    added = int((samples.kind == "filling").sum())
    assert numbers == [round(0.1 * added)]
    assert samples.normal_deviation().normal_space < 4.4
