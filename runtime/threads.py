"""Running a compiled loop over ranges on several threads: kernels hold no lock."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from .checks import whole_number

__all__ = ["over_ranges", "thread_count"]

Result = TypeVar("Result")


def thread_count(threads: int | None) -> int:
    """Return how many threads to use: as asked, else NUMBA_NUM_THREADS, else one a core."""
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
    """Yield work(first, last) for the consecutive ranges of `size` in 0 … total, in order.

    With `progress`, a bar on standard error shows work that takes longer than a second.
    """
    ranges = [(first, min(first + size, total)) for first in range(0, total, size)]
    workers = min(thread_count(threads), len(ranges))
    if workers <= 1:
        yield from _shown((work(first, last) for first, last in ranges), len(ranges), progress)
        return
    with ThreadPoolExecutor(workers) as pool:
        try:
            yield from _shown(pool.map(lambda ends: work(*ends), ranges), len(ranges), progress)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)  # Ctrl-C must not wait for all ranges
            raise


def _shown(results: Iterator[Result], count: int, progress: bool) -> Iterator[Result]:
    if not progress:
        return results
    from tqdm import tqdm

    return iter(tqdm(results, total=count, delay=1.0, leave=False, disable=None))
