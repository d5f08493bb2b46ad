"""What is shown of a run that takes long."""

from gaussmap.tools.batch import making
from gaussmap.tools.batch.workers import Tally


def test_a_log_has_few_lines(capsys, monkeypatch):
    for interval, count in ((10.0, 1), (0.0, 6)):
        monkeypatch.setattr(making, "INTERVAL", interval)
        tallies = [Tally(ok=50 - failed, failed=failed) for failed in (0, 0, 1, 0)]
        log = making.progress()
        assert list(making.watched(tallies, 1000, "http://host:8787/status", log)) == tallies
        lines = capsys.readouterr().err.splitlines()
        assert "gaussmap: Dask's dashboard: http://host:8787/status" in lines
        assert len(lines) == count
    assert lines[-1].startswith("gaussmap: 200 of 1000 parts, failed=1, ")
    assert lines[-1].endswith(" left")
