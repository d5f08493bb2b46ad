"""Threads: the same results in the same order, and errors that end the work."""

import os
import threading
import time
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.base.threads import over_ranges, thread_count
from gaussmap.runtime.samples.fields import ARRAY_NAMES


@pytest.mark.parametrize("threads", [1, 2, 3, 16])
@pytest.mark.parametrize(("total", "size"), [(0, 5), (1, 5), (5, 5), (6, 5), (23, 5), (23, 1)])
@pytest.mark.parametrize("progress", [False, True])
def test_ranges_come_in_order(threads, total, size, progress):
    def work(first, last):
        time.sleep(0.001 * (first % 3))  # so that later ranges end earlier
        return list(range(first, last))

    ranges = list(over_ranges(work, total, size, threads, progress))
    assert [x for part in ranges for x in part] == list(range(total))
    assert all(len(part) == size for part in ranges[:-1])


def test_threads_work_at_once():
    barrier = threading.Barrier(3, timeout=10)
    assert list(over_ranges(lambda first, last: barrier.wait() >= 0, 3, 1, 3)) == [True] * 3


def test_one_thread_is_the_calling_one():
    names = list(over_ranges(lambda *_: threading.current_thread(), 4, 1, 1))
    assert names == [threading.current_thread()] * 4


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, gm.errors.InputError])
def test_an_error_ends_the_work(threads, error):
    done = []

    def work(first, last):
        if first == 3:
            raise error("three")
        time.sleep(0.002)
        done.append(first)

    with pytest.raises(error, match="three"):
        list(over_ranges(work, 1000, 1, threads))
    assert len(done) < 500


def test_work_inside_of_work():
    def outer(first, last):
        return list(over_ranges(lambda a, b: (first, a), 4, 1, 2))

    found = list(over_ranges(outer, 6, 1, 2))
    assert found == [[(k, x) for x in range(4)] for k in range(6)]


def test_threads_are_kept():
    names = {x.name for x in over_ranges(lambda *_: threading.current_thread(), 50, 1, 2)}
    again = {x.name for x in over_ranges(lambda *_: threading.current_thread(), 50, 1, 2)}
    assert len(names | again) <= 2


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.filterwarnings("ignore:.*use of fork.*:DeprecationWarning")
def test_a_forked_process_starts_its_own_threads():
    list(over_ranges(lambda first, last: first, 8, 1, 2))
    child = os.fork()
    if child == 0:
        found = list(over_ranges(lambda first, last: first, 8, 1, 2))
        os._exit(0 if found == list(range(8)) else 1)
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            assert os.waitstatus_to_exitcode(status) == 0
            return
        time.sleep(0.01)
    os.kill(child, 9)
    pytest.fail("the child hangs")


def test_how_many_threads(monkeypatch):
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    cores = thread_count(None)
    assert 1 <= cores <= (os.cpu_count() or 1)
    assert thread_count(3) == 3
    assert thread_count(np.int64(3)) == 3  # pyright: ignore[reportArgumentType]
    monkeypatch.setenv("NUMBA_NUM_THREADS", "5")
    assert thread_count(None) == 5
    assert thread_count(2) == 2
    for unusable in ("0", "", "many", "-1", "1.5", "²"):
        monkeypatch.setenv("NUMBA_NUM_THREADS", unusable)
        assert thread_count(None) == cores


@pytest.mark.parametrize("threads", [0, -1, 1.5, True, "2", np.nan, [2]])
def test_threads_that_are_none(threads):
    calls = [
        lambda: thread_count(threads),
        lambda: gm.sample(gm.surfaces.torus(), count=10, cells=(4, 4), threads=threads),
        lambda: next(gm.sample_many([gm.surfaces.torus()], count=10, threads=threads)),
    ]
    for call in calls:
        with pytest.raises(
            gm.errors.InputError, match=r"^threads must be a whole number of at least 1"
        ):
            call()


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["torus", "sphere", "moebius_band", "wavy_graph"])
def test_any_number_of_threads_gives_the_same_bits(name, monkeypatch):
    """More patches and samples than go into one range; normals on symmetry planes among them."""
    monkeypatch.setattr("gaussmap.runtime.search.search.MOST_PATCHES", 500)
    monkeypatch.setattr("gaussmap.runtime.search.search.SAMPLES_AT_A_TIME", 333)
    surface = gm.surfaces.surface(name)
    asked: dict[str, Any]
    for asked in ({"normals": gm.icosphere(24)}, {"count": 2000}):
        first, *others = (
            gm.sample(surface, cells=(40, 30), threads=threads, **asked) for threads in (1, 2, 3, 7)
        )
        assert len(first) > 600
        for other in others:
            assert other.report == first.report
            for array in ARRAY_NAMES:
                assert getattr(other, array).tobytes() == getattr(first, array).tobytes()


@pytest.mark.compiled
def test_ranges_do_not_show_in_the_result(monkeypatch):
    whole = gm.sample(gm.surfaces.torus(), normals=gm.icosphere(16), cells=(24, 24), threads=1)
    monkeypatch.setattr("gaussmap.runtime.search.search.MOST_PATCHES", 7)
    monkeypatch.setattr("gaussmap.runtime.search.search.ROOM", 1)
    monkeypatch.setattr("gaussmap.runtime.search.search.SAMPLES_AT_A_TIME", 11)
    pieces = gm.sample(gm.surfaces.torus(), normals=gm.icosphere(16), cells=(24, 24), threads=2)
    for array in ARRAY_NAMES:
        assert getattr(whole, array).tobytes() == getattr(pieces, array).tobytes()


@pytest.mark.compiled
def test_several_python_threads_at_once():
    """One spline, whose cached parts are made on first use, and several surfaces."""
    names = ["torus", "sphere", "enneper", "catenoid"]
    shared = gm.fit(gm.surfaces.torus(), (24, 24))
    expected = [gm.sample(gm.surfaces.surface(x), count=500, cells=(24, 24)).points for x in names]
    expected += [
        gm.sample(gm.fit(gm.surfaces.torus(), (24, 24)), normals=gm.icosphere(8)).points
    ] * 4
    found: list[object] = [None] * 8
    start = threading.Barrier(8, timeout=30)

    def work(k):
        start.wait()
        if k < 4:
            surface = gm.surfaces.surface(names[k])
            found[k] = gm.sample(surface, count=500, cells=(24, 24)).points
        else:
            found[k] = gm.sample(shared, normals=gm.icosphere(8)).points

    workers = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)
