"""Making a data set: what to do, on this machine or on a cluster, and watching it."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Sized
from contextlib import closing, contextmanager
from functools import partial
from typing import Any, Protocol

from ...runtime.base.extras import check_extra
from ..files.paths import PathLike, checked_path
from .arguments import Where
from .asked import Asked
from .folder import FILES, Settings, opened, parts_per_shard, remove_files, remove_shards
from .inputs import Source, in_shards, inputs_of
from .local import run_locally
from .running import Plan, Tally

__all__ = ["Unwatched", "Watch", "make"]


class Watch(Protocol):
    """What is told of a run while it goes on, in the process that started it."""

    def begin(self, parts: int | None, dashboard: str | None) -> None:
        """Hear of the number of parts, if it is known, and the address of Dask's dashboard."""

    def add(self, tally: Tally) -> None:
        """Hear what became of the parts of a shard."""

    def end(self, tally: Tally) -> None:
        """Hear what became of all parts; not called if the run is stopped."""


class Unwatched:
    """Says nothing."""

    def begin(self, parts: int | None, dashboard: str | None) -> None:
        """Say nothing."""

    def add(self, tally: Tally) -> None:
        """Say nothing."""

    def end(self, tally: Tally) -> None:
        """Say nothing."""


def make(
    sources: Iterable[Source],
    folder: PathLike,
    asked: Asked,
    settings: dict[str, Any],
    where: Where,
    *,
    watch: Watch,
    overwrite: bool = False,
    again: bool = False,
) -> Tally:
    """Sample all parts into a data set; return what became of them.

    `settings` has the fields, dtype, compression and files of `Settings`. Raises InputError and
    FileError where `layout.opened` does, and FileError if the data set cannot be written.
    """
    check_extra("pyarrow", "batch", "a data set")
    check_extra("cloudpickle", "batch", "a data set")
    parts = len(sources) if isinstance(sources, Sized) else None
    wanted = Settings.of_this_version(
        asked=asked.to_json(),
        parts_per_shard=parts_per_shard(parts, asked.arguments.get("count")),
        **settings,
    )
    path = checked_path(folder).absolute()
    with _runner(where) as (run, dashboard), opened(folder, wanted, overwrite) as known:
        if known.files is not None:
            (path / FILES).mkdir(exist_ok=True)
        plan = Plan(str(path), known, asked.stored(path), where.limits, again)
        shards = enumerate(in_shards(inputs_of(sources), known.parts_per_shard))
        watch.begin(parts, dashboard)
        tally = _watched(run(plan, shards), watch)
        remove_shards(path, -(-tally.parts // known.parts_per_shard))
        if known.files is not None:
            remove_files(path, tally.parts)
        return tally


@contextmanager
def _runner(where: Where) -> Iterator[tuple[Callable[..., Generator[Tally]], str | None]]:
    """Yield what runs shards, here or on a cluster, and the address of Dask's dashboard."""
    if where.scheduler is None:
        yield partial(run_locally, workers=where.workers), None
        return
    from .cluster import connected, run_on_cluster

    with connected(where.scheduler) as client:
        yield partial(run_on_cluster, client=client), client.dashboard_link


def _watched(tallies: Generator[Tally], watch: Watch) -> Tally:
    total = Tally()
    with closing(tallies):
        for tally in tallies:
            total += tally
            watch.add(tally)
    watch.end(total)
    return total
