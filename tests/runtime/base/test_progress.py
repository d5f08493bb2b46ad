"""What a terminal shows while work takes longer than a second."""

import inspect
import os
import re
import select
import signal
import sys
import threading
import time
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.base import progress
from gaussmap.runtime.base.compiling import NOTICE
from gaussmap.runtime.base.threads import interruptible, over_ranges, thread_count

from ...products import covering
from ...refusals import refused
from .test_compiling import Terminal


def terminal_of(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Make standard error a terminal. (No fixture: pytest sets it again after these.)"""
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setattr(progress, "PATIENCE", 0.05)
    monkeypatch.setattr(progress, "INTERVAL", 0.01)
    return shown


def lines_of(terminal: Terminal) -> list[str]:
    return [line.strip() for line in terminal.getvalue().split("\r") if line.strip()]


def test_what_takes_long_is_shown_and_erased(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the step at hand and its share; also if there is an error."""
    terminal = terminal_of(monkeypatch)

    def fail() -> None:
        with progress.busy("thinking", True):
            time.sleep(0.2)
            progress.tell("hard", lambda: 0.25)
            time.sleep(0.2)
            progress.tell("twice")
            time.sleep(0.1)
            raise KeyError

    progress.tell("of nothing")
    with pytest.raises(KeyError):
        fail()
    assert len(lines_of(terminal)) > 3
    steps = ("thinking", "thinking, hard, 25%", "thinking, twice")
    assert {*lines_of(terminal)} == {f"{x}: 00:00" for x in steps}
    assert terminal.getvalue().endswith("\r")


def test_meshing_shows_its_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    samples = gm.sample("torus", 5000)
    terminal = terminal_of(monkeypatch)
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    monkeypatch.setattr(progress, "INTERVAL", 0.001)
    samples.mesh(progress=True)
    assert "meshing, triangulating: 00:0" in terminal.getvalue()
    assert re.search(r"meshing, flipping edges, \d+%: 00:0", terminal.getvalue())


def test_what_is_quick_or_not_asked_for_is_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    with progress.busy("thinking", False):
        time.sleep(0.1)
    with progress.busy("thinking", True):
        pass
    monkeypatch.setattr(NOTICE, "line", "compiling")  # has the line already
    with progress.busy("thinking", True):
        time.sleep(0.1)
    assert "thinking" not in terminal.getvalue()


def test_progress_stays_on_standard_error(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pty, termios = pytest.importorskip("pty"), pytest.importorskip("termios")
    reader, writer = pty.openpty()
    termios.tcsetwinsize(writer, (24, 80))
    with open(writer, "w") as terminal, open(reader, "rb", buffering=0) as screen:
        monkeypatch.setattr(sys, "stderr", terminal)
        monkeypatch.setattr(progress, "PATIENCE", 0.0)
        gm.sample("torus", count=100, cells=(8, 8), progress=True)
        terminal.write("then ")
        list(gm.sample_many(["torus"], count=100, cells=(8, 8), progress=True))
        terminal.flush()
        written = b""
        while select.select([screen], [], [], 1.0)[0]:  # it arrives in pieces
            written += screen.read(1 << 16)
        one, _, many = written.decode().partition("then ")
        monkeypatch.undo()
    assert "sampling: 00:00" in one
    assert "1/1" in many
    assert capfd.readouterr() == ("", "")


CALLS = [gm.sample, gm.fit, gm.read_cad, gm.sample_many, gm.sample_stream, gm.silhouette]
METHODS = ["mesh", "coverage", "normal_deviation", "weights", "progressive", "write"]


@pytest.mark.parametrize(
    "call", [*CALLS, *(getattr(gm.Samples, name) for name in METHODS)], ids=lambda x: x.__name__
)
def test_everything_that_may_take_long_has_it(call: Any) -> None:
    assert "progress" in inspect.signature(call).parameters


def test_calls_with_progress(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    terminal_of(monkeypatch)
    spline = gm.fit("torus", (8, 8), progress=True)
    samples = gm.sample(spline, 60, progress=True)
    assert len(samples.progressive(progress=True)) == 60
    assert len(samples.weights(progress=True)) == 60
    assert samples.mesh(progress=True).summary() == samples.mesh().summary()
    assert samples.coverage(progress=True) == samples.coverage()
    assert samples.normal_deviation(progress=True) == samples.normal_deviation()
    samples.write(tmp_path / "a.npz", progress=True)
    for call in samples.mesh, samples.coverage, samples.weights, samples.progressive:
        assert inspect.signature(call).parameters["progress"].default is False


# --- threads --------------------------------------------------------------------------------------


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
