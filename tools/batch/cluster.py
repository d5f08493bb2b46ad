"""Running a data set on a cluster, by Dask's distributed scheduler.

A task is a few parts. A worker samples them, writes the samples into the folder of the data set,
which all machines see by the same path, and answers with a few numbers. If a worker is lost, Dask
gives its task to another one, which samples the missing parts.
"""

import multiprocessing
import threading
from collections.abc import Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

from ... import __version__
from ...runtime.base.errors import FileError, InputError, shown
from ...runtime.base.extras import from_extra
from ...runtime.machine_code.sources import digest
from .folder import SETTINGS, read_settings
from .inputs import Input
from .plan import Plan
from .workers import Tally, Worker, sampled

# The number of times that Dask repeats a task that raises an exception. The number of workers that
# a task may lose is Dask's setting `distributed.scheduler.allowed-failures`.
LOST = 10
# Seconds that a scheduler, or its first worker, may take to answer.
PATIENCE = 30
# The number of tasks that the scheduler holds for each thread of a worker; further tasks are sent
# later.
AHEAD = 2
# The largest number of parts of a task, and the least number of tasks for each thread of a worker
# if there are enough parts.
MOST_PARTS, LEAST_TASKS = 64, 8

_HERE = threading.local()


@contextmanager
def connected(scheduler: Any) -> Iterator[Any]:  # noqa: ANN401
    """Yield a client of Dask: the given one, or one that is connected to a cluster or address.

    Raises FileError if no scheduler answers, InputError for any other argument.
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
    parts: Iterable[Input],
    count: int | None,
    client: Any,  # noqa: ANN401
) -> Generator[Tally]:
    """Sample parts on a cluster; yield the tally of each task, which has a few parts.

    `count` is the number of all parts, if it is known. Closing the iterator cancels waiting tasks.

    Raises FileError if workers have another version or do not see the folder of the data set, and
    if the scheduler is lost. Workers finish their current tasks even if a run is stopped.
    """
    distributed = from_extra("distributed", "cluster", "sampling on a cluster")
    threads = _checked_workers(client, plan)
    executor = client.get_executor(pure=False, retries=LOST)
    size = min(MOST_PARTS, max(1, (count or 0) // (LEAST_TASKS * threads)))
    left, waiting = iter(parts), set[Future[Tally]]()
    try:
        while True:
            while len(waiting) < AHEAD * threads and (some := list(islice(left, size))):
                waiting.add(executor.submit(work, plan, some))
            if not waiting:
                return
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
    except (CancelledError, distributed.scheduler.KilledWorker) as error:
        raise FileError(
            f"the cluster has lost parts ({type(error).__name__}): its scheduler has ended, or "
            "workers end again and again; what is done is kept: run the same again."
        ) from error
    finally:
        for future in waiting:
            future.cancel()


def work(plan: Plan, parts: Sequence[Input]) -> Tally:
    """Sample parts on a worker of Dask, in a process that belongs to the worker's thread."""
    # Dask forbids its workers to have child processes, which could be left behind. The process that
    # samples ends with its parent (`end_with_parent`), so that it cannot be left behind.
    multiprocessing.current_process().daemon = False
    worker = getattr(_HERE, "worker", None)
    if worker is None or worker.plan.run != plan.run:
        if worker is not None:
            worker.end()
        worker = _HERE.worker = Worker(plan)
    # A task of a cancelled run may start after another run has begun.
    if read_settings(plan.folder).to_json() != plan.settings.to_json():
        raise FileError(f"'{plan.folder}' holds another data set by now.")
    return sum(sampled(parts, [worker]), Tally())


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


def state_of(folder: Path) -> tuple[str, str, bool]:
    """Return a worker's version of gaussmap, its digest of formulas, and whether it sees `folder`.

    A worker sees the folder if the settings of the data set exist at this path.
    """
    return __version__, digest(), (folder / SETTINGS).is_file()
