"""The slope of log(time), and the sizes that are measured."""

import pytest
from gaussmap.benchmarks import scale


def test_slope_by_least_squares():
    # by hand: x = 0, 1, 2 and y = 0, 0, 3 give Σ(x − 1)(y − 1)/Σ(x − 1)² = 3/2
    assert scale.slope([(1, 1), (10, 1), (100, 1000)]) == pytest.approx(1.5)


@pytest.mark.parametrize("pairs", [[], [(10, 1.0)], [(10, 1.0), (10, 2.0)]])
def test_slope_needs_two_sizes(pairs):
    with pytest.raises(ValueError, match="two sizes"):
        scale.slope(pairs)


def test_a_series_grows_with_patches_and_samples():
    series = scale.Series("x", [(0, 1, 1.0), (50, 50, 1.0), (900, 100, 10.0)])
    assert series.slope(2) == pytest.approx(1.0)
    assert series.slope() < 1.0


def test_measuring_up_to_a_size():
    samples, patches = scale.measure(10_000)
    assert [count for _, count, _ in samples.rows] == [1_000, 10_000]
    assert {count for count, _, _ in samples.rows} == {4 * scale.FIXED_CELLS**2}
    assert [count for count, _, _ in patches.rows] == [1_024, 10_000]
    assert {count for _, count, _ in patches.rows} == {2 * scale.FIXED_NORMALS}
    assert all(seconds > 0.0 for series in (samples, patches) for *_, seconds in series.rows)


def test_larger_sizes_come_in_chunks(monkeypatch):
    asked = []

    def stream(spline, count):
        asked.append(count)
        yield from (range(count - 7), range(7))

    monkeypatch.setattr(scale, "STREAMED", 1_000)
    monkeypatch.setattr(scale.gm, "sample_stream", stream)
    series = scale.by_samples(10_000)
    assert [count for _, count, _ in series.rows] == [1_000, 10_000]
    assert set(asked) == {10_000}
