"""Threads: the results of ranges in order, and errors that end the work."""

import os
import signal
import threading
import time

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.base.threads import interruptible, over_ranges, thread_count

from ...products import covering
from ...refusals import refused


@covering(
    threads=[1, 2, 3, 16],
    progress=[False, True],
    **{"total, size": [(0, 5), (1, 5), (5, 5), (6, 5), (23, 5), (23, 1)]},
)
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


@covering(threads=[1, 2], error=[ValueError, KeyboardInterrupt, gm.errors.InputError])
def test_an_error_ends_the_work(threads, error):
    done = []

    def work(first, last):
        if first == 3:
            raise error("three")
        time.sleep(0.002)
        done.append(first)

    refused("three", list, over_ranges(work, 1000, 1, threads), error=error)
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
    refused(r"^threads must be a whole number of at least 1", thread_count, threads)


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no signals to threads")
def test_a_long_call_does_not_keep_an_interruption_waiting():
    assert interruptible(lambda: 7) == 7
    ends, start = threading.Event(), time.perf_counter()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    main = threading.get_ident()
    threading.Timer(0.1, lambda: signal.pthread_kill(main, signal.SIGINT)).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            interruptible(lambda: ends.wait(5.0))
    finally:
        signal.signal(signal.SIGINT, before)
        ends.set()
    assert time.perf_counter() - start < 2.5
