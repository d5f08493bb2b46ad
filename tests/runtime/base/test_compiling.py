"""Compilation is shown on a terminal."""

import io
import re
import sys
from typing import Any

import numba
import pytest
from gaussmap.runtime.base import compiling


@pytest.fixture(autouse=True)
def _not_quiet(monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands with --quiet, run by tests in this process, silence the notice."""
    monkeypatch.setattr(compiling.NOTICE, "quiet", False)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def compiled_now(module: str = "gaussmap.kernels") -> Any:
    """Return a function that calls another; both have still to be compiled."""

    @numba.njit
    def inner(x):
        return x + 1

    def outer(x):
        return inner(x) + 1

    outer.__module__ = module
    return numba.njit(outer)


def test_compilation_is_shown_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(compiling, "PATIENCE", 0.0)
    outer = compiled_now()
    assert outer(1) == 3
    assert outer(2) == 4
    first, *lines, last = terminal.getvalue().split(compiling.ERASE)
    assert (first, last) == ("", "")
    pattern = r"gaussmap: compiling kernels, only once here \(\d+ s\): outer"
    assert lines
    assert all(re.fullmatch(pattern, line) for line in lines)
    assert outer(1.5) == 3.5
    assert terminal.getvalue().count("outer") > len(lines)
    assert terminal.getvalue().endswith(compiling.ERASE)


def test_compilation_is_shown_in_a_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its output knows no codes of terminals: spaces erase a line."""
    notebook = type("OutStream", (io.StringIO,), {"__module__": "ipykernel.iostream"})()
    monkeypatch.setattr(sys, "stderr", notebook)
    monkeypatch.setattr(compiling, "PATIENCE", 0.0)
    assert compiled_now()(1) == 3
    written = notebook.getvalue()
    assert "compiling kernels" in written
    assert "\033" not in written
    assert written.rsplit("\r", 1)[1] == ""
    *_, blank, _ = written.split("\r")
    assert blank.strip() == ""
    assert len(blank) >= len(written.split("\r")[-4])


def test_compilation_is_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not in files, not if it is quick, not if it is of others, and not to who wants quiet."""
    monkeypatch.setattr(compiling, "PATIENCE", 0.0)
    for stream in (io.StringIO(), None):
        monkeypatch.setattr(sys, "stderr", stream)
        assert compiled_now()(1) == 3
        assert stream is None or stream.getvalue() == ""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    assert compiled_now(module="somebody.else")(1) == 3
    with monkeypatch.context() as patch:
        patch.setattr(compiling.NOTICE, "quiet", True)
        assert compiled_now()(1) == 3
    monkeypatch.setattr(compiling, "PATIENCE", 1e9)
    assert compiled_now()(1) == 3
    assert terminal.getvalue() == ""
