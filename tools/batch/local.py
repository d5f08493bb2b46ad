"""Running a data set on the cores of this machine."""

from __future__ import annotations

import signal
import threading
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice

from .child import Child
from .inputs import Input
from .running import Plan, Tally, run_shard

__all__ = ["run_locally"]

# Shards for each worker that wait.
AHEAD = 2


def run_locally(
    plan: Plan, shards: Iterable[tuple[int, Sequence[Input]]], workers: int
) -> Generator[Tally]:
    """Yield what became of each shard, when it is finished.

    Each worker is a process, and a thread here that waits for it. Closing the iterator, errors and
    Ctrl-C end all processes.
    """
    children = [Child(plan.limits) for _ in range(workers)]
    free, here = iter(children), threading.local()

    def begin() -> None:
        here.child = next(free)

    def work(number: int, inputs: Sequence[Input]) -> Tally:
        return run_shard(plan, number, inputs, here.child)

    pool = ThreadPoolExecutor(workers, "gaussmap-batch", begin)
    waiting: set[Future[Tally]] = set()
    try:
        left = iter(shards)
        while True:
            for number, inputs in islice(left, AHEAD * workers - len(waiting)):
                waiting.add(pool.submit(work, number, inputs))
            if not waiting:
                return
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
    finally:
        with _without_ctrl_c():
            for future in waiting:
                future.cancel()
            for child in children:
                child.end()
            pool.shutdown()


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
