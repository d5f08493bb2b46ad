"""Making a data set: what to do, on this machine or on a cluster, and watching it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sized
from contextlib import closing, contextmanager
from functools import partial
from typing import Any

from tqdm import tqdm

from ...runtime.base.checks import whole_number
from ...runtime.base.extras import check_extra
from ...runtime.base.threads import seen, thread_count
from ..files.paths import PathLike, checked_path
from .folder import FILES, Settings, opened, parts_per_shard, remove_from
from .inputs import Source, in_shards, inputs_of
from .plan import Asked, Plan, limits_of
from .running import Tally, run_locally

__all__ = ["make", "progress", "watched"]

# In seconds: how often a log gets a line.
INTERVAL = 10.0


def watched(
    tallies: Iterable[Tally], parts: int | None, dashboard: str | None, how: Mapping[str, Any]
) -> Iterator[Tally]:
    """Yield what became of the parts of shards, and show it: parts done, failures, rate, time left.

    `how` are options of tqdm. The number of parts may be unknown; `dashboard` is that of Dask.
    """
    if dashboard is not None and not how.get("disable"):
        _Lines().write(f"Dask's dashboard: {dashboard}")
    failed = 0
    # The first parts take longer, and those of an earlier run no time: the rate is a mean.
    with tqdm(total=parts, desc="sampling", unit="part", smoothing=0.1, **how) as bar:
        for tally in tallies:
            failed += tally.failed
            if failed:
                bar.set_postfix(failed=failed, refresh=False)
            bar.update(tally.parts)
            yield tally


class _Lines:
    """Standard error as a file of lines."""

    def write(self, text: str) -> None:
        if (line := text.strip()) and sys.stderr is not None:
            print(f"gaussmap: {line}", file=sys.stderr, flush=True)

    def flush(self) -> None:
        pass


def progress() -> dict[str, Any]:
    """Return how a run is shown on standard error: a bar, or a line of a log every ten seconds."""
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
    asked: Asked,
    settings: dict[str, Any],
    *,
    workers: int | None,
    scheduler: object,
    time_limit: float,
    memory_limit: float | None,
    how: Mapping[str, Any],
    overwrite: bool = False,
    again: bool = False,
) -> Tally:
    """Sample all parts into a data set; return what became of them.

    `settings` has the fields, dtype, compression and files of `Settings`, `how` options of tqdm.
    Raises InputError and FileError where `folder.opened` does, and FileError if the data set cannot
    be written.
    """
    count = thread_count(None) if workers is None else whole_number(workers, "workers")
    limits = limits_of(count, time_limit, memory_limit)
    check_extra("pyarrow", "batch", "a data set")
    check_extra("cloudpickle", "batch", "a data set")
    parts = len(sources) if isinstance(sources, Sized) else None
    wanted = Settings.of_this_version(
        asked=asked.to_json(),
        parts_per_shard=parts_per_shard(parts, asked.arguments.get("count")),
        **settings,
    )
    path = checked_path(folder).absolute()
    with _runner(count, scheduler) as (run, dashboard), opened(folder, wanted, overwrite) as known:
        if known.files is not None:
            (path / FILES).mkdir(exist_ok=True)
        plan = Plan(str(path), known, asked.stored(path), limits, again)
        shards = enumerate(in_shards(inputs_of(sources), known.parts_per_shard))
        tally = Tally()
        with closing(run(plan, shards)) as found:
            for more in watched(found, parts, dashboard, how):
                tally += more
        remove_from(path, -(-tally.parts // known.parts_per_shard), tally.parts)
        return tally


@contextmanager
def _runner(
    workers: int, scheduler: object
) -> Iterator[tuple[Callable[..., Generator[Tally]], str | None]]:
    """Yield what runs shards, here or on a cluster, and the address of Dask's dashboard."""
    if scheduler is None:
        yield partial(run_locally, workers=workers), None
        return
    from .cluster import connected, run_on_cluster

    with connected(scheduler) as client:
        yield partial(run_on_cluster, client=client), client.dashboard_link
