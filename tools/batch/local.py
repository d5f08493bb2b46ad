"""Running a data set on the cores of this machine."""

from __future__ import annotations

import signal
import threading
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

from .child import Child
from .inputs import Input
from .plan import Plan
from .running import Tally, run, use

__all__ = ["run_locally"]


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
