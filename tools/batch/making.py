"""Making a data set on this machine or on a cluster, with its progress."""

import sys
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sized
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from ...runtime.base.checks import positive_number, whole_number
from ...runtime.base.extras import check_extra
from ...runtime.base.memory import GIB
from ...runtime.base.memory import memory_limit as most_memory
from ...runtime.base.threads import seen, thread_count
from ..files.paths import PathLike, atomic_path, checked_path
from .folder import NORMALS, opened, remove_from
from .inputs import Source, inputs_of
from .part_files import write_manifest
from .plan import Plan
from .workers import Tally, run_locally

# The share of this machine's memory that all workers together may use.
SHARE = 0.9

# Seconds between two lines of a log.
INTERVAL = 10.0


def watched(
    tallies: Iterable[Tally], parts: int | None, dashboard: str | None, how: Mapping[str, Any]
) -> Iterator[Tally]:
    """Yield tallies of parts, and show the progress: parts done, failures, rate, time left.

    `parts` is the number of parts, None if it is unknown; `dashboard` is the address of Dask's
    dashboard; `how` are options of tqdm.
    """
    if dashboard is not None and not how.get("disable"):
        _Lines().write(f"Dask's dashboard: {dashboard}")
    failed = 0
    # The rate is a moving mean, since the first parts take longer, and parts of an earlier run take
    # no time.
    with tqdm(total=parts, desc="sampling", unit="part", smoothing=0.1, **how) as bar:
        for tally in tallies:
            failed += tally.failed
            if failed:
                bar.set_postfix(failed=failed, refresh=False)
            bar.update(tally.parts)
            yield tally


class _Lines:
    """A file-like object that prints each text as a line on standard error."""

    def write(self, text: str) -> None:
        if (line := text.strip()) and sys.stderr is not None:
            print(f"gaussmap: {line}", file=sys.stderr, flush=True)

    def flush(self) -> None:
        pass


def progress() -> dict[str, Any]:
    """Return the options of progress on standard error: a bar, or a log line every ten seconds."""
    if seen(True):
        return {}
    return {
        "file": _Lines(),
        "bar_format": "{n} of {total} parts{postfix}, {rate_fmt}, {remaining} left",
        "mininterval": INTERVAL,
        "miniters": 1,
        "delay": INTERVAL,
        "leave": False,
    }


def make(
    sources: Iterable[Source],
    folder: PathLike,
    plan: Plan,
    normals: NDArray[np.float64] | None,
    *,
    workers: int | None,
    scheduler: object,
    time_limit: float,
    memory_limit: float | None,
    how: Mapping[str, Any],
    overwrite: bool = False,
    again: bool = False,
) -> Tally:
    """Sample all parts into a data set; return the tally of all parts.

    `plan` describes the requested samples; they are at `normals`, if normals are prescribed. `how`
    are options of tqdm. Raises InputError and FileError as `folder.opened` does, and FileError if
    the data set cannot be written.
    """
    count = thread_count(None) if workers is None else whole_number(workers, "workers")
    seconds, memory = limits_of(count, time_limit, memory_limit)
    for module in ("pyarrow", "cloudpickle", "loky"):
        check_extra(module, "batch", "a data set")
    parts = len(sources) if isinstance(sources, Sized) else None
    path = checked_path(folder).absolute()
    plan = replace(plan, folder=path, seconds=seconds, memory=memory, again=again)
    with _runner(count, scheduler) as (run, dashboard), opened(path, plan.settings, overwrite):
        if normals is not None:
            with atomic_path(path / NORMALS) as temporary:
                np.save(temporary, normals, allow_pickle=False)
        tally = Tally()
        with closing(run(plan, inputs_of(sources), parts)) as found:
            for more in watched(found, parts, dashboard, how):
                tally += more
        remove_from(path, tally.parts)
        write_manifest(path, plan.settings, range(tally.parts))
        return tally


def limits_of(workers: int, seconds: float, memory: float | None) -> tuple[float, float]:
    """Return the time limit of a part, and the memory limit of each of `workers` processes."""
    share = SHARE * most_memory() / GIB / workers
    return (
        positive_number(seconds, "time_limit", "seconds"),
        positive_number(share if memory is None else memory, "memory_limit", "GiB"),
    )


@contextmanager
def _runner(
    workers: int, scheduler: object
) -> Iterator[tuple[Callable[..., Generator[Tally]], str | None]]:
    """Yield the function that samples parts, here or by Dask, and the address of the dashboard."""
    if scheduler is None:
        yield partial(run_locally, workers=workers), None
        return
    from .cluster import connected, run_on_cluster

    with connected(scheduler) as client:
        yield partial(run_on_cluster, client=client), client.dashboard_link
