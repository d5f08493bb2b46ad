"""Making a data set: what to do, on this machine or on a cluster, and watching it."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Sized
from contextlib import closing, contextmanager
from functools import partial
from typing import Any

from ...runtime.base.checks import whole_number
from ...runtime.base.extras import check_extra
from ...runtime.base.threads import thread_count
from ..files.paths import PathLike, checked_path
from .folder import FILES, Settings, opened, parts_per_shard, remove_from
from .inputs import Source, in_shards, inputs_of
from .plan import Asked, Plan, limits_of
from .running import Tally, run_locally
from .watching import Watch

__all__ = ["make"]


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
    watch: Watch,
    overwrite: bool = False,
    again: bool = False,
) -> Tally:
    """Sample all parts into a data set; return what became of them.

    `settings` has the fields, dtype, compression and files of `Settings`. Raises InputError and
    FileError where `folder.opened` does, and FileError if the data set cannot be written.
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
        watch.begin(parts, dashboard)
        try:
            with closing(run(plan, shards)) as found:
                for more in found:
                    tally += more
                    watch.add(more)
        finally:
            watch.end()
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
