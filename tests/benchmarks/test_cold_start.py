"""The measurement of first calls: what compiles is seen, and fails the check."""

from pathlib import Path

import pytest
from gaussmap.benchmarks import cold_start

CALL = "gm.fit('torus', cells=(3, 4)).evaluate(0.5, 0.5)"


@pytest.fixture(autouse=True)
def one_call(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cold_start, "CALLS", {"`fit`": CALL})
    monkeypatch.setattr(cold_start, "COMMANDS", {})
    monkeypatch.setattr(cold_start, "USUAL", ["`fit`"])


def test_only_an_empty_cache_compiles(tmp_path: Path) -> None:
    (arguments,) = cold_start.programs().values()
    folder = tmp_path / "cache"
    first, second = (cold_start.cost(arguments, folder, cold_start.HERE_ONLY) for _ in range(2))
    assert first.compiled == second.compiled > 0
    assert first.beyond > second.beyond > 0.0
    assert first.seconds > first.beyond


def test_the_check_fails_if_kernels_are_compiled(monkeypatch, capsys):
    monkeypatch.setenv("GAUSSMAP_KERNELS", "0")
    assert cold_start.main(["--check"]) == 1
    assert "FAILED `fit`" in capsys.readouterr().out
