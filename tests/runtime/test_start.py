"""The first half second: Ctrl-C, compilation that is shown, caches that cannot be written."""

import io
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numba
import pytest
from gaussmap.runtime.compiling import ERASE, compilation_shown
from gaussmap.runtime.kernels import jit
from numba.core import config

posix = pytest.mark.skipif(os.name != "posix", reason="needs signals")

# Runs the command, and presses Ctrl-C when a module is first imported.
INTERRUPTED = """
import os, signal, sys

class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == "{module}":
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Finder())
sys.argv = ["gaussmap", "surfaces", "torus"]
{before}
from gaussmap.__main__ import main
sys.exit(main())
"""


def run(code: str) -> tuple[int, str, str]:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


@posix
@pytest.mark.parametrize("module", ["gaussmap.runtime", "numpy", "llvmlite", "numba.core.types"])
def test_interrupted_while_importing(module: str) -> None:
    # A test run in the background ignores interrupts, and what it starts would do so too.
    before = "signal.signal(signal.SIGINT, signal.default_int_handler)"
    code = INTERRUPTED.format(module=module, before=before)
    assert run(code) == (130, "", "gaussmap: interrupted\n")


@posix
def test_who_ignores_interrupts_goes_on_doing_so() -> None:
    code = INTERRUPTED.format(module="numba", before="signal.signal(signal.SIGINT, signal.SIG_IGN)")
    status, out, err = run(code)
    assert (status, err) == (0, "")
    assert out.startswith("torus")


@posix
def test_interrupted_when_all_is_done() -> None:
    code = (
        "import os, signal, sys, weakref\n"
        "from gaussmap.__main__ import main\n"
        "sys.argv = ['gaussmap', 'surfaces', 'torus']\n"
        "class At: pass\n"
        "at = At()\n"
        "weakref.finalize(at, lambda: os.kill(os.getpid(), signal.SIGINT))\n"
        "sys.exit(main())"
    )
    status, out, err = run(code)
    assert (status, err) == (0, "")
    assert out.startswith("torus")


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def compiled_now() -> Any:
    """Return a function that calls another; both have still to be compiled."""

    @numba.njit
    def inner(x):
        return x + 1

    @numba.njit
    def outer(x):
        return inner(x) + 1

    return outer


@pytest.mark.compiled
def test_compilation_is_shown_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal, outer = Terminal(), compiled_now()
    monkeypatch.setattr(sys, "stderr", terminal)
    with compilation_shown(True):
        assert outer(1) == 3
        assert outer(2) == 4
    assert terminal.getvalue() == f"{ERASE}compiling outer (the first time only){ERASE}"
    with compilation_shown(True):
        assert outer(1.5) == 3.5
    assert terminal.getvalue().count("compiling outer") == 2
    assert compiled_now()(1) == 3
    with compilation_shown(False):
        assert compiled_now()(1) == 3
    assert terminal.getvalue().count("compiling") == 2


@pytest.mark.compiled
def test_compilation_is_not_shown_in_files(monkeypatch: pytest.MonkeyPatch) -> None:
    for stream in (io.StringIO(), None):
        monkeypatch.setattr(sys, "stderr", stream)
        with compilation_shown(True):
            assert compiled_now()(1) == 3
        assert stream is None or stream.getvalue() == ""


@pytest.mark.compiled
def test_a_cache_that_cannot_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels are compiled all the same, and not kept."""
    nowhere = Path(os.devnull) / "cache"
    monkeypatch.setattr(jit, "PACKAGE", nowhere)
    monkeypatch.setattr(config, "CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(nowhere))
    monkeypatch.setattr(jit, "cache_folder", jit.cache_folder.__wrapped__)
    monkeypatch.setattr(jit, "digest", lambda: "0")

    def triple(x: float) -> float:
        return 3 * x

    assert jit.cache_folder() is None
    assert jit.jit(triple)(2.0) == 6.0
