"""Compiled loops over ranges on several threads: kernels release the global lock."""

import os
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from itertools import islice
from typing import TypeVar

from .checks import whole_number, yes_or_no

Result = TypeVar("Result")

# The number of ranges per thread that are computed ahead of use.
AHEAD = 4


def thread_count(threads: int | None) -> int:
    """Return the number of threads: `threads`, else NUMBA_NUM_THREADS, else one for each core."""
    if threads is not None:
        return whole_number(threads, "threads")
    cores = (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    )
    asked = os.environ.get("NUMBA_NUM_THREADS", "")
    return int(asked) if asked.isdecimal() and int(asked) > 0 else cores


def over_ranges(
    work: Callable[[int, int], Result],
    total: int,
    size: int,
    threads: int | None,
    progress: bool = False,
) -> Iterator[Result]:
    """Yield work(first, last) for consecutive ranges of `size` that divide [0, total), in order.

    At most a few results for each thread are computed ahead; closing the iterator ends the work.
    With `progress`, a bar on standard error shows work that takes longer than a second.
    """
    if total <= size and not seen(progress):
        if total > 0:
            yield work(0, total)
        return
    starts = range(0, total, size)
    workers = min(thread_count(threads), len(starts))
    # Nested work runs in the thread that calls it: all threads of the pool may be waiting for such
    # work.
    if workers <= 1 or getattr(_HERE, "is_worker", False):
        results = (work(first, min(first + size, total)) for first in starts)
    else:
        results = _in_threads(lambda first: work(first, min(first + size, total)), starts, workers)
    yield from shown(results, len(starts), progress)


def _in_threads(
    work: Callable[[int], Result], starts: Iterable[int], workers: int
) -> Iterator[Result]:
    """Yield work(start) in order; threads compute at most AHEAD ranges per thread ahead."""
    waiting, pool = iter(starts), _pool(workers)
    ahead = deque(pool.submit(work, start) for start in islice(waiting, AHEAD * workers))
    try:
        while ahead:
            result = ahead.popleft().result()
            ahead.extend(pool.submit(work, start) for start in islice(waiting, 1))
            yield result
            del result  # so that the result is not kept alive while the next one is computed
    finally:
        for future in ahead:  # after an error or Ctrl-C, cancel the remaining ranges
            future.cancel()


def interruptible(work: Callable[[], Result]) -> Result:
    """Return work(), a long compiled call; another thread runs it, so that Ctrl-C need not wait."""
    if getattr(_HERE, "is_worker", False):
        return work()
    return next(_in_threads(lambda _: work(), (0,), 1))


@cache
def _pool(workers: int) -> ThreadPoolExecutor:
    """Return a cached pool of threads: its start takes as long as a search of a small surface."""

    def begin() -> None:
        _HERE.is_worker = True

    return ThreadPoolExecutor(workers, "gaussmap", begin)


_HERE = threading.local()
# A forked child process has no threads, and starts its own.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.cache_clear)


def shown(results: Iterator[Result], count: int, progress: bool) -> Iterator[Result]:
    """Yield results; with `progress`, a terminal shows a bar of `count` steps."""
    # tqdm shows nothing without a terminal, and its import takes longer than a small sampling.
    if not seen(progress):
        return results
    from tqdm import tqdm

    return iter(tqdm(results, total=count, delay=1.0, leave=False, disable=None))


@contextmanager
def counted(count: int | None, progress: bool) -> Iterator[Callable[[int], object]]:
    """Yield a function that takes the number of finished steps, and shows it on a terminal.

    `count` is the number of all steps, if known.
    """
    if not seen(progress):
        yield lambda done: None
        return
    from tqdm import tqdm

    with tqdm(total=count, delay=1.0, leave=False, disable=None) as bar:
        yield lambda done: bar.update(done - bar.n)


def seen(progress: bool) -> bool:
    """Return whether progress is requested and standard error is a terminal."""
    return yes_or_no(progress, "progress") and sys.stderr is not None and sys.stderr.isatty()
