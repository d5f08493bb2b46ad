"""`read_cad`: the process that reads, its limits, and what it says."""

import _thread
import os
import signal
import sys
import tempfile
import threading
import time

import gaussmap as gm
import pytest
from gaussmap.tools.cad import reader
from gaussmap.tools.cad.inspection import is_part_file

from ...refusals import refused


@pytest.fixture
def installed(monkeypatch):
    """Let Open CASCADE seem to be there: these files are refused before it is loaded."""
    monkeypatch.setattr(reader, "check_extra", lambda *_: None)


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "part.step"
    path.write_bytes(b"ISO-10303-21;")
    return path


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty."),
        (b"hello\n" * 9, "is not a STEP, IGES or BREP file."),
        (
            b"version https://git-lfs.github.com/spec/v1\n",
            "is a Git LFS pointer, not the file itself; get that with 'git lfs pull'.",
        ),
    ],
)
def test_bad_files_are_refused_in_a_sentence(content, reason, path, installed):
    path.write_bytes(content)
    said = refused("", gm.read_cad, path, error=gm.errors.FileError)
    assert said == f"'{path}' {reason}"


def test_paths_that_are_no_files_are_refused(tmp_path):
    refused("is a folder", gm.read_cad, tmp_path, error=gm.errors.FileError)
    refused("does not exist", gm.read_cad, tmp_path / "part.step", error=gm.errors.FileError)
    os.mkfifo(tmp_path / "pipe.step")
    os.mkfifo(tmp_path / "pipe.npz")
    pipe = r"pipe\.npz' is a device or a pipe"
    for read in (gm.read_part, gm.read_samples):
        refused(pipe, read, str(tmp_path / "pipe.npz"), error=gm.errors.FileError)
    assert not is_part_file(str(tmp_path / "pipe.npz"))
    refused("is a device or a pipe", gm.read_cad, tmp_path / "pipe.step", error=gm.errors.FileError)


@pytest.mark.parametrize(
    "arguments",
    [{"unit": "ell"}, {"unit": 3}, {"time_limit": 0}, {"time_limit": float("nan")},
     {"memory_limit": -1}, {"memory_limit": 0.5}, {"memory_limit": "much"}],
)  # fmt: skip
def test_arguments_are_checked(arguments, tmp_path):
    refused(next(iter(arguments)), gm.read_cad, tmp_path / "part.step", **arguments)


def runs(monkeypatch, code: str) -> None:
    """Let the process that reads run other code."""
    command = [sys.executable, "-c", code]
    monkeypatch.setattr(reader, "command_of_reader", lambda request: command)


def test_a_process_that_hangs_is_gone_after_the_limit(path, tmp_path, installed, monkeypatch):
    alive = tmp_path / "alive"
    # A process with a child of its own, which both would write to a file in a while.
    write = f"import time; time.sleep(1.5); open({str(alive)!r}, 'w')"
    code = f"import os, sys; os.fork(); {write}"
    runs(monkeypatch, code)
    start = time.perf_counter()
    late, error = r"was not read within 0\.5 s", gm.errors.FileError
    refused(late, gm.read_cad, path, time_limit=0.5, error=error)
    assert time.perf_counter() - start < 2.5
    time.sleep(1.5)
    assert not alive.exists()


def test_a_process_that_crashes_is_an_error(path, installed, monkeypatch):
    code = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
    runs(monkeypatch, code)
    refused(r"crash \(SIGSEGV\)", gm.read_cad, path, error=gm.errors.FileError)


@pytest.mark.slow
def test_an_interruption_leaves_nothing_behind(path, tmp_path, installed, monkeypatch):
    folder, alive = tmp_path / "temporary", tmp_path / "alive"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    code = f"import time; time.sleep(1.0); open({str(alive)!r}, 'w')"
    runs(monkeypatch, code)
    # A shell may have made the processes in its background ignore it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.3, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        gm.read_cad(path)
    signal.signal(signal.SIGINT, before)
    assert list(folder.iterdir()) == []
    time.sleep(1.0)
    assert not alive.exists()
