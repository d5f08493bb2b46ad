"""What a terminal shows while work takes longer than a second."""

import inspect
import re
import select
import sys
import time
from typing import Any

import gaussmap as gm
import pytest
from gaussmap.runtime.base import progress
from gaussmap.runtime.base.compiling import NOTICE

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
