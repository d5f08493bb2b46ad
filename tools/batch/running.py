"""Sampling the parts of a shard: what is done is kept, and what fails is a row of the manifest."""

from __future__ import annotations

import atexit
import signal
import threading
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Self

from ...runtime.base.errors import FileError
from .child import Child
from .folder import read_settings
from .inputs import Input
from .manifest import FAILED, ManifestRow
from .plan import Plan
from .serving import Task
from .shards import Shard

__all__ = ["Tally", "run", "run_locally", "run_shard", "use"]

# How often a part is tried that fails.
ATTEMPTS = 2
# So many failures are shown when a run ends; the manifest has all.
SHOWN = 10
# Shards for each worker that wait: executors know of no others.
AHEAD = 2

_HERE = threading.local()


@dataclass(frozen=True, slots=True)
class Tally:
    """What became of parts: how many are sampled, failed, or done by an earlier run.

    `failures` are the names of the first ones, and why.
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


def run(
    plan: Plan, shards: Iterable[tuple[int, Sequence[Input]]], executor: Executor, workers: int
) -> Generator[Tally]:
    """Yield what became of each shard, when it is finished; closing it cancels those that wait."""
    left = iter(shards)
    waiting: set[Future[Tally]] = set()
    try:
        while True:
            for number, inputs in islice(left, AHEAD * workers - len(waiting)):
                waiting.add(executor.submit(work, plan, number, inputs))
            if not waiting:
                return
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
    finally:
        for future in waiting:
            future.cancel()


def use(child: Child) -> None:
    """Let this thread do its shards by a process that others end."""
    _HERE.child = child


def work(plan: Plan, number: int, inputs: Sequence[Input]) -> Tally:
    """Do a shard by the process of this thread; one of a cluster's workers starts its own."""
    child = getattr(_HERE, "child", None)
    if child is None or child.limits != plan.limits:
        if child is not None:
            child.end()
        child = _HERE.child = Child(plan.limits)
        atexit.register(child.end)
    return run_shard(plan, number, inputs, child)


def run_shard(plan: Plan, number: int, inputs: Sequence[Input], child: Child) -> Tally:
    """Do what is missing of a shard, and finish it.

    Raises FileError if the data set cannot be written.
    """
    tally = Tally()
    shard = Shard(Path(plan.folder), number, plan.settings)
    before_all = dict(shard.rows)
    for part in inputs:
        before = shard.rows.get(part.part)
        found = _tried(plan, part, child, before)
        row = found or before
        assert row is not None
        if row.status != FAILED:
            shard.rows[part.part] = row  # whose samples are written
        elif before is None or replace(before, seconds=0.0) != replace(row, seconds=0.0):
            shard.add(row)
        tally += Tally.of(row, kept=found is None)
    # A worker of Dask that nobody waits for may come after another run.
    if read_settings(plan.folder).to_json() != plan.settings.to_json():
        raise FileError(f"'{plan.folder}' holds another data set by now.")
    shard.commit([part.part for part in inputs])
    _remove_files(plan, before_all, inputs)
    return tally


def _remove_files(plan: Plan, before: Mapping[int, ManifestRow], inputs: Sequence[Input]) -> None:
    """Remove the files of parts that are not in the list any more, or have another name now."""
    kept = {plan.file(part) for part in inputs}
    for file in {plan.file(row) for row in before.values()} - kept:
        if file is not None:
            file.unlink(missing_ok=True)


def _tried(plan: Plan, part: Input, child: Child, before: ManifestRow | None) -> ManifestRow | None:
    """Return what became of a part, after some attempts; None if it need not be done again."""
    known = _known(plan, part, before)
    row = child.sample(Task(part, plan, known))
    for attempt in range(2, ATTEMPTS + 1):
        if row is None or row.status != FAILED:
            break
        row = child.sample(Task(part, plan, known, attempt))
    return row


def _known(plan: Plan, part: Input, before: ManifestRow | None) -> str:
    """Return the content of a part that need not be done again, if it has not changed."""
    if before is None or (before.name, before.source) != (part.name, part.source):
        return ""
    if before.status == FAILED:
        return "" if plan.again else before.content
    file = plan.file(part)
    return before.content if file is None or file.exists() else ""


def run_locally(
    plan: Plan, shards: Iterable[tuple[int, Sequence[Input]]], workers: int
) -> Generator[Tally]:
    """Yield what became of each shard, when it is finished.

    Each worker is a process, and a thread here that waits for it. Closing the iterator, errors and
    Ctrl-C end all processes.
    """
    children = [Child(plan.limits) for _ in range(workers)]
    free = iter(children)
    pool = ThreadPoolExecutor(workers, "gaussmap-batch", lambda: use(next(free)))
    try:
        yield from run(plan, shards, pool, workers)
    finally:
        with _without_ctrl_c():
            for child in children:
                child.end()
            pool.shutdown(cancel_futures=True)


@contextmanager
def _without_ctrl_c() -> Iterator[None]:
    """Let a second Ctrl-C not break off ending all processes, which takes a moment only."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)
