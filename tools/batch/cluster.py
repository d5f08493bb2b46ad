"""Running a data set on a cluster, by Dask's distributed scheduler.

A task is a shard: the worker that gets it writes it into the folder of the data set, which all
machines see by the same path, and answers with a few numbers. What a lost worker has done of a
shard is in that folder; Dask gives the shard to another one.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ... import __version__
from ...runtime.base.errors import FileError, InputError, shown
from ...runtime.base.extras import from_extra
from ...runtime.machine_code.sources import digest
from .folder import SETTINGS
from .inputs import Input
from .plan import Plan
from .running import Tally, run

__all__ = ["connected", "run_on_cluster"]

# How often a shard is given to another worker after one was lost.
LOST = 10
# In seconds: how long a scheduler, and its first worker, may take to answer.
PATIENCE = 30


@contextmanager
def connected(scheduler: Any) -> Iterator[Any]:  # noqa: ANN401
    """Yield a client of Dask for a client, a cluster or an address.

    Raises FileError if nobody answers there, InputError for anything else.
    """
    distributed = from_extra("distributed", "cluster", "sampling on a cluster")
    if isinstance(scheduler, distributed.Client):
        yield scheduler
        return
    if not isinstance(scheduler, str) and not hasattr(scheduler, "scheduler_address"):
        raise InputError(
            "scheduler must be a client of Dask, or the address of a scheduler such as "
            f'"tcp://host:8786", not {shown(scheduler)}.'
        )
    try:
        client = distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise FileError(
            f"no scheduler of Dask answers at {shown(scheduler)}: look at the address, and that "
            "`dask scheduler` runs there."
        ) from error
    with client:
        yield client


def run_on_cluster(
    plan: Plan,
    shards: Iterable[tuple[int, Sequence[Input]]],
    client: Any,  # noqa: ANN401
) -> Generator[Tally]:
    """Yield what became of each shard, when it is finished.

    Raises FileError if workers have another version or do not see the folder of the data set, and
    if the scheduler is lost. Workers finish the shards that they are at even if a run is stopped.
    """
    distributed = from_extra("distributed", "cluster", "sampling on a cluster")
    threads = _checked_workers(client, plan)
    try:
        yield from run(plan, shards, client.get_executor(pure=False, retries=LOST), threads)
    except (CancelledError, distributed.scheduler.KilledWorker) as error:
        raise FileError(
            f"the cluster has lost shards ({type(error).__name__}): its scheduler has ended, or "
            "workers end again and again; what is done is kept: run the same again."
        ) from error


def _checked_workers(client: Any, plan: Plan) -> int:  # noqa: ANN401
    """Return the number of threads of all workers; FileError if they cannot do the work."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise FileError(
            "the scheduler of Dask has no workers; start some with `dask worker ADDRESS`."
        ) from None
    for worker, (version, code, sees) in client.run(state_of, plan.folder).items():
        if (version, code) != (__version__, digest()):
            raise FileError(
                f"worker {worker} has another version of gaussmap ({version}, formulas {code}) "
                f"than this program ({__version__}, formulas {digest()}); install the same one."
            )
        if not sees:
            raise FileError(
                f"worker {worker} does not see '{plan.folder}': name a folder of a file system "
                "that all machines share."
            )
    return sum(client.nthreads().values())


def state_of(folder: str) -> tuple[str, str, bool]:
    """Return the version of a worker's package, its formulas, and whether it sees the folder."""
    return __version__, digest(), (Path(folder) / SETTINGS).is_file()
