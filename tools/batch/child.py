"""A process that samples parts within limits, and what becomes of a part if it ends."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from ...runtime.base.errors import FileError, GaussmapError
from .frames import read_frame
from .serving import Task

__all__ = ["Answer", "Child", "Limits", "StoppedError"]

# Modules of users are found after those of Python and of packages: none hides them.
PROGRAM = (
    "import sys; sys.path += {!r}; from gaussmap.tools.batch.serving import main; main({!r}, {})"
)
# A process has one thread: as many processes run as there are cores.
THREADS = ("NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True, slots=True)
class Limits:
    """The longest time that a part may take, in seconds, and the most memory, in GiB."""

    seconds: float
    memory: float


class StoppedError(GaussmapError):
    """The run was stopped: the part is not done, and nothing is said of it."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What became of a part: numbers of the manifest, and the table of its samples."""

    about: dict[str, Any]
    table: Any = None

    @property
    def same(self) -> bool:
        """Whether the part is unchanged, so that it was not sampled."""
        return bool(self.about.get("same"))

    @property
    def error(self) -> str:
        """Why it could not be sampled, or nothing."""
        return str(self.about.get("error") or "")


class Child:
    """A process that is started when it is needed, and again when it has ended.

    Only `end` is called from another thread than the one that uses it.
    """

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()
        self._stopped = False

    @property
    def stopped(self) -> bool:
        """Whether `end` was called: no part is sampled any more."""
        return self._stopped

    def sample(self, task: Task) -> Answer:
        """Return what became of a part.

        Raises StoppedError if `end` was called.
        """
        late = threading.Event()
        process = self._running()
        assert process.stdin is not None
        assert process.stdout is not None
        timer = threading.Timer(self.limits.seconds, _end_late, (process, late))
        timer.daemon = True
        about: dict[str, Any] = {}
        table = None
        timer.start()
        try:
            pickle.dump(task, process.stdin, protocol=pickle.HIGHEST_PROTOCOL)
            process.stdin.flush()
            while not about.keys() & {"same", "error", "samples"}:
                more, table = read_frame(process.stdout)
                about |= more
        except (EOFError, OSError, ValueError):
            about["error"] = self._why(process, late)
        finally:
            timer.cancel()
        return Answer(about, table)

    def end(self, stop: bool = True) -> None:
        """End the process; with `stop`, none is started again."""
        with self._lock:
            self._stopped |= stop
            if self._process is not None:
                self._process.kill()
                _end(self._process)
                self._process = None

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
            env=os.environ | dict.fromkeys(THREADS, "1"),
        )
        assert process.stdout is not None
        try:
            read_frame(process.stdout)
        except EOFError:
            _end(process)
            raise FileError(
                f"the process that samples does not start (exit code {process.returncode}); look "
                "at what it says, or raise memory_limit."
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
