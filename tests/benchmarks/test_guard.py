"""The guard of speed: what it compares, when it fails, and its record."""

import json

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.benchmarks import guard
from gaussmap.benchmarks.writing import Writers, new_arrays


def test_the_record_is_of_the_cases():
    for ratios in json.loads(guard.RECORD.read_text(encoding="utf-8")).values():
        assert ratios.keys() == guard.CASES.keys()
        assert all(0.0 < ratio < 2.0 for ratio in ratios.values())


def test_quotient_is_of_the_best_times(monkeypatch):
    """Work takes 8, 5, 9 and the limit 2, 1, 4; each has an untimed run before."""
    now = [0.0]

    def taking(*seconds):
        times = iter(seconds)

        def work():
            now[0] += next(times)

        return work

    monkeypatch.setattr(guard, "process_time", lambda: now[0])
    limit = taking(7.0, 2.0, 7.0, 1.0, 7.0, 4.0)
    assert guard.quotient(taking(100.0, 8.0, 5.0, 9.0), limit, rounds=3) == 0.2


def measuring(*values):
    found = iter(values)
    return lambda: next(found)


def test_compared():
    """What two tries measure beside a record of 0.5, what counts, and whether it is fast enough."""
    cases = [
        ("steady", (0.5,), 0.5, True),
        ("slower", (0.351,), 0.351, True),
        ("disturbed", (0.1, 0.36), 0.36, True),
        ("slow", (0.3, 0.349), 0.349, False),
        ("faster", (0.9,), 0.9, True),
    ]
    measure = {name: measuring(*values) for name, values, _, _ in cases}
    found = guard.compared(dict.fromkeys(measure, 0.5), measure, tries=2)
    assert found == [(name, 0.5, counts, is_fast) for name, _, counts, is_fast in cases]


@pytest.mark.parametrize("record", [{}, {"a": 1.0, "b": 1.0}, {"b": 1.0}])
def test_a_record_of_other_cases_is_refused(record):
    with pytest.raises(ValueError, match="make bench-record"):
        guard.compared(record, {"a": measuring(1.0)})


@pytest.fixture
def one_case(tmp_path, monkeypatch):
    """One case whose ratio is 0.4, and a record of its own."""
    monkeypatch.setattr(guard, "RECORD", tmp_path / "recorded.json")
    monkeypatch.setattr(guard, "CASES", {"case": lambda: (list, new_arrays(10))})
    monkeypatch.setattr(guard, "quotient", lambda work, limit: 0.4)
    return guard.RECORD


def test_recording_and_comparing(one_case, capsys):
    assert guard.main(["--record"]) == 0
    record = {guard.processor(): {"case": 0.4}}
    assert json.loads(one_case.read_text(encoding="utf-8")) == record
    assert [x.name for x in one_case.parent.iterdir()] == ["recorded.json"]
    capsys.readouterr()
    assert guard.main([]) == 0
    assert "0.4000 of the writing limit, recorded 0.4000: ok\n" in capsys.readouterr().out


def test_a_case_that_is_too_slow_fails(one_case, capsys):
    record = {guard.processor(): {"case": 0.6}}
    one_case.write_text(json.dumps(record), encoding="utf-8")
    assert guard.main([]) == 1
    assert "recorded 0.6000: FAILED: below 70% of the record" in capsys.readouterr().out


def test_another_processor_is_not_compared(one_case, capsys):
    one_case.write_text(json.dumps({"abacus": {"case": 0.6}}), encoding="utf-8")
    assert guard.main([]) == 0
    assert "not compared: recorded were abacus, and this is " in capsys.readouterr().out
    assert guard.main(["--record"]) == 0
    assert json.loads(one_case.read_text(encoding="utf-8")) == {
        "abacus": {"case": 0.6},
        guard.processor(): {"case": 0.4},
    }


@pytest.mark.parametrize("threads", [1, 3])
def test_the_writing_limit_writes_every_sample(threads):
    arrays = new_arrays(10)
    for array in arrays:
        array.fill(-7)
    with Writers(threads) as write:
        assert write(arrays) is arrays
    assert all((array == 1).all() for array in arrays)


@pytest.mark.parametrize("name", [x for x in guard.CASES if x != "fit-grid"])
def test_cases_of_sampling_fill_the_arrays_that_are_written(name):
    work, arrays = guard.CASES[name]()
    normals = arrays[1]
    normals.fill(np.nan)
    work()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)


def test_fitting_makes_as_many_cells_as_are_written():
    work, arrays = guard.CASES["fit-grid"]()
    made = work()
    assert isinstance(made, gm.Spline)
    assert made.patches == 4 * len(arrays[0])
