"""A process that samples parts within limits, and what becomes of a part if it ends."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
import threading
from contextlib import suppress
from tempfile import TemporaryDirectory
from typing import Any

from ...runtime.base.errors import FileError, GaussmapError
from .manifest import ManifestRow
from .plan import Limits
from .serving import Task

__all__ = ["Child", "StoppedError"]

# Modules of users are found after those of Python and of packages: none hides them.
PROGRAM = (
    "import sys; sys.path += {!r}; from gaussmap.tools.batch.serving import main; main({!r}, {})"
)
# A process has one thread: as many processes run as there are cores.
THREADS = ("NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


class StoppedError(GaussmapError):
    """The run was stopped: the part is not done, and nothing is said of it."""


class Child:
    """A process that is started when it is needed, and again when it has ended.

    Only `end` is called from another thread than the one that uses it.
    """

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._process: subprocess.Popen[bytes] | None = None
        # For temporary files, which a process that is killed leaves.
        self._folder = TemporaryDirectory(prefix="gaussmap-", ignore_cleanup_errors=True)
        self._lock = threading.Lock()
        self._stopped = False

    def sample(self, task: Task) -> ManifestRow | None:
        """Return what became of a part, whose samples are written then; None if it is unchanged.

        Raises StoppedError if `end` was called, FileError if the samples cannot be written.
        """
        late = threading.Event()
        process = self._running()
        assert process.stdin is not None
        timer = threading.Timer(self.limits.seconds, _end_late, (process, late))
        timer.daemon = True
        about: dict[str, Any] = {}
        timer.start()
        try:
            pickle.dump(task, process.stdin, protocol=pickle.HIGHEST_PROTOCOL)
            process.stdin.flush()
            while not about.keys() & {"seconds", "stop"}:
                about |= _line(process)
                if about.get("content") == task.known:
                    return None
        except (EOFError, OSError, ValueError):
            about["error"] = self._why(process, late)
        finally:
            timer.cancel()
        if "stop" in about:
            raise FileError(about["stop"])
        return task.row(about)

    def end(self) -> None:
        """End the process; none is started again."""
        with self._lock:
            self._stopped = True
            if self._process is not None:
                self._process.kill()
                _end(self._process)
                self._process = None
            self._folder.cleanup()

    def _running(self) -> subprocess.Popen[bytes]:
        with self._lock:
            if self._stopped:
                raise StoppedError("the run was stopped.")
            if self._process is not None and self._process.poll() is not None:
                _end(self._process)  # between two parts
                self._process = None
            if self._process is None:
                self._process = self._started()
            return self._process

    def _started(self) -> subprocess.Popen[bytes]:
        paths = [os.path.abspath(x) for x in sys.path]
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", PROGRAM.format(paths, self.limits.memory, os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | dict.fromkeys(THREADS, "1") | {"TMPDIR": self._folder.name},
        )
        try:
            _line(process)
        except EOFError:
            _end(process)
            raise FileError(
                f"the process for sampling did not start (exit code {process.returncode}); see "
                "its messages, or raise memory_limit."
            ) from None
        return process

    def _why(self, process: subprocess.Popen[bytes], late: threading.Event) -> str:
        """Return why a process has ended; it is gone then."""
        with self._lock:
            if self._stopped:
                raise StoppedError("the run was stopped.")
            _end(process)
            self._process = None
        if late.is_set():
            return f"takes longer than time_limit ({self.limits.seconds:g} s); raise it."
        code = process.returncode
        how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
        return (
            f"the process that sampled it ended {how}; it may need more memory than "
            f"{self.limits.memory:g} GiB, or its function or file ends processes."
        )


def _line(process: subprocess.Popen[bytes]) -> dict[str, Any]:
    """Return what a process says; EOFError if it has ended."""
    assert process.stdout is not None
    line = process.stdout.readline()
    if not line.endswith(b"\n"):
        raise EOFError
    return json.loads(line)


def _end_late(process: subprocess.Popen[bytes], late: threading.Event) -> None:
    late.set()
    process.kill()


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process, and wait until it is gone."""
    # A process that was not killed ends by itself: its exit code says why.
    with suppress(subprocess.TimeoutExpired):
        process.wait(0.2)
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout):
        with suppress(OSError):
            if stream is not None:
                stream.close()
