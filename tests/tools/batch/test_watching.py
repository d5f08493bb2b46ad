"""What is shown of a run that takes long."""

import pytest
from gaussmap.tools.batch.running import Tally
from gaussmap.tools.batch.watching import Log


def test_a_log_has_few_lines(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    now = iter([0.0, 1.0, 11.0, 12.0, 22.0])
    monkeypatch.setattr("gaussmap.tools.batch.watching.time.monotonic", lambda: next(now))
    log = Log()
    log.begin(1000, "http://host:8787/status")
    for failed in (0, 0, 1, 0):
        log.add(Tally(ok=50 - failed, failed=failed))
    log.end(Tally())
    assert capsys.readouterr().err.splitlines() == [
        "gaussmap: Dask's dashboard: http://host:8787/status",
        "gaussmap: 100 of 1,000 parts, 9.1 parts/s, 99 s left",
        "gaussmap: 200 of 1,000 parts, 1 failed, 9.1 parts/s, 88 s left",
    ]
