"""The measurement of first calls: an empty cache compiles, a full one does not."""

import pytest
from gaussmap.benchmarks import cold_start

CALL = "gm.fit(torus, cells=(3, 4)).evaluate(0.5, 0.5)"


@pytest.mark.compiled
@pytest.mark.slow
def test_only_an_empty_cache_compiles(tmp_path):
    first, second = (cold_start.cold(CALL, tmp_path) for _ in range(2))
    names = [name for name, _, _ in first["functions"]]
    assert "gaussmap.runtime.kernels.spline.evaluate" in names
    assert all(seconds > 0.0 for _, _, seconds in first["functions"])
    assert second["functions"] == []


@pytest.mark.slow
@pytest.mark.compiled
def test_the_page_has_a_row_and_a_table_for_each_call(monkeypatch):
    monkeypatch.setattr(cold_start, "CALLS", {"`fit`": CALL})
    page = cold_start.page()
    assert page.count("| `fit` |") == 2
    assert "| `runtime.kernels.spline.evaluate` | 1 |" in page
