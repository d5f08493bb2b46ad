"""Sampling parts by processes: an error or a crash only costs the part that caused it."""

from __future__ import annotations

import json
import math
import os
import pickle
import signal
import time
from collections.abc import Generator, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from typing import Any, Self

from ...runtime.base.errors import FileError
from ...runtime.base.extras import from_extra
from .folder import PARTIAL
from .inputs import Input
from .manifest import FAILED, ManifestRow
from .part_files import row_of, write_part
from .plan import Plan
from .worker_loop import KEPT, STOPPED, Task, serve

# The largest number of failed parts that are shown when a run ends; the manifest has all of them.
SHOWN = 10
# A process has one thread, since one process runs on each core. Modules in the user's folder must
# not hide modules of Python and of packages (PYTHONSAFEPATH).
ENVIRONMENT = dict.fromkeys(
    ("NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS",
     "PYTHONSAFEPATH"), "1"
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Tally:
    """The numbers of parts that were sampled, that failed, and that an earlier run had done (kept).

    `samples` is the number of samples of all these parts, and `failures` are the names of the first
    failed parts, with their errors.
    """

    ok: int = 0
    failed: int = 0
    kept: int = 0
    samples: int = 0
    failures: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(cls, row: ManifestRow, kept: bool) -> Self:
        """Return the tally of one part."""
        if row.status == FAILED:
            return cls(failed=1, failures=((row.name, row.error),))
        return cls(ok=int(not kept), kept=int(kept), samples=row.samples)

    @property
    def parts(self) -> int:
        """The number of parts."""
        return self.ok + self.failed + self.kept

    def __add__(self, other: Self) -> Tally:
        return Tally(
            self.ok + other.ok,
            self.failed + other.failed,
            self.kept + other.kept,
            self.samples + other.samples,
            (self.failures + other.failures)[:SHOWN],
        )


class Worker:
    """A process that samples one part at a time; it is started when needed, and again if it ended.

    Attributes
    ----------
    plan : Plan
        The plan of the run.
    pipe : Connection
        The connection to the process; `answer` is to be called when it is readable.
    deadline : float
        The time of `time.monotonic` at which `answer` is to be called at the latest.

    """

    pipe: Connection
    task: Task

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.deadline = math.inf
        self._process: Any = None
        self._about: dict[str, Any] = {}

    def begin(self, task: Task) -> None:
        """Let the process sample a part."""
        self.task, self._about = task, {}
        if self._process is not None and self._process.is_alive():
            self._send()
        else:
            self.end()
            self._start()

    def answer(self) -> dict[str, Any] | None:
        """Return the results of the part; None if it is not done yet.

        Raises FileError if the process does not start.
        """
        try:
            if not self.pipe.poll():
                self.end()
                seconds = self.plan.seconds
                return self._failed(f"takes longer than time_limit ({seconds:g} s); raise it.")
            told = json.loads(self.pipe.recv_bytes())
        except (EOFError, OSError):
            return self._failed(self._why())
        if not told:
            self._send()
        self._about |= told
        return self._about if "status" in self._about else None

    def end(self) -> None:
        """End the process."""
        if self._process is not None:
            with suppress(OSError):  # it has just ended
                if self._process.is_alive():
                    os.kill(self._process.pid, getattr(signal, "SIGKILL", signal.SIGTERM))
            self._process.join()
            self.pipe.close()
            self._process, self.deadline = None, math.inf

    def _start(self) -> None:
        # Unlike the processes of multiprocessing, those of loky do not run the user's program
        # again.
        loky = from_extra("loky.backend", "batch", "a data set").get_context("loky")
        self.pipe, theirs = loky.Pipe()
        self._process = loky.Process(
            target=serve,
            args=(theirs, self.plan.memory, os.getpid()),
            daemon=True,
            env=ENVIRONMENT | {"TMPDIR": str(self.plan.folder / PARTIAL)},
        )
        self._process.start()
        theirs.close()

    def _send(self) -> None:
        self.deadline = time.monotonic() + self.plan.seconds
        with suppress(OSError):  # it has ended: `answer` says why
            self.pipe.send_bytes(pickle.dumps(self.task))

    def _failed(self, error: str) -> dict[str, Any]:
        return self._about | {"status": FAILED, "error": error}

    def _why(self) -> str:
        """Return the reason why the process has ended."""
        process, begun = self._process, self.deadline < math.inf
        process.join(1.0)
        self.end()
        code = process.exitcode
        if not begun:
            raise FileError(
                f"the process for sampling did not start (exit code {code}); see its messages, or "
                "raise memory_limit."
            )
        how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
        return (
            f"the process that sampled it ended {how}; it may need more memory than "
            f"{self.plan.memory:g} GiB, or its function or file ends processes."
        )


def run_locally(
    plan: Plan, parts: Iterable[Input], count: int | None, workers: int
) -> Generator[Tally]:
    """Sample parts by processes on this machine; yield the tally of each part.

    All processes end if the iterator is closed, or after an error or Ctrl-C.
    """
    crew = [Worker(plan) for _ in range(workers if count is None else min(workers, count))]
    try:
        yield from sampled(parts, crew)
    finally:
        for worker in crew:
            worker.end()


def sampled(parts: Iterable[Input], crew: Sequence[Worker]) -> Generator[Tally]:
    """Sample parts by the processes of `crew`; yield the tally of each part.

    Raises FileError if the data set cannot be written.
    """
    left, idle = iter(parts), list(crew)
    busy: dict[Connection, Worker] = {}

    def begin(worker: Worker, task: Task) -> None:
        worker.begin(task)
        busy[worker.pipe] = worker

    while True:
        while idle and (part := next(left, None)) is not None:
            begin(worker := idle.pop(), _task(worker.plan, part))
        if not busy:
            return
        late = min(worker.deadline for worker in busy.values()) - time.monotonic()
        ready = wait(list(busy), None if late == math.inf else max(late, 0.0))
        for pipe, worker in list(busy.items()):
            if pipe not in ready and worker.deadline > time.monotonic():
                continue
            if (about := worker.answer()) is None:
                continue
            del busy[pipe]
            if about["status"] == FAILED and not worker.task.again:
                begin(worker, replace(worker.task, again=True))
                continue
            idle.append(worker)
            yield _done(worker.task, about)


def _task(plan: Plan, part: Input) -> Task:
    """Return the task of a part, with its row from an earlier run if the part may be kept."""
    row = row_of(plan.folder, plan.settings, part.part)
    if row is not None and (
        (row.name, row.source) != (part.name, part.source) or (plan.again and row.status == FAILED)
    ):
        row = None
    return Task(part, plan, row)


def _done(task: Task, about: dict[str, Any]) -> Tally:
    """Return the tally of a part; write its row if it failed."""
    if about["status"] == STOPPED:
        raise FileError(about["error"])
    if about["status"] == KEPT:
        assert task.before is not None
        return Tally.of(task.before, kept=True)
    row = task.row(about)
    if row.status == FAILED and row != task.before:
        write_part(task.plan.folder, task.plan.settings, row)
    return Tally.of(row, kept=False)
